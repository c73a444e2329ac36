#include "base/archive.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { BUFFER = 1 << 18 };

struct ShvArchive {
    ShvMemory *memory;
    int descriptor;
    bool reads;
    off_t at;      /* of the next byte to be written */
    uint64_t left; /* bytes that can still be read, those in the buffer not counted */
    ShvArchiveSum sum;
    ShvError failure; /* status SHV_OK: nothing has failed */
    unsigned char *buffer;
    size_t used, filled; /* bytes of the buffer: taken so far, there */
};

ShvStatus shv_archive_create(ShvArchive **archive, ShvMemory *memory, int descriptor, bool reads, uint64_t size,
                             ShvError *error)
{
    *archive = NULL;
    ShvArchive *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    unsigned char *buffer = shv_allocate(memory, SHV_PART_RECORD, BUFFER, 1);
    if (!made || !buffer) {
        shv_release(made);
        shv_release(buffer);
        return shv_fail_memory(error, "a checkpoint", BUFFER);
    }
    *made = (ShvArchive){.memory = memory, .descriptor = descriptor, .reads = reads, .left = size, .buffer = buffer};
    made->at = lseek(descriptor, 0, SEEK_CUR);
    *archive = made;
    return SHV_OK;
}

void shv_archive_release(ShvArchive *archive)
{
    if (!archive) return;
    shv_release(archive->buffer);
    shv_release(archive);
}

bool shv_archive_reads(const ShvArchive *archive)
{
    return archive->reads;
}

bool shv_archive_fail(ShvArchive *archive, ShvStatus status, const ShvError *error)
{
    if (archive->failure.status == SHV_OK) shv_fail(&archive->failure, status, "%s", error->message);
    return false;
}

static bool fail_system(ShvArchive *archive, int number)
{
    char reason[128] = "unknown error";
    ShvError error;
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    shv_fail(&error, SHV_FILE_ERROR, "cannot %s a checkpoint: %s", archive->reads ? "read" : "write", reason);
    return shv_archive_fail(archive, SHV_FILE_ERROR, &error);
}

static bool fail_short(ShvArchive *archive)
{
    ShvError error;
    shv_fail(&error, SHV_BAD_INPUT, "the checkpoint is not of this state");
    return shv_archive_fail(archive, SHV_BAD_INPUT, &error);
}

static bool fail_memory(ShvArchive *archive, size_t bytes)
{
    ShvError error;
    shv_fail_memory(&error, "the state of a checkpoint", bytes);
    return shv_archive_fail(archive, SHV_NO_MEMORY, &error);
}

/* ---- bytes ---- */

static bool write_all(ShvArchive *archive, const unsigned char *data, size_t size)
{
    while (size > 0) {
        const ssize_t written = pwrite(archive->descriptor, data, size, archive->at);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return fail_system(archive, written < 0 ? errno : EIO);
        data += written;
        archive->at += written;
        size -= (size_t)written;
    }
    return true;
}

