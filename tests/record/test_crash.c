#include "check.h"

#include <unistd.h>

#include "crash.h"
#include "files.h"

static void test_killed_at_the_start(void **state)
{
    assert_true(crash_at_writes(*state, 5, 1000) > 1);
}

/* Within the frame that splits the nodes of the chunk index, and the one after. */
static void test_killed_while_the_index_grows(void **state)
{
    const int64_t first = crash_writes(*state, 64), stride = (crash_writes(*state, CRASH_FRAMES) - first) / 16;
    assert_true(stride > 5);
    assert_true(crash_at_writes(*state, first, stride) > 12);
}

static void test_killed_from_outside(void **state)
{
    const char *path = file_in(*state, "run.h5");
    int caught = 0;
    for (int i = 0; i < 14; i++) {
        const long nanoseconds = 3000000L + 4300000L * i;
        unlink(path);
        crash_record_after(path, &CRASH_SETUP, 100 * CRASH_FRAMES, nanoseconds);
        caught += crash_counters()->frames > 0;
        const char *wrong = crash_check(path, &CRASH_SETUP);
        if (wrong) fail_msg("killed after %ld ns: %s", nanoseconds, wrong);
    }
    assert_true(caught > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_killed_at_the_start, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_killed_while_the_index_grows, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_killed_from_outside, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
