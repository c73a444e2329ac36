#include "check.h"

#include "base/random.h"
#include "cohesive/law.h"

static ShvMaterial material_of(ShvCohesiveLaw law, double phi_n, double phi_t, double sigma, double tau, double alpha,
                               double beta)
{
    return (ShvMaterial){.name = "test",
                         .breakable = true,
                         .law = law,
                         .fracture_energy = {phi_n, phi_t},
                         .strength = {sigma, tau},
                         .shape = {alpha, beta}};
}

static ShvLaw ppr(double phi_n, double phi_t, double sigma, double tau, double alpha, double beta)
{
    const ShvMaterial material = material_of(SHV_PPR, phi_n, phi_t, sigma, tau, alpha, beta);
    return shv_law_make(&material, 1.0);
}

static ShvLaw concrete(void)
{
    return ppr(22.0, 22.0, 8e6, 8e6, 2.0, 2.0);
}

/* Work along straight pieces by the midpoint rule, the law called as a user would. */
static double work_along(const ShvLaw *law, ShvHistory *history, ShvOpening from, ShvOpening to, int steps)
{
    double work = 0.0;
    const double dn = (to.normal - from.normal) / steps, ds = (to.shear - from.shear) / steps;
    for (int i = 0; i < steps; i++) {
        const double n = from.normal + (i + 0.5) * dn, s = from.shear + (i + 0.5) * ds;
        const ShvLawTraction t = shv_law_traction(law, *history, n, s);
        work += t.normal * dn + t.shear * ds;
        *history = shv_law_grow(law, *history, n + 0.5 * dn, s + 0.5 * ds);
    }
    return work;
}

static void fact_1_peak_and_energies(void **state)
{
    (void)state;
    const ShvLaw law = ppr(22.0, 31.0, 8e6, 5e6, 2.4, 3.5);
    const double dn = 2.4 * 22.0 / 8e6, dt = 3.5 * 31.0 / 5e6;
    ShvHistory history = {0};
    check_near(shv_law_traction(&law, history, 0.0, 0.0).normal, 8e6, 8e6 * 1e-15);
    check_near(shv_law_traction(&law, history, 0.0, 0.0).shear, 5e6, 5e6 * 1e-15);
    check_near(law.final_opening[0], dn, dn * 1e-15);
    check_near(law.final_opening[1], dt, dt * 1e-15);
    /* midpoint rule: error below f'' h²/24, of the order of (1/1000)² */
    check_near(work_along(&law, &history, (ShvOpening){0.0, 0.0}, (ShvOpening){dn, 0.0}, 1000), 22.0, 22.0 * 1e-5);
    history = (ShvHistory){0};
    check_near(work_along(&law, &history, (ShvOpening){0.0, 0.0}, (ShvOpening){0.0, dt}, 1000), 31.0, 31.0 * 1e-5);
    const ShvHistory virgin = {0};
    check_near(shv_law_normal_mean(&law, virgin, 0.0, 0.0, dn) * dn, 22.0, 22.0 * 1e-14);
    check_near(shv_law_shear_mean(&law, virgin, 0.0, 0.0, 2.0 * dt) * 2.0 * dt, 31.0, 31.0 * 1e-14);
}

static void fact_2_half_way(void **state)
{
    (void)state;
    const ShvLaw law = concrete();
    const ShvHistory virgin = {0};
    const double half = 2.75e-6;
    check_near(shv_law_traction(&law, virgin, half, 0.0).normal, 4e6, 1e-6);
    check_near(shv_law_normal_mean(&law, virgin, 0.0, 0.0, half) * half, 0.75 * 22.0, 1e-13);
    const ShvLaw other = ppr(22.0, 22.0, 8e6, 8e6, 3.3, 2.0);
    const double half_other = 0.5 * other.final_opening[0];
    check_near(shv_law_traction(&other, virgin, half_other, 0.0).normal, 8e6 * pow(2.0, 1.0 - 3.3), 1e-6);
    check_near(shv_law_normal_mean(&other, virgin, 0.0, 0.0, half_other) * half_other, 22.0 * (1.0 - pow(2.0, -3.3)),
               1e-12);
}

