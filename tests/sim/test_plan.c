#include "sim/stage.h"

static void make_falling_cube(Stage *stage)
{
    stage_make(stage);
    stage_box(stage, "cube", (const double[3]){0.02, 0.03, 0.04}, 0.01, 0.5);
    stage_floor(stage);
    stage->scene.duration = 1.0;
}

static ShvPreflight preflight_of(const Stage *stage)
{
    ShvSimulation *simulation = stage_start(stage);
    ShvPreflight preflight;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_preflight(simulation, 0, &preflight, &error), error);
    check_fails(shv_simulation_preflight(simulation, stage->scene.object_count, &preflight, &error), SHV_BAD_INPUT,
                error, "does not exist");
    check_ok(shv_simulation_preflight(simulation, 0, &preflight, &error), error);
    shv_simulation_destroy(simulation);
    return preflight;
}

/* Against the formulas: c₀ = √(E/ρ), c_d, (π/8) E/(1−ν²) G/σ², 2EG/σ², δ = 2G/σ. */
static void test_preflight(void **state)
{
    (void)state;
    Stage stage;
    make_falling_cube(&stage);
    const ShvPreflight p = preflight_of(&stage);
    const double modulus = 50e6, density = 1200.0, nu = 0.2, energy = 0.5, strength = 50e3, pi = 3.14159265358979;
    check_near(p.volume, 2.4e-5, 1e-18);
    check_near(p.mass, density * 2.4e-5, 1e-14);
    check_near(p.bar_speed, sqrt(modulus / density), 1e-10);
    check_near(p.dilatational_speed, sqrt(modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * density)), 1e-10);
    check_near(p.cohesive_zone, pi / 8.0 * modulus / (1.0 - nu * nu) * energy / (strength * strength), 1e-12);
    check_near(p.snap_back, 2.0 * modulus * energy / (strength * strength), 1e-15);
    check_near(p.final_opening, 2.0 * energy / strength, 1e-18);
    /* 20 transits of the bending wave; sides are those of a box with the inertia of the lumped masses */
    const double transit = 0.5 * 0.04 * 0.04 / (1.03 * p.bar_speed * 0.02);
    check_near(p.vibration_time, 20.0 * transit, 0.1 * 20.0 * transit);
    check_near(p.opening_speed, 2.0 * strength / (density * p.bar_speed), 1e-14);
    check_near(p.steps_to_open * p.step, p.final_opening / p.opening_speed, 1e-18);
    check_near(p.courant, 0.9, 1e-12);
    check_near(p.bar_transit, 0.04 / p.bar_speed, 1e-12);
    check_near(p.extent[0], 0.02, 1e-15);
    check_near(p.extent[2], 0.04, 1e-15);
    assert_true(p.breakable);
    assert_true(p.shortest_edge <= p.mean_edge && p.mean_edge <= p.longest_edge);
}

/* Until when what an impact wakes stays in fracture mode: to the end of an interval where others fly, each of them whole. */
static void test_interval_of_flight(void **state)
{
    (void)state;
    Stage stage;
    make_falling_cube(&stage);
    stage.scene.rigid.time_step = 2e-3;
    assert_true(preflight_of(&stage).flight_interval == 0.0); /* alone */
    stage_box(&stage, "other", (const double[3]){0.02, 0.02, 0.02}, 0.01, 1.0);
    assert_true(preflight_of(&stage).flight_interval == 2e-3);
    stage.scene.rigid.engine = SHV_RIGID_ANALYTIC; /* bodies fly each for itself */
    assert_true(preflight_of(&stage).flight_interval == 0.0);
    stage.scene.rigid.engine = SHV_RIGID_BULLET;
    stage.material.breakable = false;
    assert_true(preflight_of(&stage).flight_interval == 0.0);
}

