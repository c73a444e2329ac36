/* What comes off when nodes are split, found from those nodes, against a search through the whole fragment. */
#include "check.h"

#include "rigid/world.h"

#include "cohesive/cohesive.h"

typedef struct Cracking {
    World world;
    ShvCohesive cohesive;
} Cracking;

static void begin(Cracking *cracking, uint64_t seed)
{
    World *world = &cracking->world;
    ShvError error = {0};
    world_begin(world);
    ShvObjectDefinition *object = world_box(world, 0.5, 0.4, 0.1, 0.05);
    object->mesh.jitter = 0.2;
    object->mesh.seed = seed;
    world_build(world);
    check_ok(shv_cohesive_create(&cracking->cohesive, &world->model, &world->scene.fracture, &error), error);
}

static void end(Cracking *cracking)
{
    shv_cohesive_release(&cracking->cohesive);
    world_end(&cracking->world);
}

/* The first node that was made. */
static int32_t insert(Cracking *cracking, const int32_t *facets, int32_t count)
{
    int32_t duplicated = 0;
    ShvError error = {0};
    cracking->world.state.time += 1.0;
    check_ok(shv_cohesive_insert(&cracking->cohesive, &cracking->world.state, NULL, facets, count, &duplicated, &error),
             error);
    return cracking->world.state.node_count - duplicated;
}

/* Facets near a plane that moves through the box come first, so that it falls apart, and by strips of any width. */
static int32_t draw_facets(const Cracking *cracking, uint64_t *index, int32_t most, int32_t *facets)
{
    const ShvAdjacency *adjacency = &cracking->world.model.adjacency;
    const double place = draw(index, -0.25, 0.25), angle = draw(index, 0.0, 3.0);
    const ShvVec3 normal = {cos(angle), sin(angle), 0.0};
    int32_t count = 0;
    for (int32_t facet = 0; facet < adjacency->interior_count && count < most; facet++) {
        if (cracking->cohesive.facet_cohesive[facet] >= 0) continue;
        double low = 1.0, high = -1.0;
        for (int side = 0; side < 2; side++) {
            ShvVec3 centre = {0.0, 0.0, 0.0};
            for (int a = 0; a < 4; a++) {
                const int32_t node =
                    shv_state_node(&cracking->world.state, adjacency->facet_elements[2 * facet + side], a);
                centre = shv_madd(centre, 0.25, shv_load3(cracking->world.state.reference + 3 * node));
            }
            const double distance = shv_dot(centre, normal) - place;
            low = fmin(low, distance);
            high = fmax(high, distance);
        }
        if (low <= 0.0 && high > 0.0 && draw(index, 0.0, 1.0) < 0.8) facets[count++] = facet;
    }
    return count;
}

static void check_same(const Cracking *a, const Cracking *b)
{
    const ShvFragments *x = &a->world.fragments, *y = &b->world.fragments;
    const int32_t elements = a->world.state.element_count;
    assert_int_equal(x->count, y->count);
    assert_int_equal(x->alive, y->alive);
    assert_memory_equal(x->elements, y->elements, (size_t)elements * sizeof(int32_t));
    assert_memory_equal(a->world.state.element_fragment, b->world.state.element_fragment,
                        (size_t)elements * sizeof(int32_t));
    for (int32_t i = 0; i < x->count; i++) {
        const ShvFragment *p = &x->items[i], *q = &y->items[i];
        assert_int_equal(p->mode, q->mode);
        assert_int_equal(p->parent, q->parent);
        assert_int_equal(p->element_begin, q->element_begin);
        assert_int_equal(p->element_count, q->element_count);
        assert_int_equal(p->node_count, q->node_count);
        assert_memory_equal(x->nodes + p->node_begin, y->nodes + q->node_begin,
                            (size_t)p->node_count * sizeof(int32_t));
        check_near(p->mass, q->mass, 1e-15 * q->mass);
        /* Sums over some hundred nodes in another split of the same masses. */
        check_near(p->inertia.m[0][0], q->inertia.m[0][0], 1e-13 * q->inertia.m[0][0]);
    }
    for (int32_t i = 0; i < x->scratch_capacity; i++) assert_int_equal(x->found[i], 0);
}

