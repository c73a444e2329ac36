#include "sim/shortage.h"

static void has_woken(const ShvFrameView *frame)
{
    assert_true(frame->steps > 0);
}

/* A scene with a flying and a held object, a fixed and a free obstacle, up to the first steps of an impact. */
static void test_no_memory(void **state)
{
    (void)state;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].mesh.edge = 0.02;
    stage.scene.duration = 0.0012;
    ShvObstacleDefinition *stone = stage_free_ball(&stage, "stone", 0.01, 0.01);
    stone->placement.position[0] = 0.5;
    stone->placement.position[2] = 0.02;
    stage_box(&stage, "held", (const double[3]){0.02, 0.02, 0.02}, 0.02, 0.5);
    stage_support(&stage, "hold", "held");
    stage_event(&stage, 0.001, SHV_EVENT_RELEASE, "hold");
    fail_everywhere(&stage, has_woken);
    stage.scene.fracture.criterion = SHV_CRITERION_PRINCIPAL;
    fail_everywhere(&stage, has_woken);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
