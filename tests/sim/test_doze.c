/* A body on supports costs nothing until something comes near it. */
#include "shiver/live.h"
#include "sim/stage.h"

static const double plate[3] = {0.08, 0.04, 0.02};

/* A plate that is held at both ends, and a ball that reaches it after 0.1 s. */
static void make_scene(Stage *stage, double height)
{
    stage_make(stage);
    stage_box(stage, "plate", plate, 0.01, 0.0);
    for (int side = 0; side < 2; side++) {
        ShvConditionDefinition *support = stage_support(stage, side == 0 ? "left" : "right", "plate");
        support->selection.kind = SHV_SELECT_PLANE;
        support->selection.plane_normal[0] = 1.0;
        support->selection.plane_offset = side == 0 ? -0.04 : 0.04;
        support->selection.tolerance = 1e-6;
    }
    stage_free_ball(stage, "ball", 0.01, 0.03)->placement.position[2] = height;
    stage->scene.duration = 0.12;
}

static double falls_to(double time)
{
    return 0.02 + 0.5 * 9.81 * time * time;
}

static void it_stirs_when_something_comes(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, falls_to(0.1));
    ShvSimulation *simulation = stage_start(&stage);
    ShvError error;
    check_ok(shv_simulation_step(simulation, 0.09, &error), error);
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_true(frame->fracture);
    assert_int_equal(frame->steps, 0);
    const ShvAwakeView dormant = shv_simulation_awake(simulation);
    assert_true(dormant.load == 0.0 && dormant.ahead == 0.0 && dormant.rest == frame->time);
    check_near(frame->ledger.residual, 0.0, 1e-12 * frame->ledger.largest);
    frame = stage_finish(simulation);
    assert_true(frame->steps > 0);
    assert_true(frame->contact_impulse[2] < -0.03); /* of the ball's 0.03 kg at 0.98 m/s */
    assert_true(frame->first_contact > 0.0999 && frame->first_contact < 0.101);
    check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    shv_simulation_destroy(simulation);
}

static int64_t steps_of(const Stage *stage)
{
    ShvSimulation *simulation = stage_start(stage);
    ShvError error;
    check_ok(shv_simulation_step(simulation, 0.005, &error), error);
    const int64_t steps = shv_simulation_frame(simulation)->steps;
    shv_simulation_destroy(simulation);
    return steps;
}

/* What is watched, moved, let go, loaded by more than it can bear, or touched by another body goes in steps. */
static void it_is_not_dormant_where_something_happens(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, 1.0);
    assert_int_equal(steps_of(&stage), 0);
    ShvProbeDefinition probe = shv_probe_default();
    probe.name = "middle";
    stage.scene.probes = &probe;
    stage.scene.probe_count = 1;
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage.conditions[0].kind = SHV_CONDITION_VELOCITY;
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage.conditions[1].end = 1.0;
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage.scene.gravity[2] = -1e4;
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage_event(&stage, 0.002, SHV_EVENT_GRAVITY, NULL);
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage_box(&stage, "other", plate, 0.01, 0.0201);
    assert_true(steps_of(&stage) > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_stirs_when_something_comes),
        cmocka_unit_test(it_is_not_dormant_where_something_happens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