/* 5 × 5 × 5 bricks of five tets; the slit lies between two layers and reaches from the side −x through three of five. */
static void test_where_it_breaks(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *block = stage_box(&stage, "block", (const double[3]){0.04, 0.04, 0.04}, 0.01, 0.0);
    block->mesh.pattern = SHV_PATTERN_BRICKS;
    stage.scene.duration = 1.0;
    const ShvPreflight plain = preflight_of(&stage);
    assert_string_equal(shv_breaking_name(plain.breaking), "anywhere");
    assert_int_equal(plain.breaking_tets, plain.tets);
    assert_true(plain.breaking_mean_edge == plain.mean_edge && plain.breaking_longest_edge == plain.longest_edge);

    stage.scene.fracture.on = (ShvSelection){
        .kind = SHV_SELECT_PLANE, .plane_normal = {0.0, 0.0, 1.0}, .plane_offset = 0.004, .tolerance = 1e-6};
    const ShvPreflight plane = preflight_of(&stage);
    assert_string_equal(shv_breaking_name(plane.breaking), "plane");
    assert_int_equal(plane.breaking_tets, 2 * 25 * 2); /* of each brick beside it, the two that have a face on it */
    assert_true(plane.breaking_longest_edge <= plane.longest_edge);
    stage.scene.fracture.on = (ShvSelection){.kind = SHV_SELECT_ALL};

    ShvCrackDefinition slit = {
        .plane = {.kind = SHV_SELECT_PLANE, .plane_normal = {0.0, 0.0, 1.0}, .plane_offset = 0.004, .tolerance = 1e-6},
        .box = {.kind = SHV_SELECT_BOX, .box_min = {-1.0, -1.0, -1.0}, .box_max = {0.004, 1.0, 1.0}}};
    block->cracks = &slit;
    block->crack_count = 1;
    const ShvPreflight cracked = preflight_of(&stage);
    assert_string_equal(shv_breaking_name(cracked.breaking), "tips");
    /* Nothing but tets of the bricks around the front: four a layer. */
    assert_true(cracked.breaking_tets > 0 && cracked.breaking_tets <= 4 * 5 * 5);
    assert_true(cracked.breaking_longest_edge == cracked.longest_edge);
    stage.scene.fracture.enabled = false;
    assert_string_equal(shv_breaking_name(preflight_of(&stage).breaking), "anywhere");
}

/* Twice the speed, half the step; four times the stiffness, half the step. */
static void test_step_scales(void **state)
{
    (void)state;
    Stage stage;
    make_falling_cube(&stage);
    const double step = preflight_of(&stage).step;
    stage.material.youngs_modulus *= 4.0;
    check_near(preflight_of(&stage).step, 0.5 * step, 1e-12 * step);
    stage.scene.fracture.time_step = 0.25 * step;
    const ShvPreflight given = preflight_of(&stage);
    assert_true(given.step == 0.25 * step);
    check_near(given.courant, 0.45, 1e-12);
}

static ShvPlan plan_of(const Stage *stage)
{
    ShvSimulation *simulation = stage_start(stage);
    ShvPlan plan;
    ShvError error = {SHV_OK, ""};
    const uint64_t hash = shv_simulation_hash(simulation);
    check_ok(shv_simulation_plan(simulation, &plan, &error), error);
    /* What is timed on the way leaves no trace but in the scratch of forces: a planned run gives the same bits. */
    stage_finish(simulation);
    const uint64_t planned = shv_simulation_hash(simulation);
    assert_true(planned != hash);
    assert_true(planned == stage_hash(stage));
    check_fails(shv_simulation_plan(simulation, &plan, &error), SHV_BAD_INPUT, error, "before the first frame");
    shv_simulation_destroy(simulation);
    return plan;
}

static const ShvPlanPart *part_of(const ShvPlan *plan, const char *name)
{
    for (int32_t i = 0; i < plan->part_count; i++)
        if (strcmp(plan->parts[i].name, name) == 0) return &plan->parts[i];
    fail_msg("no part is called %s", name);
    return NULL;
}

/* The first contact is that of the bounding sphere: no later than the body's own, √(2 × 0.48/g), and before it by no more than
   what the sphere sticks out. */
static void test_plan(void **state)
{
    (void)state;
    Stage stage;
    make_falling_cube(&stage);
    stage.scene.duration = 0.4;
    const ShvPlan plan = plan_of(&stage);
    assert_true(plan.first_contact <= sqrt(2.0 * 0.48 / 9.81) && plan.first_contact >= sqrt(2.0 * 0.47 / 9.81));
    assert_int_equal(plan.frames, 41);
    assert_true(plan.seconds_per_step > 0.0);
    check_near(plan.predicted_steps, plan.awake_time / plan.step, 1e-9 * plan.predicted_steps);
    const double bar_speed = sqrt(50e6 / 1200.0), transit = 0.5 * 0.04 * 0.04 / (1.03 * bar_speed * 0.02);
    check_near(plan.longest_window, 20.0 * transit, 0.1 * 20.0 * transit); /* as in test_preflight */
    assert_true(part_of(&plan, "adjacency")->on && part_of(&plan, "adjacency")->bytes > 0);
    assert_true(part_of(&plan, "obstacles")->on);
    assert_false(part_of(&plan, "nodal stress")->on);
    assert_false(part_of(&plan, "conditions")->on);
}

