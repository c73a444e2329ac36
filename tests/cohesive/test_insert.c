#include <stdlib.h>

#include "cohesive/fixture.h"

#include "base/random.h"

static void all_facets(const Fixture *f, int32_t *facets)
{
    for (int32_t i = 0; i < f->model.adjacency.interior_count; i++) facets[i] = i;
}

static void shuffle(int32_t *facets, int32_t count, uint64_t seed)
{
    for (int32_t i = count - 1; i > 0; i--) {
        const int32_t k = (int32_t)(shv_random_bits(seed, (uint64_t)i) % (uint64_t)(i + 1)), kept = facets[i];
        facets[i] = facets[k];
        facets[k] = kept;
    }
}

static double element_mass(const Fixture *f)
{
    double sum = 0.0;
    for (int32_t e = 0; e < f->state.element_count; e++) sum += f->state.element_mass[e];
    return sum;
}

static double node_mass(const Fixture *f)
{
    double sum = 0.0, rest = 0.0; /* compensated, so that the sum itself is not what is measured */
    for (int32_t i = 0; i < f->state.node_count; i++) {
        const double next = sum + f->state.mass[i];
        rest += (sum - next) + f->state.mass[i];
        sum = next;
    }
    return sum + rest;
}

static ShvVec3 momentum(const Fixture *f, double *scale)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    *scale = 0.0;
    for (int32_t i = 0; i < f->state.node_count; i++) {
        const ShvVec3 p = shv_scale(shv_load3(f->state.velocity + 3 * (int64_t)i), f->state.mass[i]);
        sum = shv_add(sum, p);
        *scale += shv_norm(p);
    }
    return sum;
}

static void check_corners(const Fixture *f)
{
    int64_t corners = 0;
    for (int32_t i = 0; i < f->state.node_count; i++) {
        double mass = 0.0;
        assert_true(f->state.corner_count[i] > 0);
        for (int32_t k = 0; k < f->state.corner_count[i]; k++, corners++) {
            const int32_t corner = f->state.corners[f->state.corner_start[i] + k];
            assert_int_equal(shv_state_node(&f->state, corner / 4, corner % 4), i);
            if (k > 0) assert_true(corner > f->state.corners[f->state.corner_start[i] + k - 1]);
            mass += 0.25 * f->state.element_mass[corner / 4];
        }
        assert_true(mass == f->state.mass[i]);
        assert_true(f->state.reference[3 * i] == f->model.mesh.positions[3 * f->state.origin[i]]);
    }
    assert_int_equal(corners, 4 * (int64_t)f->state.element_count);
    for (int32_t lane = f->state.element_count; lane < f->state.batch_count * SHV_LANES; lane++)
        for (int k = 0; k < 4; k++)
            assert_int_equal(f->state.connectivity[shv_corner_slot(lane, k)],
                             shv_state_node(&f->state, f->state.element_count - 1, k));
}

static void everything_at_once(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.03, 0.02, 0.02, 0.005);
    fixture_build(&f);
    for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
        f.state.velocity[i] = shv_random_uniform(1, (uint64_t)i) - 0.3;
    const double elements = element_mass(&f), nodes = node_mass(&f);
    double scale;
    const ShvVec3 before = momentum(&f, &scale);
    const int32_t count = f.model.adjacency.interior_count;
    int32_t *facets = calloc((size_t)count, sizeof *facets), duplicated;
    all_facets(&f, facets);
    const int32_t start = f.state.node_count;
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
    assert_int_equal(f.state.node_count, 4 * f.state.element_count);
    assert_int_equal(duplicated, f.state.node_count - start);
    assert_int_equal(fixture_components(&f), f.state.element_count);
    assert_true(element_mass(&f) == elements);
    check_near(node_mass(&f), nodes, 1e-14 * nodes);
    check_near(shv_norm(shv_sub(momentum(&f, &scale), before)), 0.0, 1e-12 * scale);
    check_corners(&f);
    assert_true(isinf(shv_cohesive_weakest(&f.cohesive, NULL, 0)));
    free(facets);
    fixture_release(&f);
}

