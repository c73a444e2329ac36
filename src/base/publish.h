/* New files under a temporary name that take their own name when they hold something. */
#ifndef SHV_BASE_PUBLISH_H
#define SHV_BASE_PUBLISH_H

#include <stdbool.h>

#include "base/memory.h"

/* Whether a new file may get this name: SHV_BAD_INPUT when a file is there and `force` is false, when what is there is no
   ordinary file, or when another process is writing it; SHV_FILE_ERROR when the folder is missing. */
ShvStatus shv_publish_check(const char *path, bool force, ShvError *error);
/* Makes and opens (read and write) a new file beside `path` named "path.PID-N.part", with the permissions of the file that
   is there. The descriptor is never one of the standard streams. The caller releases *temporary. */
ShvStatus shv_publish_begin(ShvMemory *memory, const char *path, char **temporary, int *descriptor, ShvError *error);
/* Brings the file's bytes to the disk, gives it its name, and brings that to the disk, too. Without `force`, a file that has
   appeared at `path` in the meantime is left alone; one that another process is writing is left alone in any case. */
ShvStatus shv_publish_end(const char *temporary, int descriptor, const char *path, bool force, ShvError *error);
/* Brings to the disk what was written to a descriptor; that file systems without such a thing refuse is no failure. */
ShvStatus shv_publish_sync(int descriptor, const char *path, ShvError *error);
/* The same for the names in the folder of a file. */
ShvStatus shv_publish_sync_folder(const char *path, ShvError *error);

#endif