/* What cannot break has neither adjacency nor stress nor cohesive facets, and no bytes for them. */
static void test_unbreakable(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        Stage stage;
        make_falling_cube(&stage);
        stage.scene.duration = 0.1;
        if (i == 0) stage.scene.fracture.enabled = false;
        if (i == 1) stage.material.breakable = false;
        stage.scene.obstacle_count = 0;
        const ShvPlan plan = plan_of(&stage);
        const char *off[] = {"adjacency", "stress", "cohesive facets", "obstacles"};
        for (size_t k = 0; k < sizeof off / sizeof off[0]; k++) {
            const ShvPlanPart *part = part_of(&plan, off[k]);
            assert_false(part->on);
            assert_true(strlen(part->reason) > 0);
            if (part->bytes > 0) fail_msg("%s is off and takes %zu bytes", off[k], part->bytes);
        }
        assert_true(isinf(plan.first_contact));
        assert_true(plan.predicted_steps == 0.0);
        assert_false(preflight_of(&stage).breakable);
    }
}

static ShvSimulation *plan_breaking_bar(Stage *stage, ShvPlan *plan)
{
    ShvError error = {SHV_OK, ""};
    stage_make_breaking_bar(stage);
    ShvSimulation *simulation = stage_start(stage);
    check_ok(shv_simulation_plan(simulation, plan, &error), error);
    return simulation;
}

/* A trial to the end knows the run, takes its course, and lists what it held before the first crack, part by part. */
static void test_trial(void **state)
{
    (void)state;
    Stage stage;
    ShvPlan plan;
    ShvError error = {SHV_OK, ""};
    ShvSimulation *simulation = plan_breaking_bar(&stage, &plan);
    const size_t before = plan.bytes;
    check_ok(shv_simulation_try(simulation, 600.0, &plan, &error), error);
    assert_true(shv_simulation_finished(simulation));
    assert_true(shv_simulation_hash(simulation) == stage_hash(&stage));
    const ShvTrial *trial = &plan.trial;
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_true(trial->finished && trial->time == stage.scene.duration);
    assert_true(trial->processor > 0.0 && trial->seconds > 0.0);
    assert_true(trial->low == trial->processor && trial->predicted == trial->low && trial->high == trial->low);
    assert_true(trial->first_wake > 0.0 && trial->first_crack >= trial->first_wake);
    assert_true(trial->first_crack < stage.scene.duration);
    assert_true(trial->awake > 0.0 && trial->awake <= stage.scene.duration);
    assert_int_equal(trial->steps, frame->steps);
    assert_int_equal(trial->inserted, frame->inserted);
    assert_int_equal(trial->fragments, frame->alive_count);
    assert_int_equal(trial->untouched, 0);
    size_t sum = 0;
    for (int32_t i = 0; i < plan.part_count; i++) sum += plan.parts[i].bytes;
    assert_true(sum == plan.bytes && plan.bytes > before);
    shv_simulation_destroy(simulation);
}

/* One that ends early leaves the simulation where it can go on, and bounds its guess. */
static void test_short_trial(void **state)
{
    (void)state;
    Stage stage;
    ShvPlan plan;
    ShvError error = {SHV_OK, ""};
    ShvSimulation *simulation = plan_breaking_bar(&stage, &plan);
    check_ok(shv_simulation_try(simulation, 0.0, &plan, &error), error);
    assert_true(plan.trial.seconds == 0.0 && shv_simulation_summary(simulation).time == 0.0);
    for (int i = 0; i < 4; i++) {
        check_ok(shv_simulation_try(simulation, 1e-3, &plan, &error), error);
        const ShvTrial *trial = &plan.trial;
        assert_true(trial->time == shv_simulation_summary(simulation).time);
        assert_true(trial->processor <= trial->low && trial->low <= trial->predicted);
        assert_true(trial->predicted <= trial->high && isfinite(trial->high));
        assert_int_equal(trial->untouched, isnan(trial->first_wake) ? 1 : 0);
    }
    stage_finish(simulation);
    shv_simulation_destroy(simulation);
}

