#include "check.h"

#include "rigid/pieces.h"

/* What holds of the pieces of any fragment. */
static void check_shape_within(const Shape *shape, const World *world, int32_t fragment, double reach)
{
    const ShvConvexPieces *pieces = &shape->pieces;
    const ShvFragment *item = &world->fragments.items[fragment];
    assert_in_range(pieces->count, 1, 32);
    assert_int_equal(pieces->vertex_begin[0], 0);
    double volume = 0.0;
    for (int32_t p = 0; p < pieces->count; p++) {
        assert_in_range(pieces->vertex_begin[p + 1] - pieces->vertex_begin[p], 4, SHV_PIECE_VERTICES);
        volume += pieces->volumes[p];
    }
    for (int32_t v = 0; v < pieces->vertex_begin[pieces->count]; v++) {
        const ShvVec3 x = shv_load3(pieces->vertices + 3 * v);
        assert_true(shv_finite3(x) && shv_norm(x) <= reach * item->radius);
    }
    check_near(pieces->volume, volume, 1e-12 * volume);
    check_near(pieces->excess, pieces->volume / item->volume - 1.0, 1e-9 * (1.0 + fabs(pieces->excess)));
    assert_true(pieces->outside >= 0.0 && pieces->missing >= 0.0);
}

/* No vertex farther from the centre than a node. */
static void check_shape(const Shape *shape, const World *world, int32_t fragment)
{
    check_shape_within(shape, world, fragment, 1.0000001);
}

/* A vertex, from the centre, lies in the hull of the fragment's nodes: no direction of many sees it beyond all of them. */
static void check_within_nodes(const Shape *shape, const World *world, int32_t fragment)
{
    const ShvFragment *item = &world->fragments.items[fragment];
    uint64_t index = 5;
    for (int trial = 0; trial < 200; trial++) {
        const ShvVec3 direction = shv_unit(draw3(&index, 1.0));
        double farthest = -(double)INFINITY;
        for (int32_t i = 0; i < item->node_count; i++) {
            const int32_t node = world->fragments.nodes[item->node_begin + i];
            farthest =
                fmax(farthest,
                     shv_dot(direction, shv_sub(shv_load3(world->state.reference + 3 * (int64_t)node), shape->centre)));
        }
        for (int32_t v = 0; v < shape->pieces.vertex_begin[shape->pieces.count]; v++)
            assert_true(shv_dot(direction, shv_load3(shape->pieces.vertices + 3 * v)) <=
                        farthest + 1e-6 * item->radius);
    }
}

static void test_box_is_its_corners(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.3, 0.2, 0.1, 0.02)->placement.position[0] = 40.0;
    world_build(&world);
    Shape shape;
    shape_make(&shape, &world, 0);
    check_shape(&shape, &world, 0);
    assert_int_equal(shape.pieces.count, 1);
    assert_int_equal(shape.pieces.vertex_begin[1], 8);
    check_near(shape.pieces.volume, 0.006, 1e-12);
    check_near(shape.pieces.excess, 0.0, 1e-9);
    assert_true(shape.pieces.outside == 0.0 && shape.pieces.missing == 0.0);
    for (int32_t v = 0; v < 8; v++) {
        check_near(fabs(shape.pieces.vertices[3 * v]), 0.15, 1e-12);
        check_near(fabs(shape.pieces.vertices[3 * v + 1]), 0.1, 1e-12);
        check_near(fabs(shape.pieces.vertices[3 * v + 2]), 0.05, 1e-12);
    }
    shape_release(&shape);
    world_end(&world);
}

/* Hand-made tets: expected number of pieces and whether they are exact. */
static void check_tets(const double *points, int32_t point_count, const int32_t *tets, int32_t tet_count,
                       int32_t pieces, double excess)
{
    World world;
    world_begin(&world);
    world_tets(&world, points, point_count, tets, tet_count);
    assert_int_equal(world.fragments.count, 1);
    Shape shape;
    shape_make(&shape, &world, 0);
    check_shape(&shape, &world, 0);
    check_within_nodes(&shape, &world, 0);
    assert_int_equal(shape.pieces.count, pieces);
    check_near(shape.pieces.excess, excess, 1e-7);
    shape_release(&shape);
    world_end(&world);
}

