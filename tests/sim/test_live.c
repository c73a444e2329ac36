/* Simulations driven from outside: steps to any time, pushes, bodies that come and go, and a ledger that knows it all. */
#include "shiver/live.h"
#include "sim/stage.h"

static const double side[3] = {0.04, 0.04, 0.04};
static const double mass = 1200.0 * 0.04 * 0.04 * 0.04;

/* One box in flight, another that waits, a free ball that waits; nothing breaks. */
static ShvSimulation *start(Stage *stage)
{
    stage_make(stage);
    stage_box(stage, "there", side, 0.02, 1.0);
    stage_box(stage, "later", side, 0.02, 1.0);
    stage->material.breakable = false;
    stage->objects[1].waits = true;
    stage_floor(stage);
    stage_free_ball(stage, "ball", 0.02, 0.3)->waits = true;
    stage->scene.duration = 0.05;
    stage->scene.output.rate = 100.0;
    return stage_start(stage);
}

static void check_ledger(const ShvSimulation *simulation)
{
    const ShvLedgerView *ledger = &shv_simulation_frame(simulation)->ledger;
    check_near(ledger->residual, 0.0, 1e-12 * ledger->largest);
}

static void steps_go_where_frames_would(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    ShvSimulation *by_frames = start(&stage);
    stage_finish(by_frames);
    const uint64_t hash = shv_simulation_hash(by_frames);
    shv_simulation_destroy(by_frames);
    ShvSimulation *by_steps = start(&stage);
    for (int i = 1; i <= 5; i++) check_ok(shv_simulation_step(by_steps, i / 100.0, &error), error);
    assert_true(shv_simulation_hash(by_steps) == hash);
    assert_true(shv_simulation_finished(by_steps));
    check_ok(shv_simulation_step(by_steps, 0.0612345, &error), error);
    check_near(shv_simulation_frame(by_steps)->time, 0.0612345, 0.0);
    check_near(shv_simulation_frame(by_steps)->fragments[0].position[2], 1.0 - 0.5 * 9.81 * 0.0612345 * 0.0612345,
               1e-12);
    check_fails(shv_simulation_step(by_steps, 0.05, &error), SHV_BAD_INPUT, error, "give a later time");
    check_fails(shv_simulation_step(by_steps, (double)NAN, &error), SHV_BAD_INPUT, error, "give a later time");
    shv_simulation_destroy(by_steps);
}

/* At the edge of a cube: P = J and L about the centre = r × J. */
static void a_push_gives_its_impulse(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    ShvSimulation *simulation = start(&stage);
    check_ok(shv_simulation_step(simulation, 0.013, &error), error);
    const ShvLedgerView before = shv_simulation_frame(simulation)->ledger;
    const double height = shv_simulation_frame(simulation)->fragments[0].position[2];
    const double impulse[3] = {0.0, 0.1, 0.0}, point[3] = {0.02, 0.0, height};
    check_ok(shv_simulation_push(simulation, 0, impulse, point, &error), error);
    const ShvLedgerView after = shv_simulation_frame(simulation)->ledger;
    check_near(after.momentum[1] - before.momentum[1], 0.1, 1e-15);
    check_near(after.angular_momentum[2] - before.angular_momentum[2], 0.02 * 0.1, 1e-15);
    assert_true(after.kinetic > before.kinetic + 0.5 * 0.1 * 0.1 / mass);
    check_ledger(simulation);
    check_fails(shv_simulation_push(simulation, 7, impulse, point, &error), SHV_BAD_INPUT, error, "no fragment 7");
    check_fails(shv_simulation_push(simulation, 1, impulse, point, &error), SHV_BAD_INPUT, error, "not in the scene");
    ShvEventDefinition event = shv_event_default();
    event.kind = SHV_EVENT_SET_VELOCITY;
    event.target = "there";
    check_ok(shv_simulation_apply(simulation, &event, &error), error);
    check_near(shv_simulation_frame(simulation)->ledger.kinetic, 0.0, 1e-15);
    check_ledger(simulation);
    event.target = "nobody";
    check_fails(shv_simulation_apply(simulation, &event, &error), SHV_BAD_INPUT, error, "acts on 'nobody'");
    shv_simulation_destroy(simulation);
}

