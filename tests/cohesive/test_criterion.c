#include <stdlib.h>

#include "cohesive/fixture.h"

#include "base/random.h"

static ShvVec3 facet_normal(const Fixture *f, int32_t facet)
{
    const ShvAdjacency *a = &f->model.adjacency;
    const int32_t e = a->facet_elements[2 * (int64_t)facet];
    const uint8_t *c = shv_face_corners[a->facet_faces[2 * (int64_t)facet]];
    const ShvVec3 p = shv_state_position(&f->state, shv_state_node(&f->state, e, c[0]));
    const ShvVec3 q = shv_state_position(&f->state, shv_state_node(&f->state, e, c[1]));
    const ShvVec3 r = shv_state_position(&f->state, shv_state_node(&f->state, e, c[2]));
    return shv_unit(shv_cross(shv_sub(q, p), shv_sub(r, p)));
}

static void random_stress(Fixture *f, double scale, uint64_t seed)
{
    const int64_t count = 6 * SHV_LANES * (int64_t)f->state.batch_count;
    for (int64_t i = 0; i < count; i++) f->stress[i] = scale * (shv_random_uniform(seed, (uint64_t)i) - 0.4);
}

static double brute(const Fixture *f, int32_t facet, double beta)
{
    const int32_t *e = f->model.adjacency.facet_elements + 2 * (int64_t)facet;
    double s[6];
    for (int c = 0; c < 6; c++)
        s[c] = 0.5 * (f->stress[(e[0] / 8) * 48 + c * 8 + e[0] % 8] + f->stress[(e[1] / 8) * 48 + c * 8 + e[1] % 8]);
    const ShvVec3 n = facet_normal(f, facet);
    const ShvMat3 m = {{{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}}};
    const ShvVec3 t = shv_apply(&m, n);
    const double tn = shv_dot(t, n), tt = sqrt(fmax(shv_dot(t, t) - tn * tn, 0.0));
    return sqrt(fmax(tn, 0.0) * fmax(tn, 0.0) + tt * tt / (beta * beta)) / f->cohesive.facet_strength[facet];
}

static void matches_brute_force(void **state)
{
    (void)state;
    for (int run = 0; run < 4; run++) {
        Fixture f;
        fixture_define(&f, 0.03, 0.02, 0.02, 0.004);
        f.material.cohesive_strength_shear = run % 2 ? 25e6 : 60e6;
        f.material.weibull_modulus = run < 2 ? 0.0 : 6.0;
        f.scene.threads = run == 3 ? 4 : 1;
        fixture_build(&f);
        random_stress(&f, run == 0 ? 1e6 : 80e6, 5);
        const int32_t facets = f.model.adjacency.interior_count;
        int32_t *found = calloc((size_t)facets, sizeof *found), count, expected = 0;
        double *over = calloc((size_t)facets, sizeof *over), largest = 0.0;
        shv_cohesive_watch(&f.cohesive, &f.state, NULL);
        const double got = shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count);
        for (int32_t i = 0; i < facets; i++) {
            const double value = brute(&f, i, f.material.cohesive_strength_shear / 40e6);
            largest = fmax(largest, value);
            expected += value >= f.scene.fracture.threshold;
        }
        check_near(got, largest, 1e-12 * largest);
        assert_int_equal(count, expected);
        assert_true(run == 0 ? count == 0 : count > 10);
        for (int32_t i = 0; i < count; i++) {
            check_near(over[i], brute(&f, found[i], f.material.cohesive_strength_shear / 40e6), 1e-7 * over[i]);
            if (i > 0) assert_true(over[i] < over[i - 1] || (over[i] == over[i - 1] && found[i] > found[i - 1]));
        }
        free(found);
        free(over);
        fixture_release(&f);
    }
}

static void same_bits_for_any_threads(void **state)
{
    (void)state;
    int32_t counts[2], *found[2];
    double *over[2], largest[2];
    for (int run = 0; run < 2; run++) {
        Fixture f;
        fixture_define(&f, 0.03, 0.03, 0.02, 0.003);
        f.scene.threads = run ? 3 : 1;
        fixture_build(&f);
        random_stress(&f, 90e6, 11);
        const size_t facets = (size_t)f.model.adjacency.interior_count;
        found[run] = calloc(facets, sizeof(int32_t));
        over[run] = calloc(facets, sizeof(double));
        shv_cohesive_watch(&f.cohesive, &f.state, NULL);
        largest[run] =
            shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found[run], over[run], &counts[run]);
        fixture_release(&f);
    }
    assert_int_equal(counts[0], counts[1]);
    assert_true(largest[0] == largest[1]);
    assert_memory_equal(found[0], found[1], (size_t)counts[0] * sizeof(int32_t));
    assert_memory_equal(over[0], over[1], (size_t)counts[0] * sizeof(double));
    for (int run = 0; run < 2; run++) {
        free(found[run]);
        free(over[run]);
    }
}

