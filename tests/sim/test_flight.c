#include "sim/stage.h"

static const double cube[3] = {0.02, 0.02, 0.02};

/* The animation grid: k / rate from 0, and the duration as the last frame, also where it is off the grid. */
static void check_grid(double rate, double duration, int frames)
{
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", cube, 0.01, 1.0);
    stage.scene.output.rate = rate;
    stage.scene.duration = duration;
    ShvSimulation *simulation = stage_start(&stage);
    ShvPlan plan;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_plan(simulation, &plan, &error), error);
    assert_int_equal(plan.frames, frames);
    for (int k = 0; k < frames; k++) {
        assert_false(shv_simulation_finished(simulation));
        const ShvFrameView *frame = stage_next(simulation);
        assert_true(frame->animation);
        const double expected = k == frames - 1 ? duration : k / rate;
        assert_true(frame->time == expected);
    }
    assert_true(shv_simulation_finished(simulation));
    shv_simulation_destroy(simulation);
}

static void test_frame_grid(void **state)
{
    (void)state;
    check_grid(240.0, 0.05, 13);
    check_grid(100.0, 0.025, 4);
    check_grid(1000.0, 0.0, 1);
    check_grid(10.0, 0.1 * 3.0, 4); /* 0.30000000000000004: no frame for what rounding left over */
    check_grid(100.0, 0.07, 8);     /* 0.07 × 100 = 7.000000000000001 */
    check_grid(1.0, 1e-9, 2);
}

/* z = z₀ − g t²/2 and v = −g t, to the rounding of a hundred additions to a position near 1. */
static void test_free_fall(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", cube, 0.01, 1.0);
    stage.scene.duration = 0.1;
    ShvSimulation *simulation = stage_start(&stage);
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        const ShvFragmentView *body = &frame->fragments[0];
        check_near(body->position[2], 1.0 - 0.5 * 9.81 * frame->time * frame->time, 200.0 * 2.2e-16);
        check_near(body->velocity[2], -9.81 * frame->time, 200.0 * 2.2e-16);
        check_near(frame->ledger.residual, 0.0, 1e-12 * frame->ledger.largest);
        assert_false(frame->fracture);
    }
    shv_simulation_destroy(simulation);
}

/* Without torque angular momentum stays and energy, too: the flight is exact to rounding. */
static void test_free_rotation(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *plate = stage_box(&stage, "plate", (const double[3]){0.06, 0.04, 0.02}, 0.02, 1.0);
    const double spin[3] = {0.3, 40.0, 0.2};
    memcpy(plate->placement.angular_velocity, spin, sizeof spin);
    memset(stage.scene.gravity, 0, sizeof stage.scene.gravity);
    stage.scene.duration = 2.0;
    stage.scene.output.rate = 10.0;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_next(simulation);
    const ShvLedgerView start = frame->ledger;
    const double size = fabs(start.angular_momentum[1]);
    assert_true(size > 0.0);
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        check_near(frame->ledger.kinetic, start.kinetic, 1e-11 * start.kinetic);
        for (int k = 0; k < 3; k++)
            check_near(frame->ledger.angular_momentum[k], start.angular_momentum[k], 1e-11 * size);
    }
    shv_simulation_destroy(simulation);
}

static void check_corners_unmoved(const ShvSimulation *simulation)
{
    static double corners[12 * 1024];
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    assert_true(mesh.element_count <= 1024);
    shv_simulation_corner_positions(simulation, corners);
    for (int32_t i = 0; i < 4 * mesh.element_count; i++)
        assert_memory_equal(corners + 3 * i, mesh.positions + 3 * (int64_t)mesh.elements[i], 3 * sizeof(double));
}

static void make_weightless(Stage *stage)
{
    stage_make(stage);
    ShvObjectDefinition *box = stage_box(stage, "box", cube, 0.005, 0.7);
    box->placement.rotation_axis[0] = 1.0;
    box->placement.rotation_degrees = 33.0;
    memset(stage->scene.gravity, 0, sizeof stage->scene.gravity);
    stage->scene.duration = 0.01;
    stage->scene.output.rate = 1000.0;
}

/* Without gravity a body at rest stays where it is, bit by bit: awake, with every element at work (its support goes at the
   start) … */
