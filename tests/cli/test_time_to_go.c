/* The arithmetic of the time to go, on runs that were made up. */
#include "check.h"

#include "cli/time_to_go.h"

static const double step = 1e-6;

/* The run stands at `time` after so many steps and s of processor time. */
static void add(ShvTimeToGo *estimate, double processor, double time, int64_t steps, ShvAwakeView awake)
{
    awake.step = step;
    const ShvRunSample sample = {processor, {time, steps, 1, awake.load > 0.0}, awake};
    shv_time_to_go_add(estimate, &sample);
}

static void nothing_is_told_before_it_is_seen(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0};
    assert_true(isnan(shv_time_to_go(&estimate)));
    add(&estimate, 7.0, 0.0, 0, (ShvAwakeView){.rest = 0.0});
    assert_true(isnan(shv_time_to_go(&estimate)));
    add(&estimate, 8.0, 0.1, 0, (ShvAwakeView){.rest = 0.1});
    check_near(shv_time_to_go(&estimate), 9.0, 1e-9);
    /* It flew until now: what steps cost is not known. */
    add(&estimate, 8.1, 0.11, 0, (ShvAwakeView){.load = 100.0, .ahead = 1.0, .rest = 0.12});
    assert_true(isnan(shv_time_to_go(&estimate)));
}

/* Only what was simulated since the run went on counts. */
static void a_resumed_run_is_measured_from_there(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0};
    add(&estimate, 0.0, 0.5, 1000, (ShvAwakeView){.rest = 0.5});
    add(&estimate, 1.0, 0.6, 1000, (ShvAwakeView){.rest = 0.6});
    check_near(shv_time_to_go(&estimate), 4.0, 1e-9);
}

/* 100 tets for 1000 steps of 1 µs took 2 s: what is ahead, twice that, takes 4 s; what wakes again 0.8 of what was, times the share
   of the time that is left. */
static void steps_cost_what_their_load_did(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0};
    add(&estimate, 0.0, 0.0, 0, (ShvAwakeView){.load = 100.0, .ahead = 0.3, .rest = 0.003});
    add(&estimate, 2.0, 0.001, 1000, (ShvAwakeView){.load = 100.0, .ahead = 0.2, .rest = 0.003});
    check_near(shv_time_to_go(&estimate), 4.0 + 0.8 * 2.0 * 0.999, 1e-9);
    /* Nearly nothing is left of the time: nothing more wakes. */
    estimate.duration = 0.001;
    check_near(shv_time_to_go(&estimate), 4.0, 1e-9);
}

/* What cannot crack is as dear to the end as it is; it wakes again only once it has come to rest. */
static void what_cannot_break_wakes_after_its_rest(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0, .unbreakable = true};
    add(&estimate, 0.0, 0.0, 0, (ShvAwakeView){.load = 100.0, .ahead = 100.0, .rest = 1.0});
    add(&estimate, 2.0, 0.001, 1000, (ShvAwakeView){.load = 100.0, .ahead = 99.9, .rest = 1.0});
    check_near(shv_time_to_go(&estimate), 2.0 * 999.0, 1e-9);
    estimate.last.awake = (ShvAwakeView){.load = 100.0, .ahead = 0.2, .rest = 0.003};
    check_near(shv_time_to_go(&estimate), 4.0 + 0.8 * 2.0 * 0.997, 1e-9);
}

/* Time that was flown through between two samples of something awake is no load. */
static void flight_between_is_no_load(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0};
    add(&estimate, 0.0, 0.0, 0, (ShvAwakeView){.load = 10.0, .ahead = 0.01, .rest = 0.001});
    add(&estimate, 1.0, 0.5, 1000, (ShvAwakeView){.load = 10.0, .ahead = 0.01, .rest = 0.501});
    check_near(estimate.load, 0.01, 1e-12);
}

static void flight_and_steps_are_added(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 1.0};
    add(&estimate, 0.0, 0.0, 0, (ShvAwakeView){.rest = 0.0});
    add(&estimate, 1.0, 0.5, 0, (ShvAwakeView){.load = 10.0, .ahead = 0.02, .rest = 0.502});
    add(&estimate, 3.0, 0.501, 1000, (ShvAwakeView){.load = 10.0, .ahead = 0.01, .rest = 0.502});
    check_near(shv_time_to_go(&estimate), 2.0 * 0.498 + 2.0 + 0.8 * 2.0 * 0.499, 1e-9);
}

/* A pile gathers: flight that has become dearer is guessed nearer to its late cost than to its mean. */
static void late_costs_count_more(void **state)
{
    (void)state;
    ShvTimeToGo estimate = {.duration = 2.0};
    for (int i = 0; i <= 100; i++) {
        const double time = 0.01 * i;
        const double processor = time <= 0.5 ? time : 0.5 + 5.0 * (time - 0.5);
        add(&estimate, processor, time, 0, (ShvAwakeView){.rest = time});
    }
    const double to_go = shv_time_to_go(&estimate);
    assert_true(to_go > 1.2 * 3.0 && to_go < 5.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_told_before_it_is_seen),
        cmocka_unit_test(a_resumed_run_is_measured_from_there),
        cmocka_unit_test(steps_cost_what_their_load_did),
        cmocka_unit_test(what_cannot_break_wakes_after_its_rest),
        cmocka_unit_test(flight_between_is_no_load),
        cmocka_unit_test(flight_and_steps_are_added),
        cmocka_unit_test(late_costs_count_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
