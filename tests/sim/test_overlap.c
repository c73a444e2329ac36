/* What overlaps at the start is refused, with what parts it; kept, it is found, named and measured, and a run does with it what it
   is said to do. */
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

static void make(Stage *stage)
{
    stage_make(stage);
    stage->scene.overlaps = SHV_OVERLAPS_KEEP;
}

static void two_cubes(Stage *stage, double height)
{
    make(stage);
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
    make(&stage);
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
    make(&stage);
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
    assert_string_equal(overlaps[0].second, "ball");
    assert_string_equal(overlaps[1].second, "floor");
    /* its centre is 6.3 mm deep, its far side 7.3 mm */
    check_near(overlaps[0].depth, 0.02 - 0.0137 + 1e-3, 1e-12);
    ball->placement.position[0] = 0.0211;
    assert_int_equal(find(&stage, overlaps, 2), 1);
    /* All are counted, also without room for them. */
    ball->placement.position[0] = 0.0137;
    assert_int_equal(find(&stage, NULL, 0), 2);
}

/* Of three pairs the two deepest, deepest first. */
static void test_deepest_first(void **state)
{
    (void)state;
    static const double depths[3] = {1e-3, 3e-3, 2e-3};
    Stage stage;
    make(&stage);
    for (int i = 0; i < 3; i++)
        stage_box(&stage, (const char *const[]){"one", "two", "three"}[i], cube, 0.02, 0.02 - depths[i])
            ->placement.position[0] = 0.1 * i;
    stage_floor(&stage);
    ShvOverlap overlaps[2];
    assert_int_equal(find(&stage, overlaps, 2), 3);
    assert_string_equal(overlaps[0].first, "two");
    assert_string_equal(overlaps[1].first, "three");
}

/* One body in the place of another has no corner and no edge in it; a cube on a cube of the same width has none either, where
   faces are of two triangles. */
static void test_surfaces_in_one_another(void **state)
{
    (void)state;
    ShvOverlap overlap = {0};
    Stage stage;
    two_cubes(&stage, 0.02);
    assert_int_equal(find(&stage, &overlap, 1), 1);
    assert_true(overlap.depth > 0.0 && overlap.depth <= 0.02);
    for (int i = 0; i < 2; i++) stage.objects[i].mesh.edge = 0.04;
    stage.objects[1].placement.position[2] = 0.059;
    assert_int_equal(find(&stage, &overlap, 1), 1);
    check_near(overlap.depth, 1e-3, 1e-12);
    ShvObstacleDefinition *block = stage_floor(&stage);
    block->name = "block";
    block->shape = SHV_OBSTACLE_BOX;
    memcpy(block->size, cube, sizeof cube);
    block->placement.position[2] = 0.02;
    assert_int_equal(find(&stage, &overlap, 1), 3);
    assert_string_equal(overlap.second, "block");
    assert_string_equal(overlap.first, "lower");
}

/* Obstacles of which no corner is in the body, and no corner and edge of the body in them: a rod through a face, a ball that
   looks in at one. */
static void test_obstacles_through_a_face(void **state)
{
    (void)state;
    Stage stage;
    make(&stage);
    stage_box(&stage, "cube", cube, 0.04, 0.0);
    ShvObstacleDefinition *rod = stage_floor(&stage);
    rod->name = "rod";
    rod->shape = SHV_OBSTACLE_BOX;
    rod->size[0] = rod->size[1] = 1e-3;
    rod->size[2] = 0.2;
    rod->placement.position[0] = 0.011;
    rod->placement.position[1] = 0.004;
    ShvOverlap overlap = {0};
    assert_int_equal(find(&stage, &overlap, 1), 1);
    /* its edges run 8.5 mm and 9.5 mm below the nearest face */
    check_near(overlap.depth, 0.02 - 0.0105, 1e-12);
    rod->shape = SHV_OBSTACLE_SPHERE;
    rod->radius = 1e-3;
    rod->placement.position[0] = 0.0209;
    assert_int_equal(find(&stage, &overlap, 1), 1);
    check_near(overlap.depth, 1e-4, 1e-12);
    rod->placement.position[0] = 0.021;
    assert_int_equal(find(&stage, &overlap, 1), 0);
}

