/* A body on supports costs nothing until something comes near it, and once it has calmed down again. */
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

static void it_wakes_when_something_comes(void **state)
{
    (void)state;
    Stage stage;
    make_scene(&stage, falls_to(0.1));
    ShvSimulation *simulation = stage_start(&stage);
    ShvError error;
    check_ok(shv_simulation_step(simulation, 0.09, &error), error);
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_false(frame->fracture);
    assert_int_equal(frame->steps, 0);
    const ShvAwakeView awake = shv_simulation_awake(simulation);
    assert_true(awake.load == 0.0 && awake.ahead == 0.0 && awake.rest == frame->time);
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
static void it_is_not_fixed_where_something_happens(void **state)
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
    for (int side = 0; side < 2; side++) stage.conditions[side].axes[1] = false; /* it may slide, */
    assert_int_equal(steps_of(&stage), 0);
    stage.scene.gravity[1] = 1.0; /* and does */
    assert_true(steps_of(&stage) > 0);
    make_scene(&stage, 1.0);
    stage.conditions[1].selection.plane_offset = -0.04; /* on one side, along a line alone: it may turn */
    for (int side = 0; side < 2; side++) stage.conditions[side].axes[0] = side == 0;
    stage.scene.gravity[0] = 1.0;
    assert_int_equal(steps_of(&stage), 0); /* a clamped end holds it */
}

/* A ball beside the middle, thrown up, that reaches the plate after 0.3 s with 1.8 m/s; it bears that. */
static void add_second_ball(Stage *stage)
{
    ShvObstacleDefinition *second = stage_free_ball(stage, "second", 0.01, 0.03);
    second->placement.position[0] = 0.03;
    second->placement.position[2] = 0.1185;
    second->placement.velocity[2] = 1.143;
    stage->scene.duration = 0.31;
    stage->material.cohesive_strength *= 10.0;
    stage->material.cohesive_strength_shear *= 10.0;
    stage->material.fracture_energy *= 100.0;
    stage->material.fracture_energy_shear *= 100.0;
}

/* Struck, it calms down, and what struck it lies on it: from then on no steps are taken. Another blow wakes it again, and is thrown back
   as from a plate that has never been struck. */
static void it_calms_down(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    make_scene(&stage, 10.0);
    add_second_ball(&stage);
    ShvSimulation *simulation = stage_start(&stage);
    const double rebound = stage_finish(simulation)->obstacles[1].velocity[2];
    assert_true(rebound > 0.5);
    shv_simulation_destroy(simulation);
    make_scene(&stage, falls_to(0.01));
    add_second_ball(&stage);
    simulation = stage_start(&stage);
    check_ok(shv_simulation_step(simulation, 0.2, &error), error);
    const int64_t struck = shv_simulation_frame(simulation)->steps;
    assert_true(struck > 0);
    check_ok(shv_simulation_step(simulation, 0.29, &error), error);
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_int_equal(frame->steps, struck);
    assert_false(frame->fracture);
    check_near(frame->obstacles[0].position[2], 0.02, 1e-4);
    int32_t wakes = 0;
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++) {
            if (frame->events[i].kind != SHV_RUN_WAKE) continue;
            assert_true(frame->events[i].kinetic_after == 0.0 && frame->events[i].strain_after == 0.0);
            wakes++;
        }
    }
    assert_true(wakes > 0 && frame->steps > struck && frame->inserted == 0);
    check_near(frame->obstacles[1].velocity[2], rebound, 0.1 * rebound); /* the first one swings along */
    check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    shv_simulation_destroy(simulation);
}

/* A block that is cracked along its length, and held by one half of an end: the other half hangs by the nodes of the crack's end. It
   swings until it should have calmed down, then it falls, and all rests. */
static void what_hangs_by_nodes_is_let_go(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    const ShvCrackDefinition crack = {
        .plane = {.kind = SHV_SELECT_PLANE, .plane_normal = {0.0, 1.0}, .plane_offset = 0.004, .tolerance = 1e-6}};
    ShvObjectDefinition *block = stage_box(&stage, "block", plate, 0.01, 0.0);
    block->mesh.pattern = SHV_PATTERN_BRICKS; /* five layers, with facets between */
    block->cracks = &crack;
    block->crack_count = 1;
    ShvConditionDefinition *support = stage_support(&stage, "end", "block");
    support->selection.kind = SHV_SELECT_BOX;
    for (int k = 0; k < 3; k++) {
        support->selection.box_min[k] = k == 0 ? 0.0399 : -1.0;
        support->selection.box_max[k] = k == 1 ? 0.0041 : 1.0;
    }
    stage.scene.gravity[1] = 9.81; /* so that it turns about them, away from the half that is held */
    stage.scene.gravity[2] = 0.0;
    stage.scene.fracture.longest = 0.02;
    stage.scene.duration = 0.2;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_int_equal(frame->alive_count, 2);
    assert_false(frame->fracture);
    double farthest = 0.0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        if (isfinite(frame->fragments[i].death)) continue;
        farthest = fmax(farthest, frame->fragments[i].position[1]);
    }
    assert_true(farthest > 0.05);
    shv_simulation_destroy(simulation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_wakes_when_something_comes),
        cmocka_unit_test(it_calms_down),
        cmocka_unit_test(it_is_not_fixed_where_something_happens),
        cmocka_unit_test(what_hangs_by_nodes_is_let_go),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
