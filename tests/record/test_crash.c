#include "check.h"

#include <unistd.h>

#include "crash.h"
#include "files.h"

static void test_killed_at_any_operation(void **state)
{
    const int64_t all = crash_operations(*state, &CRASH_SETUP, CRASH_FRAMES);
    assert_true(crash_at_operations(*state, &CRASH_SETUP, 3, all / 25 | 1) > 20);
    assert_true(crash_at_operations(*state, &CRASH_SETUP, all - 25, 1) == 25);
}

/* All frames but the first are in the journal alone. */
static void test_killed_with_a_long_journal(void **state)
{
    const int64_t all = crash_operations(*state, &CRASH_LAZY, CRASH_FRAMES);
    assert_true(crash_at_operations(*state, &CRASH_LAZY, 2, all / 25 | 1) > 20);
    assert_true(crash_at_operations(*state, &CRASH_LAZY, all - 25, 1) == 25);
}

static void test_killed_from_outside(void **state)
{
    const char *path = file_in(*state, "run.h5");
    int caught = 0;
    /* Later and later, until some were caught in the middle: how fast a run gets there depends on the machine. */
    for (int i = 0; i < 14 || (caught == 0 && i < 60); i++) {
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
        cmocka_unit_test_setup_teardown(test_killed_at_any_operation, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_killed_with_a_long_journal, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_killed_from_outside, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