/* Uniform tension along x: facets across it carry all of it, and what is turned with the body is judged alike. */
static void uniform_tension_and_rotation(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.04, 0.02, 0.02, 0.005);
    fixture_build_cubes(&f, 8, 4, 4);
    fixture_start(&f);
    const int32_t facets = f.model.adjacency.interior_count;
    int32_t *found = calloc((size_t)facets, sizeof *found), *turned = calloc((size_t)facets, sizeof *turned), count,
            again;
    double *over = calloc((size_t)facets, sizeof *over);
    fixture_stress(&f, 38e6, 0.0, 0.0, 0.0, 0.0, 0.0);
    shv_cohesive_watch(&f.cohesive, &f.state, NULL);
    check_near(shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count), 0.95, 1e-12);
    assert_int_equal(count, 7 * 4 * 4 * 2);
    for (int32_t i = 0; i < count; i++) check_near(facet_normal(&f, found[i]).y, 0.0, 1e-12);
    /* everything turned by 90° about z: x → y */
    for (int32_t i = 0; i < f.state.node_count; i++) {
        const double *x = f.state.reference + 3 * i;
        shv_store3(f.state.displacement + 3 * i, shv_vec3(-x[1] - x[0], x[0] - x[1], 0.0));
    }
    fixture_stress(&f, 0.0, 38e6, 0.0, 0.0, 0.0, 0.0);
    shv_cohesive_watch(&f.cohesive, &f.state, NULL);
    check_near(shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, turned, over, &again), 0.95, 1e-12);
    assert_int_equal(again, count);
    uint8_t *hit = calloc((size_t)facets, 1);
    for (int32_t i = 0; i < count; i++) hit[found[i]] = 1;
    for (int32_t i = 0; i < count; i++) assert_true(hit[turned[i]]);
    /* nothing is judged in what sleeps */
    const uint8_t awake[1] = {0};
    shv_cohesive_watch(&f.cohesive, &f.state, awake);
    assert_true(shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count) == 0.0);
    assert_int_equal(count, 0);
    fixture_stress(&f, -1e9, -1e9, -1e9, 0.0, 0.0, 0.0);
    shv_cohesive_watch(&f.cohesive, &f.state, NULL);
    assert_true(shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count) < 1e-12);
    free(hit);
    free(found);
    free(turned);
    free(over);
    fixture_release(&f);
}

static void zero_and_infinite_strength(void **state)
{
    (void)state;
    for (int run = 0; run < 2; run++) {
        Fixture f;
        fixture_define(&f, 0.02, 0.02, 0.02, 0.005);
        f.material.cohesive_strength = 0.0;
        fixture_build(&f);
        if (run == 1)
            for (int32_t i = 0; i < f.model.adjacency.interior_count; i++) f.cohesive.facet_strength[i] = HUGE_VAL;
        const int32_t facets = f.model.adjacency.interior_count;
        int32_t *found = calloc((size_t)facets, sizeof *found), count;
        double *over = calloc((size_t)facets, sizeof *over);
        fixture_stress(&f, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0);
        shv_cohesive_watch(&f.cohesive, &f.state, NULL);
        const double largest = shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count);
        assert_int_equal(count, run == 0 ? facets : 0);
        assert_true(run == 0 ? isinf(largest) : largest == 0.0);
        assert_true(run == 0 ? shv_cohesive_weakest(&f.cohesive, NULL, 0) == 0.0
                             : isinf(shv_cohesive_weakest(&f.cohesive, NULL, 0)));
        int32_t duplicated;
        if (run == 0) {
            check_ok(shv_cohesive_insert(&f.cohesive, &f.state, f.stress, found, count, &duplicated, &f.error),
                     f.error);
            shv_cohesive_begin(&f.cohesive, &f.state, NULL);
            shv_cohesive_pull(&f.cohesive, &f.state, 1e-7, 1e-7);
            for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++) assert_true(f.state.velocity[i] == 0.0);
            ShvLedger ledger = {0};
            shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
            assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).failed, facets);
        }
        free(found);
        free(over);
        fixture_release(&f);
    }
}

