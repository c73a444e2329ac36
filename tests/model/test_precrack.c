/* Cracks that are there from the start. */
#include "check.h"

#include "mesh/generate.h"
#include "model/precrack.h"

/* Where a plane between bricks lies: five of them in 2 m. */
static const double plane = 0.2;

static ShvObjectDefinition block(void)
{
    ShvObjectDefinition object = shv_object_default();
    object.name = "block";
    object.mesh.kind = SHV_MESH_BOX;
    object.mesh.pattern = SHV_PATTERN_BRICKS;
    for (int k = 0; k < 3; k++) object.mesh.size[k] = k == 0 ? 2.0 : 1.0;
    object.mesh.edge = 0.5;
    return object;
}

static ShvCrackDefinition crack_at(double x)
{
    return (ShvCrackDefinition){
        .plane = {.kind = SHV_SELECT_PLANE, .plane_normal = {1.0, 0.0, 0.0}, .plane_offset = x, .tolerance = 1e-9},
        .box = {.kind = SHV_SELECT_BOX, .box_min = {-9.0, -9.0, -9.0}, .box_max = {9.0, 9.0, 9.0}}};
}

static int32_t nodes_at(const ShvMesh *mesh, double x)
{
    int32_t count = 0;
    for (int32_t i = 0; i < mesh->node_count; i++) count += fabs(mesh->positions[3 * i] - x) < 1e-9;
    return count;
}

/* Nodes that tets of both sides of the plane have in common. */
static int32_t shared_nodes(const ShvMesh *mesh)
{
    int32_t shared = 0;
    for (int32_t n = 0; n < mesh->node_count; n++) {
        bool side[2] = {false, false};
        for (int32_t e = 0; e < mesh->element_count; e++) {
            double centre = 0.0;
            bool has = false;
            for (int k = 0; k < 4; k++) {
                centre += mesh->positions[3 * (int64_t)mesh->elements[4 * e + k]];
                has |= mesh->elements[4 * e + k] == n;
            }
            if (has) side[centre > 4.0 * plane] = true;
        }
        shared += side[0] && side[1];
    }
    return shared;
}

static ShvMesh opened(const ShvObjectDefinition *object, ShvMemory *memory, ShvStatus *status, ShvError *error)
{
    ShvMesh mesh;
    check_ok(shv_mesh_generate(&mesh, memory, &object->mesh, NULL, error), *error);
    *status = shv_precrack_open(&mesh, object, error);
    return mesh;
}

static void through_and_half_way(void **state)
{
    (void)state;
    ShvObjectDefinition object = block();
    ShvStatus status;
    ShvError error;
    ShvMesh whole = opened(&object, NULL, &status, &error);
    const int32_t section = nodes_at(&whole, plane);
    assert_true(section == 9 && shared_nodes(&whole) == section);
    /* All of the section: two bodies, and twice its nodes. */
    ShvCrackDefinition crack = crack_at(plane);
    object.cracks = &crack;
    object.crack_count = 1;
    ShvMesh parted = opened(&object, NULL, &status, &error);
    assert_int_equal(status, SHV_OK);
    assert_int_equal(parted.node_count, whole.node_count + section);
    assert_int_equal(parted.element_count, whole.element_count);
    assert_int_equal(shared_nodes(&parted), 0);
    check_ok(shv_mesh_validate(&parted, "parted", &error), error);
    check_near(shv_mesh_mass(&parted).mass, shv_mesh_mass(&whole).mass, 1e-15);
    shv_mesh_release(&parted);
    /* The half with y < 0: the nodes of its front, y = 0, stay one; those behind it are two. */
    crack.box.box_max[1] = 0.0;
    parted = opened(&object, NULL, &status, &error);
    int32_t behind = 0;
    for (int32_t i = 0; i < whole.node_count; i++)
        behind += fabs(whole.positions[3 * i] - plane) < 1e-9 && whole.positions[3 * i + 1] < -1e-9;
    assert_true(behind > 0 && behind < section);
    assert_int_equal(parted.node_count, whole.node_count + behind);
    assert_int_equal(shared_nodes(&parted), section - behind);
    shv_mesh_release(&parted);
    shv_mesh_release(&whole);
}

static void meets_no_facet(void **state)
{
    (void)state;
    ShvObjectDefinition object = block();
    ShvCrackDefinition cracks[2] = {crack_at(plane), crack_at(plane)};
    ShvStatus status;
    ShvError error;
    object.cracks = cracks;
    object.crack_count = 2;
    for (int i = 0; i < 3; i++) {
        cracks[1] = crack_at(i == 0 ? 0.1 : i == 1 ? 1.0 : plane); /* between facets, on the surface, beside its box */
        if (i == 2) cracks[1].box.box_min[2] = 2.0;
        ShvMesh mesh = opened(&object, NULL, &status, &error);
        assert_int_equal(status, SHV_BAD_INPUT);
        assert_non_null(strstr(error.message, "objects.block.cracks.1 meets no facet"));
        shv_mesh_release(&mesh);
    }
}

static void no_memory(void **state)
{
    (void)state;
    ShvObjectDefinition object = block();
    const ShvCrackDefinition crack = crack_at(plane);
    ShvMemory *memory = shv_memory_create();
    ShvStatus status = SHV_NO_MEMORY;
    int64_t failures = 0;
    object.cracks = &crack;
    object.crack_count = 1;
    while (status != SHV_OK) {
        ShvMesh mesh;
        ShvError error;
        shv_memory_fail_after(memory, -1);
        check_ok(shv_mesh_generate(&mesh, memory, &object.mesh, NULL, &error), error);
        shv_memory_fail_after(memory, failures);
        status = shv_precrack_open(&mesh, &object, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        failures++;
        shv_mesh_release(&mesh);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    }
    assert_true(failures > 5);
    shv_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(through_and_half_way), cmocka_unit_test(meets_no_facet),
                                       cmocka_unit_test(no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
