#include "check.h"

#include <stdlib.h>

#include "rigid/world.h"

/* Components by repeated passes over all pairs of elements of one group: slow and obvious. */
static int32_t brute_components(const ShvState *state, int32_t *component)
{
    int32_t count = 0;
    for (int32_t e = 0; e < state->element_count; e++) component[e] = -1;
    for (int32_t e = 0; e < state->element_count; e++) {
        if (component[e] >= 0) continue;
        component[e] = count;
        for (bool grown = true; grown;) {
            grown = false;
            uint8_t *mine = calloc((size_t)state->node_count, 1);
            for (int32_t f = 0; f < state->element_count; f++)
                for (int a = 0; a < 4; a++)
                    if (component[f] == count) mine[shv_state_node(state, f, a)] = 1;
            for (int32_t f = 0; f < state->element_count; f++)
                for (int a = 0; a < 4; a++)
                    if (component[f] < 0 && mine[shv_state_node(state, f, a)]) {
                        component[f] = count;
                        grown = true;
                    }
            free(mine);
        }
        count++;
    }
    return count;
}

static double mass_of_elements(const ShvFragments *fragments, const ShvState *state, const ShvFragment *fragment)
{
    double mass = 0.0;
    for (int32_t i = 0; i < fragment->element_count; i++)
        mass += state->element_mass[fragments->elements[fragment->element_begin + i]];
    return mass;
}

static const int face_nodes[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

static bool same_face(const World *world, int32_t e, int k, int32_t f, int m)
{
    int found = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            found += world->model.mesh.elements[4 * e + face_nodes[k][a]] ==
                     world->model.mesh.elements[4 * f + face_nodes[m][b]];
    return found == 3;
}

/* m²: of the faces that no other tet of the fragment has, by asking all of them. */
static double surface_of_elements(const World *world, const ShvFragment *fragment)
{
    const int32_t *own = world->fragments.elements + fragment->element_begin;
    double area = 0.0;
    for (int32_t i = 0; i < fragment->element_count; i++)
        for (int k = 0; k < 4; k++) {
            bool shared = false;
            for (int32_t j = 0; j < fragment->element_count && !shared; j++)
                for (int m = 0; m < 4 && i != j; m++) shared |= same_face(world, own[i], k, own[j], m);
            ShvVec3 x[3];
            for (int a = 0; a < 3; a++)
                x[a] = shv_load3(world->model.mesh.positions +
                                 3 * world->model.mesh.elements[4 * own[i] + face_nodes[k][a]]);
            if (!shared) area += 0.5 * shv_norm(shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])));
        }
    return area;
}

/* Everything that must hold of the lists at any time. */
static void check_lists(const World *world)
{
    const ShvFragments *fragments = &world->fragments;
    const ShvState *state = &world->state;
    int32_t elements = 0, alive = 0;
    for (int32_t f = 0; f < fragments->count; f++) {
        const ShvFragment *fragment = &fragments->items[f];
        assert_int_equal(fragment->id, f);
        assert_true(fragment->parent < f);
        if (fragment->mode == SHV_MODE_DEAD) {
            assert_true(fragment->death >= fragment->birth);
            continue;
        }
        alive++;
        assert_true(isnan(fragment->death));
        elements += fragment->element_count;
        const int32_t *own = fragments->elements + fragment->element_begin,
                      *nodes = fragments->nodes + fragment->node_begin;
        uint8_t *used = calloc((size_t)state->node_count, 1);
        for (int32_t i = 0; i < fragment->element_count; i++) {
            assert_true(i == 0 || own[i] > own[i - 1]);
            assert_int_equal(state->element_fragment[own[i]], f);
            for (int a = 0; a < 4; a++) used[shv_state_node(state, own[i], a)] = 1;
        }
        int32_t node_count = 0;
        for (int32_t n = 0; n < state->node_count; n++) node_count += used[n];
        assert_int_equal(fragment->node_count, node_count);
        for (int32_t i = 0; i < fragment->node_count; i++) {
            assert_true(i == 0 || nodes[i] > nodes[i - 1]);
            assert_true(used[nodes[i]]);
        }
        free(used);
        assert_true(fragment->mass == mass_of_elements(fragments, state, fragment));
        check_near(fragment->surface, surface_of_elements(world, fragment), 1e-12);
    }
    assert_int_equal(elements, state->element_count);
    assert_int_equal(alive, fragments->alive);
}

static void test_two_boxes_are_two_fragments(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.2, 0.1, 0.1, 0.05)->placement.velocity[0] = 2.0;
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.0;
    world_build(&world);
    assert_int_equal(world.fragments.count, 2);
    check_lists(&world);
    const ShvFragment *fragment = world.fragments.items;
    check_near(fragment[0].mass, 5.0, 1e-12);
    check_near(fragment[0].volume, 0.002, 1e-15);
    check_near(fragment[0].surface, 0.1, 1e-14);
    assert_int_equal(fragment[1].object, 1);
    check_near(fragment[1].position.z, 1.0, 1e-14);
    check_near(fragment[0].velocity.x, 2.0, 1e-14);
    check_near(fragment[0].radius, sqrt(0.01 + 0.0025 + 0.0025), 1e-14);
    assert_true(isinf(fragment[0].strength) && fragment[0].parent == -1);
    world_end(&world);
}

