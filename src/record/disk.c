#include "record/disk.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

/* Space is reserved in steps of this size, bytes: one system call serves several frames. */
enum { RESERVE_STEP = 256 * 1024 };

int shv_disk_write(int descriptor, const void *data, size_t size, uint64_t address)
{
    const unsigned char *bytes = data;
    while (size > 0) {
        const ssize_t written = pwrite(descriptor, bytes, size, (off_t)address);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : ENOSPC;
        bytes += written;
        size -= (size_t)written;
        address += (uint64_t)written;
    }
    return 0;
}

int shv_disk_read(int descriptor, void *data, size_t size, uint64_t address)
{
    unsigned char *bytes = data;
    while (size > 0) {
        const ssize_t got = pread(descriptor, bytes, size, (off_t)address);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return errno;
        if (got == 0) {
            memset(bytes, 0, size);
            return 0;
        }
        bytes += got;
        size -= (size_t)got;
        address += (uint64_t)got;
    }
    return 0;
}

/* The limit is asked for first, because crossing it sends a signal that ends the process by default. */
static int reserve_exactly(int descriptor, uint64_t from, uint64_t end)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && end > limit.rlim_cur) return EFBIG;
    int number = EINTR;
    while (number == EINTR) number = posix_fallocate(descriptor, (off_t)from, (off_t)(end - from));
    return number;
}

int shv_disk_reserve(int descriptor, uint64_t *reserved, uint64_t end)
{
    if (end <= *reserved) return 0;
    uint64_t taken = (end + RESERVE_STEP - 1) / RESERVE_STEP * RESERVE_STEP;
    int number = reserve_exactly(descriptor, *reserved, taken);
    if (number != 0) number = reserve_exactly(descriptor, *reserved, taken = end);
    if (number == 0) *reserved = taken;
    return number;
}

uint32_t shv_disk_checksum(int descriptor, uint64_t from, uint64_t to, int *number)
{
    unsigned char block[16384];
    uLong sum = crc32(0, NULL, 0);
    *number = 0;
    while (from < to && *number == 0) {
        const size_t size = to - from < sizeof block ? (size_t)(to - from) : sizeof block;
        *number = shv_disk_read(descriptor, block, size, from);
        sum = crc32_z(sum, block, size);
        from += size;
    }
    return (uint32_t)sum;
}

int shv_disk_sync(int descriptor)
{
    if (fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
    return errno;
}