static void fact_3_mixed_values(void **state)
{
    (void)state;
    const ShvLaw law = concrete();
    const ShvHistory virgin = {0};
    const ShvLawTraction opened = shv_law_traction(&law, virgin, 2.75e-6, 0.0);
    check_near(opened.normal, 4e6, 1e-6);
    check_near(opened.shear, 2e6, 1e-6); /* with a slip of 0+ */
    check_near(shv_law_traction(&law, virgin, 2.75e-6, 1e-18).shear, 2e6, 1.0);
    const ShvLawTraction both = shv_law_traction(&law, virgin, 2.75e-6, 2.75e-6);
    check_near(both.normal, 1e6, 1e-6);
    check_near(both.shear, 1e6, 1e-6);
}

static void fact_4_monotone_paths_do_the_energy(void **state)
{
    (void)state;
    const ShvLaw law = concrete();
    const double d = 5.5e-6;
    const ShvOpening zero = {0.0, 0.0}, ends[] = {{d, 0.0}, {0.0, d}, {d, d}, {0.3 * d, d}};
    for (int i = 0; i < 4; i++) {
        ShvHistory history = {0};
        check_near(work_along(&law, &history, zero, ends[i], 2000), 22.0, 1e-4);
    }
    ShvHistory history = {0};
    double work = work_along(&law, &history, zero, (ShvOpening){0.5 * d, 0.0}, 2000);
    work += work_along(&law, &history, (ShvOpening){0.5 * d, 0.0}, (ShvOpening){0.5 * d, d}, 2000);
    check_near(work, 22.0, 1e-4);
}

/* What is left is what opening on takes, by the midpoint rule. */
static void what_remains_is_the_work_to_come(void **state)
{
    (void)state;
    const ShvMaterial camacho = material_of(SHV_CAMACHO_ORTIZ, 22.0, 44.0, 8e6, 9e6, 2.0, 2.0);
    const ShvLaw laws[] = {concrete(), ppr(20.0, 50.0, 8e6, 4e6, 3.0, 2.0), shv_law_make(&camacho, 1.0)};
    for (int i = 0; i < 3; i++) {
        const ShvLaw *law = &laws[i];
        const double end = law->final_opening[SHV_NORMAL];
        check_near(shv_law_remaining(law, (ShvHistory){0}), law->energy[SHV_NORMAL], 1e-9);
        for (int part = 1; part < 10; part++) {
            ShvHistory history = shv_law_grow(law, (ShvHistory){0}, 0.1 * part * end, 0.02 * part * end);
            const double left = shv_law_remaining(law, history);
            check_near(work_along(law, &history, (ShvOpening){0}, (ShvOpening){end, 0.0}, 4000), left, 1e-3);
        }
        assert_true(shv_law_remaining(law, shv_law_tear(law, (ShvHistory){0})) == 0.0);
    }
}

static void fact_5_unequal_energies(void **state)
{
    (void)state;
    const ShvLaw law = ppr(100.0, 200.0, 8e6, 8e6, 2.0, 2.0);
    const double dn = law.final_opening[0], dt = law.final_opening[1], conjugate = dt * (1.0 - sqrt(0.5));
    check_near(conjugate / dt, 0.2929, 5e-5);
    const ShvHistory virgin = {0};
    assert_true(shv_law_traction(&law, virgin, 0.1 * dn, conjugate * (1.0 - 1e-6)).normal > 0.0);
    assert_true(shv_law_traction(&law, virgin, 0.1 * dn, conjugate * (1.0 + 1e-12)).normal == 0.0);
    ShvHistory history = {0};
    double work = work_along(&law, &history, (ShvOpening){0.0, 0.0}, (ShvOpening){0.25 * dn, 0.0}, 2000);
    work += work_along(&law, &history, (ShvOpening){0.25 * dn, 0.0}, (ShvOpening){0.25 * dn, dt}, 2000);
    check_near(work, 156.25, 1e-3);
}