/* Random groups of elements torn apart, in two rounds: the fragments are the components found by brute force, in the order
   of their lowest element, and the genealogy is whole. */
static void test_random_splits(void **unused)
{
    (void)unused;
    uint64_t index = 50;
    for (int trial = 0; trial < 6; trial++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.3, 0.2, 0.2, 0.05);
        world_build(&world);
        const int32_t elements = world.state.element_count;
        const double mass = world.fragments.items[0].mass;
        int32_t *group = calloc((size_t)elements, sizeof *group),
                *component = calloc((size_t)elements, sizeof *component);
        for (int round = 1; round <= 2; round++) {
            const int groups = 1 + 3 * trial;
            for (int32_t e = 0; e < elements; e++)
                group[e] = group[e] * groups + (int32_t)draw(&index, 0.0, (double)groups);
            world_separate(&world, group);
            world.state.time = round;
            const int32_t before = world.fragments.count;
            for (int32_t f = 0; f < before; f++) {
                if (world.fragments.items[f].mode == SHV_MODE_DEAD) continue;
                int32_t parts = 0;
                ShvError error = {0};
                const int32_t first = world.fragments.count;
                check_ok(shv_fragments_split(&world.fragments, &world.model, &world.state, f, &parts, &error), error);
                assert_int_equal(world.fragments.count - first, parts > 1 ? parts : 0);
                for (int32_t c = first; c < world.fragments.count; c++) {
                    assert_int_equal(world.fragments.items[c].parent, f);
                    assert_true(world.fragments.items[c].birth == round && world.fragments.items[f].death == round);
                }
            }
            check_lists(&world);
            assert_int_equal(brute_components(&world.state, component), world.fragments.alive);
            for (int32_t e = 0; e < elements; e++)
                for (int32_t f = 0; f < e; f += 7)
                    assert_int_equal(component[e] == component[f],
                                     world.state.element_fragment[e] == world.state.element_fragment[f]);
        }
        double total = 0.0;
        for (int32_t f = 0; f < world.fragments.count; f++)
            if (world.fragments.items[f].mode != SHV_MODE_DEAD) total += world.fragments.items[f].mass;
        check_near(total, mass, 1e-13 * mass);
        free(group);
        free(component);
        world_end(&world);
    }
}

static void test_children_stand_in_the_order_of_their_lowest_element(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.2, 0.2, 0.2, 0.1);
    world_build(&world);
    world.fragments.items[0].mode = SHV_MODE_FRACTURE;
    world.fragments.items[0].orientation = shv_quat_exponential(shv_vec3(0.1, 0.2, 0.3));
    int32_t *group = calloc((size_t)world.state.element_count, sizeof *group), parts = 0;
    for (int32_t e = 0; e < world.state.element_count; e++) group[e] = e;
    world_separate(&world, group);
    assert_int_equal(world.state.node_count, 4 * world.state.element_count);
    ShvError error = {0};
    check_ok(shv_fragments_split(&world.fragments, &world.model, &world.state, 0, &parts, &error), error);
    assert_int_equal(parts, world.state.element_count);
    for (int32_t e = 0; e < parts; e++) {
        const ShvFragment *child = &world.fragments.items[1 + e];
        assert_int_equal(world.fragments.elements[child->element_begin], e);
        assert_int_equal(child->mode, SHV_MODE_FRACTURE);
        assert_memory_equal(&child->orientation, &world.fragments.items[0].orientation, sizeof(ShvQuat));
    }
    check_lists(&world);
    free(group);
    world_end(&world);
}

/* A crack that does not cut through keeps the id, and the lists know the new nodes. */
static void test_crack_without_split_keeps_the_id(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.3, 0.2, 0.2, 0.1);
    world_build(&world);
    ShvState *state = &world.state;
    const ShvFragment before = world.fragments.items[0];
    /* one corner of the last element gets a node of its own */
    ShvError error = {0};
    check_ok(shv_state_reserve(state, (int64_t)state->node_count + 1, &error), error);
    const int32_t element = state->element_count - 1, old = shv_state_node(state, element, 2),
                  copy = state->node_count++;
    memcpy(state->reference + 3 * copy, state->reference + 3 * old, 3 * sizeof(double));
    state->origin[copy] = old;
    state->mass[copy] = 0.25 * state->element_mass[element];
    state->mass[old] -= state->mass[copy];
    state->connectivity[shv_corner_slot(element, 2)] = copy;
    for (int repeat = 0; repeat < 5; repeat++) {
        int32_t parts = 0;
        check_ok(shv_fragments_split(&world.fragments, &world.model, state, 0, &parts, &error), error);
        assert_int_equal(parts, 1);
    }
    assert_int_equal(world.fragments.count, 1);
    assert_int_equal(world.fragments.items[0].node_count, before.node_count + 1);
    assert_true(world.fragments.items[0].mass == before.mass);
    check_lists(&world);
    world_end(&world);
}

