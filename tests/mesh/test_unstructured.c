#include "bodies.h"

static ShvMeshDefinition disordered(double x, double y, double z, double edge, uint64_t seed)
{
    ShvMeshDefinition d = shv_mesh_default();
    d.size[0] = x;
    d.size[1] = y;
    d.size[2] = z;
    d.edge = edge;
    d.pattern = SHV_PATTERN_UNSTRUCTURED;
    d.seed = seed;
    return d;
}

static ShvMesh generated(const ShvMeshDefinition *d)
{
    ShvMesh mesh;
    ShvError error;
    check_ok(shv_mesh_generate(&mesh, NULL, d, NULL, &error), error);
    return mesh;
}

static void check_fills(const ShvMesh *mesh, const double size[3])
{
    const double volume = size[0] * size[1] * size[2];
    check_near(shv_mesh_quality(mesh).volume, volume, 1e-12 * volume);
    for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++)
        assert_true(fabs(mesh->positions[i]) <= 0.5 * size[i % 3]);
}

/* Edges as asked for, no sliver, and of all tets none allows less than half the step of the lattice's. */
static void boxes_are_filled_well(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        const ShvMeshDefinition d = disordered(0.06, 0.04, 0.05, 0.005, seed);
        ShvMeshDefinition ordered = d;
        ordered.pattern = SHV_PATTERN_LATTICE;
        ShvMesh mesh = generated(&d), lattice = generated(&ordered);
        const ShvMeshQuality q = shv_mesh_quality(&mesh), l = shv_mesh_quality(&lattice);
        check_fills(&mesh, d.size);
        check_near(q.mean_edge, d.edge, 0.15 * d.edge);
        assert_true(q.smallest_dihedral > 12.0);
        assert_true(q.smallest_altitude > 0.5 * l.smallest_altitude);
        shv_mesh_release(&mesh);
        shv_mesh_release(&lattice);
    }
}

/* The mean direction of facets, n nᵀ weighted by area, is that of a sphere: nothing is preferred. */
static void nothing_has_a_direction(void **state)
{
    (void)state;
    const ShvMeshDefinition d = disordered(0.06, 0.06, 0.06, 0.004, 1);
    ShvMesh mesh = generated(&d);
    double sum[3] = {0.0}, area = 0.0;
    for (int32_t e = 0; e < mesh.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t *n = mesh.elements + 4 * e;
            const ShvVec3 a = shv_mesh_position(&mesh, n[shv_face_corners[k][0]]);
            const ShvVec3 normal = shv_cross(shv_sub(shv_mesh_position(&mesh, n[shv_face_corners[k][1]]), a),
                                             shv_sub(shv_mesh_position(&mesh, n[shv_face_corners[k][2]]), a));
            const double size = shv_norm(normal), part[3] = {normal.x, normal.y, normal.z};
            for (int i = 0; i < 3; i++) sum[i] += part[i] * part[i] / size;
            area += size;
        }
    for (int i = 0; i < 3; i++) check_near(sum[i] / area, 1.0 / 3.0, 0.02);
    shv_mesh_release(&mesh);
}

/* Of any axis: nodes inside, none of them with a facet of three in the middle plane, and tets no flatter than the plate. */
static void plates_have_an_inside(void **state)
{
    (void)state;
    for (int thin = 0; thin < 3; thin++) {
        ShvMeshDefinition d = disordered(0.1, 0.1, 0.1, 0.007, 2);
        d.size[thin] = 0.004;
        ShvMesh mesh = generated(&d);
        const ShvMeshQuality q = shv_mesh_quality(&mesh);
        int32_t inside = 0;
        check_fills(&mesh, d.size);
        for (int32_t n = 0; n < mesh.node_count; n++) inside += fabs(mesh.positions[3 * n + thin]) < 0.002;
        assert_true(inside > mesh.node_count / 3);
        assert_true(q.smallest_altitude > 0.3 * d.size[thin]);
        for (int32_t e = 0; e < mesh.element_count; e++) {
            int middle = 0;
            for (int i = 0; i < 4; i++)
                middle += fabs(mesh.positions[3 * mesh.elements[4 * e + i] + thin]) < 0.25 * d.size[thin];
            assert_true(middle < 3);
        }
        shv_mesh_release(&mesh);
    }
}