static void principal_takes_the_weakest_corner(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.02, 0.02, 0.004);
    f.scene.fracture.criterion = SHV_CRITERION_PRINCIPAL;
    fixture_build(&f);
    const int32_t facets = f.model.adjacency.interior_count, nodes = f.state.node_count;
    double *nodal = calloc(6 * (size_t)nodes, sizeof *nodal), *over = calloc((size_t)facets, sizeof *over),
           largest = 0.0;
    int32_t *found = calloc((size_t)facets, sizeof *found), count, expected = 0;
    /* equal in all directions: the principal stress is known without an eigenvalue solver */
    for (int32_t i = 0; i < nodes; i++)
        for (int c = 0; c < 3; c++) nodal[6 * i + c] = 60e6 * (shv_random_uniform(2, (uint64_t)i) - 0.05);
    shv_cohesive_watch(&f.cohesive, &f.state, NULL);
    const double got = shv_cohesive_candidates(&f.cohesive, &f.state, NULL, nodal, found, over, &count);
    for (int32_t i = 0; i < facets; i++) {
        const int32_t e = f.model.adjacency.facet_elements[2 * i];
        const uint8_t *c = shv_face_corners[f.model.adjacency.facet_faces[2 * i]];
        double least = HUGE_VAL;
        for (int k = 0; k < 3; k++) least = fmin(least, nodal[6 * shv_state_node(&f.state, e, c[k])]);
        largest = fmax(largest, least / 40e6);
        expected += least / 40e6 >= f.scene.fracture.threshold;
    }
    check_near(got, largest, 1e-12);
    assert_int_equal(count, expected);
    free(nodal);
    free(found);
    free(over);
    fixture_release(&f);
}

/* Nodes and facets that bounds leave out change nothing: against eigenvalues of all, below and above the threshold. */
static void principal_matches_brute_force(void **state)
{
    (void)state;
    for (int run = 0; run < 4; run++) {
        Fixture f;
        fixture_define(&f, 0.03, 0.02, 0.02, 0.004);
        f.scene.fracture.criterion = SHV_CRITERION_PRINCIPAL;
        f.material.weibull_modulus = run % 2 ? 6.0 : 0.0;
        f.scene.threads = run == 3 ? 3 : 1;
        fixture_build(&f);
        const int32_t facets = f.model.adjacency.interior_count, nodes = f.state.node_count;
        double *nodal = calloc(6 * (size_t)nodes, sizeof *nodal), *over = calloc((size_t)facets, sizeof *over);
        double *principal = calloc((size_t)nodes, sizeof *principal), largest = 0.0;
        int32_t *found = calloc((size_t)facets, sizeof *found), count, expected = 0;
        for (int32_t i = 0; i < nodes; i++) {
            double *s = nodal + 6 * (int64_t)i;
            for (int c = 0; c < 6; c++)
                s[c] = (run < 2 ? 5e6 : 80e6) * (shv_random_uniform(9, (uint64_t)(6 * i + c)) - (c < 3 ? 0.3 : 0.5));
            principal[i] = shv_largest_principal(s);
        }
        shv_cohesive_watch(&f.cohesive, &f.state, NULL);
        const double got = shv_cohesive_candidates(&f.cohesive, &f.state, NULL, nodal, found, over, &count);
        for (int32_t i = 0; i < facets; i++) {
            const int32_t e = f.model.adjacency.facet_elements[2 * i];
            const uint8_t *c = shv_face_corners[f.model.adjacency.facet_faces[2 * i]];
            double least = HUGE_VAL;
            for (int k = 0; k < 3; k++) least = fmin(least, principal[shv_state_node(&f.state, e, c[k])]);
            const double value = fmax(least, 0.0) / f.cohesive.facet_strength[i];
            largest = fmax(largest, value);
            expected += value >= f.scene.fracture.threshold;
        }
        assert_true(got == largest);
        assert_int_equal(count, expected);
        assert_true(run < 2 ? count == 0 : count > 10 && over[0] == largest);
        free(nodal);
        free(principal);
        free(found);
        free(over);
        fixture_release(&f);
    }
}

/* Weibull: P(strength < s) = 1 − exp(−(s/s0)^m V/V0). */
static void weibull_scatter(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.04, 0.04, 0.04, 0.004);
    f.material.weibull_modulus = 5.0;
    f.scene.seed = 77;
    fixture_build(&f);
    const int32_t facets = f.model.adjacency.interior_count;
    int32_t below = 0;
    for (int32_t i = 0; i < facets; i++) {
        below += f.cohesive.facet_strength[i] < 40e6;
        assert_true(f.cohesive.facet_strength[i] == 40e6 * shv_cohesive_strength_scale(&f.model, i));
    }
    const double share = 1.0 - exp(-1.0);
    assert_true(facets > 5000);
    check_near((double)below / facets, share, 4.0 * sqrt(share * (1.0 - share) / facets));
    const double plain = shv_cohesive_strength_scale(&f.model, 3);
    f.model.materials[0].weibull_volume = 32.0 * 0.25 *
                                          (shv_mesh_element_volume(&f.model.mesh, f.model.adjacency.facet_elements[6]) +
                                           shv_mesh_element_volume(&f.model.mesh, f.model.adjacency.facet_elements[7]));
    check_near(shv_cohesive_strength_scale(&f.model, 3) / plain, 2.0, 1e-13);
    fixture_release(&f);
}

