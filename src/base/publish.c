#include "base/publish.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
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

/* A writer of a run file holds an exclusive lock on it. */
static bool is_being_written(const char *path)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return false;
    const bool locked = flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    close(descriptor);
    return locked;
}

ShvStatus shv_publish_check(const char *path, bool force, ShvError *error)
{
    struct stat found;
    if (!path || path[0] == '\0') return shv_fail(error, SHV_BAD_INPUT, "the output file has no name; give one");
    if (stat(path, &found) != 0) return errno == ENOENT ? SHV_OK : fail_system(error, "write", path, errno);
    if (!S_ISREG(found.st_mode))
        return shv_fail(error, SHV_BAD_INPUT, "'%s' is not an ordinary file; choose another name", path);
    if (is_being_written(path))
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%s' is being written by another process; choose another name, or wait until that has ended",
                        path);
    return force ? SHV_OK : fail_existing(error, path);
}

/* A new file, its descriptor above those of the standard streams. */
static int open_new(const char *path, mode_t mode)
{
    const int low = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (low < 0 || low > STDERR_FILENO) return low;
    const int descriptor = fcntl(low, F_DUPFD_CLOEXEC, STDERR_FILENO + 1), number = errno;
    close(low);
    errno = number;
    return descriptor;
}

ShvStatus shv_publish_begin(ShvMemory *memory, const char *path, char **temporary, int *descriptor, ShvError *error)
{
    const size_t size = strlen(path) + 48;
    struct stat old;
    const bool replaces = stat(path, &old) == 0;
    *descriptor = -1;
    *temporary = shv_allocate(memory, SHV_PART_RECORD, size, 1);
    if (!*temporary) return shv_fail_memory(error, "a file name", size);
    for (int i = 0; i < 1000 && *descriptor < 0; i++) {
        shv_format(*temporary, size, "%s.%ld-%d.part", path, (long)getpid(), i);
        *descriptor = open_new(*temporary, 0666);
        if (*descriptor < 0 && errno != EEXIST) break;
    }
    if (*descriptor >= 0) {
        if (replaces) (void)fchmod(*descriptor, old.st_mode & 0777);
        return SHV_OK;
    }
    const ShvStatus status = fail_system(error, "write", path, errno);
    shv_release(*temporary);
    *temporary = NULL;
    return status;
}

ShvStatus shv_publish_sync(int descriptor, const char *path, ShvError *error)
{
    if (fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP) return SHV_OK;
    return fail_system(error, "bring to the disk", path, errno);
}

ShvStatus shv_publish_sync_folder(const char *path, ShvError *error)
{
    char *folder = NULL;
    SHV_TRY(shv_path_folder(NULL, SHV_PART_RECORD, path, &folder, error));
    const int descriptor = open(folder[0] ? folder : ".", O_RDONLY | O_CLOEXEC | O_DIRECTORY);
    shv_release(folder);
    /* A folder that may be written to but not be read has no descriptor to sync. */
    if (descriptor < 0) return SHV_OK;
    const ShvStatus status = shv_publish_sync(descriptor, path, error);
    close(descriptor);
    return status;
}

static ShvStatus take_name(const char *temporary, const char *path, bool force, ShvError *error)
{
    if (!force) {
        /* A link never replaces what is there; a file system without links leaves only the check. */
        if (link(temporary, path) == 0) {
            unlink(temporary);
            return SHV_OK;
        }
        if (errno == EEXIST) return fail_existing(error, path);
    }
    SHV_TRY(shv_publish_check(path, force, error));
    return rename(temporary, path) == 0 ? SHV_OK : fail_system(error, "write", path, errno);
}

ShvStatus shv_publish_end(const char *temporary, int descriptor, const char *path, bool force, ShvError *error)
{
    SHV_TRY(shv_publish_sync(descriptor, path, error));
    SHV_TRY(take_name(temporary, path, force, error));
    return shv_publish_sync_folder(path, error);
}
