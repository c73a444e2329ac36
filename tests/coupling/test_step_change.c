/* Central difference keeps an energy that its step is part of: what a change of the step makes of it is booked, to the digit. */
#include "coupling/stage.h"

#include "base/random.h"
#include "coupling/hybrid.h"

/* A body that rings, strained by so little that its energy is quadratic. */
static void ring(ShvHybrid *hybrid, Stage *stage, double poisson)
{
    ShvError error = {SHV_OK, ""};
    stage_make(stage);
    stage->material.breakable = false;
    stage->material.poissons_ratio = poisson;
    stage->scene.fracture.longest = 1e3;
    stage->scene.fracture.quiet_checks = 1000000;
    ShvObjectDefinition *body = stage_box(stage, "body", (const double[3]){0.04, 0.02, 0.02}, 0.01, 0.2);
    body->placement.stretch_rate[0] = 0.02;
    body->placement.stretch_rate[1] = -0.05;
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
}

/* On in pieces of 0.4 to 3 steps, each filled by steps of its own length. */
static ShvLedgerView go_on(ShvHybrid *hybrid, uint64_t seed)
{
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    const double pieces = 0.4 + 2.6 * shv_random_uniform(5, seed);
    const double time = hybrid->state.time + pieces * shv_hybrid_choose_step(hybrid, 1.0);
    check_ok(shv_hybrid_advance(hybrid, time, 0, &taken, &error), error);
    check_ok(shv_hybrid_observe(hybrid, &error), error);
    return hybrid->observer.balance;
}

static void test_changed_steps_are_booked(void **unused)
{
    (void)unused;
    for (int k = 0; k < 2; k++) {
        Stage stage;
        ShvHybrid hybrid;
        ring(&hybrid, &stage, k ? 0.3 : 0.0);
        const double energy = hybrid.observer.balance.kinetic;
        double most = 0.0;
        for (uint64_t i = 0; i < 100; i++) {
            const ShvLedgerView balance = go_on(&hybrid, i);
            assert_true(fabs(balance.residual) < 1e-6 * energy);
            most = fmax(most, fabs(balance.step_change));
        }
        assert_true(most > 1e-2 * energy); /* there is something to be seen */
        shv_hybrid_release(&hybrid);
    }
}

static void test_equal_steps_book_nothing(void **unused)
{
    (void)unused;
    Stage stage;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    ring(&hybrid, &stage, 0.3);
    check_ok(shv_hybrid_advance(&hybrid, 1e-3, 0, &taken, &error), error);
    check_ok(shv_hybrid_observe(&hybrid, &error), error);
    const double first = hybrid.observer.balance.step_change;
    check_ok(shv_hybrid_advance(&hybrid, 2e-3, 0, &taken, &error), error);
    check_ok(shv_hybrid_observe(&hybrid, &error), error);
    assert_true(taken > 10);
    assert_true(fabs(hybrid.observer.balance.step_change - first) < 1e-12 * hybrid.observer.balance.largest);
    shv_hybrid_release(&hybrid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changed_steps_are_booked),
        cmocka_unit_test(test_equal_steps_book_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
