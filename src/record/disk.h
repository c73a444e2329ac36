/* Bytes of an open file. All return an errno, 0: done. */
#ifndef SHV_RECORD_DISK_H
#define SHV_RECORD_DISK_H

#include <stddef.h>
#include <stdint.h>

int shv_disk_write(int descriptor, const void *data, size_t size, uint64_t address);
/* Bytes behind the end of the file are zero. */
int shv_disk_read(int descriptor, void *data, size_t size, uint64_t address);
/* Makes sure that bytes [*reserved, end) have space on the disk, in generous steps where there is room. */
int shv_disk_reserve(int descriptor, uint64_t *reserved, uint64_t end);
/* CRC-32 (zlib's) of bytes [from, to); *number gets the errno of a failure. */
uint32_t shv_disk_checksum(int descriptor, uint64_t from, uint64_t to, int *number);
/* fsync; that a file system knows no such thing is no failure. */
int shv_disk_sync(int descriptor);

#endif
