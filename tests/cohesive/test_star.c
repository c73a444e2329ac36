#include <stdlib.h>

#include "cohesive/fixture.h"

#include "base/random.h"
#include "cohesive/inspection.h"
#include "cohesive/topology.h"
#include "cohesive/traction.h"

static const double strength = 40e6;

static void build(Fixture *f, double jitter)
{
    fixture_define(f, 0.03, 0.02, 0.02, 0.005);
    f->scene.fracture.criterion = SHV_CRITERION_FORCE;
    f->scene.fracture.threshold = 1.0;
    f->object.mesh.jitter = jitter;
    fixture_build(f);
    shv_cohesive_watch(&f->cohesive, &f->state, NULL);
}

static ShvVec3 corner(const Fixture *f, int32_t element, int place)
{
    return shv_state_position(&f->state, shv_state_node(&f->state, element, place));
}

/* Outward at the first of a facet's elements. */
static ShvVec3 facet_area(const Fixture *f, int32_t facet)
{
    const int32_t element = f->model.adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t *c = shv_face_corners[f->model.adjacency.facet_faces[2 * (int64_t)facet]];
    const ShvVec3 start = corner(f, element, c[0]);
    return shv_scale(shv_cross(shv_sub(corner(f, element, c[1]), start), shv_sub(corner(f, element, c[2]), start)),
                     0.5);
}

static int place_of(const int32_t *corners, int32_t count, int32_t element)
{
    for (int i = 0; i < count; i++)
        if (corners[i] / 4 == element) return i;
    return -1;
}

/* Pull along x over what holds, of a group of a node's tets in uniform tension along x, β = 1: a facet holds strength × area. */
static double ratio_of(const Fixture *f, int32_t node, uint32_t group, double tension)
{
    const int32_t *corners = f->state.corners + f->state.corner_start[node], count = f->state.corner_count[node];
    double pull = 0.0, capacity = 0.0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t facet = f->model.adjacency.element_facets[4 * (int64_t)(corners[i] / 4) + k];
            if (k == corners[i] % 4 || facet >= f->model.adjacency.interior_count) continue;
            const int32_t *sides = f->model.adjacency.facet_elements + 2 * (int64_t)facet;
            const int other = place_of(corners, count, sides[0] == corners[i] / 4 ? sides[1] : sides[0]);
            if (!(group >> i & 1u) || other < 0 || group >> other & 1u) continue;
            const ShvVec3 area = shv_scale(facet_area(f, facet), sides[0] == corners[i] / 4 ? 1.0 / 3.0 : -1.0 / 3.0);
            if (area.x > 1e-6 * shv_norm(area)) return 0.0;
            pull -= tension * area.x;
            capacity += strength * shv_norm(area);
        }
    return capacity > 0.0 ? pull / capacity : 0.0;
}

static void weakest_disk_is_that_of_brute_force(void **state)
{
    (void)state;
    Fixture f;
    build(&f, 0.2);
    const double tension = 1.5 * strength;
    fixture_stress(&f, tension, 0.0, 0.0, 0.0, 0.0, 0.0);
    int tried = 0;
    for (int32_t node = 0; node < f.state.node_count; node++) {
        if (f.state.corner_count[node] > 13) continue;
        double best = 0.0;
        for (uint32_t group = 1; group < 1u << f.state.corner_count[node]; group++)
            best = fmax(best, ratio_of(&f, node, group, tension));
        shv_star_evaluate(&f.cohesive.search.stars.items[0], &f.cohesive, &f.state, f.stress, node, 0.5);
        check_near(f.cohesive.search.stars.items[0].ratio, best > 0.5 ? best : 0.0, 1e-7);
        tried += best > 0.5;
    }
    assert_true(tried > 20);
    fixture_release(&f);
}

/* Whatever the stress, the facets of a disk part the tets of its node. */
static void a_disk_parts_its_node(void **state)
{
    (void)state;
    Fixture f;
    build(&f, 0.2);
    ShvStar *star = &f.cohesive.search.stars.items[0];
    int found = 0;
    for (int64_t i = 0; i < 6 * SHV_LANES * (int64_t)f.state.batch_count; i++)
        f.stress[i] = 150e6 * (shv_random_uniform(3, (uint64_t)i) - 0.4);
    for (int32_t node = 0; node < f.state.node_count; node++) {
        shv_star_evaluate(star, &f.cohesive, &f.state, f.stress, node, 1.0);
        if (star->ratio == 0.0) {
            assert_int_equal(star->disk_count, 0);
            continue;
        }
        assert_true(star->ratio >= 1.0 && star->disk_count > 0);
        for (int32_t k = 0; k < star->disk_count; k++) f.cohesive.facet_cohesive[star->facets[star->disk[k]].facet] = 0;
        assert_true(shv_topology_groups(&f.cohesive, &f.state, node) >= 2);
        for (int32_t k = 0; k < star->disk_count; k++)
            f.cohesive.facet_cohesive[star->facets[star->disk[k]].facet] = -1;
        found++;
    }
    assert_true(found > 50);
    fixture_release(&f);
}