static void test_few_tets(void **unused)
{
    (void)unused;
    /* one tet, a needle; two joined at a corner, at an edge, at a face with a convex union */
    static const double tet[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1},
                        needle[] = {0, 0, 0, 1, 0, 0, 0.5, 1e-4, 0, 0.5, 0, 1e-4},
                        corner[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1},
                        edge[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0},
                        face[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0};
    static const int32_t one[] = {0, 1, 2, 3}, at_corner[] = {0, 1, 2, 3, 0, 5, 4, 6},
                         at_edge[] = {0, 1, 2, 3, 0, 4, 5, 3}, at_face[] = {0, 1, 2, 3, 0, 2, 4, 3};
    check_tets(tet, 4, one, 1, 1, 0.0);
    check_tets(needle, 4, one, 1, 1, 0.0);
    check_tets(corner, 7, at_corner, 2, 2, 0.0);
    check_tets(edge, 6, at_edge, 2, 2, 0.0);
    check_tets(face, 5, at_face, 2, 1, 0.0);
}

/* A tet without thickness, as far as a hull can tell, is its four nodes; beside a sound one it does no harm. */
static void test_flat_tets(void **unused)
{
    (void)unused;
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, 1e-12, 0.3, 0.3, -1e-12},
                        beside[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, 1e-12, 0.1, 0.1, -1.0};
    static const int32_t flat[] = {0, 1, 2, 3}, both[] = {0, 1, 2, 3, 0, 2, 1, 4};
    check_tets(points, 4, flat, 1, 1, -1.0);
    check_tets(points, 5, both, 2, 1, -1.0);
    World world;
    world_begin(&world);
    world_tets(&world, beside, 5, both, 2);
    Shape shape;
    shape_make(&shape, &world, 0);
    check_shape(&shape, &world, 0);
    check_near(shape.pieces.excess, 0.0, 1e-6);
    shape_release(&shape);
    world_end(&world);
}

/* Tets of which most is inside out, as a bent shard of soft matter can be: what it has of hulls is finite, and within its nodes. */
static void test_tets_inside_out(void **unused)
{
    (void)unused;
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, 0.1, 0.3, 0.3, 1.0};
    static const int32_t elements[] = {0, 1, 2, 3, 0, 2, 1, 4};
    ShvMemory *memory = shv_memory_create();
    ShvError error;
    ShvFragmentTets tets;
    ShvConvexPieces pieces;
    assert_int_equal(shv_fragment_tets_allocate(&tets, 5, 2, memory, &error), SHV_OK);
    memcpy(tets.positions, points, sizeof points);
    memcpy(tets.tets, elements, sizeof elements);
    shv_fragment_tets_measure(&tets);
    check_near(tets.volume, (0.1 + 1.0) / 6.0, 1e-12);
    assert_int_equal(shv_convex_pieces_of_tets(&pieces, &tets, memory, &error), SHV_OK);
    assert_true(pieces.count > 0 && pieces.volume > 0.0);
    for (int32_t i = 0; i < 3 * pieces.vertex_begin[pieces.count]; i++)
        assert_true(pieces.vertices[i] > -1e-9 && pieces.vertices[i] < 1.0 + 1e-9);
    shv_convex_pieces_release(&pieces);
    shv_fragment_tets_release(&tets);
    shv_memory_destroy(memory);
}

/* Pieces of a plate, level and tilted: none reaches beyond the plate's faces, and where a piece has area on a face its hulls
   lie flush with it, so that it rests flat. */
static void test_pieces_of_a_plate_stay_flat(void **unused)
{
    (void)unused;
    for (int tilted = 0; tilted < 2; tilted++) {
        World world;
        world_begin(&world);
        ShvObjectDefinition *plate = world_box(&world, 0.2, 0.2, 0.012, 0.006);
        plate->mesh.jitter = 0.2;
        plate->placement.rotation_degrees = tilted ? 25.0 : 0.0;
        plate->placement.rotation_axis[0] = 1.0;
        plate->placement.rotation_axis[1] = plate->placement.rotation_axis[2] = 0.3 * tilted;
        world_build(&world);
        const ShvVec3 axis = shv_load3(plate->placement.rotation_axis);
        const ShvVec3 up =
            shv_rotate(shv_quat_from_axis_angle(axis, plate->placement.rotation_degrees * acos(-1.0) / 180.0),
                       shv_vec3(0.0, 0.0, 1.0));
        uint64_t index = 3;
        cut_by_seeds(&world, 20, shv_vec3(0.1, 0.1, 0.0), &index);
        for (int32_t f = 1; f < world.fragments.count; f++) {
            if (world.fragments.items[f].element_count < 20) continue;
            Shape shape;
            shape_make(&shape, &world, f);
            check_shape(&shape, &world, f);
            check_within_nodes(&shape, &world, f);
            for (int side = -1; side <= 1; side += 2) {
                int32_t flush = 0;
                for (int32_t v = 0; v < shape.pieces.vertex_begin[shape.pieces.count]; v++) {
                    const ShvVec3 x = shv_add(shv_load3(shape.pieces.vertices + 3 * v), shape.centre);
                    assert_true(side * shv_dot(up, x) <= 0.006 + 1e-8);
                    flush += side * shv_dot(up, x) >= 0.006 - 1e-8;
                }
                assert_true(flush >= 3);
            }
            shape_release(&shape);
        }
        world_end(&world);
    }
}