static void a_seed_makes_its_mesh(void **state)
{
    (void)state;
    const ShvMeshDefinition d = disordered(0.03, 0.03, 0.03, 0.005, 7), other = disordered(0.03, 0.03, 0.03, 0.005, 8);
    ShvMesh first = generated(&d), second = generated(&d), third = generated(&other);
    assert_int_equal(first.node_count, second.node_count);
    assert_memory_equal(first.positions, second.positions, 24 * (size_t)first.node_count);
    assert_memory_equal(first.elements, second.elements, 16 * (size_t)first.element_count);
    assert_true(third.node_count != first.node_count ||
                memcmp(first.positions, third.positions, 24 * (size_t)first.node_count) != 0);
    shv_mesh_release(&first);
    shv_mesh_release(&second);
    shv_mesh_release(&third);
}

/* A cup: a disk of radius 30 mm and height 40 mm without one of 25 mm from 5 mm up. */
static const double cup[] = {0.0, 0.0, 0.03, 0.0, 0.03, 0.04, 0.025, 0.04, 0.025, 0.005, 0.0, 0.005};

static ShvMeshDefinition turned(const double *profile, int32_t count, double edge)
{
    ShvMeshDefinition d = shv_mesh_default();
    d.kind = SHV_MESH_TURNED;
    d.profile = profile;
    d.profile_count = count;
    d.edge = edge;
    return d;
}

static void profiles_are_turned(void **state)
{
    (void)state;
    const ShvMeshDefinition d = turned(cup, 6, 0.004);
    ShvMesh mesh = generated(&d);
    const ShvMeshQuality q = shv_mesh_quality(&mesh);
    const double volume = 3.14159265358979323846 * (0.03 * 0.03 * 0.04 - 0.025 * 0.025 * 0.035);
    /* Chords cut off (edge/radius)²/6 of a section, inside and outside alike. */
    check_near(q.volume, volume, 0.02 * volume);
    check_near(q.mean_edge, d.edge, 0.15 * d.edge);
    assert_true(q.smallest_altitude > 0.2 * d.edge);
    for (int32_t n = 0; n < mesh.node_count; n++) {
        const double *x = mesh.positions + 3 * n, r = sqrt(x[0] * x[0] + x[1] * x[1]);
        assert_true(r < 0.03 + 1e-15 && x[2] >= 0.0 && x[2] <= 0.04);
        assert_true(r > 0.025 - 1e-15 || x[2] <= 0.005);
    }
    shv_mesh_release(&mesh);
}

/* Both sides of a wall that is thinner than edges keep their points: the body is all there, and no node is beside its surface. A
   share of a tenth or more used to be missing from walls of half an edge. */
static void thin_walls_are_whole(void **state)
{
    (void)state;
    /* A conical cup, radii of 30 and 40 mm, with walls of 3, 2 and 1.2 mm on edges of 4 mm. */
    for (double wall = 0.003; wall > 0.001; wall = wall == 0.003 ? 0.002 : wall - 0.0008) {
        const double profile[] = {0.0, 0.0, 0.03, 0.0, 0.04, 0.06, 0.04 - wall, 0.06, 0.03 - wall, wall, 0.0, wall};
        const ShvMeshDefinition d = turned(profile, 6, 0.004);
        ShvMesh mesh = generated(&d);
        const ShvMeshQuality q = shv_mesh_quality(&mesh);
        double volume = 0.0;
        for (int i = 0; i < 6; i++) {
            const double *a = profile + 2 * i, *b = profile + 2 * ((i + 1) % 6);
            volume += 3.14159265358979323846 / 3.0 * (b[1] - a[1]) * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]);
        }
        check_near(q.volume, volume, 0.03 * volume);
        check_near(q.mean_edge, d.edge, 0.2 * d.edge); /* 1 to 16 % more: there are no short edges from points inside */
        int32_t inner = 0, outer = 0;
        for (int32_t n = 0; n < mesh.node_count; n++) {
            const double *x = mesh.positions + 3 * n,
                         from_outside = 0.03 + x[2] / 6.0 - sqrt(x[0] * x[0] + x[1] * x[1]);
            outer += fabs(from_outside) < 1e-12;
            inner += x[2] > 1.5 * wall && from_outside > 0.5 * wall;
        }
        check_near((double)inner / outer, 1.0, 0.25);
        shv_mesh_release(&mesh);
    }
}

