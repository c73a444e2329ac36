/* Round bodies, whose corners convex pieces cut: they wake when their nodes touch. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

static const double radius = 0.05, edge = 0.01;

static ShvObjectDefinition *stage_ball(Stage *stage, const char *name, double height, double speed, double turn)
{
    const double none[3] = {0.0, 0.0, 0.0};
    ShvObjectDefinition *ball = stage_box(stage, name, none, edge, height);
    ball->mesh.kind = SHV_MESH_BALL;
    ball->mesh.radius = radius;
    ball->mesh.jitter = 0.1;
    ball->mesh.seed = 1;
    ball->placement.velocity[2] = -speed;
    ball->placement.rotation_axis[0] = 0.6;
    ball->placement.rotation_axis[2] = 0.8;
    ball->placement.rotation_degrees = turn;
    return ball;
}

/* Until something wakes; returns when. Frames every `interval` may cut the rigid steps. */
static double wake_time(ShvHybrid *hybrid, double until, double interval)
{
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    while (hybrid->state.time < until && taken == 0) {
        double to = hybrid->state.time + interval;
        while (hybrid->state.time < to && taken == 0)
            check_ok(shv_hybrid_advance(hybrid, to, 1, &taken, &error), error);
    }
    assert_true(taken == 1);
    return hybrid->state.time - hybrid->state.last_step;
}

static double lowest_node(const ShvHybrid *hybrid)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < hybrid->state.node_count; i++) least = fmin(least, shv_state_position(&hybrid->state, i).z);
    return least;
}

/* On a floor: whatever lies below, nodes are not in it by more than a ten-thousandth of the radius; where the hull stands out it wakes a
   little earlier. */
static void test_floor(void **state)
{
    (void)state;
    int touched = 0;
    for (int k = 0; k < 8; k++)
        for (int often = 0; often < 2; often++) {
            Stage stage;
            ShvHybrid hybrid;
            ShvError error = {SHV_OK, ""};
            stage_make(&stage);
            stage_ball(&stage, "ball", radius + 2.3e-3, 3.0, 17.0 * k);
            stage_floor(&stage)->friction = 0.3;
            stage.scene.gravity[2] = 0.0;
            check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
            wake_time(&hybrid, 0.003, often ? 7e-5 : 1e-3);
            const double step = hybrid.state.last_step * 3.0, lowest = lowest_node(&hybrid);
            assert_true(lowest >= -1e-4 * radius - step);
            assert_true(lowest <= 0.05 * radius);
            touched += lowest <= 1e-4 * radius;
            shv_hybrid_release(&hybrid);
        }
    assert_true(touched >= 4); /* where the hull cuts a corner below */
}

/* In another ball: by the distance of the farthest nodes of both along the line of their centres. */
static void test_balls(void **state)
{
    (void)state;
    for (int k = 0; k < 8; k++) {
        Stage stage;
        ShvHybrid hybrid;
        ShvError error = {SHV_OK, ""};
        stage_make(&stage);
        stage_ball(&stage, "upper", radius + 2.3e-3, 1.5, 17.0 * k);
        stage_ball(&stage, "lower", -radius - 2.3e-3, -1.5, 29.0 * k);
        stage.scene.gravity[2] = 0.0;
        check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
        wake_time(&hybrid, 0.004, 1e-3);
        double upper = HUGE_VAL, lower = -HUGE_VAL;
        for (int32_t i = 0; i < hybrid.state.node_count; i++) {
            const double z = shv_state_position(&hybrid.state, i).z;
            if (i < hybrid.model.objects[0].node_end)
                upper = fmin(upper, z);
            else
                lower = fmax(lower, z);
        }
        assert_true(upper - lower >= -1e-4 * radius - 3.0 * hybrid.state.last_step);
        shv_hybrid_release(&hybrid);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_floor), cmocka_unit_test(test_balls)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
