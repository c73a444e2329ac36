#include "record/snapshot.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "record/disk.h"
#include "record/hdf5_array.h"
#include "record/journal.h"

/* Bytes [begin, end) of the file; a copy of them lies at `copy` of the block. */
typedef struct Range {
    uint64_t begin, end;
    size_t copy;
} Range;

typedef struct Ranges {
    Range *list;
    size_t count, capacity;
} Ranges;

struct ShvSnapshot {
    ShvMemory *memory;
    char *path;
    int descriptor;
    hid_t driver;
    haddr_t allocated; /* HDF5's end of allocation */
    uint64_t bytes;    /* of the file when the snapshot was taken */
    ShvJournalView journal;
    bool surveying; /* raw data that are asked for are noted in `ranges`, not read */
    Ranges ranges;
    Ranges copied; /* in ascending order; none before the snapshot is frozen */
    unsigned char *block;
};

typedef struct SnapshotFile {
    H5FD_t base; /* must be first */
    ShvSnapshot *snapshot;
} SnapshotFile;

typedef struct SnapshotInfo {
    ShvSnapshot *snapshot;
} SnapshotInfo;

static ShvSnapshot *snapshot_of(const H5FD_t *file)
{
    return ((const SnapshotFile *)(const void *)file)->snapshot;
}

/* ---- bytes ---- */

/* As the file was when the snapshot was taken, as long as nothing has moved or for what never changes. */
static int read_bytes(const ShvSnapshot *snapshot, uint64_t address, size_t size, void *buffer)
{
    const int number = shv_disk_read(snapshot->descriptor, buffer, size, address);
    if (number == 0) shv_journal_lay(snapshot->journal.changes, snapshot->journal.size, address, size, buffer);
    return number;
}

/* The first of the copied ranges that ends behind the address. */
static size_t first_behind(const Ranges *ranges, uint64_t address)
{
    size_t low = 0, high = ranges->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (ranges->list[middle].end > address)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static void lay_copies(const ShvSnapshot *snapshot, uint64_t address, size_t size, unsigned char *buffer)
{
    const uint64_t end = address + size;
    for (size_t i = first_behind(&snapshot->copied, address); i < snapshot->copied.count; i++) {
        const Range *range = &snapshot->copied.list[i];
        if (range->begin >= end) return;
        const uint64_t from = range->begin > address ? range->begin : address;
        const uint64_t to = range->end < end ? range->end : end;
        memcpy(buffer + (from - address), snapshot->block + range->copy + (from - range->begin), (size_t)(to - from));
    }
}

/* ---- what HDF5 calls ---- */

static H5FD_t *open_file(const char *name, unsigned flags, hid_t access, haddr_t most)
{
    (void)name, (void)flags, (void)most;
    const SnapshotInfo *info = H5Pget_driver_info(access);
    if (!info) return NULL;
    SnapshotFile *file = shv_allocate(info->snapshot->memory, SHV_PART_RECORD, 1, sizeof *file);
    if (!file) return NULL;
    file->snapshot = info->snapshot;
    return &file->base;
}

static herr_t close_file(H5FD_t *file)
{
    shv_release(file);
    return 0;
}

static haddr_t get_allocated(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return snapshot_of(file)->allocated;
}

static herr_t set_allocated(H5FD_t *file, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    snapshot_of(file)->allocated = address;
    return 0;
}

static haddr_t get_end(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return snapshot_of(file)->bytes;
}

static bool note(ShvSnapshot *snapshot, uint64_t address, uint64_t size)
{
    Ranges *ranges = &snapshot->ranges;
    if (ranges->count == ranges->capacity) {
        const size_t capacity = 2 * ranges->capacity + 1024;
        Range *grown = shv_reallocate(snapshot->memory, SHV_PART_RECORD, ranges->list, capacity, sizeof *grown);
        if (!grown) return false;
        ranges->list = grown;
        ranges->capacity = capacity;
    }
    ranges->list[ranges->count++] = (Range){.begin = address, .end = address + size};
    return true;
}

static herr_t read_file(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size, void *buffer)
{
    (void)transfer;
    ShvSnapshot *snapshot = snapshot_of(file);
    if (snapshot->surveying && type == H5FD_MEM_DRAW) return note(snapshot, address, size) ? 0 : -1;
    if (read_bytes(snapshot, address, size, buffer) != 0) return -1;
    lay_copies(snapshot, address, size, buffer);
    return 0;
}

static herr_t refuse_to_write(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size,
                              const void *buffer)
{
    (void)file, (void)type, (void)transfer, (void)address, (void)size, (void)buffer;
    return -1;
}

static const H5FD_class_t SNAPSHOT_CLASS = {
#ifdef H5FD_CLASS_VERSION /* from HDF5 1.14 on */
    .version = H5FD_CLASS_VERSION,
    .value = 0x5302, /* of those for drivers that nobody registered, from 512 on */
#endif
    .name = "shiver_snapshot",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(SnapshotInfo),
    .open = open_file,
    .close = close_file,
    .get_eoa = get_allocated,
    .set_eoa = set_allocated,
    .get_eof = get_end,
    .read = read_file,
    .write = refuse_to_write,
    .fl_map = H5FD_FLMAP_SINGLE,
};

/* ---- life ---- */

static int begin(ShvSnapshot *snapshot)
{
    struct stat about;
    snapshot->descriptor = open(snapshot->path, O_RDONLY | O_CLOEXEC);
    if (snapshot->descriptor < 0) return errno;
    const int number = shv_journal_inspect(snapshot->path, snapshot->descriptor, snapshot->memory, &snapshot->journal);
    if (number != 0) return number;
    if (fstat(snapshot->descriptor, &about) != 0) return errno;
    snapshot->bytes = (uint64_t)about.st_size;
    return 0;
}

ShvStatus shv_snapshot_take(ShvSnapshot **snapshot, ShvMemory *memory, const char *path, int64_t *bytes,
                            ShvError *error)
{
    *snapshot = NULL;
    ShvSnapshot *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a snapshot of the run file", sizeof *made);
    *made = (ShvSnapshot){.memory = memory, .descriptor = -1, .driver = -1};
    made->path = shv_copy_text(memory, SHV_PART_RECORD, path);
    int number = made->path ? begin(made) : ENOMEM;
    if (number == 0 && (made->driver = H5FDregister(&SNAPSHOT_CLASS)) < 0) number = ENOMEM;
    if (number == 0) {
        *bytes = (int64_t)made->bytes;
        *snapshot = made;
        return SHV_OK;
    }
    shv_snapshot_release(made);
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    return shv_fail(error, number == ENOMEM ? SHV_NO_MEMORY : SHV_FILE_ERROR, "cannot read '%s': %s", path, reason);
}

void shv_snapshot_release(ShvSnapshot *snapshot)
{
    if (!snapshot) return;
    if (snapshot->driver >= 0) H5FDunregister(snapshot->driver);
    if (snapshot->descriptor >= 0) close(snapshot->descriptor);
    shv_release(snapshot->journal.changes);
    shv_release(snapshot->ranges.list);
    shv_release(snapshot->copied.list);
    shv_release(snapshot->block);
    shv_release(snapshot->path);
    shv_release(snapshot);
}

hid_t shv_snapshot_open(ShvSnapshot *snapshot, const char *name)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const SnapshotInfo info = {snapshot};
    hid_t file = -1;
    if (access >= 0 && H5Pset_driver(access, snapshot->driver, &info) >= 0)
        file = H5Fopen(name, H5F_ACC_RDONLY, access);
    if (access >= 0) H5Pclose(access);
    return file;
}