static bool read_all(ShvArchive *archive, unsigned char *data, size_t size)
{
    if (size > archive->left) return fail_short(archive);
    archive->left -= size;
    while (size > 0) {
        const ssize_t got = read(archive->descriptor, data, size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return fail_system(archive, errno);
        if (got == 0) return fail_short(archive);
        data += got;
        size -= (size_t)got;
    }
    return true;
}

static bool empty_buffer(ShvArchive *archive)
{
    const size_t used = archive->used;
    archive->used = 0;
    return write_all(archive, archive->buffer, used);
}

static bool put(ShvArchive *archive, const void *data, size_t size)
{
    if (size > BUFFER - archive->used && !empty_buffer(archive)) return false;
    if (size > BUFFER) return write_all(archive, data, size);
    memcpy(archive->buffer + archive->used, data, size);
    archive->used += size;
    return true;
}

static bool get(ShvArchive *archive, unsigned char *data, size_t size)
{
    const size_t there = archive->filled - archive->used, first = there < size ? there : size;
    memcpy(data, archive->buffer + archive->used, first);
    archive->used += first;
    if (first == size) return true;
    data += first;
    size -= first;
    if (size >= BUFFER) return read_all(archive, data, size);
    const size_t next = archive->left < BUFFER ? (size_t)archive->left : BUFFER;
    archive->used = archive->filled = 0;
    if (size > next) return fail_short(archive);
    if (!read_all(archive, archive->buffer, next)) return false;
    archive->filled = next;
    memcpy(data, archive->buffer, size);
    archive->used = size;
    return true;
}

bool shv_archive_bytes(ShvArchive *archive, void *data, size_t size)
{
    if (archive->failure.status != SHV_OK) return false;
    if (size == 0) return true;
    if (archive->reads ? !get(archive, data, size) : !put(archive, data, size)) return false;
    archive->sum.size += size;
    archive->sum.checksum = (uint32_t)crc32_z(archive->sum.checksum, data, size);
    return true;
}

ShvStatus shv_archive_finish(ShvArchive *archive, ShvArchiveSum *sum, ShvError *error)
{
    if (!archive->reads && archive->failure.status == SHV_OK) (void)empty_buffer(archive);
    if (archive->reads && archive->failure.status == SHV_OK && (archive->left > 0 || archive->used < archive->filled))
        (void)fail_short(archive);
    if (sum) *sum = archive->sum;
    if (archive->failure.status == SHV_OK) return SHV_OK;
    return shv_fail(error, archive->failure.status, "%s", archive->failure.message);
}

/* ---- blocks ---- */

typedef struct BlockHead {
    uint64_t bytes;
    int32_t part, there;
} BlockHead;

/* What follows of the block is read by the caller, or nothing. */
static bool exchange_head(ShvArchive *archive, void **block, BlockHead *head)
{
    *head = (BlockHead){0, 0, 0};
    if (!archive->reads && *block) *head = (BlockHead){shv_block_bytes(*block), (int32_t)shv_block_part(*block), 1};
    if (!shv_archive_bytes(archive, head, sizeof *head)) return false;
    if (!archive->reads) return true;
    if (head->part < 0 || head->part >= SHV_PART_COUNT || head->bytes > PTRDIFF_MAX) return fail_short(archive);
    void *made = NULL;
    if (head->there) {
        made = shv_allocate(archive->memory, (ShvPart)head->part, (size_t)head->bytes, 1);
        if (!made) return fail_memory(archive, (size_t)head->bytes);
    }
    shv_release(*block);
    *block = made;
    return true;
}

bool shv_archive_block(ShvArchive *archive, void **block)
{
    BlockHead head;
    return exchange_head(archive, block, &head) && shv_archive_bytes(archive, *block, (size_t)head.bytes);
}

bool shv_archive_room(ShvArchive *archive, void **block)
{
    BlockHead head;
    return exchange_head(archive, block, &head);
}

/* ---- structs ---- */

static bool exchange_rest(ShvArchive *archive, unsigned char *object, unsigned char *copy, size_t size,
                          const ShvField *fields, size_t count)
{
    if (!archive->reads) {
        memcpy(copy, object, size);
        for (size_t i = 0; i < count; i++) memset(copy + fields[i].offset, 0, fields[i].size);
        return shv_archive_bytes(archive, copy, size);
    }
    if (!shv_archive_bytes(archive, copy, size)) return false;
    for (size_t i = 0; i < count; i++) memcpy(copy + fields[i].offset, object + fields[i].offset, fields[i].size);
    memcpy(object, copy, size);
    return true;
}

bool shv_archive_struct(ShvArchive *archive, void *object, size_t size, const ShvField *fields, size_t count)
{
    if (archive->failure.status != SHV_OK) return false;
    for (size_t i = 0; i < count; i++) {
        void *block;
        if (fields[i].kind == SHV_FIELD_KEPT) continue;
        memcpy(&block, (unsigned char *)object + fields[i].offset, sizeof block);
        const bool good =
            fields[i].kind == SHV_FIELD_BLOCK ? shv_archive_block(archive, &block) : shv_archive_room(archive, &block);
        memcpy((unsigned char *)object + fields[i].offset, &block, sizeof block);
        if (!good) return false;
    }
    unsigned char *copy = shv_allocate(archive->memory, SHV_PART_RECORD, size, 1);
    if (!copy) return fail_memory(archive, size);
    const bool good = exchange_rest(archive, object, copy, size, fields, count);
    shv_release(copy);
    return good;
}