static bool stop_at_once(void *data)
{
    ++*(int *)data;
    return true;
}

/* The simulation's own stop is asked, and obeyed. */
static void test_interrupted_trial(void **state)
{
    (void)state;
    Stage stage;
    make_falling_cube(&stage);
    int asked = 0;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.stop = stop_at_once;
    options.stop_data = &asked;
    ShvSimulation *simulation = NULL;
    ShvPlan plan;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_create(&simulation, &stage.scene, &options, &error), error);
    check_ok(shv_simulation_plan(simulation, &plan, &error), error);
    check_fails(shv_simulation_try(simulation, 10.0, &plan, &error), SHV_INTERRUPTED, error, "stopped");
    assert_int_equal(asked, 1);
    shv_simulation_destroy(simulation);
}

/* Two cubes of 20 mm, 10 mm apart, over a floor, beside a ball and a wall of a box turned by 45 degrees. */
static void test_what_is_nearest(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "low", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.05);
    const ShvPreflight alone = preflight_of(&stage);
    assert_null(alone.nearest);
    assert_true(isinf(alone.clearance) && isnan(alone.impact_speed) && isnan(alone.overshoot_each_step));
    stage_floor(&stage);
    const ShvPreflight falling = preflight_of(&stage);
    assert_string_equal(falling.nearest, "floor");
    assert_true(falling.nearest_is_obstacle);
    check_near(falling.clearance, 0.04, 1e-12);
    check_near(falling.impact_speed, sqrt(2.0 * 9.81 * 0.04), 1e-9);
    ShvObstacleDefinition *second = &stage.obstacles[stage.scene.obstacle_count++];
    *second = shv_obstacle_default();
    second->name = "other";
    second->shape = SHV_OBSTACLE_SPHERE;
    second->radius = 0.005;
    second->placement.position[0] = 0.02;
    second->placement.position[1] = 0.02;
    second->placement.position[2] = 0.05; /* beside an edge of the cube: 10 mm √2 from it */
    ShvPreflight beside = preflight_of(&stage);
    assert_string_equal(beside.nearest, "other");
    check_near(beside.clearance, 0.01 * sqrt(2.0) - 0.005, 1e-9);
    second->shape = SHV_OBSTACLE_BOX;
    for (int k = 0; k < 3; k++) second->size[k] = 0.01;
    second->placement.rotation_axis[2] = 1.0;
    second->placement.rotation_degrees = 90.0;
    second->placement.position[0] = 0.03;
    second->placement.position[1] = 0.0;
    stage.objects[0].placement.velocity[0] = 2.0; /* towards it */
    beside = preflight_of(&stage);
    assert_string_equal(beside.nearest, "other");
    check_near(beside.clearance, 0.015, 1e-9);
    check_near(beside.impact_speed, 2.0, 1e-9);
    ShvObjectDefinition *high = stage_box(&stage, "high", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.08);
    high->placement.velocity[2] = -3.0; /* 10 mm above; both fall */
    const ShvPreflight between = preflight_of(&stage);
    assert_string_equal(between.nearest, "high");
    assert_false(between.nearest_is_obstacle);
    check_near(between.clearance, 0.01, 1e-9);
    check_near(between.impact_speed, 3.0, 1e-9);
}

/* The reason of a part is that of the engine at work. */
static void test_reasons(void **state)
{
    (void)state;
    static const ShvRigidEngine engines[] = {SHV_RIGID_ANALYTIC, SHV_RIGID_PBD, SHV_RIGID_BULLET};
    static const char *const words[] = {"against obstacles", "bars keep rigid", "convex pieces"};
    for (int i = 0; i < 3; i++) {
        Stage stage;
        make_falling_cube(&stage);
        stage.scene.duration = 0.1;
        stage.scene.rigid.engine = engines[i];
        const ShvPlan plan = plan_of(&stage);
        assert_non_null(strstr(part_of(&plan, "rigid flight")->reason, words[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_preflight),
        cmocka_unit_test(test_interval_of_flight),
        cmocka_unit_test(test_where_it_breaks),
        cmocka_unit_test(test_step_scales),
        cmocka_unit_test(test_plan),
        cmocka_unit_test(test_unbreakable),
        cmocka_unit_test(test_trial),
        cmocka_unit_test(test_short_trial),
        cmocka_unit_test(test_interrupted_trial),
        cmocka_unit_test(test_reasons),
        cmocka_unit_test(test_what_is_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
