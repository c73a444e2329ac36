#include "check.h"

#include "base/timer.h"

static void costs_chain_without_gaps(void **state)
{
    (void)state;
    ShvCosts costs = {{0.0}, {0}};
    const double start = shv_now();
    double now = start;
    for (int i = 0; i < 30; i++) now = shv_costs_add(&costs, (ShvCost)(i % 3), now);
    assert_true(now >= start);
    double sum = 0.0;
    for (int i = 0; i < SHV_COST_COUNT; i++) {
        assert_true(costs.seconds[i] >= 0.0);
        assert_int_equal(costs.calls[i], i < 3 ? 10 : 0);
        sum += costs.seconds[i];
    }
    /* Thirty differences of clock readings, each rounded to a unit of the clock's own magnitude. */
    check_near(sum, now - start, 30.0 * 2.3e-16 * now);
}

static void the_clock_runs(void **state)
{
    (void)state;
    const double start = shv_now();
    double now = start;
    for (int64_t i = 0; i < 100000000 && now <= start; i++) now = shv_now();
    assert_true(now > start);
}

static void every_cost_has_its_own_name(void **state)
{
    (void)state;
    for (int a = 0; a <= SHV_COST_COUNT; a++)
        for (int b = 0; b < a; b++) assert_string_not_equal(shv_cost_name((ShvCost)a), shv_cost_name((ShvCost)b));
    assert_string_equal(shv_cost_name(SHV_COST_HANDOVER), "handover");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(costs_chain_without_gaps),
        cmocka_unit_test(the_clock_runs),
        cmocka_unit_test(every_cost_has_its_own_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
