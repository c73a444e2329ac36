#include "bodies.h"

static int has_node(const int32_t *element, int32_t node)
{
    return element[0] == node || element[1] == node || element[2] == node || element[3] == node;
}

/* The face of `other` that has the same nodes as face `face` of `element`, or −1. */
static int common_face(const ShvMesh *mesh, int32_t element, int face, int32_t other)
{
    const int32_t *e = mesh->elements + 4 * element, *o = mesh->elements + 4 * other;
    for (int i = 0; i < 3; i++)
        if (!has_node(o, e[shv_face_corners[face][i]])) return -1;
    for (int k = 0; k < 4; k++)
        if (!has_node(e, o[k])) return k;
    return -1;
}

/* Everything in adjacency.h, rebuilt by comparing all pairs of elements. */
static void agrees_with_brute_force(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh mesh;
        ShvAdjacency a;
        const ShvMeshDefinition d = any_body(b, 0.017);
        check_ok(make(&mesh, NULL, &d, &error), error);
        check_ok(shv_adjacency_build(&a, &mesh, &error), error);
        int32_t next_interior = 0, next_boundary = a.interior_count;
        for (int32_t e = 0; e < mesh.element_count; e++)
            for (int k = 0; k < 4; k++) {
                int32_t mate = -1;
                int mate_face = -1;
                for (int32_t o = 0; o < mesh.element_count && mate < 0; o++) {
                    if (o == e || (mate_face = common_face(&mesh, e, k, o)) < 0) continue;
                    mate = o;
                }
                const int32_t facet = a.element_facets[4 * e + k];
                if (mate > e) assert_int_equal(facet, next_interior++);
                if (mate < 0) assert_int_equal(facet, next_boundary++);
                const int side = mate >= 0 && mate < e;
                assert_int_equal(a.facet_elements[2 * facet + side], e);
                assert_int_equal(a.facet_faces[2 * facet + side], k);
                assert_int_equal(a.facet_elements[2 * facet + 1 - side], mate);
                if (mate >= 0) assert_int_equal(a.facet_faces[2 * facet + 1 - side], mate_face);
            }
        assert_int_equal(next_interior, a.interior_count);
        assert_int_equal(next_boundary, a.facet_count);
        shv_adjacency_release(&a);
        shv_mesh_release(&mesh);
    }
}

static void corners_of_every_node(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    ShvAdjacency a;
    const ShvMeshDefinition d = body(SHV_MESH_BALL, 0.01);
    check_ok(make(&mesh, NULL, &d, &error), error);
    check_ok(shv_adjacency_build(&a, &mesh, &error), error);
    assert_int_equal(a.corner_start[0], 0);
    assert_int_equal(a.corner_start[mesh.node_count], 4 * mesh.element_count);
    for (int32_t n = 0; n < mesh.node_count; n++)
        for (int32_t i = a.corner_start[n]; i < a.corner_start[n + 1]; i++) {
            assert_int_equal(mesh.elements[a.corners[i]], n);
            if (i > a.corner_start[n]) assert_true(a.corners[i] > a.corners[i - 1]);
        }
    shv_adjacency_release(&a);
    assert_null(a.corners);
    shv_mesh_release(&mesh);
}

/* The boundary is closed, outward (it encloses the tets' volume), and in the order of the boundary facets. */
static void boundary_encloses_the_body(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh mesh;
        ShvAdjacency a;
        int32_t *triangles, count;
        const ShvMeshDefinition d = any_body(b, 0.008);
        check_ok(make(&mesh, NULL, &d, &error), error);
        check_ok(shv_adjacency_build(&a, &mesh, &error), error);
        check_ok(shv_mesh_boundary(&mesh, SHV_PART_SHAPE, &triangles, &count, &error), error);
        assert_int_equal(count, a.facet_count - a.interior_count);
        for (int32_t t = 0; t < count; t++) {
            const int32_t facet = a.interior_count + t;
            for (int i = 0; i < 3; i++)
                assert_int_equal(
                    triangles[3 * t + i],
                    mesh.elements[4 * a.facet_elements[2 * facet] + shv_face_corners[a.facet_faces[2 * facet]][i]]);
        }
        check_boundary_closed(triangles, count);
        const double volume = shv_mesh_quality(&mesh).volume;
        check_near(enclosed_volume(&mesh, triangles, count), volume, 1e-12 * volume);
        shv_release(triangles);
        shv_adjacency_release(&a);
        shv_mesh_release(&mesh);
    }
}

/* Thousands of elements around one node: its bucket of faces is sorted in n log n. */
static void one_node_in_all_elements(void **state)
{
    (void)state;
    ShvError error;
    ShvMesh mesh;
    const ShvMeshDefinition d = body(SHV_MESH_BALL, 0.004);
    check_ok(make(&mesh, NULL, &d, &error), error);
    int32_t *triangles, count;
    check_ok(shv_mesh_boundary(&mesh, SHV_PART_GENERAL, &triangles, &count, &error), error);
    /* A fan of tets from the centre (node 0) to every surface triangle; other nodes stay unused. */
    for (int32_t t = 0; t < count; t++) {
        mesh.elements[4 * t] = 0;
        for (int i = 0; i < 3; i++) mesh.elements[4 * t + 1 + i] = triangles[3 * t + i];
    }
    mesh.element_count = count;
    ShvAdjacency a;
    check_ok(shv_adjacency_build(&a, &mesh, &error), error);
    assert_int_equal(a.facet_count - a.interior_count, count);
    assert_int_equal(2 * a.interior_count, 3 * count);
    assert_int_equal(a.corner_start[1], count);
    shv_adjacency_release(&a);
    shv_release(triangles);
    shv_mesh_release(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_brute_force),
        cmocka_unit_test(corners_of_every_node),
        cmocka_unit_test(boundary_encloses_the_body),
        cmocka_unit_test(one_node_in_all_elements),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
