#include "bodies.h"

static void every_kind_is_made_sound_and_renumbered(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMesh mesh;
        ShvMeshDefinition d = any_body(b, 0.01);
        d.jitter = 0.2;
        check_ok(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), error);
        check_ok(shv_mesh_validate(&mesh, "made", &error), error);
        /* Nodes are numbered by first use. */
        int32_t used = 0;
        for (int32_t i = 0; i < 4 * mesh.element_count; i++) {
            assert_true(mesh.elements[i] <= used);
            used += mesh.elements[i] == used;
        }
        shv_mesh_release(&mesh);
    }
}

static void refused(ShvMeshDefinition d, ShvStatus status, const char *part)
{
    ShvMesh mesh;
    ShvError error;
    check_fails(shv_mesh_generate(&mesh, NULL, &d, "folder", &error), status, error, part);
    assert_null(mesh.positions);
}

static void bad_definitions_are_refused(void **state)
{
    (void)state;
    ShvMeshDefinition d = body(SHV_MESH_BOX, 0.01);
    d.cookie = 0;
    refused(d, SHV_BAD_INPUT, "shv_mesh_default()");
    d = body((ShvMeshKind)99, 0.01);
    refused(d, SHV_BAD_INPUT, "99");
    d = body(SHV_MESH_BALL, 0.01);
    d.jitter = 0.5;
    refused(d, SHV_BAD_INPUT, "jitter is 0.5");
    d = body(SHV_MESH_GMSH, 0.01);
    refused(d, SHV_BAD_INPUT, "no file");
    d.file = "plate.msh";
    d.scale = 0.0;
    refused(d, SHV_BAD_INPUT, "scale is 0");
    d.scale = 1.0;
    refused(d, SHV_FILE_ERROR, "folder/plate.msh");
    d.file = "/no/such/plate.msh";
    refused(d, SHV_FILE_ERROR, "/no/such/plate.msh");
}

static ShvStatus make_and_connect(ShvMemory *memory, const ShvMeshDefinition *d, ShvError *error)
{
    ShvMesh mesh;
    ShvAdjacency adjacency;
    int32_t *triangles, count;
    SHV_TRY(shv_mesh_generate(&mesh, memory, d, NULL, error));
    ShvStatus status = shv_adjacency_build(&adjacency, &mesh, error);
    if (status == SHV_OK) {
        status = shv_mesh_boundary(&mesh, SHV_PART_SHAPE, &triangles, &count, error);
        if (status == SHV_OK) shv_release(triangles);
        shv_adjacency_release(&adjacency);
    }
    shv_mesh_release(&mesh);
    return status;
}

/* Every allocation is made to fail once: an error each time, and nothing is left behind. */
static void failed_allocations_leave_nothing(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++) {
        ShvMemory *memory = shv_memory_create();
        ShvMeshDefinition d = any_body(b, 0.012);
        d.jitter = 0.1;
        check_ok(make_and_connect(memory, &d, &error), error);
        const int64_t requests = shv_memory_requests(memory);
        assert_true(requests > 20);
        for (int64_t i = 0; i < requests; i++) {
            shv_memory_fail_after(memory, i);
            check_fails(make_and_connect(memory, &d, &error), SHV_NO_MEMORY, error, "out of memory");
            assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        }
        shv_memory_fail_after(memory, -1);
        shv_memory_destroy(memory);
    }
}

static void tets_from_memory_are_copied_or_refused(void **state)
{
    (void)state;
    static const double positions[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    int32_t tets[8] = {0, 1, 2, 3, 1, 2, 3, 4};
    ShvMeshDefinition d = shv_mesh_default();
    ShvMesh mesh;
    ShvError error;
    d.kind = SHV_MESH_MEMORY;
    check_fails(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), SHV_BAD_INPUT, error, "from memory has 0 nodes");
    d.positions = positions;
    d.tets = tets;
    d.node_count = 5;
    d.tet_count = 2;
    check_ok(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), error);
    assert_int_equal(mesh.node_count, 5);
    assert_int_equal(mesh.element_count, 2);
    shv_mesh_release(&mesh);
    tets[6] = 5;
    check_fails(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), SHV_BAD_INPUT, error, "tet 1 names node 5");
    tets[6] = 2;
    check_fails(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), SHV_BAD_INPUT, error, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_is_made_sound_and_renumbered),
        cmocka_unit_test(bad_definitions_are_refused),
        cmocka_unit_test(failed_allocations_leave_nothing),
        cmocka_unit_test(tets_from_memory_are_copied_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
