/* Round bodies, whose corners convex pieces cut: they wake when their nodes touch. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

static const double radius = 0.05, edge = 0.01, gap = 2.3e-3; /* m; gap: of each ball to the plane z = 0 */
static const double closing = 3.0;                            /* m/s */

static void stage_ball(Stage *stage, const char *name, double height, double speed, double turn)
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
}

/* Makes the run, and the first step of fracture mode. Frames every `interval` may cut the rigid steps. Returns how far two points
   that close may be in each other for that step, and for rounding, m. */
static double run_until_awake(ShvHybrid *hybrid, Stage *stage, double interval)
{
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    stage->scene.gravity[2] = 0.0;
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    for (double to = interval; hybrid->state.time < 0.004 && taken == 0; to += interval)
        while (hybrid->state.time < to && taken == 0)
            check_ok(shv_hybrid_advance(hybrid, to, 1, &taken, &error), error);
    assert_true(taken == 1);
    return closing * hybrid->state.last_step + 1e-4 * radius;
}

typedef struct Heights {
    double lowest, highest; /* m */
} Heights;

static Heights heights_of(const ShvHybrid *hybrid, int object)
{
    Heights heights = {HUGE_VAL, -HUGE_VAL};
    for (int32_t i = hybrid->model.objects[object].node_begin; i < hybrid->model.objects[object].node_end; i++) {
        const double z = shv_state_position(&hybrid->state, i).z;
        heights.lowest = fmin(heights.lowest, z);
        heights.highest = fmax(heights.highest, z);
    }
    return heights;
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
            stage_make(&stage);
            stage_ball(&stage, "ball", radius + gap, closing, 17.0 * k);
            stage_floor(&stage)->friction = 0.3;
            const double depth = run_until_awake(&hybrid, &stage, often ? 7e-5 : 1e-3);
            const double lowest = heights_of(&hybrid, 0).lowest;
            assert_true(lowest >= -depth);
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
        stage_make(&stage);
        stage_ball(&stage, "upper", radius + gap, 0.5 * closing, 17.0 * k);
        stage_ball(&stage, "lower", -radius - gap, -0.5 * closing, 29.0 * k);
        const double depth = run_until_awake(&hybrid, &stage, 1e-3);
        assert_true(heights_of(&hybrid, 0).lowest - heights_of(&hybrid, 1).highest >= -depth);
        shv_hybrid_release(&hybrid);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_floor), cmocka_unit_test(test_balls)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
