#include "record/checkpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/hash.h"
#include "base/publish.h"
#include "base/text.h"
#include "record/disk.h"
#include "shiver/version.h"

/* "SHVCKPT1" as it lies in memory of this byte order. */
#define MAGIC UINT64_C(0x3154504b43564853)

typedef struct Head {
    uint64_t magic;
    ShvCheckpointMark mark;
    uint64_t note_size, size;
    uint32_t note, state, own, unused; /* CRC-32 of the note, the state and the head up to here */
} Head;
_Static_assert(sizeof(Head) == 96, "a head has no gaps");

static uint32_t checksum(const void *data, size_t size)
{
    return (uint32_t)crc32_z(crc32(0, NULL, 0), data, size);
}

char *shv_checkpoint_path(ShvMemory *memory, const char *run_file, int index)
{
    const size_t size = strlen(run_file) + sizeof ".checkpoint-1";
    char *path = shv_allocate(memory, SHV_PART_RECORD, size, 1);
    if (path) shv_format(path, size, "%s.checkpoint-%d", run_file, index + 1);
    return path;
}

uint64_t shv_checkpoint_program(void)
{
    const uint64_t version = shv_hash_text(SHV_HASH_START, SHIVER_VERSION);
    struct stat about;
    const int program = open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    if (program < 0) return version;
    int number = 0;
    uint32_t sum = 0;
    if (fstat(program, &about) == 0) sum = shv_disk_checksum(program, 0, (uint64_t)about.st_size, &number);
    close(program);
    return shv_hash_bytes(version, &sum, sizeof sum);
}

void shv_checkpoint_remove(const char *run_file, ShvMemory *memory, int kept)
{
    for (int i = 0; i < SHV_CHECKPOINTS; i++) {
        char *path = i != kept ? shv_checkpoint_path(memory, run_file, i) : NULL;
        if (path) (void)unlink(path);
        shv_release(path);
    }
}

/* ---- writing ---- */

static ShvStatus fail(ShvError *error, const char *what, const char *path, int number)
{
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    return shv_fail(error, SHV_FILE_ERROR, "cannot %s the checkpoint '%s': %s", what, path, reason);
}

static ShvStatus write_contents(int descriptor, const char *path, ShvSimulation *simulation,
                                const ShvCheckpointMark *mark, const void *note, size_t note_size, ShvError *error)
{
    Head head = {.magic = MAGIC, .mark = *mark, .note_size = note_size, .note = checksum(note, note_size)};
    if (lseek(descriptor, (off_t)(sizeof head + note_size), SEEK_SET) < 0) return fail(error, "write", path, errno);
    SHV_TRY(shv_simulation_save(simulation, descriptor, &head.size, &head.state, error));
    head.own = checksum(&head, offsetof(Head, own));
    int number = shv_disk_write(descriptor, note, note_size, sizeof head);
    if (number == 0) number = shv_disk_write(descriptor, &head, sizeof head, 0);
    return number == 0 ? SHV_OK : fail(error, "write", path, number);
}

ShvStatus shv_checkpoint_write(const char *run_file, ShvMemory *memory, ShvSimulation *simulation,
                               const ShvCheckpointMark *mark, const void *note, size_t note_size, ShvError *error)
{
    char *path = shv_checkpoint_path(memory, run_file, (int)(mark->sequence % SHV_CHECKPOINTS)), *temporary = NULL;
    int descriptor = -1;
    if (!path) return shv_fail_memory(error, "a checkpoint", strlen(run_file));
    ShvStatus status = shv_publish_begin(memory, path, &temporary, &descriptor, error);
    if (status == SHV_OK) status = write_contents(descriptor, path, simulation, mark, note, note_size, error);
    if (status == SHV_OK) status = shv_publish_end(temporary, descriptor, path, true, error);
    if (status != SHV_OK && temporary) (void)unlink(temporary);
    if (descriptor >= 0) close(descriptor);
    shv_release(temporary);
    shv_release(path);
    return status;
}

/* ---- finding ---- */

/* Why a file will not do, the worst last. */
typedef enum Fault {
    FAULT_NONE,
    FAULT_MISSING,
    FAULT_DAMAGED,
    FAULT_FRAME,
    FAULT_GEOMETRY,
    FAULT_SCENE,
    FAULT_PROGRAM
} Fault;

typedef struct Search {
    const ShvCheckpointMark *own;
    ShvCheckpointFits fits;
    void *data;
} Search;

static Fault compare(const Search *search, const ShvCheckpointMark *mark)
{
    if (mark->program != search->own->program) return FAULT_PROGRAM;
    if (mark->scene != search->own->scene) return FAULT_SCENE;
    if (mark->geometry != search->own->geometry) return FAULT_GEOMETRY;
    return !search->fits || search->fits(search->data, mark) ? FAULT_NONE : FAULT_FRAME;
}

