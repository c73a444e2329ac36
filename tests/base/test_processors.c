/* Processors that other programs leave free. */
#include "check.h"

#include <unistd.h>

#include "base/processors.h"
#include "base/timer.h"

static void others_take_whole_processors(void **unused)
{
    (void)unused;
    assert_int_equal(shv_processors_left(8, 0.0), 8);
    assert_int_equal(shv_processors_left(8, 0.4), 8); /* a desktop that idles */
    assert_int_equal(shv_processors_left(8, 0.6), 7);
    assert_int_equal(shv_processors_left(8, 2.9), 5);
    assert_int_equal(shv_processors_left(8, 7.0), 1);
    assert_int_equal(shv_processors_left(8, 8.0), 1); /* one is always ours */
    assert_int_equal(shv_processors_left(2, 40.0), 1);
    assert_int_equal(shv_processors_left(1, 0.0), 1);
    assert_int_equal(shv_processors_left(4, -1.0), 4); /* clocks that disagree by a tick */
}

static void a_quota_grants_no_more(void **unused)
{
    (void)unused;
    assert_int_equal(shv_processors_granted(8, "max 100000\n"), 8);
    assert_int_equal(shv_processors_granted(8, "200000 100000\n"), 2);
    assert_int_equal(shv_processors_granted(8, "150000 100000\n"), 1); /* a second one would wait half of the time */
    assert_int_equal(shv_processors_granted(8, "20000 100000\n"), 1);
    assert_int_equal(shv_processors_granted(8, "6400000 100000\n"), 8);
    assert_int_equal(shv_processors_granted(8, ""), 8);
    assert_int_equal(shv_processors_granted(8, "0 0"), 8);
}

/* Own work is not that of others: with or without it the count stays within what there is, and the first look counts what runs. */
static void looks_stay_within_what_there_is(void **unused)
{
    (void)unused;
    const int32_t online = (int32_t)sysconf(_SC_NPROCESSORS_ONLN);
    ShvProcessors processors = {0};
    shv_processors_look(&processors);
    assert_in_range(processors.free, 1, online); /* fewer under a quota */
    for (double end = shv_now() + 0.05; shv_now() < end;) continue;
    const double before = processors.time;
    shv_processors_look(&processors);
    assert_true(processors.time > before);
    assert_true(processors.own > 0.0);
    assert_in_range(processors.free, 1, online);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(others_take_whole_processors),
        cmocka_unit_test(a_quota_grants_no_more),
        cmocka_unit_test(looks_stay_within_what_there_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