static void a_single_facet_splits_nothing(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.03, 0.03, 0.03, 0.005);
    fixture_build(&f);
    int32_t found = -1;
    for (int32_t i = 0; i < f.model.adjacency.interior_count && found < 0; i++) {
        const ShvVec3 x = fixture_facet_centre(&f, i);
        if (shv_norm(x) < 0.004) found = i;
    }
    assert_true(found >= 0);
    int32_t duplicated;
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, &found, 1, &duplicated, &f.error), f.error);
    assert_int_equal(duplicated, 0);
    shv_cohesive_begin(&f.cohesive, &f.state, NULL);
    assert_int_equal(f.cohesive.pair_count, 0);
    check_fails(shv_cohesive_insert(&f.cohesive, &f.state, NULL, &found, 1, &duplicated, &f.error), SHV_BAD_INPUT,
                f.error, "intact");
    assert_int_equal(f.cohesive.count, 1);
    fixture_release(&f);
}

static void a_plane_cuts_in_two(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.04, 0.02, 0.02, 0.005);
    fixture_build_cubes(&f, 8, 4, 4);
    fixture_start(&f);
    int32_t *facets = calloc((size_t)f.model.adjacency.interior_count, sizeof *facets), duplicated;
    const int32_t count = fixture_plane(&f, 0.0, 1e-9, facets);
    assert_true(count > 0);
    int32_t on_plane = 0;
    for (int32_t i = 0; i < f.state.node_count; i++) on_plane += fabs(f.state.reference[3 * i]) < 1e-9;
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
    assert_int_equal(duplicated, on_plane);
    assert_int_equal(fixture_components(&f), 2);
    check_corners(&f);
    shv_cohesive_begin(&f.cohesive, &f.state, NULL);
    assert_int_equal(f.cohesive.pair_count, 3 * count);
    const ShvCohesiveEnergy energy = shv_cohesive_energy(&f.cohesive, &f.state);
    check_near(energy.inserted_area, 0.02 * 0.02, 1e-15);
    assert_int_equal(energy.failed, 0);
    free(facets);
    fixture_release(&f);
}

static void a_rough_cut_separates(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.04, 0.02, 0.02, 0.004);
    fixture_build(&f);
    int32_t *facets = calloc((size_t)f.model.adjacency.interior_count, sizeof *facets), duplicated;
    const int32_t count = fixture_cut(&f, facets);
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
    assert_int_equal(fixture_components(&f), 2);
    check_corners(&f);
    free(facets);
    fixture_release(&f);
}

/* The groups at a node by brute force: corners joined when some intact facet contains both elements and the node. */
static int32_t brute_copies(const Fixture *f, int32_t origin)
{
    const ShvAdjacency *a = &f->model.adjacency;
    const int32_t *corners = a->corners + a->corner_start[origin],
                  count = a->corner_start[origin + 1] - a->corner_start[origin];
    int32_t label[256], groups = count;
    for (int32_t i = 0; i < count; i++) label[i] = i;
    for (int32_t facet = 0; facet < a->interior_count; facet++) {
        if (f->cohesive.facet_cohesive[facet] >= 0) continue;
        int32_t side[2] = {-1, -1};
        for (int s = 0; s < 2; s++)
            for (int32_t i = 0; i < count; i++)
                if (corners[i] / 4 == a->facet_elements[2 * facet + s] &&
                    corners[i] % 4 != a->facet_faces[2 * facet + s])
                    side[s] = i;
        if (side[0] < 0 || side[1] < 0 || label[side[0]] == label[side[1]]) continue;
        const int32_t from = label[side[1]], to = label[side[0]];
        for (int32_t i = 0; i < count; i++)
            if (label[i] == from) label[i] = to;
        groups--;
    }
    return groups;
}

