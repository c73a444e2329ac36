/* The machine stops: of what was not brought to the disk any page may be there or not. Everything that a run does with its files
   is noted, and for many moments a disk is made up as it could look after the power has gone. */
#include "check.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/random.h"
#include "crash.h"
#include "files.h"
#include "operations.h"
#include "shiver/run_file.h"

enum { FRAMES = 24, MOST_OPERATIONS = 20000, PAGE = 4096, MOST_FILES = 12, EVERY = 5 /* frames a checkpoint */ };

typedef struct Note {
    Operation operation;
    unsigned char *data;
    char name[64];
    int64_t frames; /* told of until then */
} Note;

typedef struct Random {
    uint64_t seed, index;
} Random;

static double draw(Random *random)
{
    return shv_random_uniform(random->seed, random->index++);
}

static Note notes[MOST_OPERATIONS];
static int note_count;

static int take_note(const Operation *operation, size_t *size)
{
    if (note_count == MOST_OPERATIONS) abort();
    Note *note = &notes[note_count++];
    *note = (Note){.operation = *operation, .frames = crash_counters()->frames};
    if (operation->kind == OPERATION_WRITE) {
        note->data = malloc(*size);
        if (!note->data) abort();
        memcpy(note->data, operation->data, *size);
    }
    const char *slash = operation->path ? strrchr(operation->path, '/') : NULL;
    if (slash) snprintf(note->name, sizeof note->name, "%s", slash + 1);
    return 0;
}

/* ---- a disk ---- */

typedef struct DiskFile {
    uint64_t number;
    char name[64]; /* "": none yet */
    unsigned char *bytes;
    uint64_t size;
} DiskFile;

typedef struct Disk {
    DiskFile files[MOST_FILES];
    int count;
} Disk;

static DiskFile *file_of(Disk *disk, uint64_t number)
{
    for (int i = 0; i < disk->count; i++)
        if (disk->files[i].number == number) return &disk->files[i];
    assert_true(disk->count < MOST_FILES);
    disk->files[disk->count] = (DiskFile){.number = number};
    return &disk->files[disk->count++];
}

static void resize(DiskFile *file, uint64_t size)
{
    file->bytes = realloc(file->bytes, size + 1);
    assert_non_null(file->bytes);
    if (size > file->size) memset(file->bytes + file->size, 0, size - file->size);
    file->size = size;
}

static void put(DiskFile *file, const Note *note, uint64_t from, uint64_t to)
{
    const uint64_t begin = note->operation.offset > from ? note->operation.offset : from;
    const uint64_t written = note->operation.offset + note->operation.size, end = written < to ? written : to;
    if (end > file->size) resize(file, end);
    memcpy(file->bytes + begin, note->data + (begin - note->operation.offset), end - begin);
}

/* Each page of a write, and each change of a size, arrives with the chance given. */
static void arrive(DiskFile *file, const Note *note, double chance, Random *random)
{
    const Operation *operation = &note->operation;
    if (operation->kind == OPERATION_RESIZE && draw(random) < chance) resize(file, operation->offset);
    if (operation->kind != OPERATION_WRITE) return;
    const uint64_t end = operation->offset + operation->size;
    for (uint64_t page = operation->offset / PAGE; page * PAGE < end; page++)
        if (draw(random) < chance) put(file, note, page * PAGE, (page + 1) * PAGE);
}

/* Number of the last operation before `cut` that brought this file to the disk; −1: none. */
static int last_sync(uint64_t number, int cut)
{
    for (int i = cut - 1; i >= 0; i--)
        if (notes[i].operation.kind == OPERATION_SYNC && notes[i].operation.file == number) return i;
    return -1;
}

static void take_name_from(Disk *disk, const char *name)
{
    for (int i = 0; i < disk->count; i++)
        if (strcmp(disk->files[i].name, name) == 0) disk->files[i].name[0] = '\0';
}

