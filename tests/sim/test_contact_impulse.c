/* What obstacles do to a body in fracture mode: impulses add up to its change of momentum, and the clock runs while they act. */
#include "sim/stage.h"

/* An explicit run, or one with bars, in which what has woken stays awake, so that all contact is in fracture mode. */
static void make_impact(Stage *stage, bool bars)
{
    stage_make_breaking_bar(stage);
    stage->objects[0].placement.velocity[2] = -0.26;
    stage->scene.fracture.quiet_checks = 1000000;
    stage->scene.fracture.longest = 1e3;
    if (bars) stage->scene.fracture.stabiliser = SHV_STABILISER_BARS;
}

static void check_impact(bool bars)
{
    Stage stage;
    make_impact(&stage, bars);
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_next(simulation);
    double start[3], gravity[3], contact_time = 0.0;
    memcpy(start, frame->ledger.momentum, sizeof start);
    for (int k = 0; k < 3; k++) gravity[k] = frame->fragments[0].mass * stage.scene.gravity[k];
    assert_true(isnan(frame->first_contact) && isnan(frame->last_contact) && frame->contact_time == 0.0);
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        assert_true(frame->contact_time >= contact_time && frame->contact_time <= frame->time);
        contact_time = frame->contact_time;
    }
    assert_true(contact_time > 0.0);
    assert_true(frame->first_contact > 0.0 && frame->last_contact <= frame->time * (1.0 + 1e-12));
    assert_true(contact_time <= (frame->last_contact - frame->first_contact) * (1.0 + 1e-9));
    /* P(t) = P(0) + m g t + J. A momentum between two steps is the mean of both, so half of the last step's impulses, and half a
       step of gravity's, may be missing from it: a step's share of the whole. */
    double size = 0.0;
    for (int k = 0; k < 3; k++) size += fabs(frame->contact_impulse[k]);
    const double tolerance = size * frame->step / contact_time + 1e-9 * size;
    for (int k = 0; k < 3; k++)
        check_near(frame->ledger.momentum[k], start[k] + gravity[k] * frame->time + frame->contact_impulse[k],
                   tolerance);
    assert_true(frame->contact_impulse[2] > 10.0 * tolerance);
    shv_simulation_destroy(simulation);
}

static void test_explicit(void **state)
{
    (void)state;
    check_impact(false);
}

static void test_bars(void **state)
{
    (void)state;
    check_impact(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_explicit), cmocka_unit_test(test_bars)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
