#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "crash.h"
#include "files.h"

/* 64 chunks fill a node of HDF5's chunk index: with one chunk a frame and series, frame 65 splits the nodes of all. */
static const FakeSetup BREAKING = {.bricks = 64, .split_every = 3, .most = 127, .splits = 2};
enum { FRAMES = 70, BEFORE_SPLIT = 62 };

/* Kills within write `at`; the file must be whole. */
static void kill_at(void **state, int64_t at, bool torn)
{
    const char *path = file_in(*state, "run.h5");
    unlink(path);
    crash_record(path, &BREAKING, FRAMES, at, torn);
    assert_true(crash_counters()->writes == at + 1);
    const char *wrong = crash_check(path, &BREAKING);
    if (wrong) fail_msg("killed within write %lld%s: %s", (long long)at, torn ? ", half of it done" : "", wrong);
}

static int64_t writes_of(void **state, int frames)
{
    const char *path = file_in(*state, "count.h5");
    crash_record(path, &BREAKING, frames, -1, false);
    unlink(path);
    return crash_counters()->writes;
}

/* Every few writes of a whole run, its start included. */
static void test_killed_between_writes(void **state)
{
    const int64_t all = writes_of(state, FRAMES);
    assert_true(all > 1000);
    const int64_t stride = getenv("SHIVER_CRASH_STRIDE") ? atoll(getenv("SHIVER_CRASH_STRIDE")) : all / 60;
    for (int64_t at = stride / 2; at < all - 8; at += stride) kill_at(state, at, false);
}

/* Raw data, a node or a header may be half on the disk: a write cut short by the kill itself. */
static void test_killed_from_outside(void **state)
{
    const char *path = file_in(*state, "run.h5");
    int64_t caught = 0;
    for (int i = 0; i < 40; i++) {
        unlink(path);
        crash_record_after(path, &BREAKING, FRAMES, 2000000L + 1700000L * i);
        caught += crash_counters()->frames > 0 && crash_counters()->frames < FRAMES;
        const char *wrong = crash_check(path, &BREAKING);
        if (wrong) fail_msg("killed after %ld ns: %s", 2000000L + 1700000L * i, wrong);
    }
    assert_true(caught > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_killed_between_writes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_killed_from_outside, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
