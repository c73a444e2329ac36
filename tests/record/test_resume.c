/* Runs that are killed at any operation and go on from a checkpoint: their files hold what a run that never stopped has written. */
#include "check.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crash.h"
#include "files.h"
#include "operations.h"
#include "shiver/run_file.h"

enum { FRAMES = 30, EVERY = 4 /* frames from a checkpoint to the next */ };

typedef struct Note {
    int64_t frames;
} Note;

/* What happens to the operations of a child. */
static int64_t operations, kill_at, fail_at;
static bool torn;

static int kill_or_fail(const Operation *operation, size_t *size)
{
    enum { PAGE = 4096 };
    if (torn) kill(getpid(), SIGKILL);
    const int64_t number = operations++;
    if (number == fail_at) return EIO;
    if (number != kill_at) return 0;
    if (operation->kind != OPERATION_WRITE || *size <= PAGE || number % 2 == 0) kill(getpid(), SIGKILL);
    *size = *size / 2 / PAGE * PAGE + PAGE - operation->offset % PAGE;
    torn = true;
    return 0;
}

static ShvRecordDefinition define(const char *path)
{
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.force = true;
    definition.sync_interval = 0.002;
    definition.resume_hash = 77;
    return definition;
}

/* Goes on where there is a checkpoint, else begins; *checkpoints (may be NULL): those that could be written. */
static ShvStatus record(const char *path, const FakeSetup *setup, int frames, int *checkpoints, ShvError *error)
{
    ShvRecord *made;
    Note note = {0};
    const ShvRecordDefinition definition = define(path);
    ShvSimulation *simulation = fake_create(setup);
    ShvStatus status = shv_record_resume(&made, &definition, simulation, &note, sizeof note, error);
    if (status == SHV_OK && !made) status = shv_record_create(&made, &definition, simulation, error);
    for (int64_t i = note.frames; i < frames && status == SHV_OK;) {
        fake_advance(simulation);
        status = shv_record_frame(made, simulation, error);
        ShvError ignored;
        note.frames = ++i;
        if (status == SHV_OK && i % EVERY == 0 && i < frames &&
            shv_record_checkpoint(made, simulation, &note, sizeof note, &ignored) == SHV_OK && checkpoints)
            ++*checkpoints;
    }
    ShvError closing;
    const ShvStatus closed = shv_record_close(made, status, "", &closing);
    if (status == SHV_OK && closed != SHV_OK) *error = closing;
    fake_destroy(simulation);
    return status == SHV_OK ? closed : status;
}

static int record_in_child(const char *path, const FakeSetup *setup, int64_t killed, int64_t failing)
{
    int status = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        ShvError error;
        operations = 0;
        kill_at = killed;
        fail_at = failing;
        operations_hook(kill_or_fail);
        _exit((int)record(path, setup, FRAMES, NULL, &error));
    }
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int64_t count_operations(const void *folder, const FakeSetup *setup)
{
    ShvError error;
    operations = 0;
    kill_at = fail_at = -1;
    operations_hook(kill_or_fail);
    const char *path = file_in(folder, "whole.h5");
    check_ok(record(path, setup, FRAMES, NULL, &error), error);
    operations_hook(NULL);
    return operations;
}

static void remove_run(const char *path)
{
    static const char *const endings[] = {"", ".journal", ".checkpoint-1", ".checkpoint-2"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        char name[300];
        snprintf(name, sizeof name, "%s%s", path, endings[i]);
        unlink(name);
    }
}

/* All series to the last bit, what a checksum does not see included. */
static void check_same(const char *path, const char *whole, int64_t at)
{
    ShvError error;
    ShvRunFile *files[2];
    uint32_t sums[2];
    check_ok(shv_run_file_open(&files[0], path, NULL, &error), error);
    check_ok(shv_run_file_open(&files[1], whole, NULL, &error), error);
    const ShvRunFileInfo *info[2] = {shv_run_file_info(files[0]), shv_run_file_info(files[1])};
    ShvFragmentView *fragments[2];
    int32_t *lines[2];
    for (int i = 0; i < 2; i++) {
        check_ok(shv_run_file_verify(files[i], &error), error);
        check_ok(shv_run_file_checksum(files[i], &sums[i], &error), error);
        fragments[i] = calloc((size_t)info[i]->fragment_count, sizeof **fragments);
        lines[i] = calloc((size_t)info[i]->fragment_count, sizeof **lines);
        check_ok(shv_run_file_fragments(files[i], fragments[i], &error), error);
        check_ok(shv_run_file_lineages(files[i], lines[i], &error), error);
    }
    if (sums[0] != sums[1]) fail_msg("stopped at operation %lld: other frames", (long long)at);
    assert_int_equal(info[0]->frame_count, FRAMES);
    assert_string_equal(info[0]->status, "finished");
    assert_int_equal(info[0]->fragment_count, info[1]->fragment_count);
    assert_int_equal(info[0]->event_count, info[1]->event_count);
    assert_int_equal(info[0]->probe_row_count, info[1]->probe_row_count);
    const size_t count = (size_t)info[0]->fragment_count;
    assert_memory_equal(fragments[0], fragments[1], count * sizeof **fragments);
    assert_memory_equal(lines[0], lines[1], count * sizeof **lines);
    for (int i = 0; i < 2; i++) {
        free(fragments[i]);
        free(lines[i]);
        shv_run_file_close(files[i]);
    }
}

