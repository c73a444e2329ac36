#include "record/stage.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* One overwriting of known bytes. Lower ranks are written first. */
typedef struct Piece {
    haddr_t address;
    size_t size, begin; /* bytes; offset in the stage's bytes */
    int32_t rank, sequence;
} Piece;

struct ShvStage {
    ShvMemory *memory;
    int descriptor;
    hid_t driver;
    haddr_t allocated; /* HDF5's end of allocation */
    haddr_t committed; /* the same at the last flush */
    haddr_t reserved;  /* bytes of the file that have space on the disk */
    Piece *pieces;
    size_t piece_count, piece_capacity;
    unsigned char *bytes;
    size_t byte_count, byte_capacity;
    bool overlapping; /* pieces overlap in part: only their own order is right */
    bool discard;
    int failure;
};

typedef struct StageFile {
    H5FD_t base; /* must be first */
    ShvStage *stage;
} StageFile;

typedef struct StageInfo {
    ShvStage *stage;
} StageInfo;

/* Space is reserved in steps of this size: one system call serves several frames. */
static const haddr_t RESERVE_STEP = 256 * 1024;

static ShvStage *stage_of(const H5FD_t *file)
{
    return ((const StageFile *)(const void *)file)->stage;
}

static herr_t failed(ShvStage *stage, int number)
{
    if (stage->failure == 0) stage->failure = number;
    stage->discard = true;
    return -1;
}

/* ---- bytes of the disk ---- */

static int write_all(int descriptor, const unsigned char *data, size_t size, haddr_t address)
{
    while (size > 0) {
        const ssize_t written = pwrite(descriptor, data, size, (off_t)address);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : ENOSPC;
        data += written;
        size -= (size_t)written;
        address += (haddr_t)written;
    }
    return 0;
}

/* Bytes behind the end of the file are zero. */
static int read_all(int descriptor, unsigned char *data, size_t size, haddr_t address)
{
    while (size > 0) {
        const ssize_t got = pread(descriptor, data, size, (off_t)address);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return errno;
        if (got == 0) {
            memset(data, 0, size);
            return 0;
        }
        data += got;
        size -= (size_t)got;
        address += (haddr_t)got;
    }
    return 0;
}

/* The limit is asked for first, because crossing it sends a signal that ends the process by default. */
static int reserve_exactly(int descriptor, haddr_t from, haddr_t end)
{
    struct rlimit limit;
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && end > limit.rlim_cur) return EFBIG;
    int number = EINTR;
    while (number == EINTR) number = posix_fallocate(descriptor, (off_t)from, (off_t)(end - from));
    return number;
}

static herr_t reserve(ShvStage *stage, haddr_t end)
{
    if (end <= stage->reserved) return 0;
    const haddr_t generous = (end + RESERVE_STEP - 1) / RESERVE_STEP * RESERVE_STEP;
    haddr_t taken = generous;
    int number = reserve_exactly(stage->descriptor, stage->reserved, generous);
    if (number != 0) number = reserve_exactly(stage->descriptor, stage->reserved, taken = end);
    if (number != 0) return failed(stage, number);
    stage->reserved = taken;
    return 0;
}

/* ---- pieces ---- */

enum { RANK_SUPERBLOCK, RANK_NODE, RANK_DATA = RANK_NODE + 256, RANK_HEADER };

/* A split of an index node moves entries to a new node that its parent learns of: as long as the parent is written
   first, every entry can be found. The byte of the level follows the signature "TREE" and the node type
   (HDF5 File Format Specification 3.0, III.A.1). */
static int32_t rank_of(H5FD_mem_t type, const unsigned char *data, size_t size)
{
    if (type == H5FD_MEM_SUPER) return RANK_SUPERBLOCK;
    if (type == H5FD_MEM_DRAW) return RANK_DATA;
    if (type == H5FD_MEM_BTREE && size > 6 && memcmp(data, "TREE", 4) == 0) return RANK_NODE + 255 - data[5];
    return RANK_HEADER;
}

