#include "check.h"

#include "shiver/status.h"

static void every_status_has_its_own_name(void **state)
{
    (void)state;
    for (int a = SHV_OK; a <= SHV_UNSUPPORTED; a++) {
        assert_non_null(shv_status_name((ShvStatus)a));
        for (int b = SHV_OK; b < a; b++)
            assert_string_not_equal(shv_status_name((ShvStatus)a), shv_status_name((ShvStatus)b));
    }
    assert_string_equal(shv_status_name(SHV_BAD_INPUT), "bad input");
    assert_string_equal(shv_status_name((ShvStatus)99), "unknown status");
}

static void failing_fills_status_and_message(void **state)
{
    (void)state;
    ShvError error = {SHV_OK, ""};
    assert_int_equal(shv_fail(&error, SHV_BAD_INPUT, "edge is %g m, give %d", 0.5, 7), SHV_BAD_INPUT);
    assert_int_equal(error.status, SHV_BAD_INPUT);
    assert_string_equal(error.message, "edge is 0.5 m, give 7");
    assert_int_equal(shv_fail(NULL, SHV_DIVERGED, "x"), SHV_DIVERGED);
}

static void context_stands_in_front(void **state)
{
    (void)state;
    ShvError error = {SHV_OK, ""};
    shv_fail(&error, SHV_FILE_ERROR, "no such file");
    assert_int_equal(shv_fail_within(&error, error.status, "mesh '%s'", "a"), SHV_FILE_ERROR);
    assert_string_equal(error.message, "mesh 'a': no such file");
    assert_int_equal(error.status, SHV_FILE_ERROR);
    assert_int_equal(shv_fail_within(NULL, SHV_BAD_INPUT, "x"), SHV_BAD_INPUT);
}

static void old_message_may_be_an_argument(void **state)
{
    (void)state;
    ShvError error = {SHV_OK, "first"};
    shv_fail(&error, SHV_BAD_INPUT, "second after %s", error.message);
    assert_string_equal(error.message, "second after first");
}

static void long_messages_are_cut_and_terminated(void **state)
{
    (void)state;
    char text[3000];
    memset(text, 'x', sizeof text);
    text[sizeof text - 1] = '\0';
    ShvError error = {SHV_OK, ""};
    shv_fail(&error, SHV_BAD_INPUT, "%s", text);
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    shv_fail_within(&error, SHV_BAD_INPUT, "c");
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    assert_memory_equal(error.message, "c: xxx", 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_status_has_its_own_name),
        cmocka_unit_test(failing_fills_status_and_message),
        cmocka_unit_test(context_stands_in_front),
        cmocka_unit_test(old_message_may_be_an_argument),
        cmocka_unit_test(long_messages_are_cut_and_terminated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
