/* Paths, whole files, and strict numbers of text files. */
#ifndef SHV_BASE_FILE_H
#define SHV_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

/* `file` as seen from `folder`: itself when it is absolute or `folder` is NULL or empty, else "folder/file".
   The caller releases *path. */
ShvStatus shv_path_join(ShvMemory *memory, ShvPart part, const char *folder, const char *file, char **path,
                        ShvError *error);
/* The folder of a file's path as a text for shv_path_join: "a/b" of "a/b/c.yaml", "" of "c.yaml". The caller
   releases *folder. */
ShvStatus shv_path_folder(ShvMemory *memory, ShvPart part, const char *path, char **folder, ShvError *error);

/* Makes a folder whose parent is there; one that exists already is as good. */
ShvStatus shv_make_folder(const char *path, ShvError *error);

/* Whether both names lead to one existing file. */
bool shv_same_file(const char *a, const char *b);

/* Reads a whole file, or what comes through a pipe, of at most `limit` bytes into a block of *size bytes and a
   terminating zero that does not count. SHV_FILE_ERROR when it cannot be read (also a folder, or a pipe that nobody writes
   to), SHV_BAD_INPUT when it is longer or a device. On failure *data is NULL. The caller releases *data. */
ShvStatus shv_read_file(ShvMemory *memory, ShvPart part, const char *path, size_t limit, char **data, size_t *size,
                        ShvError *error);

/* The whole of text[0 … length) as a decimal number ("1", "-2.5", ".5", "7.", "3e-6"), in the C locale. Also "inf",
   "infinity" and "nan", with sign and in any case, when `special` is true. SHV_BAD_INPUT for anything else and
   for magnitudes beyond the largest double; what is too small becomes 0 or a subnormal number. */
ShvStatus shv_parse_double(const char *text, size_t length, bool special, double *value, ShvError *error);
/* The whole of text[0 … length) as a decimal whole number with optional sign. */
ShvStatus shv_parse_int64(const char *text, size_t length, int64_t *value, ShvError *error);

#endif