static Piece *same_place(ShvStage *stage, haddr_t address, size_t size)
{
    for (size_t i = 0; i < stage->piece_count; i++) {
        Piece *piece = &stage->pieces[i];
        if (piece->address == address && piece->size == size) return piece;
        if (piece->address < address + size && address < piece->address + piece->size) stage->overlapping = true;
    }
    return NULL;
}

static bool make_room(ShvStage *stage, size_t size)
{
    if (stage->piece_count == stage->piece_capacity) {
        const size_t capacity = 2 * stage->piece_capacity + 64;
        Piece *grown = shv_reallocate(stage->memory, SHV_PART_RECORD, stage->pieces, capacity, sizeof *grown);
        if (!grown) return false;
        stage->pieces = grown;
        stage->piece_capacity = capacity;
    }
    if (size > stage->byte_capacity - stage->byte_count) {
        const size_t capacity = 2 * (stage->byte_capacity + size);
        unsigned char *grown = shv_reallocate(stage->memory, SHV_PART_RECORD, stage->bytes, capacity, 1);
        if (!grown) return false;
        stage->bytes = grown;
        stage->byte_capacity = capacity;
    }
    return true;
}

static herr_t put_piece(ShvStage *stage, H5FD_mem_t type, haddr_t address, size_t size, const unsigned char *data)
{
    Piece *piece = same_place(stage, address, size);
    if (!piece) {
        if (!make_room(stage, size)) return failed(stage, ENOMEM);
        piece = &stage->pieces[stage->piece_count];
        *piece = (Piece){address, size, stage->byte_count, 0, (int32_t)stage->piece_count};
        stage->piece_count++;
        stage->byte_count += size;
    }
    piece->rank = rank_of(type, data, size);
    memcpy(stage->bytes + piece->begin, data, size);
    return 0;
}

static void drop_pieces(ShvStage *stage)
{
    stage->piece_count = stage->byte_count = 0;
    stage->overlapping = false;
}

static int by_rank(const void *a, const void *b)
{
    const Piece *left = a, *right = b;
    if (left->rank != right->rank) return left->rank < right->rank ? -1 : 1;
    return left->sequence < right->sequence ? -1 : left->sequence > right->sequence;
}

static herr_t commit(ShvStage *stage)
{
    if (stage->discard) return 0;
    if (reserve(stage, stage->allocated) < 0) return -1;
    if (!stage->overlapping && stage->piece_count > 1)
        qsort(stage->pieces, stage->piece_count, sizeof *stage->pieces, by_rank);
    for (size_t i = 0; i < stage->piece_count; i++) {
        const Piece *piece = &stage->pieces[i];
        const int number = write_all(stage->descriptor, stage->bytes + piece->begin, piece->size, piece->address);
        if (number != 0) return failed(stage, number);
    }
    drop_pieces(stage);
    stage->committed = stage->allocated;
    return 0;
}

/* ---- what HDF5 calls ---- */

static H5FD_t *open_file(const char *name, unsigned flags, hid_t access, haddr_t most)
{
    (void)name, (void)flags, (void)most;
    const StageInfo *info = H5Pget_driver_info(access);
    if (!info) return NULL;
    StageFile *file = shv_allocate(info->stage->memory, SHV_PART_RECORD, 1, sizeof *file);
    if (!file) return NULL;
    file->stage = info->stage;
    return &file->base;
}

static herr_t close_file(H5FD_t *file)
{
    shv_release(file);
    return 0;
}

/* No features: HDF5 then neither merges metadata nor hands out space in blocks, so that all space allocated after a
   flush lies behind the end of that flush. */
static herr_t query(const H5FD_t *file, unsigned long *flags)
{
    (void)file;
    *flags = 0;
    return 0;
}

static haddr_t get_allocated(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return stage_of(file)->allocated;
}