/* Some of the facets that still bond lose it; their number. */
static int32_t fail_bonds(Cracking *cracking, double share, uint64_t *index)
{
    ShvCohesive *cohesive = &cracking->cohesive;
    cohesive->failed_count = 0;
    for (int32_t i = 0; i < cohesive->count; i++) {
        if (!cohesive->bonded[i] || draw(index, 0.0, 1.0) > share) continue;
        cohesive->bonded[i] = false;
        cohesive->failed[cohesive->failed_count++] = i;
    }
    return cohesive->failed_count;
}

/* Splits of all fragments that live, from what was inserted or from the whole. */
static int32_t split_all(Cracking *cracking, int32_t first_copy, bool search_all)
{
    const ShvConnectivityChange change = {first_copy, cracking->cohesive.failed, cracking->cohesive.failed_count};
    World *world = &cracking->world;
    const int32_t before = world->fragments.count;
    int32_t split = 0;
    for (int32_t i = 0; i < before; i++) {
        int32_t parts = 0;
        ShvError error = {0};
        if (world->fragments.items[i].mode == SHV_MODE_DEAD) continue;
        check_ok(search_all ? shv_fragments_split(&world->fragments, &world->model, &world->state, i, &parts, &error)
                            : shv_fragments_split_by(&world->fragments, &world->model, &world->state, i, &change,
                                                     &parts, &error),
                 error);
        split += parts > 1;
    }
    return split;
}

/* Batches from a single facet to a whole plane; a batch may cut off several parts at once, and one between two others. */
static void test_parts_are_those_of_a_full_search(void **unused)
{
    (void)unused;
    int32_t splits = 0, whole = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        Cracking by_nodes, by_all;
        begin(&by_nodes, seed);
        begin(&by_all, seed);
        uint64_t index = 1000 * seed;
        int32_t *facets = malloc((size_t)by_all.world.model.adjacency.interior_count * sizeof *facets);
        for (int round = 0; round < 60; round++) {
            const int32_t most = 1 << (round % 10);
            const int32_t count = draw_facets(&by_nodes, &index, most, facets);
            const int32_t first = insert(&by_nodes, facets, count);
            assert_int_equal(insert(&by_all, facets, count), first);
            const int32_t split = split_all(&by_nodes, first, false);
            assert_int_equal(split_all(&by_all, first, true), split);
            splits += split;
            whole += split == 0;
            check_same(&by_nodes, &by_all);
        }
        free(facets);
        end(&by_nodes);
        end(&by_all);
    }
    assert_true(splits > 20 && whole > 20);
}

/* The same where bonds join: inserting splits nothing, and bonds fail a few or many at once, in insertions and between them. */
static void test_bonds_hold_until_they_fail(void **unused)
{
    (void)unused;
    int32_t splits = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        Cracking by_parts, by_all;
        begin(&by_parts, seed);
        begin(&by_all, seed);
        by_parts.world.fragments.bonds = &by_parts.cohesive;
        by_all.world.fragments.bonds = &by_all.cohesive;
        uint64_t index = 1000 * seed, bond = 7000 * seed, again = bond;
        int32_t *facets = malloc((size_t)by_all.world.model.adjacency.interior_count * sizeof *facets);
        for (int round = 0; round < 60; round++) {
            const int32_t most = 1 << (round % 10);
            const int32_t count = round % 2 ? 0 : draw_facets(&by_parts, &index, most, facets);
            const int32_t first = insert(&by_parts, facets, count);
            assert_int_equal(insert(&by_all, facets, count), first);
            by_parts.cohesive.failed_count = by_all.cohesive.failed_count = 0;
            if (round % 3 == 0) assert_int_equal(split_all(&by_parts, first, false), 0);
            if (round % 3 == 0) assert_int_equal(split_all(&by_all, first, true), 0);
            const double share = round % 5 == 0 ? 0.5 : 0.05;
            const int32_t failed = fail_bonds(&by_parts, share, &bond);
            assert_int_equal(fail_bonds(&by_all, share, &again), failed);
            const int32_t copies = round % 3 == 0 ? by_parts.world.state.node_count : first;
            const int32_t split = split_all(&by_parts, copies, false);
            assert_int_equal(split_all(&by_all, first, true), split);
            splits += split;
            check_same(&by_parts, &by_all);
        }
        free(facets);
        end(&by_parts);
        end(&by_all);
    }
    assert_true(splits > 20);
}