static void test_awake_rest_without_gravity(void **state)
{
    (void)state;
    Stage stage;
    make_weightless(&stage);
    stage_support(&stage, "hold", "box");
    stage_event(&stage, 0.0, SHV_EVENT_RELEASE, "hold");
    /* Released and quiet it would go to rest: here it is to stay in fracture mode. */
    stage.scene.fracture.quiet_checks = 1000000;
    stage.scene.fracture.longest = 1e3;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_true(frame->steps > 100);
    check_corners_unmoved(simulation);
    assert_true(frame->ledger.kinetic == 0.0 && frame->ledger.strain == 0.0 && frame->ledger.residual == 0.0);
    assert_int_equal(frame->inserted, 0);
    shv_simulation_destroy(simulation);
}

/* … and in flight, where its pose stays. */
static void test_flying_rest_without_gravity(void **state)
{
    (void)state;
    Stage stage;
    make_weightless(&stage);
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFragmentView start = stage_next(simulation)->fragments[0];
    const ShvFrameView *frame = stage_finish(simulation);
    assert_false(frame->fracture);
    assert_memory_equal(frame->fragments[0].position, start.position, sizeof start.position);
    assert_memory_equal(frame->fragments[0].orientation, start.orientation, sizeof start.orientation);
    assert_true(frame->ledger.kinetic == 0.0 && frame->ledger.residual == 0.0);
    shv_simulation_destroy(simulation);
}

/* A turned body has no stress to open anything, however weak: 1e-9 of the modulus is far above rounding. */
static void test_turned_body_stays_whole(void **state)
{
    (void)state;
    Stage stage;
    make_weightless(&stage);
    stage.objects[0].placement.rotation_degrees = 90.0;
    stage.material.cohesive_strength = 1e-9 * stage.material.youngs_modulus;
    stage_support(&stage, "hold", "box");
    stage_event(&stage, 0.0, SHV_EVENT_RELEASE, "hold");
    /* Released and quiet it would go to rest: here it is to stay in fracture mode. */
    stage.scene.fracture.quiet_checks = 1000000;
    stage.scene.fracture.longest = 1e3;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_true(frame->fracture && frame->steps > 100);
    assert_int_equal(frame->inserted, 0);
    shv_simulation_destroy(simulation);
}

/* Beside a body in fracture mode another lands on the floor. It wakes before it touches: a rigid impulse would take the energy
   that is to break it. */
static void test_wakes_before_it_is_struck(void **state)
{
    (void)state;
    Stage stage;
    make_weightless(&stage);
    stage.objects[0].placement.position[2] = 0.02;
    stage_support(&stage, "hold", "box");
    ShvObjectDefinition *second = stage_box(&stage, "second", cube, 0.005, 0.02);
    second->placement.position[0] = 0.025;
    second->placement.rotation_axis[0] = 1.0;
    second->placement.rotation_degrees = 20.0;
    second->placement.velocity[2] = -2.0;
    stage_floor(&stage);
    stage.scene.rigid.engine = SHV_RIGID_BULLET;
    ShvSimulation *simulation = stage_start(&stage);
    const double start = stage_next(simulation)->ledger.kinetic;
    int32_t woken = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++) {
            if (frame->events[i].kind != SHV_RUN_WAKE || frame->events[i].reason == SHV_REASON_CONTACT) continue;
            if (woken++ == 0) check_near(frame->events[i].kinetic_before, start, 1e-9);
        }
    }
    assert_true(woken > 0);
    shv_simulation_destroy(simulation);
}

static void test_separate_meshes(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "lower", cube, 0.01, 0.5);
    stage_box(&stage, "upper", cube, 0.02, 1.5)->placement.velocity[0] = 1.0;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    assert_int_equal(mesh.object_count, 2);
    assert_int_equal(mesh.objects[0].element_end, mesh.objects[1].element_begin);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_int_equal(frame->alive_count, 2);
    check_near(frame->fragments[0].mass, 1200.0 * 8e-6, 1e-15);
    check_near(frame->fragments[1].mass, 1200.0 * 8e-6, 1e-15);
    check_near(frame->fragments[0].position[0], 0.0, 1e-15);
    check_near(frame->fragments[1].position[0], 0.1, 1e-14);
    shv_simulation_destroy(simulation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frame_grid),
        cmocka_unit_test(test_free_fall),
        cmocka_unit_test(test_free_rotation),
        cmocka_unit_test(test_awake_rest_without_gravity),
        cmocka_unit_test(test_flying_rest_without_gravity),
        cmocka_unit_test(test_turned_body_stays_whole),
        cmocka_unit_test(test_wakes_before_it_is_struck),
        cmocka_unit_test(test_separate_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