static void fact_6_gradient_and_decay(void **state)
{
    (void)state;
    const double energies[3][2] = {{22.0, 22.0}, {22.0, 35.0}, {40.0, 25.0}};
    for (int e = 0; e < 3; e++) {
        const ShvLaw law = ppr(energies[e][0], energies[e][1], 8e6, 6e6, 2.5, 3.0);
        const double dn = law.final_opening[0], dt = law.final_opening[1], h = 1e-6;
        const ShvHistory virgin = {0};
        double last = HUGE_VAL;
        for (int i = 1; i < 10; i++) {
            /* inside both conjugate openings, where the potential holds */
            const double n = 0.02 * i * dn, s = 0.015 * i * dt;
            const ShvLawTraction t = shv_law_traction(&law, virgin, n, s);
            const double by_n =
                (shv_ppr_potential(&law, n + h * dn, s) - shv_ppr_potential(&law, n - h * dn, s)) / (2.0 * h * dn);
            const double by_s =
                (shv_ppr_potential(&law, n, s + h * dt) - shv_ppr_potential(&law, n, s - h * dt)) / (2.0 * h * dt);
            /* round-off of Ψ over 2h: 1e-16 × 40 / (2e-6 × 1e-5) = 2e-4 of 1e6 */
            check_near(by_n, t.normal, 1e-3 * 8e6 * 1e-2);
            check_near(by_s, t.shear, 1e-3 * 6e6 * 1e-2);
            assert_true(t.normal < last);
            last = t.normal;
        }
        check_near(shv_law_traction(&law, virgin, dn * (1.0 - 1e-9), 0.0).normal, 0.0, 8e6 * 1e-12);
        assert_true(shv_law_traction(&law, virgin, dn, 0.0).normal == 0.0);
        assert_true(shv_law_traction(&law, virgin, 0.0, dt).shear == 0.0);
    }
}

static void fact_7_cycle(void **state)
{
    (void)state;
    const ShvLaw law = concrete();
    const double reached = 2e-6;
    ShvHistory history = shv_law_advance(&law, (ShvHistory){0}, (ShvOpening){0.0, 0.0}, (ShvOpening){reached, 0.0});
    history = shv_law_advance(&law, history, (ShvOpening){reached, 0.0}, (ShvOpening){0.0, 0.0});
    check_near(history.dissipated, 0.5 * 8e6 * reached, 1e-14);
    check_near(shv_law_recoverable(&law, history, 0.0, 0.0), 0.0, 0.0);
    check_near(shv_law_damage(&law, history), reached / 5.5e-6, 1e-14);
}

static void camacho_ortiz_as_published(void **state)
{
    (void)state;
    const ShvMaterial material = material_of(SHV_CAMACHO_ORTIZ, 20.0, 50.0, 8e6, 6e6, 2.0, 2.0);
    const ShvLaw law = shv_law_make(&material, 1.0);
    const double beta = 0.75, kappa = 2.5, end = 2.0 * 20.0 / 8e6;
    const double n = 1.1e-6, s = 2.3e-6, delta = sqrt(beta * beta / (kappa * kappa) * s * s + n * n);
    const ShvHistory virgin = {0};
    const ShvLawTraction t = shv_law_traction(&law, virgin, n, s);
    const double secant = 8e6 / delta * (1.0 - delta / end);
    check_near(t.normal, n * secant, 1e-6);
    check_near(t.shear, beta * beta / kappa * s * secant, 1e-6);
    ShvHistory history = shv_law_grow(&law, virgin, n, s);
    check_near(shv_law_traction(&law, history, 0.4 * n, 0.7 * s).shear, 0.7 * t.shear, 1e-6);
    check_near(shv_law_damage(&law, history), delta / end, 1e-14);
    /* pure modes do GI and GII; E_diss = ½ σc δmax on the way in mode I */
    history = shv_law_advance(&law, virgin, (ShvOpening){0.0, 0.0}, (ShvOpening){0.3 * end, 0.0});
    check_near(history.dissipated, 0.5 * 8e6 * 0.3 * end, 1e-14);
    history = shv_law_advance(&law, virgin, (ShvOpening){0.0, 0.0}, (ShvOpening){1.2 * end, 0.0});
    check_near(history.dissipated, 20.0, 1e-13);
    history = shv_law_advance(&law, virgin, (ShvOpening){0.0, 0.0}, (ShvOpening){0.0, 1.0});
    check_near(history.dissipated, 50.0, 1e-13);
    check_near(shv_law_traction(&law, virgin, 0.0, 0.0).normal, 8e6, 1e-6);
    check_near(shv_law_traction(&law, virgin, 0.0, 0.0).shear, 6e6, 1e-6);
}

