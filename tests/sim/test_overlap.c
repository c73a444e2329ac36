/* What overlaps at the start is found, named and measured, and a run does with it what it is said to do. */
#include "sim/stage.h"

static const double cube[3] = {0.04, 0.04, 0.04};

/* The overlaps of a stage, deepest ones stored; returns how many there are. */
static int32_t find(const Stage *stage, ShvOverlap *overlaps, int32_t room)
{
    ShvSimulation *simulation = stage_start(stage);
    ShvError error = {SHV_OK, ""};
    int32_t count = -1;
    check_ok(shv_simulation_overlaps(simulation, overlaps, room, &count, &error), error);
    shv_simulation_destroy(simulation);
    return count;
}

static void two_cubes(Stage *stage, double height)
{
    stage_make(stage);
    stage_box(stage, "lower", cube, 0.02, 0.02);
    stage_box(stage, "upper", cube, 0.02, height);
}

/* Cubes that stand in each other by 1 mm, by corners (moved aside) and face to face; and by less than rounding. */
static void test_two_objects(void **state)
{
    (void)state;
    ShvOverlap overlap = {0};
    Stage stage;
    two_cubes(&stage, 0.059);
    assert_int_equal(find(&stage, &overlap, 1), 1);
    assert_string_equal(overlap.first, "lower");
    assert_string_equal(overlap.second, "upper");
    assert_false(overlap.obstacle);
    stage.objects[1].placement.position[0] = 0.013;
    stage.objects[1].placement.position[1] = 0.017;
    assert_int_equal(find(&stage, &overlap, 1), 1);
    check_near(overlap.depth, 1e-3, 1e-12);
    check_near(fabs(overlap.point[2] - 0.0395), 5e-4, 1e-12);
    stage.objects[1].placement.position[2] = 0.06;
    assert_int_equal(find(&stage, &overlap, 1), 0);
    stage.objects[1].placement.position[2] = 0.061;
    assert_int_equal(find(&stage, &overlap, 1), 0);
}

/* Two bars that cross have no corner in each other. */
static void test_crossing_bars(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "along", (const double[3]){0.2, 0.01, 0.01}, 0.02, 0.0);
    stage_box(&stage, "across", (const double[3]){0.01, 0.2, 0.01}, 0.02, 0.008);
    /* Nodes are 2 cm apart: none of the one is in the other. */
    stage.objects[0].placement.position[1] = 0.01;
    stage.objects[1].placement.position[0] = 0.0123;
    ShvOverlap overlap = {0};
    assert_int_equal(find(&stage, &overlap, 1), 1);
    assert_true(overlap.depth > 1e-4 && overlap.depth <= 2e-3 + 1e-12);
}

/* A plane by the depth of the deepest corner; a ball that no corner is in, inside of one tet's reach. */
static void test_obstacles(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", cube, 0.04, 0.0195);
    stage_floor(&stage);
    ShvOverlap overlaps[2] = {{0}};
    assert_int_equal(find(&stage, overlaps, 2), 1);
    assert_true(overlaps[0].obstacle);
    assert_string_equal(overlaps[0].second, "floor");
    check_near(overlaps[0].depth, 5e-4, 1e-12);
    ShvObstacleDefinition *ball = &stage.obstacles[stage.scene.obstacle_count++];
    *ball = shv_obstacle_default();
    ball->name = "ball";
    ball->shape = SHV_OBSTACLE_SPHERE;
    ball->radius = 1e-3;
    ball->placement.position[0] = 0.0137;
    ball->placement.position[1] = 0.004;
    ball->placement.position[2] = 0.0205;
    assert_int_equal(find(&stage, overlaps, 2), 2);
    assert_string_equal(overlaps[1].second, "ball");
    /* its centre is 6.3 mm deep, its far side 7.3 mm */
    check_near(overlaps[1].depth, 0.02 - 0.0137 + 1e-3, 1e-12);
    ball->placement.position[0] = 0.0211;
    assert_int_equal(find(&stage, overlaps, 2), 1);
    /* All are counted, also without room for them. */
    ball->placement.position[0] = 0.0137;
    assert_int_equal(find(&stage, NULL, 0), 2);
}

