/* New files under a temporary name that take their own name when they hold something. */
#ifndef SHV_RECORD_PUBLISH_H
#define SHV_RECORD_PUBLISH_H

#include <stdbool.h>

#include "base/memory.h"

/* Whether a new file may get this name: SHV_BAD_INPUT when a file is there and `force` is false, or when what is there
   is no ordinary file; SHV_FILE_ERROR when the folder is missing. */
ShvStatus shv_publish_check(const char *path, bool force, ShvError *error);
/* Makes and opens (read and write) a new file beside `path` named "path.PID-N.part"; the caller releases *temporary. */
ShvStatus shv_publish_begin(ShvMemory *memory, const char *path, char **temporary, int *descriptor, ShvError *error);
/* Gives the file its name. Without `force`, a file that has appeared at `path` in the meantime is left alone. */
ShvStatus shv_publish_end(const char *temporary, const char *path, bool force, ShvError *error);

#endif
