/* Loss factors: vibration decays, rigid motion does not. */
#include "coupling/stage.h"

#include "coupling/hybrid.h"

/* Twice as long as wide, so that its slowest mode is the axial one, of the frequency c/2L without lateral contraction. */
static const double length = 0.04, width = 0.02;

static void start(ShvHybrid *hybrid, Stage *stage, const double size[3], double poisson, double loss_factor)
{
    ShvError error = {SHV_OK, ""};
    stage_make(stage);
    stage->material.breakable = false;
    stage->material.poissons_ratio = poisson;
    stage->material.loss_factor = loss_factor;
    memset(stage->scene.gravity, 0, sizeof stage->scene.gravity);
    stage->scene.fracture.longest = 1e3;
    stage->scene.fracture.quiet_checks = 1000000;
    ShvObjectDefinition *body = stage_box(stage, "body", size, 0.005, 0.0);
    body->placement.stretch_rate[0] = 0.05;
    body->placement.velocity[1] = 0.3;
    body->placement.angular_velocity[2] = 0.2;
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
}

static ShvLedgerView balance_at(ShvHybrid *hybrid, double time)
{
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    check_ok(shv_hybrid_advance(hybrid, time, 0, &taken, &error), error);
    check_ok(shv_hybrid_observe(hybrid, &error), error);
    return hybrid->observer.balance;
}

/* J: of the motion as a whole, which the stretch is beside. */
static double rigid_energy(const ShvHybrid *hybrid)
{
    return shv_fragment_kinetic(&hybrid->fragments.items[0]);
}

static void test_vibration_decays(void **unused)
{
    (void)unused;
    const double loss_factor = 0.02, periods = 10.0;
    Stage stage;
    ShvHybrid hybrid;
    start(&hybrid, &stage, (const double[]){length, width, width}, 0.0, loss_factor);
    const double period = 2.0 * length / hybrid.model.materials[0].bar_speed;
    const ShvLedgerView first = hybrid.observer.balance, last = balance_at(&hybrid, periods * period);
    const double whole = rigid_energy(&hybrid);
    const double before = first.kinetic + first.strain - whole, after = last.kinetic + last.strain - whole;
    const double expected = exp(-2.0 * 3.14159265358979323846 * loss_factor * periods);
    /* Masses at nodes make the bar 1.5 % longer, and its period with it, than it is. */
    assert_true(fabs(log(after / before) / log(expected) - 1.0) < 0.03);
    assert_true(fabs(last.damping + before - after) < 1e-3 * before);
    assert_true(fabs(last.residual) < 1e-4 * before);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(last.momentum[k] - first.momentum[k]) < 1e-13 * fabs(first.momentum[1]));
        assert_true(fabs(last.angular_momentum[k] - first.angular_momentum[k]) <
                    1e-12 * fabs(first.angular_momentum[2]));
    }
    shv_hybrid_release(&hybrid);
}

/* A free square plate's slowest mode, in which it twists, has the frequency 13.49 √(D/ρt)/2πb² (ν 0.3; A. W. Leissa, J. Sound
   Vib. 31, 1973). Rates are reckoned from sizes alone: such a body may ring too long, by half, but not too short. Damping is
   proportional to mass, so that other modes, and a mesh too coarse to bend, decay at the same rate. */
static void test_thin_plates_ring_long_enough(void **unused)
{
    (void)unused;
    const double loss_factor = 0.02, side = 0.06, thickness = 0.003, poisson = 0.3;
    Stage stage;
    ShvHybrid hybrid;
    start(&hybrid, &stage, (const double[]){side, side, thickness}, poisson, loss_factor);
    const double speed = hybrid.model.materials[0].bar_speed;
    const double bending = thickness * speed / sqrt(12.0 * (1.0 - poisson * poisson)); /* √(D/ρt) */
    const double pulsation = 13.49 * bending / (side * side);
    const ShvLedgerView first = hybrid.observer.balance, last = balance_at(&hybrid, 1.0 / (loss_factor * pulsation));
    const double whole = rigid_energy(&hybrid);
    const double decay = log((first.kinetic + first.strain - whole) / (last.kinetic + last.strain - whole));
    assert_true(decay > 0.5 && decay < 1.0);
    shv_hybrid_release(&hybrid);
}

static void test_nothing_without_it(void **unused)
{
    (void)unused;
    Stage stage;
    ShvHybrid hybrid;
    start(&hybrid, &stage, (const double[]){length, width, width}, 0.0, 0.0);
    assert_true(balance_at(&hybrid, 1e-3).damping == 0.0);
    assert_null(hybrid.damping.force);
    shv_hybrid_release(&hybrid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_vibration_decays),
                                       cmocka_unit_test(test_thin_plates_ring_long_enough),
                                       cmocka_unit_test(test_nothing_without_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