/* Not below the strength, not in compression, and turned with the body alike. */
static void what_holds_is_left_alone(void **state)
{
    (void)state;
    Fixture f;
    build(&f, 0.2);
    const int32_t facets = f.model.adjacency.interior_count;
    int32_t *found = calloc((size_t)facets, sizeof *found), count;
    double *over = calloc((size_t)facets, sizeof *over);
    const double cases[4][6] = {
        {0.99 * strength}, {-0.9 * strength, -strength, -strength}, {-10e9, -10e9, -10e9}, {0.0}};
    for (int i = 0; i < 4; i++) {
        const double *s = cases[i];
        fixture_stress(&f, s[0], s[1], s[2], s[3], s[4], s[5]);
        shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found, over, &count);
        assert_int_equal(count, 0);
    }
    free(found);
    free(over);
    fixture_release(&f);
}

/* Disks come in order of their ratios, no facet twice, and their laws start on the ellipse by which they were judged. */
static void disks_are_inserted_as_judged(void **state)
{
    (void)state;
    int32_t *found[2], counts[2];
    for (int run = 0; run < 2; run++) {
        Fixture f;
        fixture_define(&f, 0.03, 0.02, 0.02, 0.005);
        f.scene.fracture.criterion = SHV_CRITERION_FORCE;
        f.scene.fracture.threshold = 1.0;
        f.scene.threads = run ? 3 : 1;
        f.object.mesh.jitter = 0.2;
        f.material.cohesive_strength_shear = 60e6;
        fixture_build(&f);
        shv_cohesive_watch(&f.cohesive, &f.state, NULL);
        const size_t facets = (size_t)f.model.adjacency.interior_count;
        found[run] = calloc(facets, sizeof(int32_t));
        double *over = calloc(facets, sizeof *over);
        fixture_stress(&f, 2.5 * strength, 0.0, 0.0, 0.0, 0.0, 0.0);
        shv_cohesive_candidates(&f.cohesive, &f.state, f.stress, NULL, found[run], over, &counts[run]);
        assert_true(counts[run] > 20 && over[0] <= 2.5 && over[counts[run] - 1] >= 1.03);
        for (int32_t i = 1; i < counts[run]; i++) assert_true(over[i] <= over[i - 1]);
        int32_t duplicated = 0;
        check_ok(shv_cohesive_insert(&f.cohesive, &f.state, f.stress, found[run], counts[run], &duplicated, &f.error),
                 f.error);
        assert_true(duplicated > 0);
        for (int32_t i = 0; i < f.cohesive.count; i++) {
            const double n = f.cohesive.law[i].strength[SHV_NORMAL] / 40e6;
            const double s = f.cohesive.law[i].strength[SHV_SHEAR] / 60e6;
            assert_true(n >= 0.1 && n <= 1.0 + 1e-12 && s >= 0.1 - 1e-12 && s <= 1.0 + 1e-12);
            if (n > 0.1 && s > 0.1 + 1e-12) check_near(n * n + s * s, 1.0, 1e-9);
        }
        free(over);
        fixture_release(&f);
    }
    assert_int_equal(counts[0], counts[1]);
    assert_memory_equal(found[0], found[1], (size_t)counts[0] * sizeof(int32_t));
    free(found[0]);
    free(found[1]);
}

/* A tet between cracks keeps its last bond up to sixteen times what others hold. */
static void the_last_bond_of_a_tet_holds_longer(void **state)
{
    (void)state;
    Fixture f;
    build(&f, 0.2);
    const ShvAdjacency *adjacency = &f.model.adjacency;
    ShvStar *star = &f.cohesive.search.stars.items[0];
    int32_t element = 0;
    for (int inside = 0; inside < 4; element++)
        for (int k = inside = 0; k < 4; k++)
            inside += adjacency->element_facets[4 * (int64_t)element + k] < adjacency->interior_count;
    element--;
    for (int k = 1; k < 4; k++) f.cohesive.facet_cohesive[adjacency->element_facets[4 * (int64_t)element + k]] = 0;
    const int32_t last = adjacency->element_facets[4 * (int64_t)element];
    fixture_stress(&f, 0.5 * strength, 0.0, 0.0, 0.0, 0.0, 0.0);
    shv_star_evaluate(star, &f.cohesive, &f.state, f.stress, shv_state_node(&f.state, element, 1), 1.0);
    int seen = 0;
    for (int32_t k = 0; k < star->cut.joint_count; k++) {
        const bool is_last = star->facets[k].facet == last;
        assert_true(star->facets[k].share == (is_last ? 16.0 : 1.0));
        seen += is_last;
    }
    assert_int_equal(seen, 1);
    fixture_release(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weakest_disk_is_that_of_brute_force),
        cmocka_unit_test(a_disk_parts_its_node),
        cmocka_unit_test(what_holds_is_left_alone),
        cmocka_unit_test(disks_are_inserted_as_judged),
        cmocka_unit_test(the_last_bond_of_a_tet_holds_longer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