/* In pure opening extrinsic PPR with α = 2 is the linear Camacho-Ortiz law. */
static void linear_laws_agree(void **state)
{
    (void)state;
    const ShvMaterial material = material_of(SHV_CAMACHO_ORTIZ, 22.0, 22.0, 8e6, 8e6, 2.0, 2.0);
    const ShvLaw a = concrete(), b = shv_law_make(&material, 1.0);
    ShvHistory ha = {0}, hb = {0};
    double last = 0.0;
    for (int i = 0; i < 500; i++) {
        const double n = 6e-6 * shv_random_uniform(3, (uint64_t)i) * (i / 500.0);
        ha = shv_law_advance(&a, ha, (ShvOpening){last, 0.0}, (ShvOpening){n, 0.0});
        hb = shv_law_advance(&b, hb, (ShvOpening){last, 0.0}, (ShvOpening){n, 0.0});
        check_near(shv_law_traction(&a, ha, n, 0.0).normal, shv_law_traction(&b, hb, n, 0.0).normal, 8e6 * 1e-12);
        check_near(ha.dissipated, hb.dissipated, 22.0 * 1e-12);
        last = n;
    }
}

static const ShvLaw *some_laws(int *count)
{
    static ShvLaw laws[5];
    const ShvMaterial equal = material_of(SHV_CAMACHO_ORTIZ, 22.0, 22.0, 8e6, 8e6, 2.0, 2.0);
    const ShvMaterial unequal = material_of(SHV_CAMACHO_ORTIZ, 22.0, 70.0, 8e6, 5e6, 2.0, 2.0);
    laws[0] = concrete();
    laws[1] = ppr(22.0, 40.0, 8e6, 5e6, 1.7, 3.2);
    laws[2] = ppr(60.0, 20.0, 8e6, 9e6, 4.0, 1.5);
    laws[3] = shv_law_make(&equal, 1.0);
    laws[4] = shv_law_make(&unequal, 1.3);
    *count = 5;
    return laws;
}

/* Random paths, back and forth: ∫T·dΔ, taken from the law's tractions in fine pieces along the same path (first the normal
   component, then the shear one), is what recoverable and dissipated grow by; dissipation never falls; and no closed path
   yields energy. */
static void random_paths_never_yield_energy(void **state)
{
    (void)state;
    int count;
    const ShvLaw *laws = some_laws(&count);
    for (int l = 0; l < count; l++) {
        const ShvLaw *law = &laws[l];
        const double dn = law->final_opening[0], dt = law->final_opening[1];
        for (uint64_t path = 0; path < 20; path++) {
            ShvHistory history = {0};
            ShvOpening at = {0.0, 0.0};
            double work = 0.0;
            for (uint64_t i = 0; i < 40; i++) {
                const double reach = 0.05 + 0.03 * (double)i;
                const ShvOpening to = {dn * (reach * shv_random_uniform(path, 2 * i) - 0.1 * (i % 3 == 0)),
                                       dt * reach * shv_random_uniform(path, 2 * i + 1)};
                ShvHistory walked = history;
                const ShvOpening corner = {fmax(to.normal, 0.0), at.shear};
                work += work_along(law, &walked, (ShvOpening){fmax(at.normal, 0.0), at.shear}, corner, 400);
                work += work_along(law, &walked, corner, (ShvOpening){corner.normal, to.shear}, 400);
                const double before = history.dissipated;
                history = shv_law_advance(law, history, at, to);
                assert_true(history.dissipated >= before);
                assert_true(shv_law_damage(law, history) >= 0.0 && shv_law_damage(law, history) <= 1.0);
                at = to;
                const double kept = shv_law_recoverable(law, history, at.normal, at.shear) + history.dissipated;
                /* kinks and steep starts cost the midpoint rule a piece each: 1/400 of a peak times a reach */
                check_near(work, kept, 3e-3 * (law->energy[0] + law->energy[1]));
                assert_true(kept >= 0.0);
            }
            assert_true(history.dissipated <= fmax(law->energy[0], law->energy[1]) * (1.0 + 1e-12));
        }
    }
}

