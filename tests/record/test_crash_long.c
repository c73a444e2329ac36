#include "check.h"

#include "crash.h"
#include "files.h"

/* 11 has no factor in common with the number of operations of a frame: all kinds of operations are met. */
static void test_killed_anywhere(void **state)
{
    assert_true(crash_at_operations(*state, &CRASH_SETUP, 0, 11) > 100);
    assert_true(crash_at_operations(*state, &CRASH_LAZY, 0, 11) > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_killed_anywhere, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