static void test_started(void **state)
{
    (void)state;
    Stage stage;
    two_cubes(&stage, 0.059);
    ShvSimulation *simulation = stage_start(&stage);
    stage_next(simulation);
    ShvOverlap overlap;
    int32_t count;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_simulation_overlaps(simulation, &overlap, 1, &count, &error), SHV_BAD_INPUT, error, "start");
    shv_simulation_destroy(simulation);
}

/* What is said, and where the first object's centre is after a tenth of a second without gravity. */
static double height_after(Stage *stage, ShvRigidEngine engine, char *course, size_t size)
{
    stage->scene.rigid.engine = engine;
    ShvOverlap overlap;
    assert_int_equal(find(stage, &overlap, 1), 1);
    ShvSimulation *simulation = stage_start(stage);
    snprintf(course, size, "%s", shv_simulation_overlap_course(simulation, &overlap));
    const double height = stage_finish(simulation)->fragments[0].position[2];
    shv_simulation_destroy(simulation);
    return height;
}

static void test_the_run_does_as_it_is_said(void **state)
{
    (void)state;
    char course[256];
    Stage stage;
    stage_make(&stage);
    stage.material.breakable = false;
    stage_box(&stage, "cube", cube, 0.02, 0.019);
    stage_floor(&stage);
    memset(stage.scene.gravity, 0, sizeof stage.scene.gravity);
    check_near(height_after(&stage, SHV_RIGID_BULLET, course, sizeof course), 0.019, 1e-12);
    assert_non_null(strstr(course, "lets it be"));
    check_near(height_after(&stage, SHV_RIGID_ANALYTIC, course, sizeof course), 0.02, 1e-6);
    assert_non_null(strstr(course, "moves the object out"));
    assert_true(height_after(&stage, SHV_RIGID_PBD, course, sizeof course) > 0.0195);
    assert_non_null(strstr(course, "moves the nodes out"));
    /* Two objects: only Bullet sees that they touch, and leaves them; the others fly on through each other. */
    Stage pair;
    two_cubes(&pair, 0.059);
    pair.material.breakable = false;
    memset(pair.scene.gravity, 0, sizeof pair.scene.gravity);
    check_near(height_after(&pair, SHV_RIGID_BULLET, course, sizeof course), 0.02, 1e-12);
    assert_non_null(strstr(course, "lets it be"));
    check_near(height_after(&pair, SHV_RIGID_ANALYTIC, course, sizeof course), 0.02, 1e-12);
    assert_non_null(strstr(course, "does not see it"));
}

/* Without memory nothing is lost, whatever fails. */
static void test_shortage(void **state)
{
    (void)state;
    Stage stage;
    two_cubes(&stage, 0.059);
    ShvMemory *memory = shv_memory_create();
    ShvSimulationOptions options = shv_simulation_options_default();
    options.memory = memory;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_create(&simulation, &stage.scene, &options, &error), error);
    const size_t held = shv_memory_bytes(memory, SHV_PART_COUNT);
    ShvStatus status = SHV_NO_MEMORY;
    int allowed = 0;
    for (; status == SHV_NO_MEMORY && allowed < 1000; allowed++) {
        ShvOverlap overlap;
        int32_t count;
        shv_memory_fail_after(memory, allowed);
        status = shv_simulation_overlaps(simulation, &overlap, 1, &count, &error);
        shv_memory_fail_after(memory, -1);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), held);
    }
    check_ok(status, error);
    assert_true(allowed > 4);
    shv_simulation_destroy(simulation);
    shv_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_objects), cmocka_unit_test(test_crossing_bars),
        cmocka_unit_test(test_obstacles),   cmocka_unit_test(test_started),
        cmocka_unit_test(test_shortage),    cmocka_unit_test(test_the_run_does_as_it_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