static void check_finite(const ShvLaw *law, ShvHistory history, double n, double s)
{
    const ShvLawTraction t = shv_law_traction(law, history, n, s);
    assert_true(isfinite(t.normal) && t.normal >= 0.0);
    assert_true(isfinite(t.shear) && t.shear >= 0.0);
    const ShvHistory next = shv_law_advance(law, history, (ShvOpening){0.0, 0.0}, (ShvOpening){n, s});
    assert_true(isfinite(next.dissipated) && next.dissipated >= 0.0);
    assert_true(isfinite(shv_law_recoverable(law, next, n, s)));
    const double damage = shv_law_damage(law, next);
    assert_true(damage >= 0.0 && damage <= 1.0);
}

static void extremes_stay_finite(void **state)
{
    (void)state;
    const double energies[] = {0.0, 22.0, 1e30, HUGE_VAL}, strengths[] = {0.0, 8e6, 1e40, HUGE_VAL};
    const double openings[] = {-1e-6, 0.0, 1e-300, 5.5e-6, 1e-3, 1e3};
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < 256; i++) {
            const ShvMaterial material =
                material_of(kind ? SHV_CAMACHO_ORTIZ : SHV_PPR, energies[i % 4], energies[i / 4 % 4],
                            strengths[i / 16 % 4], strengths[i / 64], 2.0, 2.5);
            const ShvLaw law = shv_law_make(&material, 1.0);
            for (int a = 0; a < 6; a++)
                for (int b = 1; b < 6; b++) {
                    check_finite(&law, (ShvHistory){0}, openings[a], openings[b]);
                    check_finite(&law, shv_law_grow(&law, (ShvHistory){0}, openings[b], openings[b]), openings[a],
                                 openings[b]);
                }
        }
}

static void limits(void **state)
{
    (void)state;
    const ShvHistory virgin = {0};
    const ShvLaw brittle = ppr(0.0, 0.0, 8e6, 8e6, 2.0, 2.0);
    assert_true(shv_law_traction(&brittle, virgin, 0.0, 0.0).normal == 0.0);
    assert_true(shv_law_damage(&brittle, virgin) == 1.0);
    const ShvLaw loose = ppr(22.0, 22.0, 0.0, 0.0, 2.0, 2.0);
    assert_true(shv_law_traction(&loose, virgin, 1e-9, 1e-9).normal == 0.0);
    assert_true(shv_law_damage(&loose, virgin) == 1.0);
    const ShvLaw tough = ppr(1e30, 1e30, 8e6, 8e6, 2.0, 2.0);
    check_near(shv_law_traction(&tough, virgin, 1.0, 0.0).normal, 8e6, 1e-6);
    check_near(shv_law_normal_mean(&tough, virgin, 0.0, 0.0, 1e-6), 8e6, 1e-6);
    const ShvLaw law = concrete();
    const ShvHistory reached = shv_law_grow(&law, virgin, law.final_opening[0], 0.0);
    assert_true(shv_law_traction(&law, reached, 0.0, 0.0).normal == 0.0);
    assert_true(shv_law_damage(&law, shv_law_advance(&law, virgin, (ShvOpening){0.0, 0.0},
                                                     (ShvOpening){law.final_opening[0], 0.0})) == 1.0);
    const ShvMaterial material = material_of(SHV_PPR, 22.0, 22.0, 8e6, 8e6, 2.0, 2.0);
    const ShvLaw scaled = shv_law_make(&material, 1.25);
    check_near(shv_law_traction(&scaled, virgin, 0.0, 0.0).normal, 1e7, 1e-6);
    check_near(shv_law_normal_mean(&scaled, virgin, 0.0, 0.0, 1.0), 22.0, 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fact_1_peak_and_energies),
        cmocka_unit_test(fact_2_half_way),
        cmocka_unit_test(fact_3_mixed_values),
        cmocka_unit_test(fact_4_monotone_paths_do_the_energy),
        cmocka_unit_test(what_remains_is_the_work_to_come),
        cmocka_unit_test(fact_5_unequal_energies),
        cmocka_unit_test(fact_6_gradient_and_decay),
        cmocka_unit_test(fact_7_cycle),
        cmocka_unit_test(camacho_ortiz_as_published),
        cmocka_unit_test(linear_laws_agree),
        cmocka_unit_test(random_paths_never_yield_energy),
        cmocka_unit_test(extremes_stay_finite),
        cmocka_unit_test(limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
