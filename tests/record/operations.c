#include "operations.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static OperationHook hook;

void operations_hook(OperationHook next)
{
    hook = next;
}

static uint64_t file_of(int descriptor)
{
    struct stat about;
    return fstat(descriptor, &about) == 0 ? (uint64_t)about.st_ino : 0;
}

static uint64_t file_at(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 ? (uint64_t)about.st_ino : 0;
}

/* The errno of a refusal; *size is what is left of a write. */
static int ask(Operation operation, size_t *size)
{
    *size = operation.size;
    return hook ? hook(&operation, size) : 0;
}

static int refuse(int number)
{
    errno = number;
    return -1;
}

ssize_t pwrite(int descriptor, const void *data, size_t size, off_t offset);
int ftruncate(int descriptor, off_t size);
int posix_fallocate(int descriptor, off_t offset, off_t size);
int fsync(int descriptor);
int link(const char *from, const char *path);
int rename(const char *from, const char *path);
int unlink(const char *path);

ssize_t pwrite(int descriptor, const void *data, size_t size, off_t offset)
{
    size_t part;
    const int number = ask((Operation){.kind = OPERATION_WRITE,
                                       .file = file_of(descriptor),
                                       .data = data,
                                       .size = size,
                                       .offset = (uint64_t)offset},
                           &part);
    if (number != 0) return refuse(number);
    if (lseek(descriptor, offset, SEEK_SET) < 0) return -1;
    return write(descriptor, data, part);
}

static int resize(int descriptor, off_t size)
{
    char name[64];
    snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
    return truncate(name, size);
}

int ftruncate(int descriptor, off_t size)
{
    size_t part;
    const int number =
        ask((Operation){.kind = OPERATION_RESIZE, .file = file_of(descriptor), .offset = (uint64_t)size}, &part);
    return number != 0 ? refuse(number) : resize(descriptor, size);
}

int posix_fallocate(int descriptor, off_t offset, off_t size)
{
    size_t part;
    struct stat about;
    if (fstat(descriptor, &about) != 0) return errno;
    const off_t end = offset + size > about.st_size ? offset + size : about.st_size;
    const int number =
        ask((Operation){.kind = OPERATION_RESIZE, .file = file_of(descriptor), .offset = (uint64_t)end}, &part);
    if (number != 0) return number;
    return resize(descriptor, end) == 0 ? 0 : errno;
}

/* The tests' disk is as good as its memory: nothing is brought anywhere. */
int fsync(int descriptor)
{
    size_t part;
    const int number = ask((Operation){.kind = OPERATION_SYNC, .file = file_of(descriptor)}, &part);
    return number != 0 ? refuse(number) : 0;
}

int link(const char *from, const char *path)
{
    size_t part;
    const int number =
        ask((Operation){.kind = OPERATION_NAME, .file = file_at(from), .path = path, .from = from}, &part);
    return number != 0 ? refuse(number) : linkat(AT_FDCWD, from, AT_FDCWD, path, 0);
}

int rename(const char *from, const char *path)
{
    size_t part;
    const int number =
        ask((Operation){.kind = OPERATION_NAME, .file = file_at(from), .path = path, .from = from}, &part);
    return number != 0 ? refuse(number) : renameat(AT_FDCWD, from, AT_FDCWD, path);
}

int unlink(const char *path)
{
    size_t part;
    const int number = ask((Operation){.kind = OPERATION_UNLINK, .file = file_at(path), .path = path}, &part);
    return number != 0 ? refuse(number) : unlinkat(AT_FDCWD, path, 0);
}