/* Names are brought to the disk with their folder; later ones may have come along, in their order. */
static void give_names(Disk *disk, uint64_t folder, int cut, Random *random)
{
    const int synced = last_sync(folder, cut);
    bool goes_on = true;
    for (int i = 0; i < cut; i++) {
        const Operation *operation = &notes[i].operation;
        if (operation->kind != OPERATION_NAME && operation->kind != OPERATION_UNLINK) continue;
        goes_on = goes_on && (i <= synced || draw(random) < 0.5);
        if (!goes_on) break;
        take_name_from(disk, notes[i].name);
        DiskFile *file = file_of(disk, operation->file);
        if (operation->kind == OPERATION_NAME) snprintf(file->name, sizeof file->name, "%s", notes[i].name);
    }
}

static void write_disk(const Disk *disk, const void *folder)
{
    for (int i = 0; i < disk->count; i++)
        if (disk->files[i].name[0] != '\0')
            write_file(file_in(folder, disk->files[i].name),
                       disk->files[i].bytes ? disk->files[i].bytes : (const void *)"", disk->files[i].size);
}

/* Frames that the run had brought to the disk when it was cut: those told of before the journal was. */
static int64_t frames_synced(uint64_t journal, int cut)
{
    const int synced = last_sync(journal, cut);
    return synced < 0 ? 0 : notes[synced].frames;
}

/* ---- the test ---- */

/* Writes a run to its end; returns a ShvStatus. */
typedef int Writer(const char *path, const FakeSetup *setup, int frames, ShvError *error);

typedef struct Numbers {
    uint64_t folder, run, journal;
} Numbers;

static Numbers find_numbers(void)
{
    Numbers numbers = {0, 0, 0};
    for (int i = 0; i < note_count; i++) {
        const Operation *operation = &notes[i].operation;
        if (operation->kind == OPERATION_NAME && strcmp(notes[i].name, "run.h5") == 0) numbers.run = operation->file;
        if (operation->kind == OPERATION_UNLINK && strstr(notes[i].name, ".journal")) numbers.journal = operation->file;
    }
    /* Nothing is written to a folder. */
    for (int i = 0; i < note_count && numbers.folder == 0; i++) {
        const Operation *operation = &notes[i].operation;
        bool written = false;
        for (int k = 0; k < note_count; k++)
            written =
                written || (notes[k].operation.file == operation->file && notes[k].operation.kind != OPERATION_SYNC);
        if (operation->kind == OPERATION_SYNC && !written) numbers.folder = operation->file;
    }
    assert_true(numbers.folder != 0 && numbers.run != 0 && numbers.journal != 0);
    return numbers;
}

static void make_disk(Disk *disk, const Numbers *numbers, int cut, Random *random)
{
    static const double chances[] = {0.0, 0.2, 0.5, 0.9, 1.0};
    const double chance = chances[(int)(5.0 * draw(random))];
    for (int i = 0; i < cut; i++) {
        const Operation *operation = &notes[i].operation;
        if (operation->kind != OPERATION_WRITE && operation->kind != OPERATION_RESIZE) continue;
        const bool synced = i <= last_sync(operation->file, cut);
        arrive(file_of(disk, operation->file), &notes[i], synced ? 2.0 : chance, random);
    }
    /* The journal has its name from the beginning, as soon as the folder was synced; before, it may be missing. */
    if (last_sync(numbers->folder, cut) >= 0 || draw(random) < 0.5)
        snprintf(file_of(disk, numbers->journal)->name, sizeof disk->files[0].name, "run.h5.journal");
    give_names(disk, numbers->folder, cut, random);
}

static void name_for(char name[64])
{
    char own[64];
    if (strncmp(name, "run.h5", 6) == 0) {
        snprintf(own, sizeof own, "cut.h5%.50s", name + 6);
        memcpy(name, own, sizeof own);
    }
}

static int cut_power(const void *folder, const FakeSetup *setup, const Numbers *numbers, int cut, uint64_t seed)
{
    Disk disk = {.count = 0};
    Random random = {seed, 0};
    make_disk(&disk, numbers, cut, &random);
    const char *path = file_in(folder, "cut.h5");
    for (int i = 0; i < disk.count; i++) name_for(disk.files[i].name);
    write_disk(&disk, folder);
    for (int i = 0; i < disk.count; i++) free(disk.files[i].bytes);
    const int64_t least = frames_synced(numbers->journal, cut);
    crash_expect(cut > 0 ? notes[cut - 1].frames : 0);
    const char *wrong = crash_check_least(path, setup, least);
    if (wrong) fail_msg("cut after operation %d of %d, seed %d: %s", cut, note_count, (int)seed, wrong);
    return least > 0;
}

