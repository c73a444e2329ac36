#include "sim/shortage.h"

static void has_broken_and_rested(const ShvFrameView *frame)
{
    assert_true(frame->alive_count > 2);
    assert_true(frame->ledger.handover < 0.0);
}

/* Cracks, splits and pieces that rest again. */
static void test_no_memory_while_breaking(void **state)
{
    (void)state;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].mesh.edge = 0.02;
    stage.scene.duration = 0.005;
    stage.scene.fracture.longest = 1e-3;
    fail_everywhere(&stage, has_broken_and_rested);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory_while_breaking)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