/* A body of the volume or surface that the strength belongs to has it with a probability of 1/e, whatever its mesh: the weakest of its nodes. */
static void flaws_at_nodes_are_those_of_the_body(void **state)
{
    (void)state;
    enum { BODIES = 400 };
    for (int i = 0; i < 4; i++) {
        Fixture f;
        int whole = 0;
        fixture_define(&f, 0.02, 0.02, 0.02, i % 2 ? 0.004 : 0.007);
        f.material.weibull_modulus = 7.0;
        f.material.weibull_volume = i < 2 ? 0.02 * 0.02 * 0.02 : 0.0;
        f.material.weibull_area = i < 2 ? 0.0 : 6.0 * 0.02 * 0.02;
        fixture_build(&f);
        for (int body = 0; body < BODIES; body++) {
            double weakest = (double)INFINITY;
            f.model.seed = (uint64_t)body;
            for (int32_t node = 0; node < f.model.mesh.node_count; node++)
                weakest = fmin(weakest, shv_cohesive_node_strength(&f.model, node));
            whole += weakest > 40e6;
        }
        const double share = exp(-1.0);
        check_near((double)whole / BODIES, share, 3.0 * sqrt(share * (1.0 - share) / BODIES));
        fixture_release(&f);
    }
}

/* Under a pressure from all sides a plane of facets bears c + p tan φ in shear, no more under tension than without friction:
   facet by facet, and node by node. */
static void pressure_adds_friction(void **state)
{
    (void)state;
    const double pressure = 100e6, cohesion = 60e6, degrees = 30.0,
                 bears = cohesion + pressure * tan(degrees * 0.017453292519943295);
    const ShvCriterion criteria[] = {SHV_CRITERION_TRACTION, SHV_CRITERION_FORCE};
    for (int i = 0; i < 2; i++) {
        Fixture f;
        fixture_define(&f, 0.02, 0.02, 0.02, 0.005);
        f.scene.fracture.criterion = criteria[i];
        f.scene.fracture.threshold = 1.0;
        f.material.cohesive_strength_shear = cohesion;
        f.material.friction_angle_degrees = degrees;
        fixture_build_cubes(&f, 4, 4, 4);
        fixture_start(&f);
        int32_t *candidates = calloc((size_t)f.model.adjacency.interior_count, sizeof *candidates), count;
        double *overstress = calloc((size_t)f.model.adjacency.interior_count, sizeof *overstress);
        const double shares[] = {0.97, 1.04}; /* where nothing has cracked, 3 % more are asked for */
        for (int k = 0; k < 2; k++) {
            const double shear = shares[k] * bears;
            shv_cohesive_watch(&f.cohesive, &f.state, NULL);
            fixture_stress(&f, -pressure, -pressure, -pressure, 0.0, 0.0, shear);
            const double largest =
                shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, candidates, overstress, &count);
            check_near(largest, shares[k], 1e-9);
            assert_true(k == 0 ? count == 0 : count > 0);
        }
        fixture_stress(&f, 30e6, 0.0, 0.0, 0.0, 0.0, 0.0);
        check_near(shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, candidates, overstress, &count),
                   30.0 / 40.0, 1e-9);
        free(candidates);
        free(overstress);
        fixture_release(&f);
    }
}

static void friction_needs_a_criterion_of_shear(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.02, 0.02, 0.01);
    f.scene.fracture.criterion = SHV_CRITERION_PRINCIPAL;
    f.material.friction_angle_degrees = 30.0;
    fixture_build_cubes(&f, 2, 2, 2);
    check_fails(shv_cohesive_create(&f.cohesive, &f.model, &f.scene.fracture, &f.error), SHV_BAD_INPUT, f.error,
                "friction_angle");
    shv_model_release(&f.model);
    shv_memory_destroy(f.memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pressure_adds_friction),
        cmocka_unit_test(friction_needs_a_criterion_of_shear),
        cmocka_unit_test(matches_brute_force),
        cmocka_unit_test(same_bits_for_any_threads),
        cmocka_unit_test(uniform_tension_and_rotation),
        cmocka_unit_test(zero_and_infinite_strength),
        cmocka_unit_test(principal_takes_the_weakest_corner),
        cmocka_unit_test(principal_matches_brute_force),
        cmocka_unit_test(weibull_scatter),
        cmocka_unit_test(flaws_at_nodes_are_those_of_the_body),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
