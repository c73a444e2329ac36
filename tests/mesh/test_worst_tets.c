#include "bodies.h"
#include "files.h"

#include "mesh/improve.h"

static const double edge = 0.007;

static double worst(const ShvMesh *mesh)
{
    double least = (double)INFINITY;
    for (int32_t t = 0; t < mesh->element_count; t++)
        least = fmin(least, shv_improve_measure(mesh->positions, mesh->elements + 4 * (int64_t)t));
    return least;
}

static void mark_surface(const ShvMesh *mesh, uint8_t *marks)
{
    int32_t *triangles = NULL, count = 0;
    ShvError error;
    check_ok(shv_mesh_boundary(mesh, SHV_PART_GENERAL, &triangles, &count, &error), error);
    for (int32_t i = 0; i < 3 * count; i++) marks[triangles[i]] = 1;
    shv_release(triangles);
}

/* Nodes inside go nearly into the facet across, as far as all tets stay upright: tets a hundred times flatter than an edge is long. */
static void flatten(ShvMesh *mesh)
{
    uint8_t *done = calloc((size_t)mesh->node_count, 1);
    assert_non_null(done);
    mark_surface(mesh, done);
    for (int32_t t = 0; t < mesh->element_count; t += 40) {
        const int32_t *n = mesh->elements + 4 * (int64_t)t;
        if (done[n[3]]) continue;
        const ShvVec3 a = shv_mesh_position(mesh, n[0]), old = shv_mesh_position(mesh, n[3]);
        const ShvVec3 normal =
            shv_unit(shv_cross(shv_sub(shv_mesh_position(mesh, n[1]), a), shv_sub(shv_mesh_position(mesh, n[2]), a)));
        const double height = shv_dot(normal, shv_sub(old, a));
        shv_store3(mesh->positions + 3 * (int64_t)n[3], shv_madd(old, -0.97 * height, normal));
        if (worst(mesh) <= 0.0) shv_store3(mesh->positions + 3 * (int64_t)n[3], old);
        for (int i = 0; i < 4; i++) done[n[i]] = 1;
    }
    free(done);
}

static ShvMesh spoiled(const ShvMeshDefinition *d)
{
    ShvMesh mesh;
    ShvError error;
    check_ok(make(&mesh, NULL, d, &error), error);
    check_ok(shv_mesh_jitter(&mesh, 0.3, 1, &error), error);
    flatten(&mesh);
    check_ok(shv_mesh_validate(&mesh, "spoiled", &error), error);
    return mesh;
}

static void improve(ShvMesh *mesh, bool curved)
{
    ShvError error;
    check_ok(shv_mesh_improve(mesh, curved, 1, &error), error);
    check_ok(shv_mesh_validate(mesh, "improved", &error), error);
}

/* The step of the worst tet is a fifth of an edge and more, ten times and more what it was. Flat bodies keep their volume to round-off, round
   ones, whose surface nodes slide, to a thousandth. */
static void slivers_go(void **state)
{
    (void)state;
    for (int b = 0; b < BODY_COUNT; b++) {
        const ShvMeshDefinition d = any_body(b, edge);
        const bool flat = d.kind == SHV_MESH_BOX || d.kind == SHV_MESH_NOTCHED_BEAM;
        ShvMesh mesh = spoiled(&d);
        const ShvMeshQuality before = shv_mesh_quality(&mesh);
        const double was = worst(&mesh);
        assert_true(was < 0.02 * edge);
        improve(&mesh, true);
        assert_true(worst(&mesh) > (d.kind == SHV_MESH_NOTCHED_BEAM ? 0.05 : 0.2) * edge);
        check_near(shv_mesh_quality(&mesh).volume, before.volume, (flat ? 1e-12 : 1e-3) * before.volume);
        assert_int_equal(mesh.node_count, before.node_count);
        shv_mesh_release(&mesh);
    }
}

/* Planes keep their nodes exactly, edges and corners of the body stay, and nodes of a round surface stay where they are or, where they may
   slide, within a hundredth of an edge of it. */
static void surfaces_stay(void **state)
{
    (void)state;
    const ShvMeshDefinition box = body(SHV_MESH_BOX, edge), ball = body(SHV_MESH_BALL, edge);
    ShvMesh mesh = spoiled(&box), before = spoiled(&box);
    int32_t slid = 0;
    improve(&mesh, true);
    for (int64_t i = 0; i < 3 * (int64_t)mesh.node_count; i++)
        if (fabs(before.positions[i]) == 0.5 * box.size[i % 3])
            assert_true(mesh.positions[i] == before.positions[i]);
        else
            slid += mesh.positions[i] != before.positions[i];
    assert_true(slid > 100);
    shv_mesh_release(&before);
    shv_mesh_release(&mesh);
    for (int curved = 0; curved < 2; curved++) {
        mesh = spoiled(&ball);
        before = spoiled(&ball);
        improve(&mesh, curved);
        slid = 0;
        for (int32_t n = 0; n < mesh.node_count; n++) {
            const ShvVec3 old = shv_mesh_position(&before, n), x = shv_mesh_position(&mesh, n);
            if (fabs(shv_norm(old) - ball.radius) > 1e-9) continue;
            check_near(shv_norm(x), ball.radius, 0.01 * edge);
            slid += shv_norm(shv_sub(x, old)) > 0.0;
        }
        assert_true(curved ? slid > 10 : slid == 0);
        shv_mesh_release(&before);
        shv_mesh_release(&mesh);
    }
}

