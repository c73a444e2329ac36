#include "record/stage.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/timer.h"
#include "record/disk.h"
#include "record/journal.h"

/* One overwriting of known bytes; its bytes lie behind it, so that a row of them is a record of the journal. */
typedef struct Piece {
    uint64_t address, size;
} Piece;

struct ShvStage {
    ShvMemory *memory;
    int descriptor;
    hid_t driver;
    haddr_t allocated; /* HDF5's end of allocation */
    haddr_t committed; /* the same at the last flush */
    uint64_t reserved; /* bytes of the file that have space on the disk */
    unsigned char *pieces;
    size_t used, capacity, journaled; /* bytes of the pieces; of those that are in the journal */
    ShvJournal *journal;              /* NULL: nobody else knows the file yet */
    char *path;
    uint64_t place;
    double interval, settled, due; /* s; shv_now at the last settling; from then to the next */
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

/* Bytes of the journal at which it is carried out ahead of time. */
static const int64_t LARGEST_JOURNAL = 64 << 20;
/* Settling waits for the disk: at most one part in so many of the run time goes there. */
static const double SETTLE_SHARE = 100.0;

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

/* ---- pieces ---- */

/* The piece of this very place, when nothing after it overlaps it in part and the journal does not have it yet. */
static unsigned char *same_place(const ShvStage *stage, haddr_t address, size_t size)
{
    unsigned char *found = NULL;
    for (size_t at = stage->journaled; at < stage->used;) {
        Piece piece;
        memcpy(&piece, stage->pieces + at, sizeof piece);
        if (piece.address < address + size && address < piece.address + piece.size)
            found = piece.address == address && piece.size == size ? stage->pieces + at : NULL;
        at += sizeof piece + piece.size;
    }
    return found;
}

static bool make_room(ShvStage *stage, size_t size)
{
    if (size <= stage->capacity - stage->used) return true;
    const size_t capacity = 2 * (stage->capacity + size);
    unsigned char *grown = shv_reallocate(stage->memory, SHV_PART_RECORD, stage->pieces, capacity, 1);
    if (!grown) return false;
    stage->pieces = grown;
    stage->capacity = capacity;
    return true;
}

static herr_t put_piece(ShvStage *stage, haddr_t address, size_t size, const void *data)
{
    unsigned char *place = same_place(stage, address, size);
    if (!place) {
        if (!make_room(stage, sizeof(Piece) + size)) return failed(stage, ENOMEM);
        place = stage->pieces + stage->used;
        memcpy(place, &(Piece){address, size}, sizeof(Piece));
        stage->used += sizeof(Piece) + size;
    }
    memcpy(place + sizeof(Piece), data, size);
    return 0;
}

static void drop_pieces(ShvStage *stage)
{
    stage->used = stage->journaled = 0;
}

static int apply_pieces(ShvStage *stage)
{
    int number = 0;
    for (size_t at = 0; number == 0 && at < stage->used;) {
        Piece piece;
        memcpy(&piece, stage->pieces + at, sizeof piece);
        number = shv_disk_write(stage->descriptor, stage->pieces + at + sizeof piece, piece.size, piece.address);
        at += sizeof piece + piece.size;
    }
    return number;
}

/* ---- commit ---- */

static int settle(ShvStage *stage)
{
    const double start = shv_now();
    const int number = stage->journal ? shv_journal_settle(stage->journal) : apply_pieces(stage);
    if (number != 0) return number;
    drop_pieces(stage);
    stage->settled = shv_now();
    const double most = SETTLE_SHARE * (stage->settled - start);
    stage->due = stage->interval > 0.0 && most > stage->interval ? most : stage->interval;
    return 0;
}

static bool is_due(const ShvStage *stage)
{
    return !stage->journal || shv_journal_size(stage->journal) > LARGEST_JOURNAL ||
           shv_now() - stage->settled >= stage->due;
}

static int write_record(ShvStage *stage)
{
    return shv_journal_append(stage->journal, stage->committed, stage->allocated, stage->pieces + stage->journaled,
                              stage->used - stage->journaled);
}

static herr_t commit(ShvStage *stage)
{
    if (stage->discard || (stage->used == stage->journaled && stage->allocated == stage->committed)) return 0;
    int number = shv_disk_reserve(stage->descriptor, &stage->reserved, stage->allocated);
    if (number == 0 && stage->journal) number = write_record(stage);
    if (number != 0) return failed(stage, number);
    stage->journaled = stage->used;
    stage->committed = stage->allocated;
    number = is_due(stage) ? settle(stage) : 0;
    return number == 0 ? 0 : failed(stage, number);
}

/* ---- what HDF5 calls ---- */

static H5FD_t *open_file(const char *name, unsigned flags, hid_t access, haddr_t most)
{
    (void)name, (void)flags, (void)most;
    const StageInfo *info = H5Pget_driver_info(access);
    if (!info) return NULL;
    StageFile *file = shv_allocate(info->stage->memory, SHV_PART_RECORD, 1, sizeof *file);
    if (!file) {
        failed(info->stage, ENOMEM);
        return NULL;
    }
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
    if (shv_disk_read(stage->descriptor, buffer, size, address) != 0) return -1;
    shv_journal_lay(stage->pieces, stage->used, address, size, buffer);
    return 0;
}

static herr_t write_file(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t address, size_t size,
                         const void *buffer)
{
    (void)type, (void)transfer;
    ShvStage *stage = stage_of(file);
    if (stage->discard) return 0;
    if (address < stage->committed) return put_piece(stage, address, size, buffer);
    int number = shv_disk_reserve(stage->descriptor, &stage->reserved, address + size);
    if (number == 0) number = shv_disk_write(stage->descriptor, buffer, size, address);
    return number == 0 ? 0 : failed(stage, number);
}

static herr_t flush_file(H5FD_t *file, hid_t transfer, hbool_t closing)
{
    (void)transfer, (void)closing;
    return commit(stage_of(file));
}

/* ---- life ---- */

static const H5FD_class_t STAGE_CLASS = {
#ifdef H5FD_CLASS_VERSION /* from HDF5 1.14 on */
    .version = H5FD_CLASS_VERSION,
    .value = 0x5301, /* of those for drivers that nobody registered, from 512 on */
#endif
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

ShvStatus shv_stage_create(ShvStage **stage, ShvMemory *memory, int descriptor, ShvError *error)
{
    *stage = NULL;
    ShvStage *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the run file", sizeof *made);
    *made = (ShvStage){.memory = memory, .descriptor = descriptor};
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
    shv_journal_release(stage->journal);
    shv_release(stage->pieces);
    shv_release(stage->path);
    shv_release(stage);
}

/* The superblock of version 2 (HDF5 1.8) has a checksum and, other than version 3, no mark of an open file that a writer which
   dies would leave; everything else is as of HDF5 1.10, whose indices of chunks have checksums, too. */
static hid_t set_versions(hid_t file)
{
    if (file < 0 || H5Fset_libver_bounds(file, H5F_LIBVER_V110, H5F_LIBVER_V110) >= 0) return file;
    H5Fclose(file);
    return -1;
}

static hid_t make_access(ShvStage *stage)
{
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    const StageInfo info = {stage};
    if (access < 0) return access;
    if (H5Pset_driver(access, stage->driver, &info) >= 0 && H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) >= 0 &&
        H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V110) >= 0)
        return access;
    H5Pclose(access);
    return -1;
}

