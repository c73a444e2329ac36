/* What cannot break moves, bit for bit, as what is far too strong to break: many parts are left out where nothing can, and none of
   them may be missed. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

typedef struct Case {
    bool box;     /* a free box falls on the pad, or else a block that turns */
    bool contact; /* the block flies until it touches; else it is awake from the start */
    ShvRigidEngine engine;
} Case;

/* A soft pad in fracture mode on a floor, and what falls onto it off its middle, a corner first. */
static void stage_pad(Stage *stage, const Case *c, bool breakable)
{
    stage_make(stage);
    stage->material.youngs_modulus = 5e6;
    stage->material.poissons_ratio = 0.4;
    stage->material.cohesive_strength = 1e12;
    stage->material.fracture_energy = 1e9;
    stage->scene.fracture.enabled = breakable;
    stage->scene.rigid.engine = c->engine;
    stage->scene.rigid.wake = c->contact ? SHV_WAKE_CONTACT : SHV_WAKE_STRESS;
    stage->scene.fracture.longest = 1e3; /* what is awake stays so */
    stage->scene.fracture.quiet_checks = INT32_MAX;
    stage->scene.duration = 0.012;
    stage_floor(stage)->friction = 0.3;
    ShvObjectDefinition *pad = stage_box(stage, "pad", (const double[3]){0.06, 0.06, 0.018}, 6e-3, 0.0091);
    pad->placement.stretch_rate[0] = 1e-6; /* starts awake */
    if (c->box) {
        ShvObstacleDefinition *box = stage_free_ball(stage, "box", 0.0, 0.2);
        box->shape = SHV_OBSTACLE_BOX;
        for (int k = 0; k < 3; k++) box->size[k] = 0.03;
        box->placement.rotation_axis[0] = 1.0;
        box->placement.rotation_degrees = 40.0;
        box->placement.position[2] = 0.045;
        box->placement.velocity[2] = -2.0;
        return;
    }
    ShvObjectDefinition *block = stage_box(stage, "block", (const double[3]){0.03, 0.03, 0.03}, 8e-3, 0.048);
    block->placement.rotation_axis[0] = 1.0;
    block->placement.rotation_degrees = 40.0;
    block->placement.position[0] = 0.004;
    block->placement.velocity[2] = -2.0;
    if (!c->contact) block->placement.stretch_rate[0] = 1e-6;
}

typedef struct End {
    ShvVec3 pad, other;
    double way; /* m, of the pad's farthest node from where it began */
} End;

static End run(const Case *c, bool breakable)
{
    Stage stage;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    stage_pad(&stage, c, breakable);
    check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
    assert_true(hybrid.model.can_break == breakable);
    int64_t taken = 0;
    check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration, 0, &taken, &error), error);
    const ShvState *state = &hybrid.state;
    assert_int_equal(hybrid.fragments.items[0].mode, SHV_MODE_FRACTURE);
    End end = {.pad = shv_state_position(state, 0)};
    end.other = c->box ? hybrid.obstacles.items[1].position : shv_state_position(state, state->node_count - 1);
    for (int32_t i = 0; i < hybrid.model.objects[0].node_end; i++)
        end.way = fmax(end.way, shv_norm(shv_load3(state->displacement + 3 * (int64_t)i)));
    shv_hybrid_release(&hybrid);
    return end;
}

static void compare(Case c)
{
    const End able = run(&c, true), unable = run(&c, false);
    assert_memory_equal(&able.pad, &unable.pad, sizeof able.pad);
    assert_memory_equal(&able.other, &unable.other, sizeof able.other);
    assert_true(able.way > 2e-4); /* it was hit */
}

static void test_free_obstacle(void **state)
{
    (void)state;
    compare((Case){.box = true, .engine = SHV_RIGID_BULLET});
    compare((Case){.box = true, .engine = SHV_RIGID_ANALYTIC});
}

static void test_awake_block(void **state)
{
    (void)state;
    compare((Case){.engine = SHV_RIGID_BULLET});
}

static void test_block_that_contact_wakes(void **state)
{
    (void)state;
    compare((Case){.contact = true, .engine = SHV_RIGID_BULLET});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_free_obstacle), cmocka_unit_test(test_awake_block),
                                       cmocka_unit_test(test_block_that_contact_wakes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
