/* A file is read while another process writes it. */
#include "check.h"

#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "crash.h"
#include "files.h"
#include "operations.h"
#include "shiver/run_file.h"

static int to_parent[2], to_child[2];
static int64_t stride;

/* The writer stops before every operation of which the number is a multiple of the stride, until it is told to go on. */
static int stop(const Operation *operation, size_t *size)
{
    (void)operation, (void)size;
    char byte = 0;
    if (crash_counters()->operations++ % stride != 0) return 0;
    if (write(to_parent[1], "x", 1) != 1 || read(to_child[0], &byte, 1) != 1) _exit(1);
    return 0;
}

static pid_t start_writer(const char *path, const FakeSetup *setup, int frames, OperationHook hook)
{
    assert_int_equal(pipe(to_parent) | pipe(to_child), 0);
    crash_expect(0);
    crash_counters()->operations = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        ShvError error;
        close(to_parent[0]);
        close(to_child[1]); /* so that it ends when this test does */
        operations_hook(hook);
        _exit(crash_frames(path, setup, frames, &error));
    }
    close(to_parent[1]);
    return child;
}

static bool writer_stops(void)
{
    char byte = 0;
    return read(to_parent[0], &byte, 1) == 1;
}

static void go_on(void)
{
    assert_int_equal(write(to_child[1], "x", 1), 1);
}

static void end_writer(pid_t child)
{
    int status = -1;
    waitpid(child, &status, 0);
    assert_int_equal(status, 0);
    close(to_parent[0]);
    assert_int_equal(close(to_child[0]) | close(to_child[1]), 0);
}

/* What was opened at a stop, and what it must hold at least. */
typedef struct Look {
    ShvRunFile *file;
    int64_t frames;
} Look;

static Look look(const char *path)
{
    ShvError error;
    Look made = {NULL, crash_counters()->frames};
    if (access(path, F_OK) != 0) return made;
    check_ok(shv_run_file_open(&made.file, path, NULL, &error), error);
    return made;
}

static void check(const Look *look, const FakeSetup *setup)
{
    const int64_t count = shv_run_file_info(look->file)->frame_count;
    const char *wrong = crash_check_open(look->file, setup, look->frames);
    if (wrong) fail_msg("opened beside frame %lld: %s", (long long)look->frames, wrong);
    assert_in_range(count - look->frames, 0, 1);
    shv_run_file_close(look->file);
}

/* What is opened at a stop is read at the next one but two, when the writer has changed the file several times. */
static void read_beside(const char *path, const FakeSetup *setup, int64_t operations)
{
    enum { KEPT = 3 };
    Look kept[KEPT] = {{NULL, 0}};
    int live = 0, looks = 0;
    stride = operations;
    const pid_t child = start_writer(path, setup, CRASH_FRAMES, stop);
    for (int i = 0; writer_stops(); i++) {
        Look *oldest = &kept[i % KEPT];
        if (oldest->file) check(oldest, setup);
        *oldest = look(path);
        looks += oldest->file != NULL;
        live += oldest->file && shv_run_file_info(oldest->file)->live;
        go_on();
    }
    end_writer(child);
    for (int i = 0; i < KEPT; i++)
        if (kept[i].file) check(&kept[i], setup);
    assert_true(looks > 12 && live > 8);
}

static void test_settled_at_every_frame(void **state)
{
    const int64_t all = crash_operations(*state, &CRASH_SETUP, CRASH_FRAMES);
    read_beside(file_in(*state, "run.h5"), &CRASH_SETUP, all / 20 | 1);
}

static void test_long_journal(void **state)
{
    const int64_t all = crash_operations(*state, &CRASH_LAZY, CRASH_FRAMES);
    read_beside(file_in(*state, "run.h5"), &CRASH_LAZY, all / 100 | 1); /* most are those of the end */
}

/* Goes on at once at every operation but the first after half of the frames: however slow the reader is, it finds the file
   being written once. */
static int stop_halfway(const Operation *operation, size_t *size)
{
    (void)operation, (void)size;
    static bool stopped;
    char byte = 0;
    if (stopped || crash_counters()->frames < CRASH_FRAMES / 2) return 0;
    stopped = true;
    if (write(to_parent[1], "x", 1) != 1 || read(to_child[0], &byte, 1) != 1) _exit(1);
    return 0;
}

static int count_live(const char *path, const FakeSetup *setup)
{
    const Look beside = look(path);
    if (!beside.file) return 0;
    const bool live = shv_run_file_info(beside.file)->live;
    const char *wrong = crash_check_open(beside.file, setup, beside.frames);
    if (wrong) fail_msg("%s", wrong);
    shv_run_file_close(beside.file);
    return live;
}

/* The writer does not wait but once: readers begin anew where it has changed the file under them. */
static void test_writer_that_does_not_wait(void **state)
{
    static const FakeSetup often = {
        .bricks = 64, .split_every = 3, .most = 127, .splits = 2, .probes = 2, .sync_interval = 0.02};
    const char *path = file_in(*state, "run.h5");
    const pid_t child = start_writer(path, &often, CRASH_FRAMES, stop_halfway);
    struct pollfd halfway = {.fd = to_parent[0], .events = POLLIN};
    while (poll(&halfway, 1, 0) == 0) count_live(path, &often);
    assert_true(writer_stops());
    assert_int_equal(count_live(path, &often), 1);
    go_on();
    int status = -1;
    while (waitpid(child, &status, WNOHANG) == 0) count_live(path, &often);
    assert_int_equal(status, 0);
    close(to_parent[0]);
    assert_int_equal(close(to_child[0]) | close(to_child[1]), 0);
}

/* The status tells a file that is written from one whose writer was killed. */
static void test_status(void **state)
{
    const char *path = file_in(*state, "run.h5");
    const int64_t all = crash_operations(*state, &CRASH_SETUP, CRASH_FRAMES);
    stride = all / 2;
    const pid_t child = start_writer(path, &CRASH_SETUP, CRASH_FRAMES, stop);
    assert_true(writer_stops());
    go_on();
    assert_true(writer_stops());
    Look beside = look(path);
    const ShvRunFileInfo *info = shv_run_file_info(beside.file);
    assert_true(info->live);
    assert_string_equal(info->status, "running");
    assert_non_null(strstr(info->message, "is being written"));
    shv_run_file_close(beside.file);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    beside = look(path);
    info = shv_run_file_info(beside.file);
    assert_false(info->live);
    assert_string_equal(info->status, "running");
    assert_non_null(strstr(info->message, "ended without a word"));
    shv_run_file_close(beside.file);
    assert_int_equal(close(to_parent[0]) | close(to_child[0]) | close(to_child[1]), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_settled_at_every_frame, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_long_journal, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_writer_that_does_not_wait, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_status, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