hid_t shv_stage_make(ShvStage *stage, const char *name)
{
    const hid_t access = make_access(stage), list = H5Pcreate(H5P_FILE_CREATE);
    hid_t file = -1;
    if (access >= 0 && list >= 0 && H5Pset_obj_track_times(list, false) >= 0)
        file = H5Fcreate(name, H5F_ACC_TRUNC, list, access);
    if (list >= 0) H5Pclose(list);
    if (access >= 0) H5Pclose(access);
    return set_versions(file);
}

hid_t shv_stage_open(ShvStage *stage, const char *name)
{
    const hid_t access = make_access(stage);
    if (access < 0) return access;
    const hid_t file = H5Fopen(name, H5F_ACC_RDWR, access);
    H5Pclose(access);
    if (file >= 0) stage->committed = stage->allocated; /* what lies behind is of nobody */
    return set_versions(file);
}

ShvStatus shv_stage_journal(ShvStage *stage, const char *path, uint64_t place, double interval, ShvError *error)
{
    if (!stage->path) stage->path = shv_copy_text(stage->memory, SHV_PART_RECORD, path);
    if (!stage->path) return shv_fail_memory(error, "a path", strlen(path) + 1);
    stage->place = place;
    stage->interval = stage->due = interval;
    stage->settled = shv_now();
    return shv_journal_create(&stage->journal, stage->memory, path, stage->descriptor, place, error);
}

int shv_stage_failure(const ShvStage *stage)
{
    return stage->failure;
}

void shv_stage_discard(ShvStage *stage)
{
    stage->discard = true;
}

/* What a reader would do that finds the file with its writer gone. */
static ShvStatus take_whole(ShvStage *stage, ShvError *error)
{
    SHV_TRY(shv_journal_recover(stage->path, stage->descriptor, stage->memory, error));
    const off_t end = lseek(stage->descriptor, 0, SEEK_END);
    if (end < 0) return shv_fail(error, SHV_FILE_ERROR, "cannot tell the size of '%s': error %d", stage->path, errno);
    stage->allocated = stage->committed = stage->reserved = (haddr_t)end;
    stage->discard = false;
    stage->failure = 0;
    return SHV_OK;
}

ShvStatus shv_stage_adopt(ShvStage *stage, const char *path, ShvError *error)
{
    stage->path = shv_copy_text(stage->memory, SHV_PART_RECORD, path);
    return stage->path ? take_whole(stage, error) : shv_fail_memory(error, "a path", strlen(path) + 1);
}

ShvStatus shv_stage_restore(ShvStage *stage, ShvError *error)
{
    drop_pieces(stage);
    shv_journal_release(stage->journal);
    stage->journal = NULL;
    SHV_TRY(take_whole(stage, error));
    return shv_journal_create(&stage->journal, stage->memory, stage->path, stage->descriptor, stage->place, error);
}

static ShvStatus fail_disk(int number, ShvError *error)
{
    if (number == 0) return SHV_OK;
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    return shv_fail(error, SHV_FILE_ERROR, "cannot bring the last changes to the disk: %s", reason);
}

/* Pieces that wait for the next flush stay. */
ShvStatus shv_stage_settle(ShvStage *stage, ShvError *error)
{
    if (stage->discard || stage->used > stage->journaled) return SHV_OK;
    const int number = settle(stage);
    if (number != 0) failed(stage, number);
    return fail_disk(number, error);
}

ShvStatus shv_stage_end(ShvStage *stage, ShvError *error)
{
    int number = settle(stage);
    if (number == 0 && ftruncate(stage->descriptor, (off_t)stage->committed) != 0) number = errno;
    if (number == 0 && stage->journal) number = shv_journal_finish(stage->journal);
    return fail_disk(number, error);
}