/* ---- refusal ---- */

static void refused(Stage *stage, ShvError *error)
{
    ShvSimulation *simulation = NULL;
    stage->scene.overlaps = SHV_OVERLAPS_REFUSE;
    *error = (ShvError){SHV_OK, ""};
    check_fails(shv_simulation_create(&simulation, &stage->scene, NULL, error), SHV_BAD_INPUT, *error,
                "overlap at the start");
    assert_null(simulation);
}

static void says(const ShvError *error, const char *part)
{
    if (!strstr(error->message, part)) fail_msg("'%s' is missing in: %s", part, error->message);
}

/* A library's scene is refused as it comes, with both names, depth, the way out and the other choice; a touch is not. */
static void test_refusal(void **state)
{
    (void)state;
    assert_int_equal(shv_scene_default().overlaps, SHV_OVERLAPS_REFUSE);
    ShvError error;
    Stage stage;
    two_cubes(&stage, 0.0585);
    refused(&stage, &error);
    says(&error, "'lower' and the object 'upper' overlap at the start, 0.0015 m deep at (");
    says(&error, "move 'upper' by (0, 0, 0.0015) m, or give 'overlaps: keep', and the run lets it be");
    stage.objects[1].placement.position[2] += 0.0015;
    shv_simulation_destroy(stage_start(&stage));
    /* What would go down is not moved; the other goes up. */
    stage.objects[0].placement.position[2] = 0.0985;
    refused(&stage, &error);
    says(&error, "move 'lower' by (0, 0, 0.0015) m");
    /* With more than there is room for, the deepest come first. */
    stage.objects[0].placement.position[2] = 0.019;
    stage.objects[1].placement.position[2] = 0.015;
    stage_floor(&stage);
    stage_box(&stage, "aside", cube, 0.02, 0.0199)->placement.position[0] = 0.1;
    refused(&stage, &error);
    says(&error, "'upper' and the obstacle 'floor' overlap at the start, 0.005 m deep at (");
    says(&error, "move 'upper' by (0, 0, 0.005) m, or give");
    says(&error, "; also 'lower' and the object 'upper' overlap");
    says(&error, "move 'lower' by (0, 0, 0.036) m; also 'lower' and the obstacle 'floor'");
    says(&error, "; and 1 more");
}

/* What is told to be moved overlaps no more where it is moved: also turned, and with no way out but past the whole. */
static void test_the_way_out_is_one(void **state)
{
    (void)state;
    static const double shifts[][3] = {
        {0.0, 0.0, 0.0}, {0.013, 0.011, 0.03}, {0.03, 0.03, 0.03}, {-0.035, 0.001, 0.002}, {0.0, 0.02, -0.038}};
    for (int turned = 0; turned < 3; turned++)
        for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i++) {
            Stage stage;
            two_cubes(&stage, 0.02);
            ShvPlacement *upper = &stage.objects[1].placement;
            for (int k = 0; k < 3; k++) upper->position[k] = shifts[i][k] + (k == 2 ? 0.02 : 0.0);
            upper->rotation_axis[turned] = 1.0;
            upper->rotation_axis[(turned + 1) % 3] = 0.4;
            upper->rotation_degrees = 25.0 * turned;
            ShvOverlap overlap;
            assert_int_equal(find(&stage, &overlap, 1), 1);
            ShvPlacement *mover = &stage.objects[strcmp(overlap.mover, "upper") == 0].placement;
            for (int k = 0; k < 3; k++) mover->position[k] += overlap.parting[k];
            assert_int_equal(find(&stage, &overlap, 1), 0);
            stage.scene.overlaps = SHV_OVERLAPS_REFUSE;
            shv_simulation_destroy(stage_start(&stage));
        }
}

