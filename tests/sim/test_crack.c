#include "sim/stage.h"

/* A bar of bricks that stretches until it parts in the only plane that may open. */
static void make_stretched_bar(Stage *stage)
{
    stage_make(stage);
    ShvObjectDefinition *bar = stage_box(stage, "bar", (const double[3]){0.02, 0.03, 0.04}, 0.0125, 0.0);
    bar->mesh.pattern = SHV_PATTERN_BRICKS;
    bar->placement.stretch_rate[2] = 200.0;
    stage->scene.fracture.on =
        (ShvSelection){.kind = SHV_SELECT_PLANE, .plane_normal = {0.0, 0.0, 1.0}, .tolerance = 1e-9};
    memset(stage->scene.gravity, 0, sizeof stage->scene.gravity);
    stage->scene.duration = 1e-3;
}

static ShvCrackView crack_of(const ShvSimulation *simulation)
{
    ShvCrackView crack;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_crack(simulation, &crack, &error), error);
    return crack;
}

/* 2 x 3 bricks meet in the plane, two facets each. The crack is all of it: its centre that of the plane, its normal too. */
static void test_crack_of_a_plane(void **state)
{
    (void)state;
    Stage stage;
    make_stretched_bar(&stage);
    ShvSimulation *simulation = stage_start(&stage);
    stage_next(simulation);
    assert_int_equal(crack_of(simulation).facets, 0);
    assert_true(isnan(crack_of(simulation).centre[2]));
    const ShvFrameView *frame = stage_finish(simulation);
    assert_int_equal(frame->failed, 12);
    const ShvCrackView crack = crack_of(simulation);
    assert_int_equal(crack.facets, 12);
    check_near(crack.origin[2], 0.0, 1e-15);
    for (int axis = 0; axis < 3; axis++) check_near(crack.centre[axis], 0.0, 1e-12);
    check_near(fabs(crack.normal[2]), 1.0, 1e-12);
    shv_simulation_destroy(simulation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_crack_of_a_plane)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