/* In one go, in any order: the same bits. In pieces: the same splits. Cracks at random leave edges and vertices where
   elements meet in nothing else. */
static void order_does_not_matter(void **state)
{
    (void)state;
    uint64_t hash[4];
    for (int run = 0; run < 4; run++) {
        Fixture f;
        fixture_define(&f, 0.03, 0.02, 0.02, 0.005);
        fixture_build(&f);
        const int32_t total = f.model.adjacency.interior_count, count = total / 2;
        int32_t *facets = calloc((size_t)total, sizeof *facets), duplicated, sum = 0;
        all_facets(&f, facets);
        shuffle(facets, total, 17);
        shuffle(facets, count, (uint64_t)run + 100);
        const int32_t pieces = run < 3 ? 1 : 7;
        for (int32_t p = 0; p < pieces; p++) {
            const int32_t begin = count * p / pieces, end = count * (p + 1) / pieces;
            check_ok(
                shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets + begin, end - begin, &duplicated, &f.error),
                f.error);
            sum += duplicated;
            check_corners(&f);
        }
        hash[run] = shv_state_hash(&f.state);
        int32_t copies = 0;
        for (int32_t i = 0; i < f.model.mesh.node_count; i++) copies += brute_copies(&f, i) - 1;
        assert_int_equal(sum, copies);
        free(facets);
        fixture_release(&f);
    }
    assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
}

/* The law of a facet found in any state of stress starts where that state, raised to the criterion's limit if it is below,
   just reaches the peak of one component; the other's suffices too, and energies are kept. */
static void laws_start_at_the_facets_traction(void **state)
{
    (void)state;
    for (uint64_t run = 0; run < 40; run++) {
        Fixture f;
        fixture_define(&f, 0.01, 0.01, 0.01, 0.005);
        f.material.cohesive_strength_shear = 30e6;
        f.material.law = run % 2 ? SHV_CAMACHO_ORTIZ : SHV_PPR;
        fixture_build(&f);
        double s[6];
        for (uint64_t c = 0; c < 6; c++) s[c] = 50e6 * (shv_random_uniform(run, c) - 0.2);
        fixture_stress(&f, s[0], s[1], s[2], s[3], s[4], s[5]);
        const int32_t facet = (int32_t)(run % (uint64_t)f.model.adjacency.interior_count);
        int32_t duplicated;
        check_ok(shv_cohesive_insert(&f.cohesive, &f.state, f.stress, &facet, 1, &duplicated, &f.error), f.error);
        const int32_t e = f.model.adjacency.facet_elements[2 * facet];
        const uint8_t *k = shv_face_corners[f.model.adjacency.facet_faces[2 * facet]];
        const int32_t *nodes = f.model.mesh.elements + 4 * e;
        const ShvVec3 a = shv_mesh_position(&f.model.mesh, nodes[k[0]]);
        const ShvVec3 b = shv_sub(shv_mesh_position(&f.model.mesh, nodes[k[1]]), a);
        const ShvVec3 n = shv_unit(shv_cross(b, shv_sub(shv_mesh_position(&f.model.mesh, nodes[k[2]]), a)));
        const ShvMat3 m = {{{s[0], s[5], s[4]}, {s[5], s[1], s[3]}, {s[4], s[3], s[2]}}};
        const ShvVec3 t = shv_apply(&m, n);
        const double tension = fmax(shv_dot(t, n), 0.0), shear = shv_norm(shv_madd(t, -shv_dot(t, n), n));
        const double whole = hypot(tension / 40e6, shear / 30e6), raised = fmax(1.0, 1.0 / whole);
        const ShvLaw *law = f.cohesive.law;
        const double use = fmax(raised * tension / law->strength[0], raised * shear / law->strength[1]);
        check_near(use, 1.0, 1e-12);
        check_near(law->strength[1] / law->strength[0], 0.75, 1e-14);
        assert_true(law->strength[0] >= 40e6 * sqrt(0.5) * (1.0 - 1e-12));
        assert_true(law->strength[0] <= 40e6 * fmax(whole, 1.0) * (1.0 + 1e-12));
        check_near(law->energy[0], 8.0, 0.0);
        fixture_release(&f);
    }
}