/* Each run is killed twice: the second time while it goes on. */
static void test_killed_and_resumed(void **state)
{
    ShvError error;
    const int64_t all = count_operations(*state, &CRASH_SETUP), stride = all / 60 | 1;
    const char *path = file_in(*state, "run.h5"), *whole = file_in(*state, "whole.h5");
    int64_t kills = 0;
    for (int64_t at = 1; at < all; at += stride) {
        remove_run(path);
        kills += record_in_child(path, &CRASH_SETUP, at, -1) < 0;
        kills += record_in_child(path, &CRASH_SETUP, (at * 7) % all, -1) < 0;
        check_ok(record(path, &CRASH_SETUP, FRAMES, NULL, &error), error);
        check_same(path, whole, at);
    }
    assert_true(kills > 60);
}

/* A run goes on when a checkpoint cannot be written, and can go on later from the one before. */
static void test_failing_operations(void **state)
{
    ShvError error;
    const int64_t all = count_operations(*state, &CRASH_SETUP), stride = all / 60 | 1;
    const char *path = file_in(*state, "run.h5"), *whole = file_in(*state, "whole.h5");
    for (int64_t at = 2; at < all; at += stride) {
        remove_run(path);
        const int status = record_in_child(path, &CRASH_SETUP, -1, at);
        if (status < 0) fail_msg("operation %lld failed and the writer crashed", (long long)at);
        check_ok(record(path, &CRASH_SETUP, FRAMES, NULL, &error), error);
        check_same(path, whole, at);
    }
}

/* The first checkpoints of a run that has come to frame 14: of frames 8 and 12. */
static void make_stopped(const char *path)
{
    ShvError error;
    ShvRecord *made;
    Note note = {0};
    const ShvRecordDefinition definition = define(path);
    remove_run(path);
    ShvSimulation *simulation = fake_create(&CRASH_SETUP);
    check_ok(shv_record_create(&made, &definition, simulation, &error), error);
    for (note.frames = 0; note.frames < 14;) {
        fake_advance(simulation);
        check_ok(shv_record_frame(made, simulation, &error), error);
        if (++note.frames % EVERY == 0)
            check_ok(shv_record_checkpoint(made, simulation, &note, sizeof note, &error), error);
    }
    check_ok(shv_record_close(made, SHV_INTERRUPTED, "", &error), error);
    fake_destroy(simulation);
}

static ShvStatus resume(const char *path, const ShvRecordDefinition *definition, const FakeSetup *setup,
                        int64_t *frames, ShvError *error)
{
    ShvRecord *made;
    Note note = {0};
    ShvSimulation *simulation = fake_create(setup);
    const ShvStatus status = shv_record_resume(&made, definition, simulation, &note, sizeof note, error);
    (void)path;
    *frames = note.frames;
    shv_record_abandon(made);
    fake_destroy(simulation);
    return status;
}

static void damage(const char *path, const char *ending)
{
    char name[300];
    snprintf(name, sizeof name, "%s%s", path, ending);
    const size_t size = (size_t)file_size(name);
    char *bytes = read_bytes(name);
    bytes[size / 2] ^= 4;
    write_file(name, bytes, size);
    free(bytes);
}

static void test_refusals(void **state)
{
    ShvError error;
    int64_t frames;
    const char *path = file_in(*state, "run.h5");
    ShvRecordDefinition definition = define(path);
    check_ok(resume(path, &definition, &CRASH_SETUP, &frames, &error), error); /* there is no file at all */
    assert_int_equal(frames, 0);
    make_stopped(path);
    check_ok(resume(path, &definition, &CRASH_SETUP, &frames, &error), error);
    assert_int_equal(frames, 12);
    definition.resume_hash++;
    check_fails(resume(path, &definition, &CRASH_SETUP, &frames, &error), SHV_BAD_INPUT, error, "another scene");
    definition.resume_hash--;
    FakeSetup other = CRASH_SETUP;
    other.bricks = 63;
    check_fails(resume(path, &definition, &other, &frames, &error), SHV_BAD_INPUT, error, "other meshes");
    damage(path, ".checkpoint-2"); /* of frame 12: the third */
    check_ok(resume(path, &definition, &CRASH_SETUP, &frames, &error), error);
    assert_int_equal(frames, 8);
    damage(path, ".checkpoint-1");
    check_fails(resume(path, &definition, &CRASH_SETUP, &frames, &error), SHV_BAD_INPUT, error, "are damaged");
}

/* Checkpoints of a run do not serve another that takes its place. */
static void test_other_run(void **state)
{
    ShvError error;
    int64_t frames;
    const char *path = file_in(*state, "run.h5");
    const ShvRecordDefinition definition = define(path);
    make_stopped(path);
    char name[300];
    snprintf(name, sizeof name, "%s.checkpoint-2", path);
    const size_t size = (size_t)file_size(name);
    char *bytes = read_bytes(name);
    FakeSetup other = CRASH_SETUP;
    other.split_every = 2;
    ShvRecord *made;
    ShvSimulation *simulation = fake_create(&other);
    check_ok(shv_record_create(&made, &definition, simulation, &error), error);
    for (int i = 0; i < 14; i++) {
        fake_advance(simulation);
        check_ok(shv_record_frame(made, simulation, &error), error);
    }
    check_ok(shv_record_close(made, SHV_OK, "", &error), error);
    fake_destroy(simulation);
    assert_int_not_equal(access(name, F_OK), 0);
    write_file(name, bytes, size);
    free(bytes);
    check_fails(resume(path, &definition, &other, &frames, &error), SHV_BAD_INPUT, error,
                "frames that the run file does");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_killed_and_resumed, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_failing_operations, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_refusals, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_other_run, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