/* Tets that share a vertex or an edge only are one component; a node without elements belongs to none. */
static void test_vertex_contact_and_unused_node(void **unused)
{
    (void)unused;
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1};
    static const int32_t tets[] = {0, 1, 2, 3, 0, 5, 4, 6};
    World world;
    world_begin(&world);
    world_tets(&world, points, 7, tets, 2);
    assert_int_equal(world.fragments.count, 1);
    check_lists(&world);
    /* both corners at the origin move to copies: node 0 is left without elements and mass */
    ShvState *state = &world.state;
    ShvError error = {0};
    check_ok(shv_state_reserve(state, 9, &error), error);
    for (int32_t e = 0; e < 2; e++) {
        const int32_t copy = state->node_count++;
        state->connectivity[shv_corner_slot(e, 0)] = copy;
        state->origin[copy] = 0;
        state->mass[copy] = 0.25 * state->element_mass[e];
    }
    state->mass[0] = 0.0;
    int32_t parts = 0;
    check_ok(shv_fragments_split(&world.fragments, &world.model, state, 0, &parts, &error), error);
    assert_int_equal(parts, 2);
    check_lists(&world);
    for (int32_t f = 1; f <= 2; f++) {
        assert_int_equal(world.fragments.items[f].node_count, 4);
        assert_true(isfinite(world.fragments.items[f].inertia.m[0][0]));
    }
    world_end(&world);
}

static int32_t surface_count(World *world, int32_t fragment)
{
    int32_t *nodes = NULL, count = 0;
    ShvError error = {0};
    check_ok(shv_fragment_surface(&world->fragments, &world->model, &world->state, fragment, &nodes, &count, &error),
             error);
    for (int32_t i = 1; i < count; i++) assert_true(nodes[i] > nodes[i - 1]);
    shv_release(nodes);
    return count;
}

static void test_surface_nodes(void **unused)
{
    (void)unused;
    for (int breakable = 0; breakable < 2; breakable++) {
        World world;
        world_begin(&world);
        world.scene.fracture.enabled = breakable;
        world_box(&world, 0.4, 0.3, 0.3, 0.1);
        world_build(&world);
        assert_int_equal(world.model.can_break, breakable);
        const ShvFragment *whole = &world.fragments.items[0];
        int32_t inside = 0;
        for (int32_t n = 0; n < world.state.node_count; n++) {
            const ShvVec3 x = shv_load3(world.state.reference + 3 * n);
            inside += fabs(x.x) < 0.199 && fabs(x.y) < 0.149 && fabs(x.z) < 0.149;
        }
        assert_true(inside > 0);
        assert_int_equal(surface_count(&world, 0), whole->node_count - inside);
        if (breakable) {
            /* torn into single tets, every node is on the surface: crack faces count */
            int32_t *group = calloc((size_t)world.state.element_count, sizeof *group), parts = 0;
            for (int32_t e = 0; e < world.state.element_count; e++) group[e] = e;
            world_separate(&world, group);
            ShvError error = {0};
            check_ok(shv_fragments_split(&world.fragments, &world.model, &world.state, 0, &parts, &error), error);
            for (int32_t f = 1; f < world.fragments.count; f++) assert_int_equal(surface_count(&world, f), 4);
            free(group);
        }
        world_end(&world);
    }
}

static void test_memory_runs_out(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.2, 0.2, 0.2, 0.1);
    world_build(&world);
    ShvError error = {0};
    bool done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        ShvFragments fragments;
        shv_memory_fail_after(world.memory, allowed);
        const ShvStatus status = shv_fragments_create(&fragments, &world.model, &world.state, &error);
        shv_memory_fail_after(world.memory, -1);
        done = status == SHV_OK;
        if (!done) assert_int_equal(status, SHV_NO_MEMORY);
        if (!done) assert_null(fragments.items);
        assert_true(allowed < 50);
        shv_fragments_release(&fragments);
    }
    int32_t *group = calloc((size_t)world.state.element_count, sizeof *group), parts = 0;
    for (int32_t e = 0; e < world.state.element_count; e++) group[e] = e % 5;
    world_separate(&world, group);
    done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        shv_memory_fail_after(world.memory, allowed);
        const ShvStatus status = shv_fragments_split(&world.fragments, &world.model, &world.state, 0, &parts, &error);
        shv_memory_fail_after(world.memory, -1);
        done = status == SHV_OK;
        if (!done) assert_int_equal(status, SHV_NO_MEMORY);
        if (!done) assert_int_equal(world.fragments.count, 1);
        if (!done) assert_int_equal(world.fragments.items[0].mode, SHV_MODE_FLIGHT);
        assert_true(allowed < 50);
    }
    assert_true(parts > 1);
    check_lists(&world);
    free(group);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_boxes_are_two_fragments),
        cmocka_unit_test(test_random_splits),
        cmocka_unit_test(test_children_stand_in_the_order_of_their_lowest_element),
        cmocka_unit_test(test_crack_without_split_keeps_the_id),
        cmocka_unit_test(test_vertex_contact_and_unused_node),
        cmocka_unit_test(test_surface_nodes),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
