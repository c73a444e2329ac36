#include "files.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int make_folder(void **state)
{
    char *folder = malloc(64);
    if (!folder) return -1;
    strcpy(folder, "/tmp/shiver_test_XXXXXX");
    *state = folder;
    return mkdtemp(folder) ? 0 : -1;
}

static int for_files(const char *folder, int remove_them)
{
    int count = 0;
    DIR *list = opendir(folder);
    if (!list) return -1;
    for (const struct dirent *entry = readdir(list); entry; entry = readdir(list)) {
        if (entry->d_name[0] == '.') continue;
        count++;
        if (remove_them) unlink(file_in(folder, entry->d_name));
    }
    closedir(list);
    return count;
}

int remove_folder(void **state)
{
    for_files(*state, 1);
    const int status = rmdir(*state);
    free(*state);
    return status;
}

const char *file_in(const void *folder, const char *name)
{
    static char paths[8][512];
    static int next = 0;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof paths[0], "%s/%s", (const char *)folder, name);
    return path;
}

int files_in(const void *folder)
{
    return for_files(folder, 0);
}

long file_size(const char *path)
{
    struct stat found;
    return stat(path, &found) == 0 ? (long)found.st_size : -1;
}

void write_file(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file) return;
    fwrite(data, 1, size, file);
    fclose(file);
}

char *read_bytes(const char *path)
{
    const long size = file_size(path);
    char *data = calloc((size_t)size + 1, 1);
    FILE *file = fopen(path, "rb");
    if (data && file && fread(data, 1, (size_t)size, file) != (size_t)size) data[0] = '\0';
    if (file) fclose(file);
    return data;
}
