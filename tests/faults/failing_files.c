/* Loaded before the C library: operation number SHIVER_FAIL_FROM on files fails with SHIVER_FAIL_NUMBER (EIO unless given), and with
   SHIVER_FAIL_ALL every later one. SHIVER_FAIL_COUNT tells at the end how many there were. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static long count;

static bool fails(void)
{
    const char *text = getenv("SHIVER_FAIL_FROM"), *number = getenv("SHIVER_FAIL_NUMBER");
    const long from = text ? atol(text) : 0;
    count++;
    if (from <= 0 || !(count == from || (getenv("SHIVER_FAIL_ALL") && count > from))) return false;
    errno = number ? atoi(number) : EIO;
    return true;
}

#define REAL(type, name, ...)                                                                                          \
    type (*real)(__VA_ARGS__);                                                                                         \
    *(void **)(void *)&real = dlsym(RTLD_NEXT, #name)

ssize_t pwrite(int descriptor, const void *bytes, size_t size, off_t at)
{
    REAL(ssize_t, pwrite, int, const void *, size_t, off_t);
    return fails() ? -1 : real(descriptor, bytes, size, at);
}

int posix_fallocate(int descriptor, off_t from, off_t length)
{
    REAL(int, posix_fallocate, int, off_t, off_t);
    return fails() ? errno : real(descriptor, from, length);
}

int ftruncate(int descriptor, off_t length)
{
    REAL(int, ftruncate, int, off_t);
    return fails() ? -1 : real(descriptor, length);
}

int fsync(int descriptor)
{
    REAL(int, fsync, int);
    return fails() ? -1 : real(descriptor);
}

int rename(const char *from, const char *to)
{
    REAL(int, rename, const char *, const char *);
    return fails() ? -1 : real(from, to);
}

int link(const char *from, const char *to)
{
    REAL(int, link, const char *, const char *);
    return fails() ? -1 : real(from, to);
}

int unlink(const char *path)
{
    REAL(int, unlink, const char *);
    return fails() ? -1 : real(path);
}

__attribute__((destructor)) static void tell(void)
{
    if (getenv("SHIVER_FAIL_COUNT")) fprintf(stderr, "failing_files: %ld\n", count);
}
