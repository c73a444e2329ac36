/* State on its way to a file and back. One description serves both: a table names the pointers of a struct, everything else of it
   are numbers that are taken as they lie in memory. An archive is read by the program that wrote it, on a machine of the same
   kind; whoever keeps one says so in front of it, with a checksum. */
#ifndef SHV_BASE_ARCHIVE_H
#define SHV_BASE_ARCHIVE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"

typedef struct ShvArchive ShvArchive;

typedef enum ShvFieldKind {
    SHV_FIELD_BLOCK, /* a block of shv_allocate, NULL included: its bytes, in which nobody will follow a pointer */
    SHV_FIELD_ROOM,  /* a block whose contents do not outlive a step: comes back zeroed */
    SHV_FIELD_KEPT /* stays what it is where the archive is read: what was made from the scene, or has a table of its own */
} ShvFieldKind;

typedef struct ShvField {
    size_t offset, size;
    ShvFieldKind kind;
} ShvField;

#define SHV_FIELD_OF(type, member, kind)                                                                               \
    {                                                                                                                  \
        offsetof(type, member), sizeof(((type *)NULL)->member), kind                                                   \
    }

typedef struct ShvArchiveSum {
    uint64_t size; /* bytes from where the archive began */
    uint32_t checksum;
} ShvArchiveSum;

/* Over an open descriptor, from where it stands; `reads`: an archive of `size` bytes is read, else one is written. */
ShvStatus shv_archive_create(ShvArchive **archive, ShvMemory *memory, int descriptor, bool reads, uint64_t size,
                             ShvError *error);
/* After the last: writes what is left; the first failure of any call. `sum` (may be NULL) of what was written or read. */
ShvStatus shv_archive_finish(ShvArchive *archive, ShvArchiveSum *sum, ShvError *error);
void shv_archive_release(ShvArchive *archive);
bool shv_archive_reads(const ShvArchive *archive);

/* After a failure these do nothing and return false; what was being read can then be released and nothing else. */
bool shv_archive_bytes(ShvArchive *archive, void *data, size_t size);
bool shv_archive_block(ShvArchive *archive, void **block);
bool shv_archive_room(ShvArchive *archive, void **block);
/* A struct: blocks in the order of the table, then the rest of its bytes at once. */
bool shv_archive_struct(ShvArchive *archive, void *object, size_t size, const ShvField *fields, size_t count);
#define SHV_ARCHIVE_STRUCT(archive, object, fields)                                                                    \
    shv_archive_struct((archive), (object), sizeof *(object), (fields), sizeof(fields) / sizeof *(fields))
/* A part of the caller that failed: the archive ends with that. */
bool shv_archive_fail(ShvArchive *archive, ShvStatus status, const ShvError *error);

#endif
