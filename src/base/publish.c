#include "record/publish.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"

static ShvStatus fail_system(ShvError *error, const char *what, const char *path, int number)
{
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    return shv_fail(error, SHV_FILE_ERROR, "cannot %s '%s': %s; check the folder and its permissions", what, path,
                    reason);
}

static ShvStatus fail_existing(ShvError *error, const char *path)
{
    return shv_fail(error, SHV_BAD_INPUT, "'%s' exists already; choose another name, or replace it with --force", path);
}

ShvStatus shv_publish_check(const char *path, bool force, ShvError *error)
{
    struct stat found;
    if (!path || path[0] == '\0') return shv_fail(error, SHV_BAD_INPUT, "the output file has no name; give one");
    if (stat(path, &found) != 0) return errno == ENOENT ? SHV_OK : fail_system(error, "write", path, errno);
    if (!S_ISREG(found.st_mode))
        return shv_fail(error, SHV_BAD_INPUT, "'%s' is not an ordinary file; choose another name", path);
    return force ? SHV_OK : fail_existing(error, path);
}

ShvStatus shv_publish_begin(ShvMemory *memory, const char *path, char **temporary, int *descriptor, ShvError *error)
{
    const size_t size = strlen(path) + 48;
    *descriptor = -1;
    *temporary = shv_allocate(memory, SHV_PART_RECORD, size, 1);
    if (!*temporary) return shv_fail_memory(error, "a file name", size);
    for (int i = 0; i < 1000 && *descriptor < 0; i++) {
        shv_format(*temporary, size, "%s.%ld-%d.part", path, (long)getpid(), i);
        *descriptor = open(*temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (*descriptor < 0 && errno != EEXIST) break;
    }
    if (*descriptor >= 0) return SHV_OK;
    const ShvStatus status = fail_system(error, "write", path, errno);
    shv_release(*temporary);
    *temporary = NULL;
    return status;
}

ShvStatus shv_publish_end(const char *temporary, const char *path, bool force, ShvError *error)
{
    if (!force) {
        /* A link never replaces what is there; a file system without links leaves only the check. */
        if (link(temporary, path) == 0) {
            unlink(temporary);
            return SHV_OK;
        }
        if (errno == EEXIST) return fail_existing(error, path);
        SHV_TRY(shv_publish_check(path, false, error));
    }
    return rename(temporary, path) == 0 ? SHV_OK : fail_system(error, "write", path, errno);
}
