/* What a simulation refuses, and how it ends before its time: bad numbers, unstable steps, a caller who has enough. */
#include "sim/stage.h"

static void make_small_bar(Stage *stage)
{
    stage_make_breaking_bar(stage);
    stage->objects[0].mesh.edge = 0.02;
    stage->scene.duration = 0.003;
}

static void refuse(const Stage *stage, const char *part)
{
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_simulation_create(&simulation, &stage->scene, NULL, &error), SHV_BAD_INPUT, error, part);
    assert_null(simulation);
}

/* Each number by itself set to what makes no sense; every message names its key. */
static void test_bad_numbers(void **state)
{
    (void)state;
    const double nan = (double)NAN, infinite = (double)INFINITY;
    Stage stage;
    make_small_bar(&stage);
    ShvSceneDefinition *scene = &stage.scene;
    const struct {
        double *number;
        double value;
        const char *name;
    } cases[] = {
        {&scene->duration, nan, "duration"},
        {&scene->duration, -1.0, "duration"},
        {&scene->duration, infinite, "duration"},
        {&scene->output.rate, 0.0, "output.rate"},
        {&scene->output.rate, nan, "output.rate"},
        {&scene->gravity[1], nan, "gravity"},
        {&scene->gravity[2], -infinite, "gravity"},
        {&scene->rigid.time_step, 0.0, "rigid.time_step"},
        {&scene->rigid.time_step, -1e-3, "rigid.time_step"},
        {&scene->rigid.time_step, nan, "rigid.time_step"},
        {&scene->rigid.wake_fraction, nan, "rigid.wake_fraction"},
        {&scene->rigid.wake_factor, -6.0, "rigid.wake_factor"},
        {&scene->rigid.friction, -0.1, "rigid.friction"},
        {&scene->rigid.restitution, 1.1, "rigid.restitution"},
        {&scene->rigid.dust_size, nan, "rigid.dust_size"},
        {&scene->audit.momentum, 0.0, "audit.momentum"},
        {&scene->audit.dropped_share, -1.0, "audit.dropped_share"},
        {&scene->audit.hull_error, nan, "audit.hull_error"},
        {&scene->fracture.time_step, 0.0, "fracture.time_step"},
        {&scene->fracture.time_step, -1e-6, "fracture.time_step"},
        {&scene->fracture.time_step, infinite, "fracture.time_step"},
        {&scene->fracture.safety, 0.0, "fracture.safety"},
        {&scene->fracture.safety, 1.5, "fracture.safety"},
        {&scene->fracture.safety, nan, "fracture.safety"},
        {&scene->fracture.threshold, nan, "fracture.threshold"},
        {&scene->fracture.regularisation, 0.0, "fracture.regularisation"},
        {&scene->fracture.longest, -1.0, "fracture.longest"},
        {&scene->fracture.energy_bound, nan, "fracture.energy_bound"},
        {&scene->pbd.stiffness, 1.1, "pbd.stiffness"},
        {&scene->pbd.damping, -0.1, "pbd.damping"},
        {&stage.material.density, 0.0, "density"},
        {&stage.material.youngs_modulus, nan, "youngs_modulus"},
        {&stage.material.poissons_ratio, 0.5, "poissons_ratio"},
        {&stage.material.poissons_ratio, -1.0, "poissons_ratio"},
        {&stage.material.fracture_energy, -1.0, "fracture_energy"},
        {&stage.material.cohesive_strength, nan, "cohesive_strength"},
        {&stage.objects[0].placement.velocity[0], nan, "velocity"},
        {&stage.objects[0].placement.position[0], infinite, "position"},
        {&stage.obstacles[0].friction, -0.1, "friction"},
        {&stage.obstacles[0].plane_normal[2], 0.0, "normal"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const double good = *cases[i].number;
        *cases[i].number = cases[i].value;
        refuse(&stage, cases[i].name);
        *cases[i].number = good;
    }
    ShvSimulation *simulation = stage_start(&stage);
    shv_simulation_destroy(simulation);
}

static void test_bad_counts(void **state)
{
    (void)state;
    Stage stage;
    make_small_bar(&stage);
    stage.scene.output.fracture_every = -1;
    refuse(&stage, "output.fracture_every");
    stage.scene.output.fracture_every = 0;
    stage.scene.fracture.check_every = -1;
    refuse(&stage, "fracture.check_every");
    stage.scene.fracture.check_every = 0;
    stage.scene.fracture.quiet_checks = 0;
    refuse(&stage, "fracture.quiet_checks");
    stage.scene.fracture.quiet_checks = 1;
    stage.scene.pbd.iterations = 0;
    refuse(&stage, "pbd.iterations");
    stage.scene.pbd.iterations = 1;
    stage.scene.threads = -1;
    refuse(&stage, "threads");
    stage.scene.threads = 1;
    stage.objects[0].material = "cheese";
    refuse(&stage, "cheese");
}

static void test_without_defaults(void **state)
{
    (void)state;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    const ShvSceneDefinition zero = {0};
    check_fails(shv_simulation_create(&simulation, &zero, NULL, &error), SHV_BAD_INPUT, error, "shv_scene_default");
    check_fails(shv_simulation_create(&simulation, NULL, NULL, &error), SHV_BAD_INPUT, error, "shv_scene_default");
    Stage stage;
    make_small_bar(&stage);
    const ShvSimulationOptions options = {0};
    check_fails(shv_simulation_create(&simulation, &stage.scene, &options, &error), SHV_BAD_INPUT, error,
                "shv_simulation_options_default");
    shv_simulation_destroy(NULL);
}

/* 400 GPa allow a step below a microsecond: 1 ms is refused, and the message says what is possible. */
static void test_unstable_step(void **state)
{
    (void)state;
    Stage stage;
    make_small_bar(&stage);
    stage.material.youngs_modulus = 400e9;
    stage.scene.fracture.time_step = 1e-3;
    refuse(&stage, "stable step");
    stage.scene.fracture.time_step = (double)NAN;
    ShvSimulation *simulation = stage_start(&stage);
    ShvPreflight preflight;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_preflight(simulation, 0, &preflight, &error), error);
    assert_true(preflight.step < 1e-6 && preflight.step > 1e-8);
    check_near(preflight.courant, 0.9, 1e-12);
    shv_simulation_destroy(simulation);
}

