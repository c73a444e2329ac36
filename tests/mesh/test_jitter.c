#include "bodies.h"

static ShvMesh jittered(const ShvMeshDefinition *d, double amount, uint64_t seed)
{
    ShvMesh mesh;
    ShvError error;
    check_ok(make(&mesh, NULL, d, &error), error);
    check_ok(shv_mesh_jitter(&mesh, amount, seed, &error), error);
    return mesh;
}

/* Sound, of the same volume and boundary volume, with a share of the old shape, and really moved. */
static void meshes_stay_sound(void **state)
{
    (void)state;
    ShvError error;
    for (int b = 0; b < BODY_COUNT; b++)
        for (int i = 0; i < 3; i++) {
            static const double amounts[3] = {0.1, 0.2, 0.3};
            const ShvMeshDefinition d = any_body(b, 0.007);
            ShvMesh before = jittered(&d, 0.0, 7), mesh = jittered(&d, amounts[i], 7);
            check_ok(shv_mesh_validate(&mesh, "jittered", &error), error);
            const ShvMeshQuality old = shv_mesh_quality(&before), q = shv_mesh_quality(&mesh);
            check_near(q.volume, old.volume, 1e-12 * old.volume);
            /* No element keeps less than half of its own aspect. */
            assert_true(q.worst_aspect >= 0.5 * old.worst_aspect);
            assert_true(q.mean_aspect < 0.999 * old.mean_aspect);
            assert_true(q.mean_aspect > 0.85 * old.mean_aspect);
            shv_mesh_release(&mesh);
            shv_mesh_release(&before);
        }
}

static bool on_curved_surface(const ShvMeshDefinition *d, ShvVec3 x)
{
    const bool cylinder = d->kind == SHV_MESH_CYLINDER;
    const double r = sqrt(x.x * x.x + x.y * x.y + (cylinder ? 0.0 : x.z * x.z));
    return fabs(r - d->radius) < 1e-12 || (d->inner_radius > 0.0 && fabs(r - d->inner_radius) < 1e-12);
}

/* Nodes of the box's and the beam's sides keep the coordinate of every side they lie in; nodes of curved surfaces keep
   their distance from the centre or axis. Nodes move by no more than the share of the longest edge. */
static void surfaces_keep_their_shape(void **state)
{
    (void)state;
    for (int b = 0; b < BODY_COUNT; b++) {
        const ShvMeshDefinition d = any_body(b, 0.007);
        const bool flat = d.kind == SHV_MESH_BOX || d.kind == SHV_MESH_NOTCHED_BEAM;
        ShvMesh before = jittered(&d, 0.0, 3), mesh = jittered(&d, 0.3, 3);
        const double longest = shv_mesh_quality(&before).longest_edge;
        int32_t inside_moved = 0, side_moved = 0;
        for (int32_t n = 0; n < mesh.node_count; n++) {
            const ShvVec3 old = shv_mesh_position(&before, n), x = shv_mesh_position(&mesh, n);
            const double moved = shv_norm(shv_sub(x, old));
            int sides = 0;
            assert_true(moved <= 0.3 * longest);
            for (int axis = 0; axis < 3 && flat; axis++) {
                if (fabs(before.positions[3 * n + axis]) != 0.5 * d.size[axis]) continue;
                check_near(mesh.positions[3 * n + axis], before.positions[3 * n + axis], 1e-15);
                sides++;
            }
            if (d.kind == SHV_MESH_CYLINDER && fabs(old.z) == 0.5 * d.height) {
                check_near(x.z, old.z, 1e-15);
                sides++;
            }
            if (!flat && on_curved_surface(&d, old)) {
                check_near(x.x * x.x + x.y * x.y + (d.kind == SHV_MESH_CYLINDER ? 0.0 : x.z * x.z),
                           old.x * old.x + old.y * old.y + (d.kind == SHV_MESH_CYLINDER ? 0.0 : old.z * old.z), 1e-15);
                sides += d.kind == SHV_MESH_CYLINDER ? 1 : 3;
            }
            if (sides == 3) assert_true(moved == 0.0);
            inside_moved += sides == 0 && moved > 0.0;
            side_moved += sides == 1 && moved > 0.0;
        }
        assert_true(inside_moved > 100);
        if (d.kind != SHV_MESH_BALL && d.kind != SHV_MESH_HOLLOW_BALL) assert_true(side_moved > 100);
        shv_mesh_release(&mesh);
        shv_mesh_release(&before);
    }
}

/* The front of the notch does not move, its lips stay in the plane. */
static void check_notch(ShvMeshPattern pattern, double edge)
{
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, edge);
    d.pattern = pattern;
    ShvMesh before = jittered(&d, 0.0, 3), mesh = jittered(&d, 0.3, 3);
    const NotchNodes nodes = check_notch_stays(&d, &before, &mesh);
    assert_true(nodes.front > 10 && nodes.slid > 20);
    shv_mesh_release(&mesh);
    shv_mesh_release(&before);
}

static void notch_stays(void **state)
{
    (void)state;
    check_notch(SHV_PATTERN_LATTICE, 0.007);
    check_notch(SHV_PATTERN_BRICKS, 0.0048);
}

static void the_seed_decides(void **state)
{
    (void)state;
    const ShvMeshDefinition d = body(SHV_MESH_BOX, 0.01);
    ShvMesh a = jittered(&d, 0.2, 5), b = jittered(&d, 0.2, 5), c = jittered(&d, 0.2, 6);
    const size_t bytes = 24 * (size_t)a.node_count;
    assert_memory_equal(a.positions, b.positions, bytes);
    assert_memory_not_equal(a.positions, c.positions, bytes);
    shv_mesh_release(&a);
    shv_mesh_release(&b);
    shv_mesh_release(&c);
}

static void bad_amounts_are_refused(void **state)
{
    (void)state;
    static const double bad[3] = {-0.1, 0.31, (double)NAN};
    const ShvMeshDefinition d = body(SHV_MESH_BOX, 0.02);
    ShvMesh mesh = jittered(&d, 0.0, 0);
    ShvError error;
    for (int i = 0; i < 3; i++)
        check_fails(shv_mesh_jitter(&mesh, bad[i], 0, &error), SHV_BAD_INPUT, error, "between 0 and 0.3");
    shv_mesh_release(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_stay_sound), cmocka_unit_test(surfaces_keep_their_shape), cmocka_unit_test(notch_stays),
        cmocka_unit_test(the_seed_decides),  cmocka_unit_test(bad_amounts_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