/* Fragments of a few tets: hulls of the tets' volume, none beyond the nodes. */
static void test_small_pieces(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_ball(&world, 0.1, 0.03);
    world_build(&world);
    uint64_t index = 8;
    cut_by_seeds(&world, 250, shv_vec3(0.1, 0.1, 0.1), &index);
    int32_t small = 0;
    double missing = 0.0, volume = 0.0;
    for (int32_t f = 1; f < world.fragments.count; f++) {
        const ShvFragment *item = &world.fragments.items[f];
        Shape shape;
        shape_make(&shape, &world, f);
        check_shape(&shape, &world, f);
        check_within_nodes(&shape, &world, f);
        if (item->element_count <= 16) {
            small++;
            check_near(shape.pieces.excess, 0.0, 1e-6);
            assert_true(shape.pieces.count <= item->element_count);
            missing += shape.pieces.missing;
            volume += item->volume;
        }
        shape_release(&shape);
    }
    assert_true(small > 50);
    assert_true(missing < 0.25 * volume);
    world_end(&world);
}

/* The grid's shares against random points: 4,000 of them have a standard error of at most √(0.25/4000) = 0.8 %, and a share
   that the grid sees is that of all the fragment's tets; four errors. What the owner's hulls hold of others and of nothing
   cannot be seen by points in tets, so `outside` follows from the volumes: in hulls = tets − missing + outside when one
   hull stands alone. */
static void test_pieces_of_a_ball(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_ball(&world, 0.1, 0.018);
    world_build(&world);
    uint64_t index = 1;
    cut_by_seeds(&world, 12, shv_vec3(0.1, 0.1, 0.1), &index);
    for (int32_t f = 1; f < world.fragments.count; f++) {
        const ShvFragment *item = &world.fragments.items[f];
        Shape shape;
        shape_make(&shape, &world, f);
        check_shape(&shape, &world, f);
        const int32_t samples = 4000;
        double held = 0.0, volume = 0.0;
        for (int32_t i = 0; i < samples; i++) {
            const int32_t element =
                world.fragments.elements[item->element_begin + (int32_t)draw(&index, 0.0, item->element_count)];
            const double weight = shv_mesh_element_volume(&world.model.mesh, element);
            volume += weight;
            if (shape_holds(&shape, draw_in_tet(&world, element, &index))) held += weight;
        }
        check_near(1.0 - held / volume, shape.pieces.missing / item->volume, 0.04);
        assert_true(shape.pieces.missing < 0.25 * item->volume && shape.pieces.outside < 0.25 * item->volume);
        if (shape.pieces.count == 1)
            check_near(shape.pieces.volume, item->volume - shape.pieces.missing + shape.pieces.outside,
                       0.03 * item->volume);
        shape_release(&shape);
    }
    world_end(&world);
}

/* A smooth ball is one hull of 64 vertices with about its volume; the hollow one many, which leave most of its inside free. */
static void test_ball_and_hollow_ball(void **unused)
{
    (void)unused;
    for (int hollow = 0; hollow < 2; hollow++) {
        World world;
        world_begin(&world);
        world_ball(&world, 0.1, 0.012);
        if (hollow) world.objects[0].mesh.kind = SHV_MESH_HOLLOW_BALL;
        if (hollow) world.objects[0].mesh.inner_radius = 0.085;
        world_build(&world);
        Shape shape;
        shape_make(&shape, &world, 0);
        /* hulls of 64 vertices stand out between the nodes as much as they cut corners: a sagitta of 124 equal faces, 3 %; of
           the few that a cap of the hollow ball has, more */
        check_shape_within(&shape, &world, 0, hollow ? 1.1 : 1.06);
        if (!hollow) {
            assert_int_equal(shape.pieces.count, 1);
            check_near(shape.pieces.excess, 0.0, 0.03);
        } else {
            assert_in_range(shape.pieces.count, 13, 32);
            /* one hull would fill it, with 0.085³ / (0.1³ − 0.085³) = 1.6 times the tets: a tenth of that at most */
            assert_true(shape.pieces.outside < 0.16 * world.fragments.items[0].volume);
            assert_false(shape_holds(&shape, shv_vec3(0.0, 0.0, 0.0)));
        }
        shape_release(&shape);
        world_end(&world);
    }
}