typedef struct Patience {
    int64_t asked, until;
} Patience;

static bool enough(void *data)
{
    Patience *patience = data;
    return ++patience->asked > patience->until;
}

/* Stopped in flight and in fracture mode alike; the frame shows that time, and going on leads where an
   undisturbed run goes. Observing between frames names pieces earlier, which orders sums differently and may let a piece rest
   earlier: here none rests. */
static void test_interruption(void **state)
{
    (void)state;
    Stage stage;
    make_small_bar(&stage);
    stage.scene.fracture.quiet_checks = 1000000;
    ShvSimulation *undisturbed = stage_start(&stage);
    const ShvLedgerView expected = stage_finish(undisturbed)->ledger;
    shv_simulation_destroy(undisturbed);
    assert_true(expected.inserted_area > 0.0);
    const int64_t moments[] = {0, 1, 2, 20, 60};
    for (size_t i = 0; i < sizeof moments / sizeof moments[0]; i++) {
        Patience patience = {.until = moments[i]};
        ShvSimulationOptions options = shv_simulation_options_default();
        options.stop = enough;
        options.stop_data = &patience;
        ShvSimulation *simulation = NULL;
        ShvError error = {SHV_OK, ""};
        check_ok(shv_simulation_create(&simulation, &stage.scene, &options, &error), error);
        ShvStatus status = SHV_OK;
        while (status == SHV_OK && !shv_simulation_finished(simulation))
            status = shv_simulation_advance(simulation, &error);
        assert_int_equal(status, SHV_INTERRUPTED);
        const ShvFrameView *frame = shv_simulation_frame(simulation);
        assert_true(frame->time < stage.scene.duration);
        assert_false(frame->animation);
        check_near(frame->ledger.residual, 0.0, 0.05 * frame->ledger.largest);
        patience.until = INT64_MAX;
        const ShvLedgerView last = stage_finish(simulation)->ledger;
        check_near(last.kinetic, expected.kinetic, 1e-12 * expected.largest);
        check_near(last.strain, expected.strain, 1e-12 * expected.largest);
        shv_simulation_destroy(simulation);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_numbers),      cmocka_unit_test(test_bad_counts),
        cmocka_unit_test(test_without_defaults), cmocka_unit_test(test_unstable_step),
        cmocka_unit_test(test_interruption),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