static herr_t set_allocated(H5FD_t *file, H5FD_mem_t type, haddr_t address)
{
    (void)type;
    stage_of(file)->allocated = address;
    return 0;
}

static haddr_t get_end(const H5FD_t *file, H5FD_mem_t type)
{
    (void)type;
    return stage_of(file)->reserved;
}

static herr_t read_file(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size, void *buffer)
{
    (void)type, (void)transfer;
    const ShvStage *stage = stage_of(file);
    if (read_all(stage->descriptor, buffer, size, address) != 0) return -1;
    for (size_t i = 0; i < stage->piece_count; i++) {
        const Piece *piece = &stage->pieces[i];
        const haddr_t begin = piece->address > address ? piece->address : address;
        const haddr_t piece_end = piece->address + piece->size, end_of_buffer = address + size;
        const haddr_t end = piece_end < end_of_buffer ? piece_end : end_of_buffer;
        if (begin < end)
            memcpy((unsigned char *)buffer + (begin - address), stage->bytes + piece->begin + (begin - piece->address),
                   (size_t)(end - begin));
    }
    return 0;
}

static herr_t write_file(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size,
                         const void *buffer)
{
    (void)transfer;
    ShvStage *stage = stage_of(file);
    if (stage->discard) return 0;
    if (address < stage->committed) return put_piece(stage, type, address, size, buffer);
    if (reserve(stage, address + size) < 0) return -1;
    const int number = write_all(stage->descriptor, buffer, size, address);
    return number == 0 ? 0 : failed(stage, number);
}

static herr_t flush_file(H5FD_t *file, hid_t transfer, hbool_t closing)
{
    (void)transfer, (void)closing;
    return commit(stage_of(file));
}

/* ---- life ---- */

static const H5FD_class_t STAGE_CLASS = {
    .name = "shiver_stage",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(StageInfo),
    .open = open_file,
    .close = close_file,
    .query = query,
    .get_eoa = get_allocated,
    .set_eoa = set_allocated,
    .get_eof = get_end,
    .read = read_file,
    .write = write_file,
    .flush = flush_file,
    .fl_map = H5FD_FLMAP_SINGLE,
};

ShvStatus shv_stage_create(ShvStage **stage, ShvMemory *memory, int descriptor, int64_t size, ShvError *error)
{
    *stage = NULL;
    ShvStage *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the run file", sizeof *made);
    *made = (ShvStage){.memory = memory,
                       .descriptor = descriptor,
                       .allocated = (haddr_t)size,
                       .committed = (haddr_t)size,
                       .reserved = (haddr_t)size};
    made->driver = H5FDregister(&STAGE_CLASS);
    if (made->driver < 0) {
        shv_release(made);
        return shv_fail(error, SHV_FILE_ERROR, "HDF5 does not take the file driver of the run file");
    }
    *stage = made;
    return SHV_OK;
}

void shv_stage_release(ShvStage *stage)
{
    if (!stage) return;
    H5FDunregister(stage->driver);
    shv_release(stage->pieces);
    shv_release(stage->bytes);
    shv_release(stage);
}

hid_t shv_stage_access(ShvStage *stage)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const StageInfo info = {stage};
    if (access < 0) return access;
    if (H5Pset_driver(access, stage->driver, &info) >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0)
        return access;
    H5Pclose(access);
    return -1;
}

int64_t shv_stage_committed(const ShvStage *stage)
{
    return (int64_t)stage->committed;
}

int shv_stage_failure(const ShvStage *stage)
{
    return stage->failure;
}

void shv_stage_discard(ShvStage *stage)
{
    stage->discard = true;
}

ShvStatus shv_stage_rollback(ShvStage *stage, ShvError *error)
{
    drop_pieces(stage);
    if (ftruncate(stage->descriptor, (off_t)stage->committed) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "cannot cut the run file to its last whole frame: error %d", errno);
    stage->allocated = stage->reserved = stage->committed;
    stage->discard = false;
    return SHV_OK;
}