/* A row of tets in the middle is torn from both halves at once: these hung together through it alone. */
static void test_halves_that_a_part_joined_come_apart(void **unused)
{
    (void)unused;
    Cracking cracking;
    begin(&cracking, 9);
    const ShvModel *model = &cracking.world.model;
    const ShvAdjacency *adjacency = &model->adjacency;
    int32_t *facets = malloc((size_t)adjacency->interior_count * sizeof *facets), count = 0;
    for (int32_t facet = 0; facet < adjacency->interior_count; facet++) {
        int band[2];
        for (int side = 0; side < 2; side++) {
            double x = 0.0;
            for (int a = 0; a < 4; a++)
                x += 0.25 *
                     model->mesh
                         .positions[3 * model->mesh.elements[4 * adjacency->facet_elements[2 * facet + side] + a]];
            band[side] = x < -0.05 ? 0 : x > 0.05 ? 2 : 1;
        }
        if (band[0] != band[1]) facets[count++] = facet;
    }
    int32_t parts = 0;
    ShvError error = {0};
    const int32_t first = insert(&cracking, facets, count);
    check_ok(shv_fragments_split_by(&cracking.world.fragments, model, &cracking.world.state, 0,
                                    &(ShvConnectivityChange){.first_copy = first}, &parts, &error),
             error);
    assert_true(parts >= 3);
    int32_t sizes[3] = {0};
    for (int32_t i = 1; i < cracking.world.fragments.count; i++) {
        const int32_t size = cracking.world.fragments.items[i].element_count;
        for (int k = 0; k < 3; k++)
            if (size > sizes[k]) {
                for (int m = 2; m > k; m--) sizes[m] = sizes[m - 1];
                sizes[k] = size;
                break;
            }
    }
    assert_true(sizes[2] > model->mesh.element_count / 10); /* the halves and the band */
    free(facets);
    end(&cracking);
}

static void test_memory_runs_out(void **unused)
{
    (void)unused;
    Cracking cracking;
    begin(&cracking, 3);
    uint64_t index = 77;
    int32_t *facets = malloc((size_t)cracking.world.model.adjacency.interior_count * sizeof *facets);
    const int32_t count = draw_facets(&cracking, &index, INT32_MAX, facets);
    const int32_t first = insert(&cracking, facets, count);
    ShvError error = {0};
    bool done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        int32_t parts = 0;
        shv_memory_fail_after(cracking.world.memory, allowed);
        const ShvStatus status =
            shv_fragments_split_by(&cracking.world.fragments, &cracking.world.model, &cracking.world.state, 0,
                                   &(ShvConnectivityChange){.first_copy = first}, &parts, &error);
        shv_memory_fail_after(cracking.world.memory, -1);
        done = status == SHV_OK;
        if (!done) assert_int_equal(status, SHV_NO_MEMORY);
        if (!done) assert_int_equal(cracking.world.fragments.count, 1);
        for (int32_t i = 0; i < cracking.world.fragments.scratch_capacity && cracking.world.fragments.found; i++)
            assert_int_equal(cracking.world.fragments.found[i], 0);
        assert_true(allowed < 50);
    }
    free(facets);
    end(&cracking);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parts_are_those_of_a_full_search),
        cmocka_unit_test(test_bonds_hold_until_they_fail),
        cmocka_unit_test(test_halves_that_a_part_joined_come_apart),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