/* A crack that does not part the fragment adds nodes where others are, and no shape: as many hulls, and, but for which of two
   points in one place comes first, the same. */
static void test_internal_crack_changes_nothing(void **unused)
{
    (void)unused;
    ShvConvexPieces pieces[2];
    World worlds[2];
    for (int cracked = 0; cracked < 2; cracked++) {
        World *world = &worlds[cracked];
        world_begin(world);
        world_ball(world, 0.1, 0.03);
        world_build(world);
        ShvState *state = &world->state;
        ShvError error = {0};
        int32_t parts = 0;
        /* the crack: a corner of every tenth element gets a node of its own */
        for (int32_t e = 0; cracked && e < state->element_count; e += 10) {
            check_ok(shv_state_reserve(state, (int64_t)state->node_count + 1, &error), error);
            const int32_t old = shv_state_node(state, e, 1), copy = state->node_count++;
            memcpy(state->reference + 3 * (int64_t)copy, state->reference + 3 * (int64_t)old, 3 * sizeof(double));
            state->origin[copy] = state->origin[old];
            state->mass[copy] = 0.25 * state->element_mass[e];
            state->mass[old] -= state->mass[copy];
            state->connectivity[shv_corner_slot(e, 1)] = copy;
        }
        check_ok(shv_fragments_split(&world->fragments, &world->model, state, 0, &parts, &error), error);
        assert_int_equal(parts, 1);
        world->fragments.items[0].reference_centre = shv_vec3(0.0, 0.0, 0.0);
        check_ok(shv_convex_pieces_make(&pieces[cracked], &world->fragments, &world->model, state, 0, &error), error);
    }
    assert_int_equal(pieces[0].count, pieces[1].count);
    check_near(pieces[0].volume, pieces[1].volume, 1e-3 * pieces[0].volume);
    for (int cracked = 0; cracked < 2; cracked++) {
        shv_convex_pieces_release(&pieces[cracked]);
        world_end(&worlds[cracked]);
    }
}

static void test_same_fragment_same_bits(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_ball(&world, 0.1, 0.02);
    world_build(&world);
    uint64_t index = 1;
    cut_by_seeds(&world, 6, shv_vec3(0.1, 0.1, 0.1), &index);
    for (int32_t f = 1; f < world.fragments.count; f++) {
        ShvConvexPieces a, b;
        ShvError error = {0};
        check_ok(shv_convex_pieces_make(&a, &world.fragments, &world.model, &world.state, f, &error), error);
        check_ok(shv_convex_pieces_make(&b, &world.fragments, &world.model, &world.state, f, &error), error);
        assert_int_equal(a.count, b.count);
        const size_t vertices = (size_t)a.vertex_begin[a.count];
        assert_memory_equal(a.vertex_begin, b.vertex_begin, (size_t)(a.count + 1) * sizeof(int32_t));
        assert_memory_equal(a.vertices, b.vertices, 3 * vertices * sizeof(double));
        assert_true(a.outside == b.outside && a.missing == b.missing && a.volume == b.volume);
        shv_convex_pieces_release(&a);
        shv_convex_pieces_release(&b);
    }
    world_end(&world);
}

static void test_memory_runs_out(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_ball(&world, 0.1, 0.04);
    world_build(&world);
    uint64_t index = 1;
    cut_by_seeds(&world, 3, shv_vec3(0.1, 0.1, 0.1), &index);
    ShvError error = {0};
    bool done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        ShvConvexPieces pieces;
        shv_memory_fail_after(world.memory, allowed);
        const ShvStatus status =
            shv_convex_pieces_make(&pieces, &world.fragments, &world.model, &world.state, 1, &error);
        shv_memory_fail_after(world.memory, -1);
        done = status == SHV_OK;
        if (!done) assert_int_equal(status, SHV_NO_MEMORY);
        if (!done) assert_true(pieces.count == 0 && !pieces.vertices && !pieces.volumes);
        assert_true(allowed < 50);
        shv_convex_pieces_release(&pieces);
    }
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_is_its_corners),
        cmocka_unit_test(test_few_tets),
        cmocka_unit_test(test_flat_tets),
        cmocka_unit_test(test_tets_inside_out),
        cmocka_unit_test(test_pieces_of_a_plate_stay_flat),
        cmocka_unit_test(test_small_pieces),
        cmocka_unit_test(test_pieces_of_a_ball),
        cmocka_unit_test(test_ball_and_hollow_ball),
        cmocka_unit_test(test_internal_crack_changes_nothing),
        cmocka_unit_test(test_same_fragment_same_bits),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
