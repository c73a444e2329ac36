#include "cohesive/fixture.h"

#include "cohesive/inspection.h"

static const double strength = 40e6, thickness = 0.008;

static void build(Fixture *f, ShvUnresolved unresolved, double energy)
{
    fixture_define(f, 0.03, 0.02, thickness, 0.004);
    f->scene.fracture.criterion = SHV_CRITERION_FORCE;
    f->scene.fracture.threshold = 1.0;
    f->material.unresolved = unresolved;
    f->material.fracture_energy = energy;
    fixture_build(f);
    shv_cohesive_watch(&f->cohesive, &f->state, NULL);
}

/* Bent about y, free to curl about x: `tension` in the upper surface along x. */
static void bend(Fixture *f, double tension)
{
    const double curvature = tension / f->material.youngs_modulus / (0.5 * thickness);
    const double ratio = f->material.poissons_ratio;
    for (int32_t node = 0; node < f->state.node_count; node++) {
        const double *at = f->state.reference + 3 * (int64_t)node;
        double *moved = f->state.displacement + 3 * (int64_t)node;
        moved[0] = curvature * at[0] * at[2];
        moved[1] = -ratio * curvature * at[1] * at[2];
        moved[2] = 0.5 * curvature * (ratio * (at[1] * at[1] - at[2] * at[2]) - at[0] * at[0]);
    }
}

/* Facets that part where tets carry half the strength, as those of a coarse mesh do that is bent. */
static int32_t choose(Fixture *f, int32_t *candidates, double tension)
{
    const size_t facets = (size_t)f->model.adjacency.interior_count;
    double *overstress = shv_allocate(f->memory, SHV_PART_GENERAL, facets, sizeof *overstress);
    int32_t count = 0;
    assert_non_null(overstress);
    bend(f, tension);
    fixture_stress(f, 0.5 * strength, 0.0, 0.0, 0.0, 0.0, 0.0);
    shv_cohesive_candidates(&f->cohesive, &f->state, f->stress, NULL, candidates, overstress, &count);
    for (int32_t k = 0; k < count; k++) check_near(overstress[k], tension / strength, 0.1);
    shv_release(overstress);
    return count;
}

static int32_t *room(const Fixture *f)
{
    int32_t *candidates =
        shv_allocate(f->memory, SHV_PART_GENERAL, (size_t)f->model.adjacency.interior_count, sizeof *candidates);
    assert_non_null(candidates);
    return candidates;
}

static void the_surface_tells_its_stress(void **state)
{
    (void)state;
    Fixture f;
    build(&f, SHV_UNRESOLVED_TIP_STRENGTH, 8.0);
    bend(&f, strength);
    fixture_stress(&f, 0.5 * strength, 0.0, 0.0, 0.0, 0.0, 0.0);
    int32_t looked_at = 0;
    for (int32_t node = 0; node < f.state.node_count; node++) {
        const double *at = f.state.reference + 3 * (int64_t)node;
        const ShvSurfaceTension tension = shv_initiation_tension(&f.cohesive, &f.state, node);
        if (fabs(at[0]) > 0.014 || fabs(at[1]) > 0.009) continue;
        if (fabs(at[2]) < 0.49 * thickness) assert_true(tension.stress == 0.0); /* inside */
        if (at[2] < 0.49 * thickness) continue;
        check_near(tension.stress, strength, 0.01 * strength);
        check_near(fabs(tension.direction.x), 1.0, 1e-4);
        looked_at++;
    }
    assert_true(looked_at > 10);
    fixture_release(&f);
}

/* The disk parts at the strength of the surface, on the side under tension, and holds what its tets carry, with the energy of the plane that it covers. */
static void cracks_begin_at_the_strength_of_the_surface(void **state)
{
    (void)state;
    Fixture f;
    int32_t duplicated;
    build(&f, SHV_UNRESOLVED_TIP_STRENGTH, 8.0);
    int32_t *candidates = room(&f);
    assert_int_equal(choose(&f, candidates, 0.9 * strength), 0);
    const int32_t count = choose(&f, candidates, 1.1 * strength);
    assert_true(count > 0);
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, f.stress, candidates, count, &duplicated, &f.error), f.error);
    assert_true(duplicated > 0);
    for (int32_t k = 0; k < count; k++) {
        const ShvLaw *law = &f.cohesive.law[k];
        assert_true(fixture_facet_centre(&f, f.cohesive.facet[k]).z > 0.0);
        assert_true(law->strength[SHV_NORMAL] <= 0.5 * strength && law->strength[SHV_NORMAL] > 0.05 * strength);
        const double along = f.cohesive.search.facet_along[f.cohesive.facet[k]]; /* tension leans at the strip's rims */
        check_near(law->energy[SHV_NORMAL], 8.0 * fmax(along, 0.1), 1e-12);
    }
    /* next to them nothing else begins at once */
    const int32_t more = choose(&f, candidates, 1.1 * strength);
    for (int32_t k = 0; k < more; k++)
        for (int side = 0; side < 2; side++) {
            const int32_t element = f.model.adjacency.facet_elements[2 * (int64_t)candidates[k] + side];
            for (int face = 0; face < 4; face++) {
                const int32_t facet = f.model.adjacency.element_facets[4 * (int64_t)element + face];
                assert_true(facet >= f.model.adjacency.interior_count || f.cohesive.facet_cohesive[facet] < 0);
            }
        }
    shv_release(candidates);
    fixture_release(&f);
}

/* Other words, and materials whose zone the mesh resolves (10⁵ J/m²: σ_tip above the strength), go by force. */
static void force_decides_elsewhere(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        Fixture f;
        build(&f, i ? SHV_UNRESOLVED_TIP_STRENGTH : SHV_UNRESOLVED_KEEP, i ? 1e5 : 8.0);
        int32_t *candidates = room(&f);
        assert_int_equal(choose(&f, candidates, 1.3 * strength), 0);
        shv_release(candidates);
        fixture_release(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_surface_tells_its_stress),
        cmocka_unit_test(cracks_begin_at_the_strength_of_the_surface),
        cmocka_unit_test(force_decides_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