static Fault inspect_head(int descriptor, const Search *search, Head *head)
{
    struct stat about;
    if (fstat(descriptor, &about) != 0 || !S_ISREG(about.st_mode) || (uint64_t)about.st_size < sizeof *head)
        return FAULT_DAMAGED;
    if (shv_disk_read(descriptor, head, sizeof *head, 0) != 0) return FAULT_DAMAGED;
    if (head->magic != MAGIC || head->own != checksum(head, offsetof(Head, own))) return FAULT_DAMAGED;
    const uint64_t rest = (uint64_t)about.st_size - sizeof *head;
    if (head->note_size > rest || head->size != rest - head->note_size) return FAULT_DAMAGED;
    return compare(search, &head->mark);
}

/* The whole file is read once before anything of it is used. */
static Fault look(int descriptor, const Search *search, Head *head)
{
    const Fault fault = inspect_head(descriptor, search, head);
    if (fault != FAULT_NONE) return fault;
    const uint64_t note = sizeof *head, state = note + head->note_size;
    int number = 0;
    const bool good = shv_disk_checksum(descriptor, note, state, &number) == head->note && number == 0 &&
                      shv_disk_checksum(descriptor, state, state + head->size, &number) == head->state && number == 0;
    return good ? FAULT_NONE : FAULT_DAMAGED;
}

void shv_checkpoint_close(ShvCheckpoint *checkpoint)
{
    if (checkpoint->descriptor >= 0) close(checkpoint->descriptor);
    shv_release(checkpoint->note);
    *checkpoint = (ShvCheckpoint){.descriptor = -1};
}

static Fault take(ShvCheckpoint *found, int descriptor, const Search *search)
{
    Head head;
    const Fault fault = look(descriptor, search, &head);
    if (fault != FAULT_NONE || (found->descriptor >= 0 && head.mark.sequence < found->mark.sequence)) {
        close(descriptor);
        return fault;
    }
    if (found->descriptor >= 0) close(found->descriptor);
    *found = (ShvCheckpoint){
        .descriptor = descriptor, .mark = head.mark, .size = head.size, .note_size = (size_t)head.note_size};
    return FAULT_NONE;
}

static ShvStatus read_note(ShvCheckpoint *found, const char *run_file, ShvMemory *memory, ShvError *error)
{
    found->note = shv_allocate(memory, SHV_PART_RECORD, found->note_size, 1);
    if (!found->note) return shv_fail_memory(error, "a checkpoint", found->note_size);
    const int number = shv_disk_read(found->descriptor, found->note, found->note_size, sizeof(Head));
    if (number == 0 && lseek(found->descriptor, (off_t)(sizeof(Head) + found->note_size), SEEK_SET) >= 0) return SHV_OK;
    return fail(error, "read", run_file, number != 0 ? number : errno);
}

static ShvStatus refuse(Fault fault, const char *run_file, ShvError *error)
{
    static const char *const reasons[] = {
        [FAULT_DAMAGED] = "are damaged",
        [FAULT_FRAME] = "belong to frames that the run file does not have",
        [FAULT_GEOMETRY] = "were taken with other meshes",
        [FAULT_SCENE] = "were taken of another scene (what --set changed counts; use --until for a longer duration)",
        [FAULT_PROGRAM] = "were written by another program or version of it",
    };
    return shv_fail(error, SHV_BAD_INPUT,
                    "the checkpoints of '%s' %s; go on with what they were made with, or run without --resume",
                    run_file, reasons[fault]);
}

ShvStatus shv_checkpoint_find(ShvCheckpoint *found, const char *run_file, ShvMemory *memory,
                              const ShvCheckpointMark *own, ShvCheckpointFits fits, void *data, ShvError *error)
{
    const Search search = {own, fits, data};
    Fault worst = FAULT_MISSING;
    *found = (ShvCheckpoint){.descriptor = -1};
    for (int i = 0; i < SHV_CHECKPOINTS; i++) {
        char *path = shv_checkpoint_path(memory, run_file, i);
        if (!path) return shv_fail_memory(error, "a checkpoint", strlen(run_file));
        const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        const Fault fault = descriptor >= 0 ? take(found, descriptor, &search) : FAULT_MISSING;
        shv_release(path);
        if (fault > worst) worst = fault;
    }
    if (found->descriptor >= 0) return read_note(found, run_file, memory, error);
    return worst == FAULT_MISSING ? SHV_OK : refuse(worst, run_file, error);
}