/* The lips of a notch stay in its plane, its front where it is. */
static void notches_stay(void **state)
{
    (void)state;
    const ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, edge);
    ShvMesh mesh = spoiled(&d), before = spoiled(&d);
    improve(&mesh, true);
    assert_true(check_notch_stays(&d, &before, &mesh).front > 10);
    shv_mesh_release(&before);
    shv_mesh_release(&mesh);
}

/* Tags of a file may be any whole number. */
static const int32_t tags[2] = {INT32_MIN, -1};

/* Two groups with a jagged border: each keeps its volume, and nodes of the border their places. */
static ShvMesh grouped(void)
{
    ShvError error;
    const ShvMeshDefinition d = body(SHV_MESH_BOX, edge);
    ShvMesh mesh = spoiled(&d);
    check_ok(shv_mesh_add_groups(&mesh, &error), error);
    for (int32_t t = 0; t < mesh.element_count; t++) {
        double x = 0.0;
        for (int i = 0; i < 4; i++) x += mesh.positions[3 * (int64_t)mesh.elements[4 * (int64_t)t + i]];
        mesh.element_groups[t] = x > 0.0 ? tags[1] : tags[0];
    }
    return mesh;
}

static double group_volume(const ShvMesh *mesh, int32_t group)
{
    double volume = 0.0;
    for (int32_t t = 0; t < mesh->element_count; t++)
        if (mesh->element_groups[t] == group) volume += shv_mesh_element_volume(mesh, t);
    return volume;
}

static void groups_keep_their_shape(void **state)
{
    (void)state;
    ShvMesh mesh = grouped(), before = grouped();
    uint8_t *seen = calloc((size_t)before.node_count, 1);
    assert_non_null(seen);
    for (int32_t i = 0; i < 4 * before.element_count; i++)
        seen[before.elements[i]] |= before.element_groups[i / 4] == tags[1] ? 1 : 2;
    improve(&mesh, true);
    assert_true(worst(&mesh) > 5.0 * worst(&before));
    for (int i = 0; i < 2; i++) {
        const double volume = group_volume(&before, tags[i]);
        assert_true(volume > 0.0);
        check_near(group_volume(&mesh, tags[i]), volume, 1e-12 * volume);
    }
    int32_t common = 0;
    for (int32_t n = 0; n < mesh.node_count; n++) {
        if (seen[n] != 3) continue;
        assert_memory_equal(mesh.positions + 3 * (int64_t)n, before.positions + 3 * (int64_t)n, 3 * sizeof(double));
        common++;
    }
    assert_true(common > 50);
    free(seen);
    shv_mesh_release(&before);
    shv_mesh_release(&mesh);
}

static void the_seed_decides(void **state)
{
    (void)state;
    const ShvMeshDefinition d = body(SHV_MESH_BALL, 0.01);
    ShvError error;
    ShvMesh mesh[3];
    for (int i = 0; i < 3; i++) {
        mesh[i] = spoiled(&d);
        check_ok(shv_mesh_improve(&mesh[i], true, i < 2 ? 1 : 2, &error), error);
    }
    const size_t bytes = 24 * (size_t)mesh[0].node_count;
    assert_memory_equal(mesh[0].positions, mesh[1].positions, bytes);
    assert_memory_not_equal(mesh[0].positions, mesh[2].positions, bytes);
    for (int i = 0; i < 3; i++) shv_mesh_release(&mesh[i]);
}

static ShvStatus improve_once(ShvMemory *memory, const char *path, ShvError *error)
{
    (void)path;
    ShvMesh mesh;
    const ShvMeshDefinition d = body(SHV_MESH_BOX, 0.02);
    SHV_TRY(make(&mesh, memory, &d, error));
    ShvStatus status = shv_mesh_add_groups(&mesh, error);
    if (status == SHV_OK) mesh.element_groups[0] = 1;
    if (status == SHV_OK) status = shv_mesh_improve(&mesh, true, 1, error);
    shv_mesh_release(&mesh);
    return status;
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    check_allocation_failures(improve_once, NULL);
}

static void generated_meshes_are_not_improved(void **state)
{
    (void)state;
    ShvMesh mesh;
    ShvError error;
    ShvMeshDefinition d = body(SHV_MESH_BOX, 0.02);
    d.improve = true;
    check_fails(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), SHV_BAD_INPUT, error, "leave it out");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slivers_go),
        cmocka_unit_test(surfaces_stay),
        cmocka_unit_test(notches_stay),
        cmocka_unit_test(groups_keep_their_shape),
        cmocka_unit_test(the_seed_decides),
        cmocka_unit_test(survives_failing_allocations),
        cmocka_unit_test(generated_meshes_are_not_improved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
