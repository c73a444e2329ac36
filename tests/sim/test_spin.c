/* A body that spins faster than it may bear wakes, however it came to spin; what has borne its rotation awake does not wake again. */
#include "sim/stage.h"

/* rad/s: of a disc of this radius at which three times the density of its energy of rotation, ¼ρω²R², is all of its strength. */
static const double radius = 0.05;
static double full_speed(const Stage *stage)
{
    return sqrt(4.0 / 3.0 * stage->material.cohesive_strength / stage->material.density) / radius;
}

static ShvObjectDefinition *make_disc(Stage *stage, double spin)
{
    stage_make(stage);
    stage->scene.gravity[2] = 0.0;
    stage->scene.duration = 0.02;
    stage->scene.output.rate = 100.0;
    ShvObjectDefinition *disc = stage_box(stage, "disc", (const double[3]){0.1, 0.1, 0.02}, 0.02, 0.5);
    disc->mesh.kind = SHV_MESH_CYLINDER;
    disc->mesh.radius = radius;
    disc->mesh.height = 0.02;
    disc->mesh.edge = 0.02;
    disc->placement.angular_velocity[2] = spin;
    return disc;
}

static int wakes(const ShvFrameView *frame, ShvSwitchReason reason)
{
    int count = 0;
    for (int32_t i = 0; i < frame->event_count; i++)
        count += frame->events[i].kind == SHV_RUN_WAKE && frame->events[i].reason == reason;
    return count;
}

/* Wakes by spin until the end of the scene, where the balance must hold. */
static int count_wakes(const Stage *stage)
{
    int count = 0;
    ShvSimulation *simulation = stage_start(stage);
    while (!shv_simulation_finished(simulation)) count += wakes(stage_next(simulation), SHV_REASON_SPIN);
    check_near(shv_simulation_frame(simulation)->ledger.residual, 0.0,
               1e-4 * shv_simulation_frame(simulation)->ledger.largest);
    shv_simulation_destroy(simulation);
    return count;
}

static void the_fast_one_wakes_once(void **state)
{
    (void)state;
    Stage stage;
    ShvObjectDefinition *disc = make_disc(&stage, 0.0);
    const double speed = full_speed(&stage), least = sqrt(stage.scene.rigid.wake_fraction);
    disc->placement.angular_velocity[2] = 0.85 * least * speed; /* the inertia of the mesh is that of its nodes */
    assert_int_equal(count_wakes(&stage), 0);
    disc->placement.angular_velocity[2] = 1.1 * least * speed;
    assert_int_equal(count_wakes(&stage), 1);
    stage.material.breakable = false;
    assert_int_equal(count_wakes(&stage), 0);
}

static void an_event_makes_it_spin(void **state)
{
    (void)state;
    Stage stage;
    make_disc(&stage, 0.0);
    ShvEventDefinition event = shv_event_default();
    event.time = 0.01;
    event.kind = SHV_EVENT_SET_VELOCITY;
    event.target = "disc";
    event.angular[2] = full_speed(&stage);
    stage.scene.events = &event;
    stage.scene.event_count = 1;
    assert_int_equal(count_wakes(&stage), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_fast_one_wakes_once),
                                       cmocka_unit_test(an_event_makes_it_spin)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