/* Two by two cubes meet in the plane x = 0, two facets each; nothing else may open. */
static void cracks_keep_to_their_plane(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.02, 0.02, 0.01);
    f.scene.fracture.on = (ShvSelection){.kind = SHV_SELECT_PLANE, .plane_normal = {1.0, 0.0, 0.0}, .tolerance = 1e-9};
    fixture_build_cubes(&f, 2, 2, 2);
    fixture_start(&f);
    int32_t free_to_open = 0;
    for (int32_t i = 0; i < f.model.adjacency.interior_count; i++) {
        const int32_t e = f.model.adjacency.facet_elements[2 * i];
        const uint8_t *corners = shv_face_corners[f.model.adjacency.facet_faces[2 * i]];
        double farthest = 0.0;
        for (int k = 0; k < 3; k++)
            farthest =
                fmax(farthest, fabs(shv_mesh_position(&f.model.mesh, f.model.mesh.elements[4 * e + corners[k]]).x));
        assert_true(isfinite(f.cohesive.facet_strength[i]) == (farthest == 0.0));
        free_to_open += farthest == 0.0;
    }
    assert_int_equal(free_to_open, 8);
    fixture_release(&f);
}

static void failure_changes_nothing(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.02, 0.02, 0.005);
    fixture_build(&f);
    const int32_t count = f.model.adjacency.interior_count;
    int32_t *facets = calloc((size_t)count, sizeof *facets), duplicated;
    all_facets(&f, facets);
    const uint64_t before = shv_state_hash(&f.state);
    int failures = 0;
    for (int64_t allowed = 0;; allowed++) {
        shv_memory_fail_after(f.memory, allowed);
        const ShvStatus status = shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error);
        shv_memory_fail_after(f.memory, -1);
        if (status == SHV_OK) break;
        failures++;
        assert_int_equal(status, SHV_NO_MEMORY);
        assert_int_equal(f.cohesive.count, 0);
        assert_int_equal(duplicated, 0);
        assert_true(shv_state_hash(&f.state) == before);
        for (int32_t i = 0; i < count; i++) assert_int_equal(f.cohesive.facet_cohesive[i], -1);
    }
    assert_true(failures > 10);
    assert_int_equal(f.state.node_count, 4 * f.state.element_count);
    free(facets);
    fixture_release(&f);
}

static void creation_fails_cleanly(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.02, 0.02, 0.01);
    f.scene.fracture.criterion = SHV_CRITERION_PRINCIPAL;
    fixture_build(&f);
    shv_cohesive_release(&f.cohesive);
    int failures = 0;
    for (int64_t allowed = 0;; allowed++) {
        shv_memory_fail_after(f.memory, allowed);
        const ShvStatus status = shv_cohesive_create(&f.cohesive, &f.model, &f.scene.fracture, &f.error);
        shv_memory_fail_after(f.memory, -1);
        if (status == SHV_OK) break;
        failures++;
        assert_int_equal(status, SHV_NO_MEMORY);
        assert_int_equal(shv_memory_bytes(f.memory, SHV_PART_COHESIVE), 0);
    }
    assert_true(failures >= 8);
    fixture_release(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_at_once),         cmocka_unit_test(a_single_facet_splits_nothing),
        cmocka_unit_test(a_plane_cuts_in_two),        cmocka_unit_test(a_rough_cut_separates),
        cmocka_unit_test(order_does_not_matter),      cmocka_unit_test(laws_start_at_the_facets_traction),
        cmocka_unit_test(cracks_keep_to_their_plane), cmocka_unit_test(failure_changes_nothing),
        cmocka_unit_test(creation_fails_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
