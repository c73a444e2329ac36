/* A folder of its own for each test, and whole files. */
#ifndef SHV_TESTS_FILES_H
#define SHV_TESTS_FILES_H

#include <stddef.h>

/* Setup and teardown of CMocka: *state is the folder's path. */
int make_folder(void **state);
int remove_folder(void **state);
/* "folder/name", valid until the eighth next call. */
const char *file_in(const void *folder, const char *name);
int files_in(const void *folder);
long file_size(const char *path);
void write_file(const char *path, const void *data, size_t size);
/* file_size bytes and a terminator, to be freed. */
char *read_bytes(const char *path);

#endif
