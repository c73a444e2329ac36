/* What flies beside an awake body and is moved with it: events and pushes reach it, and it goes on as a ball does that was thrown. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

static const double side[3] = {0.04, 0.04, 0.04};
static const double mass = 1200.0 * 0.04 * 0.04 * 0.04, gravity = 9.81;

typedef struct Scene {
    Stage stage;
    ShvMemory *memory;
    ShvHybrid hybrid;
} Scene;

/* Two cubes, the upper one 3 mm over the lower one, fall together until the lower one is awake, and the upper one coupled. */
static const ShvFragment *begin(Scene *scene)
{
    ShvError error = {0};
    int64_t taken;
    stage_make(&scene->stage);
    stage_box(&scene->stage, "lower", side, 0.02, 0.021)->placement.velocity[2] = -1.0;
    stage_box(&scene->stage, "upper", side, 0.02, 0.064)->placement.velocity[2] = -1.0;
    stage_floor(&scene->stage);
    scene->memory = shv_memory_create();
    check_ok(shv_hybrid_create(&scene->hybrid, scene->memory, &scene->stage.scene, NULL, &error), error);
    ShvHybrid *hybrid = &scene->hybrid;
    for (int i = 0; i < 100 && !hybrid->fragments.items[1].coupled; i++)
        check_ok(shv_hybrid_advance(hybrid, hybrid->state.time + 5e-5, 0, &taken, &error), error);
    assert_true(hybrid->fragments.items[1].coupled);
    assert_int_equal(hybrid->fragments.items[0].mode, SHV_MODE_FRACTURE);
    check_ok(shv_hybrid_observe(hybrid, &error), error);
    return &hybrid->fragments.items[1];
}

static void end(Scene *scene)
{
    shv_hybrid_release(&scene->hybrid);
    assert_int_equal(shv_memory_bytes(scene->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(scene->memory);
}

/* x + v t − g t²/2, some steps later and, once it flies by itself, much later. */
static void check_throw(ShvHybrid *hybrid, ShvVec3 velocity)
{
    ShvError error = {0};
    int64_t taken;
    const ShvVec3 start = hybrid->fragments.items[1].position;
    const double begin_time = hybrid->state.time, later[] = {2e-4, 5e-3};
    for (int i = 0; i < 2; i++) {
        check_ok(shv_hybrid_advance(hybrid, begin_time + later[i], 0, &taken, &error), error);
        check_ok(shv_hybrid_observe(hybrid, &error), error);
        const double t = hybrid->state.time - begin_time;
        const ShvFragment *body = &hybrid->fragments.items[1]; /* fragments move in memory as the lower cube breaks */
        assert_true(t >= later[i] * (1.0 - 1e-12));
        check_near(body->position.x, start.x + velocity.x * t, 1e-12);
        check_near(body->position.y, start.y + velocity.y * t, 1e-12);
        check_near(body->position.z, start.z + velocity.z * t - 0.5 * gravity * t * t, 1e-12);
        check_near(body->velocity.z, velocity.z - gravity * t, 1e-11);
    }
}

static void a_set_velocity_throws_it(void **state)
{
    (void)state;
    Scene scene;
    ShvError error = {0};
    begin(&scene);
    ShvEventDefinition event = shv_event_default();
    event.kind = SHV_EVENT_SET_VELOCITY;
    event.target = "upper";
    event.value[0] = 2.0;
    event.value[2] = 1.5;
    check_ok(shv_hybrid_apply(&scene.hybrid, &event, &error), error);
    check_throw(&scene.hybrid, shv_vec3(2.0, 0.0, 1.5));
    end(&scene);
}

static void an_impulse_adds_to_what_it_has(void **state)
{
    (void)state;
    Scene scene;
    ShvError error = {0};
    const double falls = begin(&scene)->velocity.z;
    ShvEventDefinition event = shv_event_default();
    event.kind = SHV_EVENT_IMPULSE;
    event.target = "upper";
    event.value[1] = 0.5 * mass;
    event.value[2] = 3.0 * mass;
    check_ok(shv_hybrid_apply(&scene.hybrid, &event, &error), error);
    check_throw(&scene.hybrid, shv_vec3(0.0, 0.5, 3.0 + falls));
    end(&scene);
}

/* Beside its centre: momentum as at the centre, and r × J about it, kept in flight. */
static void a_push_turns_it(void **state)
{
    (void)state;
    Scene scene;
    ShvError error = {0};
    const ShvFragment *upper = begin(&scene);
    const double falls = upper->velocity.z, arm = 0.01;
    const ShvVec3 point = shv_add(upper->position, shv_vec3(arm, 0.0, 0.0)), push = {0.0, 0.0, 3.0 * mass};
    check_ok(shv_hybrid_push(&scene.hybrid, 1, push, point, &error), error);
    check_throw(&scene.hybrid, shv_vec3(0.0, 0.0, 3.0 + falls));
    const ShvFragment *now = &scene.hybrid.fragments.items[1];
    const ShvMat3 inertia = shv_fragment_world_inertia(now);
    const ShvVec3 momentum = shv_apply(&inertia, now->angular_velocity);
    check_near(momentum.x, 0.0, 1e-12);
    check_near(momentum.y, -arm * push.z, 1e-12);
    check_near(momentum.z, 0.0, 1e-12);
    end(&scene);
}

/* Thrown on a corner of the lower cube; `watched`: looked at after each interval. */
static ShvFragment after_impact(bool watched)
{
    Scene scene;
    ShvError error = {0};
    int64_t taken;
    const ShvFragment *upper = begin(&scene);
    scene.stage.scene.rigid.wake_fraction = 1e9; /* it stays rigid */
    const ShvVec3 beside = shv_add(upper->position, shv_vec3(0.02, 0.015, 0.0));
    check_ok(shv_hybrid_push(&scene.hybrid, 1, shv_vec3(0.0, 0.0, -2.0 * mass), beside, &error), error);
    for (int i = 0; i < 60; i++) {
        check_ok(shv_hybrid_advance(&scene.hybrid, scene.hybrid.state.time + 5e-5, 0, &taken, &error), error);
        if (watched) check_ok(shv_hybrid_observe(&scene.hybrid, &error), error);
    }
    check_ok(shv_hybrid_observe(&scene.hybrid, &error), error);
    const ShvFragment result = scene.hybrid.fragments.items[1];
    assert_true(scene.hybrid.observer.balance.contact < -0.01); /* it has met the lower one */
    end(&scene);
    return result;
}

static void watching_changes_nothing(void **state)
{
    (void)state;
    const ShvFragment one = after_impact(false), other = after_impact(true);
    assert_memory_equal(&one.position, &other.position, sizeof one.position);
    assert_memory_equal(&one.orientation, &other.orientation, sizeof one.orientation);
    assert_memory_equal(&one.velocity, &other.velocity, sizeof one.velocity);
    assert_memory_equal(&one.angular_velocity, &other.angular_velocity, sizeof one.angular_velocity);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_set_velocity_throws_it),
        cmocka_unit_test(an_impulse_adds_to_what_it_has),
        cmocka_unit_test(a_push_turns_it),
        cmocka_unit_test(watching_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