/* A ball in the floor, two balls in each other, by the distances of their centres; what waits is in nothing. */
static void test_free_obstacles(void **state)
{
    (void)state;
    Stage stage;
    ShvOverlap overlap = {0};
    make(&stage);
    stage_box(&stage, "far", cube, 0.02, 1.0);
    stage_floor(&stage);
    ShvObstacleDefinition *ball = stage_free_ball(&stage, "ball", 0.02, 0.1);
    ball->placement.position[2] = 0.012;
    assert_int_equal(find(&stage, &overlap, 1), 1);
    assert_string_equal(overlap.first, "ball");
    assert_string_equal(overlap.second, "floor");
    assert_string_equal(overlap.mover, "ball");
    assert_true(overlap.obstacle);
    check_near(overlap.depth, 0.008, 1e-15);
    check_near(overlap.parting[2], 0.008, 1e-15);
    ball->placement.position[2] += overlap.parting[2];
    assert_int_equal(find(&stage, &overlap, 1), 0);
    ball->placement.position[2] = 0.012;
    ball->waits = true;
    assert_int_equal(find(&stage, &overlap, 1), 0);
    make(&stage);
    stage_box(&stage, "far", cube, 0.02, 1.0);
    stage_free_ball(&stage, "one", 0.02, 0.1);
    ShvObstacleDefinition *two = stage_free_ball(&stage, "two", 0.04, 0.1);
    two->placement.position[0] = 0.03;
    two->placement.position[2] = 0.04; /* 0.05 apart */
    assert_int_equal(find(&stage, &overlap, 1), 1);
    check_near(overlap.depth, 0.01, 1e-15);
    ShvError error;
    refused(&stage, &error);
    says(&error, "'one' and the obstacle 'two' overlap at the start, 0.01 m deep");
    says(&error, "neither is pushed out, it only comes no deeper");
    two->name = NULL;
    refused(&stage, &error);
    says(&error, "'one' and the obstacle '' overlap");
    two->name = "two";
    for (int k = 0; k < 3; k++) stage.obstacles[0].placement.position[k] += overlap.parting[k];
    shv_simulation_destroy(stage_start(&stage));
}

/* ---- runs that keep it ---- */

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
    make(&stage);
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

/* Nor is anything left of a simulation that is refused, or lacks memory before it is. */
static void test_shortage_of_what_is_refused(void **state)
{
    (void)state;
    Stage stage;
    two_cubes(&stage, 0.059);
    stage.scene.overlaps = SHV_OVERLAPS_REFUSE;
    ShvMemory *memory = shv_memory_create();
    ShvSimulationOptions options = shv_simulation_options_default();
    options.memory = memory;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    ShvStatus status = SHV_NO_MEMORY;
    for (int allowed = 0; status == SHV_NO_MEMORY && allowed < 10000; allowed++) {
        shv_memory_fail_after(memory, allowed);
        status = shv_simulation_create(&simulation, &stage.scene, &options, &error);
        shv_memory_fail_after(memory, -1);
        assert_null(simulation);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    }
    assert_int_equal(status, SHV_BAD_INPUT);
    shv_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_objects),
        cmocka_unit_test(test_crossing_bars),
        cmocka_unit_test(test_obstacles),
        cmocka_unit_test(test_free_obstacles),
        cmocka_unit_test(test_started),
        cmocka_unit_test(test_deepest_first),
        cmocka_unit_test(test_surfaces_in_one_another),
        cmocka_unit_test(test_obstacles_through_a_face),
        cmocka_unit_test(test_refusal),
        cmocka_unit_test(test_the_way_out_is_one),
        cmocka_unit_test(test_shortage),
        cmocka_unit_test(test_shortage_of_what_is_refused),
        cmocka_unit_test(test_the_run_does_as_it_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