static void refused(ShvMeshDefinition d, const char *words)
{
    ShvMesh mesh;
    ShvError error;
    assert_int_equal(shv_mesh_generate(&mesh, NULL, &d, NULL, &error), SHV_BAD_INPUT);
    assert_non_null(strstr(error.message, words));
    assert_null(mesh.positions);
}

static void bad_bodies_are_refused(void **state)
{
    (void)state;
    static const double eight[] = {0.01, 0.0, 0.02, 0.01, 0.01, 0.01, 0.02, 0.0};
    static const double left[] = {-0.01, 0.0, 0.02, 0.0, 0.02, 0.01}, twice[] = {0.01, 0.0, 0.01, 0.0, 0.02, 0.01};
    static const double near_axis[] = {9e-18, 0.0, 0.02, 0.0, 0.02, 0.01, 0.0, 0.01};
    refused(turned(NULL, 0, 0.004), "its profile has 0 corners");
    refused(turned(near_axis, 4, 0.004), "off the axis");
    refused(turned(eight, 4, 0.004), "crosses itself after corners 1 and 3");
    refused(turned(left, 3, 0.004), "corner 1 of its profile has the radius -0.01");
    refused(turned(twice, 3, 0.004), "corner 1 of its profile is the next one, too");
    refused(turned(cup, 6, 0.0), "edge is 0 m");
    refused(turned(cup, 6, 0.1), "is too long for its volume");
    refused(turned(cup, 6, 1e-6), "elements");
    refused(turned(cup, 6, 0.03), "choose an edge no longer than its thinnest wall");
    refused(disordered(0.1, 0.1, 0.1, 1e-6, 0), "elements");
    refused(disordered(0.1, 0.1, 0.001, 1e-6, 0), "elements");
    refused(disordered(0.1, 0.1, 0.001, 0.01, 0), "more than twice the thinnest side");
}

static void memory_can_be_out(void **state)
{
    (void)state;
    const ShvMeshDefinition bodies[3] = {disordered(0.02, 0.02, 0.02, 0.006, 1),
                                         disordered(0.03, 0.03, 0.004, 0.006, 1), turned(cup, 6, 0.006)};
    for (int i = 0; i < 3; i++) {
        ShvStatus status = SHV_NO_MEMORY;
        for (int64_t count = 0; status != SHV_OK; count += 1 + count / 8) {
            ShvMemory *memory = shv_memory_create();
            ShvMesh mesh;
            ShvError error;
            shv_memory_fail_after(memory, count);
            status = shv_mesh_generate(&mesh, memory, &bodies[i], NULL, &error);
            shv_mesh_release(&mesh);
            assert_true(status == SHV_OK || status == SHV_NO_MEMORY);
            assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
            shv_memory_destroy(memory);
            assert_true(count < 1000);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_filled_well),  cmocka_unit_test(nothing_has_a_direction),
        cmocka_unit_test(plates_have_an_inside),  cmocka_unit_test(a_seed_makes_its_mesh),
        cmocka_unit_test(profiles_are_turned),    cmocka_unit_test(thin_walls_are_whole),
        cmocka_unit_test(bad_bodies_are_refused), cmocka_unit_test(memory_can_be_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