/* In flight, whoever moves the body: velocities are as they were set at once, and the next step goes on with them. */
static void events_move_what_flies(void **state)
{
    (void)state;
    static const ShvRigidEngine engines[] = {SHV_RIGID_ANALYTIC, SHV_RIGID_PBD, SHV_RIGID_BULLET};
    for (int i = 0; i < 3; i++) {
        Stage stage;
        ShvError error;
        shv_simulation_destroy(start(&stage));
        stage.scene.rigid.engine = engines[i];
        stage.scene.pbd.exact_rotation = true;
        ShvSimulation *simulation = stage_start(&stage);
        check_ok(shv_simulation_step(simulation, 0.01, &error), error);
        ShvEventDefinition event = shv_event_default();
        event.kind = SHV_EVENT_SET_VELOCITY;
        event.target = "there";
        event.value[0] = 3.0;
        event.angular[2] = 4.0;
        check_ok(shv_simulation_apply(simulation, &event, &error), error);
        const double turning = 0.5 * shv_simulation_frame(simulation)->fragments[0].inertia[2] * 16.0;
        const double momentum = shv_simulation_frame(simulation)->ledger.angular_momentum[2];
        check_near(shv_simulation_frame(simulation)->ledger.kinetic, 0.5 * mass * 9.0 + turning, 1e-9);
        check_near(momentum, 2.0 * turning / 4.0, 1e-12);
        check_ledger(simulation);
        check_ok(shv_simulation_step(simulation, 0.02, &error), error);
        check_near(shv_simulation_frame(simulation)->fragments[0].position[0], 0.03, 1e-9);
        check_near(shv_simulation_frame(simulation)->ledger.angular_momentum[2], momentum, 1e-12);
        /* z is no principal axis of the tets: the angular velocity changes by at most |ω|² t, the turn by half of that. */
        check_near(shv_simulation_frame(simulation)->fragments[0].orientation[3], sin(0.02), 0.25 * 16.0 * 1e-4);
        check_ledger(simulation);
        event.target = "ball"; /* waits */
        check_fails(shv_simulation_apply(simulation, &event, &error), SHV_BAD_INPUT, error,
                    "'ball' is not in the scene");
        event.target = "later";
        check_fails(shv_simulation_apply(simulation, &event, &error), SHV_BAD_INPUT, error, "is not in the scene");
        shv_simulation_destroy(simulation);
    }
}

static void bodies_come_and_go(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    ShvSimulation *simulation = start(&stage);
    check_ok(shv_simulation_step(simulation, 0.02, &error), error);
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_int_equal(frame->fragments[1].mode, SHV_FRAGMENT_BINNED);
    check_near(frame->fragments[1].position[2], 1.0, 1e-12);
    const double height = frame->fragments[0].position[2];
    ShvPlacement at = {.position = {0.03, 0.0, height}, .velocity = {0.0, 0.0, 2.0}};
    check_fails(shv_simulation_enter(simulation, "later", &at, &error), SHV_BAD_INPUT, error, "in the object 'there'");
    at.position[2] = 0.01;
    check_fails(shv_simulation_enter(simulation, "later", &at, &error), SHV_BAD_INPUT, error, "obstacle 'floor'");
    check_fails(shv_simulation_enter(simulation, "there", &at, &error), SHV_BAD_INPUT, error, "already");
    check_fails(shv_simulation_enter(simulation, "floor", &at, &error), SHV_BAD_INPUT, error, "is not free");
    at.position[2] = 0.5;
    at.rotation_axis[1] = 1.0;
    at.rotation_degrees = 90.0;
    check_ok(shv_simulation_enter(simulation, "later", &at, &error), error);
    check_ledger(simulation);
    check_ok(shv_simulation_step(simulation, 0.03, &error), error);
    check_near(shv_simulation_frame(simulation)->fragments[1].position[2], 0.5 + 2.0 * 0.01 - 0.5 * 9.81 * 1e-4, 1e-12);
    check_near(shv_simulation_frame(simulation)->fragments[1].orientation[2], sqrt(0.5), 1e-12);
    check_ok(shv_simulation_leave(simulation, "later", &error), error);
    check_ledger(simulation);
    check_ok(shv_simulation_enter(simulation, "later", &at, &error), error);
    check_ok(shv_simulation_remove(simulation, 0, &error), error);
    check_fails(shv_simulation_remove(simulation, 0, &error), SHV_BAD_INPUT, error, "not in the scene");
    check_ok(shv_simulation_step(simulation, 0.04, &error), error);
    check_ledger(simulation);
    shv_simulation_destroy(simulation);
}

/* A body that was stretched when it went to rest takes its strain with it, and brings it back. */
static void strain_comes_and_goes(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    stage_make(&stage);
    stage_box(&stage, "there", side, 0.02, 1.0)->placement.stretch_rate[2] = 20.0;
    stage.material.breakable = false;
    stage.scene.fracture.deformation = SHV_DEFORMATION_KEEP;
    ShvSimulation *simulation = stage_start(&stage);
    check_ok(shv_simulation_step(simulation, 0.1, &error), error);
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_int_equal(frame->fragments[0].mode, SHV_FRAGMENT_FLIGHT);
    const double strain = frame->ledger.strain, residual = frame->ledger.residual;
    assert_true(strain > 1e-3 * frame->ledger.largest);
    const ShvPlacement at = {.position = {0.0, 0.0, 2.0}};
    check_ok(shv_simulation_leave(simulation, "there", &error), error);
    check_near(shv_simulation_frame(simulation)->ledger.strain, 0.0, 0.0);
    check_near(shv_simulation_frame(simulation)->ledger.residual, residual, 1e-9 * strain);
    check_ok(shv_simulation_enter(simulation, "there", &at, &error), error);
    check_near(shv_simulation_frame(simulation)->ledger.strain, strain, 1e-9 * strain);
    check_near(shv_simulation_frame(simulation)->ledger.residual, residual, 1e-9 * strain);
    shv_simulation_destroy(simulation);
}