bool shv_snapshot_moved(const ShvSnapshot *snapshot)
{
    ShvJournalView now;
    if (shv_journal_inspect(snapshot->path, snapshot->descriptor, snapshot->memory, &now) != 0) return true;
    shv_release(now.changes);
    return now.marked != snapshot->journal.marked || now.badge.identity != snapshot->journal.badge.identity ||
           now.badge.epoch != snapshot->journal.badge.epoch;
}

/* ---- freezing ---- */

static int by_address(const void *a, const void *b)
{
    const Range *first = a, *second = b;
    return (first->begin > second->begin) - (first->begin < second->begin);
}

/* In place of the ranges, of which the last lies behind everything, those between them up to `end`; returns their bytes. */
static size_t complement(Ranges *ranges, uint64_t end)
{
    uint64_t at = 0;
    size_t count = 0, bytes = 0;
    for (size_t i = 0; i < ranges->count; i++) {
        const Range range = ranges->list[i];
        if (range.begin > at && at < end) {
            const uint64_t to = range.begin < end ? range.begin : end;
            ranges->list[count++] = (Range){at, to, bytes};
            bytes += (size_t)(to - at);
        }
        if (range.end > at) at = range.end;
    }
    ranges->count = count;
    return bytes;
}

/* Notes what never changes. Rows of fragments change when one of them dies; all other rows are as they were first written. */
static bool survey(ShvSnapshot *snapshot, const ShvSeries *series)
{
    bool good = true;
    snapshot->surveying = true;
    for (int i = 0; i < SHV_SERIES_COUNT && good; i++)
        if (series[i].dataset >= 0 && i != SHV_SERIES_FRAGMENTS) good = shv_chunks_touch(series[i].dataset);
    snapshot->surveying = false;
    return good && note(snapshot, UINT64_MAX, 0);
}

ShvStatus shv_snapshot_freeze(ShvSnapshot *snapshot, const ShvSeries *series, ShvError *error)
{
    Ranges *ranges = &snapshot->ranges;
    if (!survey(snapshot, series)) return shv_fail(error, SHV_BAD_INPUT, "'%s' is damaged", snapshot->path);
    qsort(ranges->list, ranges->count, sizeof(Range), by_address);
    const size_t size = complement(ranges, snapshot->allocated);
    snapshot->block = shv_allocate(snapshot->memory, SHV_PART_RECORD, size, 1);
    if (!snapshot->block) return shv_fail_memory(error, "a snapshot of the run file", size);
    for (size_t i = 0; i < ranges->count; i++) {
        const Range *range = &ranges->list[i];
        if (read_bytes(snapshot, range->begin, (size_t)(range->end - range->begin), snapshot->block + range->copy) != 0)
            return shv_fail(error, SHV_FILE_ERROR, "cannot read '%s'", snapshot->path);
    }
    snapshot->copied = *ranges;
    *ranges = (Ranges){NULL, 0, 0};
    return SHV_OK;
}
