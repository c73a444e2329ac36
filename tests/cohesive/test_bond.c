/* Whether a facet joins its two tets, against the tractions that its law still shows. */
#include "cohesive/fixture.h"

#include "base/random.h"

/* All facets of a box, as soon as its points have the histories that the test gives them. */
static void insert_all(Fixture *f)
{
    int32_t *facets = calloc((size_t)f->model.adjacency.interior_count, sizeof *facets), duplicated;
    assert_non_null(facets);
    for (int32_t i = 0; i < f->model.adjacency.interior_count; i++) facets[i] = i;
    check_ok(shv_cohesive_insert(&f->cohesive, &f->state, NULL, facets, f->model.adjacency.interior_count, &duplicated,
                                 &f->error),
             f->error);
    free(facets);
}

static double uniform(uint64_t index)
{
    return shv_random_uniform(3, index);
}

/* The traction that it takes to open a point, at zero slip, to where it was once: its normal strength. */
static double strength_left(const ShvLaw *law, ShvHistory history)
{
    const double reach = history.normal > 0.0 ? history.normal : 1e-12 * law->final_opening[SHV_NORMAL];
    return shv_law_traction(law, history, reach, 0.0).normal;
}

static void check_flags(ShvCohesiveLaw kind, double shear_energy, int32_t *failed)
{
    Fixture f;
    fixture_define(&f, 0.02, 0.01, 0.01, 0.003);
    f.material.law = kind;
    f.material.fracture_energy_shear = shear_energy;
    f.material.cohesive_strength_shear = 100e6;
    fixture_build(&f);
    insert_all(&f);
    *failed = 0;
    for (int32_t i = 0; i < f.cohesive.count; i++)
        for (int64_t k = 3 * (int64_t)i; k < 3 * (int64_t)i + 3; k++) {
            const ShvLaw *law = &f.cohesive.law[i];
            const double n = law->final_opening[SHV_NORMAL], s = law->final_opening[SHV_SHEAR];
            /* three points in four are far gone, so that whole facets fail, too */
            const double share = uniform(2 * (uint64_t)k) < 0.75 ? 0.98 + 0.03 * uniform(7 * (uint64_t)k) : 0.5;
            const double normal = uniform(5 * (uint64_t)k) < 0.5 ? share * n : 0.0;
            f.cohesive.internal[k].history =
                shv_law_grow(law, f.cohesive.internal[k].history, normal, normal > 0.0 ? 0.0 : share * s);
        }
    ShvLedger ledger = {0};
    shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
    for (int32_t i = 0; i < f.cohesive.count; i++) {
        bool holds = false;
        for (int64_t k = 3 * (int64_t)i; k < 3 * (int64_t)i + 3; k++)
            holds |= strength_left(&f.cohesive.law[i], f.cohesive.internal[k].history) >
                     0.01 * f.cohesive.law[i].strength[SHV_NORMAL];
        assert_int_equal(f.cohesive.bonded[i], holds);
        assert_int_equal(shv_cohesive_joins(&f.cohesive, f.cohesive.facet[i]), holds);
        *failed += !holds;
    }
    assert_int_equal(f.cohesive.failed_count, *failed);
    assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).failed, *failed);
    assert_true(ledger.released == 0.0); /* nothing was torn */
    shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
    assert_int_equal(f.cohesive.failed_count, 0); /* each is told once */
    fixture_release(&f);
}

static void flags_are_the_law_s(void **state)
{
    (void)state;
    static const double shear_energies[] = {8.0, 80.0, 4.0};
    for (int kind = 0; kind < 2; kind++)
        for (int i = 0; i < 3; i++) {
            int32_t failed;
            check_flags(kind ? SHV_CAMACHO_ORTIZ : SHV_PPR, shear_energies[i], &failed);
            assert_in_range(failed, 20, 100000);
        }
}

/* With ten times the energy in shear, slip takes all of the tension while the damage is small: no bond for all that. */
static void slip_takes_the_tension(void **state)
{
    (void)state;
    ShvMaterial material = {.law = SHV_PPR,
                            .fracture_energy = {10.0, 100.0},
                            .strength = {2e6, 20e6},
                            .shape = {2.0, 2.0},
                            .breakable = true};
    const ShvLaw law = shv_law_make(&material, 1.0);
    const double conjugate = law.final_opening[SHV_SHEAR] * (1.0 - sqrt(0.9));
    const ShvHistory slipped = shv_law_grow(&law, (ShvHistory){0}, 0.0, conjugate);
    assert_true(shv_law_residual(&law, slipped) < 1e-12);
    assert_true(shv_law_traction(&law, slipped, 0.0, conjugate).shear > 0.9 * law.strength[SHV_SHEAR]);
    assert_true(shv_law_damage(&law, slipped) < 0.2);
    check_near(shv_law_residual(&law, (ShvHistory){0}), 1.0, 0.0);
}

/* A facet that hangs on one corner, the others open by a tenth of an edge, or slipped by it, is torn; what was stored in it is
   released. */
static void check_one_corner(int mode)
{
    Fixture f;
    fixture_define(&f, 0.01, 0.01, 0.01, 0.005);
    fixture_build(&f);
    insert_all(&f);
    const ShvLaw *law = &f.cohesive.law[0];
    const double edge = sqrt(f.cohesive.area[0] * 4.0 / sqrt(3.0)), half = 0.5 * law->final_opening[SHV_NORMAL];
    f.cohesive.internal[0].history =
        shv_law_grow(law, f.cohesive.internal[0].history, half, 0.0); /* this corner holds, and stores */
    f.cohesive.internal[0].opening.normal = half;
    const double stored =
        f.cohesive.area[0] / 3.0 * shv_law_recoverable(law, f.cohesive.internal[0].history, half, 0.0);
    ShvLedger ledger = {0};
    for (int k = 1; k < 3; k++) {
        ShvInternalVariables *internal = &f.cohesive.internal[k];
        internal->history = shv_law_tear(law, internal->history);
        *(mode == SHV_NORMAL ? &internal->opening.normal : &internal->opening.shear) = (k == 1 ? 0.1 : 0.04) * edge;
    }
    shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
    assert_int_equal(f.cohesive.failed_count, 1);
    assert_int_equal(f.cohesive.failed[0], 0);
    check_near(ledger.released, stored, 1e-12 * stored);
    assert_true(stored > 0.0 && shv_cohesive_residual(&f.cohesive, 0) == 0.0);
    fixture_release(&f);
}

static void one_corner_holds_nothing(void **state)
{
    (void)state;
    check_one_corner(SHV_NORMAL);
    check_one_corner(SHV_SHEAR);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(flags_are_the_law_s), cmocka_unit_test(slip_takes_the_tension),
                                       cmocka_unit_test(one_corner_holds_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
