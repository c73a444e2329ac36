/* Events of a scene's time line, on bodies in flight and awake: what they do, and that the ledger knows it. */
#include "sim/stage.h"

static const double bar[3] = {0.02, 0.02, 0.06};

/* A long soft unbreakable bar that hangs by its upper end until 5 ms, so that it is awake and vibrates; or one that flies. */
static void make_scene(Stage *stage, bool awake)
{
    stage_make(stage);
    stage_box(stage, "bar", bar, 0.01, 0.5);
    stage->material.breakable = false;
    stage->scene.duration = 0.02;
    stage->scene.output.rate = 500.0;
    if (!awake) return;
    ShvConditionDefinition *support = stage_support(stage, "hold", "bar");
    support->selection.kind = SHV_SELECT_PLANE;
    support->selection.plane_normal[2] = 1.0;
    support->selection.plane_offset = 0.53;
    support->selection.tolerance = 1e-6;
    stage_event(stage, 0.005, SHV_EVENT_RELEASE, "hold");
}

static const double mass = 1200.0 * 0.02 * 0.02 * 0.06;

/* Runs to the end with the residual small all the way: 1e-4 of the largest energy is what Green strain, which is not quadratic,
   leaves to the trapezoidal rule at the strains of these scenes; booking an event wrongly would show as a share of one. Besides,
   a start from given velocities takes ½ m v² for the ½ m v₋·v₊ of the staggered scheme, which is m (g dt)²/8 less. */
static ShvFrameView run(const Stage *stage, int32_t *happened)
{
    const double longest_step = 2e-5, start = mass * (9.81 * longest_step) * (9.81 * longest_step) / 8.0;
    ShvSimulation *simulation = stage_start(stage);
    *happened = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        assert_true(frame->step < longest_step);
        check_near(frame->ledger.residual, 0.0, 1e-4 * frame->ledger.largest + start);
        for (int32_t i = 0; i < frame->event_count; i++)
            if (frame->events[i].kind == SHV_RUN_SCENE) {
                assert_int_equal((int)frame->events[i].value, *happened);
                check_near(frame->events[i].time, stage->events[*happened].time, 1e-15);
                ++*happened;
            }
    }
    ShvFrameView last = *shv_simulation_frame(simulation);
    last.fragments = NULL;
    last.events = NULL;
    shv_simulation_destroy(simulation);
    return last;
}

static void test_release(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, true);
    int32_t happened;
    const ShvFrameView last = run(&stage, &happened);
    assert_int_equal(happened, 1);
    /* Free from 5 ms on, with what momentum the support's end left it. */
    assert_true(last.ledger.momentum[2] < -0.9 * mass * 9.81 * 0.015);
}

static void test_set_velocity(void **state)
{
    (void)state;
    for (int awake = 0; awake < 2; awake++) {
        Stage stage;
        make_scene(&stage, awake);
        ShvEventDefinition *event = stage_event(&stage, 0.0073, SHV_EVENT_SET_VELOCITY, "bar");
        event->value[0] = 3.0;
        event->angular[1] = 20.0;
        int32_t happened;
        const ShvFrameView last = run(&stage, &happened);
        assert_int_equal(happened, stage.scene.event_count);
        check_near(last.ledger.momentum[0], 3.0 * mass, 1e-9 * mass);
        check_near(last.ledger.momentum[2], -9.81 * (0.02 - 0.0073) * mass, 1e-9 * mass);
        assert_true(last.ledger.event > 0.4 * mass * 9.0);
    }
}

static void test_impulse(void **state)
{
    (void)state;
    for (int awake = 0; awake < 2; awake++) {
        Stage stage;
        make_scene(&stage, awake);
        stage_event(&stage, 0.0073, SHV_EVENT_IMPULSE, "bar")->value[1] = 0.04;
        int32_t happened;
        const ShvFrameView last = run(&stage, &happened);
        assert_int_equal(happened, stage.scene.event_count);
        check_near(last.ledger.momentum[1], 0.04, 1e-12);
    }
}

static void test_gravity(void **state)
{
    (void)state;
    for (int awake = 0; awake < 2; awake++) {
        Stage stage;
        make_scene(&stage, awake);
        stage_event(&stage, 0.01, SHV_EVENT_GRAVITY, NULL)->value[0] = 100.0;
        int32_t happened;
        const ShvFrameView last = run(&stage, &happened);
        assert_int_equal(happened, stage.scene.event_count);
        check_near(last.ledger.momentum[0], mass * 100.0 * 0.01, 1e-9 * mass);
    }
}

/* Two events at one time happen in their order; one after the end never does. */
static void test_order(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, false);
    stage_event(&stage, 0.01, SHV_EVENT_SET_VELOCITY, "bar");
    stage_event(&stage, 0.01, SHV_EVENT_IMPULSE, "bar")->value[0] = 0.01;
    stage_event(&stage, 1.0, SHV_EVENT_IMPULSE, "bar")->value[0] = 1.0;
    int32_t happened;
    const ShvFrameView last = run(&stage, &happened);
    assert_int_equal(happened, 2);
    check_near(last.ledger.momentum[0], 0.01, 1e-15);
}

static void refuse(const Stage *stage, const char *part)
{
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_simulation_create(&simulation, &stage->scene, NULL, &error), SHV_BAD_INPUT, error, part);
    assert_null(simulation);
}

static void test_bad_events(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, false);
    stage_event(&stage, 0.01, SHV_EVENT_IMPULSE, "bat");
    refuse(&stage, "'bat'");
    stage.events[0].target = NULL;
    refuse(&stage, "event 0");
    stage.events[0].target = "bar";
    stage.events[0].value[1] = (double)NAN;
    refuse(&stage, "finite");
    stage.events[0].value[1] = 0.0;
    stage_event(&stage, 0.005, SHV_EVENT_GRAVITY, NULL);
    refuse(&stage, "increasing time");
    stage.events[1] = (ShvEventDefinition){0};
    refuse(&stage, "shv_event_default");
    stage.events[1] = shv_event_default();
    stage.events[1].time = 0.02;
    stage.events[1].kind = SHV_EVENT_RELEASE;
    stage.events[1].target = "bar";
    refuse(&stage, "no condition");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_release), cmocka_unit_test(test_set_velocity), cmocka_unit_test(test_impulse),
        cmocka_unit_test(test_gravity), cmocka_unit_test(test_order),        cmocka_unit_test(test_bad_events),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
