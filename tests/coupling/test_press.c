/* What wakes without an impact. What obstacles close on deforms, as no rigid motion can answer them: the oracle is the energy of uniform
   compression, ½ E ε² V. What lies on supports bears its weight: the oracle is the stress ¾ ρ g L²/h of a beam. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

/* Plates of 0.1 m over the floor or both of them moving, whose faces are frictionless. */
typedef struct Plate {
    ShvKeyframe keyframes[2];
} Plate;

static const double thickness = 0.02, duration = 0.025;

/* Its face at a height of `from` moves to `to` until the end, and on. */
static void stage_plate(Stage *stage, Plate *plate, bool above, double from, double to)
{
    const double middle = above ? 0.5 * thickness : -0.5 * thickness;
    ShvObstacleDefinition *obstacle = &stage->obstacles[stage->scene.obstacle_count++];
    *obstacle = shv_obstacle_default();
    obstacle->name = above ? "press" : "table";
    obstacle->shape = SHV_OBSTACLE_BOX;
    for (int k = 0; k < 3; k++) obstacle->size[k] = k < 2 ? 0.1 : thickness;
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    plate->keyframes[0] = (ShvKeyframe){0.0, {0.0, 0.0, from + middle}, {0.0, 0.0, 1.0}, 0.0};
    plate->keyframes[1] = (ShvKeyframe){2.0 * duration, {0.0, 0.0, 2.0 * to - from + middle}, {0.0, 0.0, 1.0}, 0.0};
    obstacle->keyframes = plate->keyframes;
    obstacle->keyframe_count = 2;
}

static void stage_block(Stage *stage, ShvRigidEngine engine)
{
    stage_make(stage);
    stage->material.cohesive_strength = 5e6; /* it does not break */
    stage->scene.rigid.engine = engine;
    stage->scene.duration = duration;
    stage_box(stage, "block", (const double[3]){0.02, 0.02, 0.04}, 0.01, 0.02);
}

static void advance(ShvHybrid *hybrid, const Stage *stage)
{
    int64_t taken = 0;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    check_ok(shv_hybrid_advance(hybrid, stage->scene.duration, 0, &taken, &error), error);
}

static void check_compressed(const ShvHybrid *hybrid, double strain, double volume)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        assert_int_equal(hybrid->fragments.items[i].mode, SHV_MODE_FRACTURE);
    const double energy = 0.5 * 50e6 * strain * strain * volume;
    check_near(shv_solid_strain_energy(&hybrid->solid, &hybrid->state), energy, 0.03 * energy);
}

static void press_block(ShvRigidEngine engine, ShvWake wake)
{
    Stage stage;
    Plate press;
    ShvHybrid hybrid;
    stage_block(&stage, engine);
    stage.scene.rigid.wake = wake;
    stage_floor(&stage);
    stage_plate(&stage, &press, true, 0.0401, 0.0396);
    advance(&hybrid, &stage);
    assert_int_equal(hybrid.log.items[0].kind, SHV_RUN_WAKE);
    assert_int_equal(hybrid.log.items[0].reason, SHV_REASON_LOAD);
    check_compressed(&hybrid, 0.01, 1.6e-5);
    shv_hybrid_release(&hybrid);
}

static void a_press_strains_what_it_closes_on(void **unused)
{
    (void)unused;
    press_block(SHV_RIGID_BULLET, SHV_WAKE_STRESS);
    press_block(SHV_RIGID_BULLET, SHV_WAKE_CONTACT);
    press_block(SHV_RIGID_ANALYTIC, SHV_WAKE_STRESS);
}

/* The floor meets one and the press the other. */
static void and_what_that_presses(void **unused)
{
    (void)unused;
    Stage stage;
    Plate press;
    ShvHybrid hybrid;
    stage_block(&stage, SHV_RIGID_BULLET);
    stage.scene.rigid.wake = SHV_WAKE_CONTACT;
    stage.scene.fracture.quiet_checks = 20;
    stage_floor(&stage);
    stage_box(&stage, "other", (const double[3]){0.02, 0.02, 0.04}, 0.01, 0.0601);
    stage_plate(&stage, &press, true, 0.0802, 0.0792);
    advance(&hybrid, &stage);
    check_compressed(&hybrid, 0.01, 3.2e-5);
    shv_hybrid_release(&hybrid);
}

/* Obstacles that move alike leave a body between them as much room as it had. */
static void a_cage_carries_what_is_in_it(void **unused)
{
    (void)unused;
    Stage stage;
    Plate table, press;
    ShvHybrid hybrid;
    stage_block(&stage, SHV_RIGID_BULLET);
    stage.objects[0].placement.velocity[2] = 0.5;
    stage_plate(&stage, &table, false, 0.0, 0.5 * duration);
    stage_plate(&stage, &press, true, 0.04001, 0.04001 + 0.5 * duration);
    advance(&hybrid, &stage);
    assert_int_equal(hybrid.fragments.items[0].mode, SHV_MODE_FLIGHT);
    assert_true(hybrid.fragments.items[0].wake_energy == 0.0);
    shv_hybrid_release(&hybrid);
}

/* A beam of the height 20 mm on its ends; whether it wakes, and breaks. */
static void lay_beam(ShvRigidEngine engine, double length, bool breaks)
{
    Stage stage;
    ShvHybrid hybrid;
    stage_make(&stage);
    stage.scene.rigid.engine = engine;
    stage.scene.duration = 0.08;
    stage_box(&stage, "beam", (const double[3]){length, 0.02, 0.02}, 0.01, 0.06);
    for (int side = 0; side < 2; side++) {
        ShvObstacleDefinition *support = &stage.obstacles[stage.scene.obstacle_count++];
        *support = shv_obstacle_default();
        support->name = side == 0 ? "left" : "right";
        support->shape = SHV_OBSTACLE_BOX;
        for (int k = 0; k < 3; k++) support->size[k] = k == 0 ? 0.02 : 0.05;
        support->placement.position[0] = (side - 0.5) * (length - 0.02);
        support->placement.position[2] = 0.025;
    }
    advance(&hybrid, &stage);
    assert_int_equal(hybrid.fragments.items[0].wake_energy > 0.0 || hybrid.awake.count > 0, breaks);
    assert_int_equal(hybrid.cohesive.count > 0, breaks);
    shv_hybrid_release(&hybrid);
}

static void a_long_beam_breaks_by_its_weight(void **unused)
{
    (void)unused;
    lay_beam(SHV_RIGID_BULLET, 0.5, true); /* 110 kPa, and 4.4 */
    lay_beam(SHV_RIGID_BULLET, 0.1, false);
    lay_beam(SHV_RIGID_ANALYTIC, 0.5, true);
    lay_beam(SHV_RIGID_ANALYTIC, 0.1, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_press_strains_what_it_closes_on), cmocka_unit_test(and_what_that_presses),
        cmocka_unit_test(a_cage_carries_what_is_in_it), cmocka_unit_test(a_long_beam_breaks_by_its_weight)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