static void remove_cut(const void *folder)
{
    static const char *const names[] = {"cut.h5", "cut.h5.journal", "cut.h5.checkpoint-1", "cut.h5.checkpoint-2"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) unlink(file_in(folder, names[i]));
}

/* Notes all operations of a run. */
static Numbers note_run(const void *folder, const FakeSetup *setup, Writer *writer)
{
    ShvError error;
    crash_expect(0);
    note_count = 0;
    operations_hook(take_note);
    assert_int_equal(writer(file_in(folder, "run.h5"), setup, FRAMES, &error), SHV_OK);
    operations_hook(NULL);
    return find_numbers();
}

static void cut_often(void **state, const FakeSetup *setup)
{
    enum { CUTS = 300 };
    const Numbers numbers = note_run(*state, setup, crash_frames);
    int with_frames = 0;
    for (int i = 0; i < CUTS; i++, remove_cut(*state))
        with_frames += cut_power(*state, setup, &numbers, (int)((int64_t)note_count * i / CUTS), (uint64_t)i + 1);
    for (int i = note_count - 20; i <= note_count; i++, remove_cut(*state))
        cut_power(*state, setup, &numbers, i, (uint64_t)i + 7);
    for (int i = 0; i < note_count; i++) free(notes[i].data);
    assert_true(with_frames > (setup->sync_interval > 0.0 ? 0 : CUTS / 2));
}

static void test_power_cuts(void **state)
{
    cut_often(state, &CRASH_SETUP);
}

static void test_power_cuts_with_a_long_journal(void **state)
{
    cut_often(state, &CRASH_LAZY);
}

static int gone_on;

/* With checkpoints, from one of which it goes on where there is one. */
static int write_or_go_on(const char *path, const FakeSetup *setup, int frames, ShvError *error)
{
    ShvRecord *record;
    int64_t done = 0;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.force = true;
    definition.sync_interval = 0.002;
    ShvSimulation *simulation = fake_create(setup);
    ShvStatus status = shv_record_resume(&record, &definition, simulation, &done, sizeof done, error);
    gone_on += done > 0;
    if (status == SHV_OK && !record) status = shv_record_create(&record, &definition, simulation, error);
    while (status == SHV_OK && done < frames) {
        fake_advance(simulation);
        status = shv_record_frame(record, simulation, error);
        if (status == SHV_OK) crash_counters()->frames = ++done;
        if (status == SHV_OK && done % EVERY == 0)
            status = shv_record_checkpoint(record, simulation, &done, sizeof done, error);
    }
    ShvError closing;
    const ShvStatus closed = shv_record_close(record, status, "", &closing);
    if (status == SHV_OK && closed != SHV_OK) *error = closing;
    fake_destroy(simulation);
    return status == SHV_OK ? (int)closed : (int)status;
}

/* What is left can go on, and comes to the same end. */
static void test_power_cuts_with_checkpoints(void **state)
{
    enum { CUTS = 50 };
    ShvError error;
    const Numbers numbers = note_run(*state, &CRASH_SETUP, write_or_go_on);
    for (int i = 0; i < CUTS; i++, remove_cut(*state)) {
        const int cut = (int)((int64_t)note_count * (i + 1) / CUTS);
        cut_power(*state, &CRASH_SETUP, &numbers, cut, (uint64_t)i + 1);
        const char *path = file_in(*state, "cut.h5");
        if (write_or_go_on(path, &CRASH_SETUP, FRAMES, &error) != SHV_OK)
            fail_msg("after operation %d: %s", cut, error.message);
        crash_expect(FRAMES);
        const char *wrong = crash_check(path, &CRASH_SETUP);
        if (wrong) fail_msg("went on after operation %d of %d: %s", cut, note_count, wrong);
    }
    for (int i = 0; i < note_count; i++) free(notes[i].data);
    assert_true(gone_on > CUTS / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_power_cuts, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_power_cuts_with_a_long_journal, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_power_cuts_with_checkpoints, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