static void obstacles_come_and_go(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    ShvSimulation *simulation = start(&stage);
    check_ok(shv_simulation_step(simulation, 0.02, &error), error);
    const double height = shv_simulation_frame(simulation)->fragments[0].position[2];
    ShvPlacement at = {.position = {0.0, 0.0, height + 0.03}};
    check_fails(shv_simulation_enter(simulation, "ball", &at, &error), SHV_BAD_INPUT, error, "in the object 'there'");
    at.position[0] = 0.5;
    at.position[2] = 0.019;
    check_fails(shv_simulation_enter(simulation, "ball", &at, &error), SHV_BAD_INPUT, error, "in the obstacle 'floor'");
    at.position[0] = 0.0;
    at.position[2] = height + 0.06;
    at.velocity[2] = -10.0;
    check_ok(shv_simulation_enter(simulation, "ball", &at, &error), error);
    check_ledger(simulation);
    /* It overtakes the box, which falls at 0.2 m/s, and drives it down. */
    check_ok(shv_simulation_step(simulation, 0.026, &error), error);
    assert_true(shv_simulation_frame(simulation)->fragments[0].velocity[2] < -1.0);
    check_near(shv_simulation_frame(simulation)->ledger.residual, 0.0,
               1e-9 * shv_simulation_frame(simulation)->ledger.largest);
    check_ok(shv_simulation_leave(simulation, "ball", &error), error);
    const double left = shv_simulation_frame(simulation)->ledger.momentum[2];
    check_near(left, mass * shv_simulation_frame(simulation)->fragments[0].velocity[2], 1e-12);
    check_ok(shv_simulation_step(simulation, 0.03, &error), error);
    check_near(shv_simulation_frame(simulation)->ledger.momentum[2], left - mass * 9.81 * 0.004, 1e-12);
    shv_simulation_destroy(simulation);
}

/* Of a scene made in C; it is asked for its name where others are looked for. */
static void an_obstacle_may_have_no_name(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    shv_simulation_destroy(start(&stage));
    stage.obstacles[0].name = NULL;
    stage.obstacles[1].waits = false;
    stage.obstacles[1].placement.position[0] = 0.5;
    stage.obstacles[1].placement.position[2] = 0.5;
    ShvSimulation *simulation = stage_start(&stage);
    ShvEventDefinition event = shv_event_default();
    event.kind = SHV_EVENT_IMPULSE;
    event.target = "ball";
    event.value[0] = 0.3;
    check_ok(shv_simulation_apply(simulation, &event, &error), error);
    check_near(shv_simulation_frame(simulation)->obstacles[1].velocity[0], 1.0, 1e-15);
    shv_simulation_destroy(simulation);
}

static void count_event(void *data, const ShvEventView *event)
{
    *(int32_t *)data += event->kind == SHV_RUN_SCENE;
}

static void events_are_told_once(void **state)
{
    (void)state;
    Stage stage;
    ShvError error;
    ShvSimulation *simulation = start(&stage);
    int32_t told = 0;
    ShvEventDefinition event = shv_event_default();
    event.kind = SHV_EVENT_GRAVITY;
    shv_simulation_listen(simulation, count_event, &told);
    check_ok(shv_simulation_apply(simulation, &event, &error), error);
    assert_int_equal(told, 1);
    check_ok(shv_simulation_step(simulation, 0.01, &error), error);
    assert_int_equal(told, 1);
    check_near(shv_simulation_frame(simulation)->fragments[0].position[2], 1.0, 1e-15);
    check_ledger(simulation);
    shv_simulation_destroy(simulation);
}

static void what_waits_is_checked(void **state)
{
    (void)state;
    Stage stage;
    ShvSimulation *simulation = start(&stage);
    ShvError error;
    shv_simulation_destroy(simulation);
    stage.obstacles[1].motion = SHV_OBSTACLE_FIXED;
    check_fails(shv_simulation_create(&simulation, &stage.scene, NULL, &error), SHV_BAD_INPUT, error, "only free ones");
    stage.obstacles[1].motion = SHV_OBSTACLE_FREE;
    stage_support(&stage, "hold", "later");
    check_fails(shv_simulation_create(&simulation, &stage.scene, NULL, &error), SHV_BAD_INPUT, error,
                "cannot be held by 'hold'");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_go_where_frames_would),  cmocka_unit_test(a_push_gives_its_impulse),
        cmocka_unit_test(events_move_what_flies),       cmocka_unit_test(bodies_come_and_go),
        cmocka_unit_test(strain_comes_and_goes),        cmocka_unit_test(obstacles_come_and_go),
        cmocka_unit_test(an_obstacle_may_have_no_name), cmocka_unit_test(events_are_told_once),
        cmocka_unit_test(what_waits_is_checked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
