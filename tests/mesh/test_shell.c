#include "check.h"

#include "files.h"
#include "mesh/adjacency.h"
#include "mesh/generate.h"
#include "mesh/shell.h"

static const char octahedron[] = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
                                 "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";

/* The surface of a box about the origin, its edges in equal parts; every square has corners of its own. */
static void write_box(const char *path, const double size[3], const int parts[3])
{
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    for (int face = 0; face < 6; face++) {
        const int normal = face / 2, side = face % 2, u = (normal + 1 + side) % 3, v = 3 - normal - u;
        for (int square = 0; square < parts[u] * parts[v]; square++) {
            static const int turn[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            for (int corner = 0; corner < 4; corner++) {
                double x[3];
                x[normal] = side ? -0.5 * size[normal] : 0.5 * size[normal];
                x[u] = size[u] * ((double)(square % parts[u] + turn[corner][0]) / parts[u] - 0.5);
                x[v] = size[v] * ((double)(square / parts[u] + turn[corner][1]) / parts[v] - 0.5);
                fprintf(out, "v %.17g %.17g %.17g\n", x[0], x[1], x[2]);
            }
            fprintf(out, "f -4 -3 -2 -1\n");
        }
    }
    assert_int_equal(fclose(out), 0);
}
static const double unit_cube[3] = {1.0, 1.0, 1.0};

static ShvMeshDefinition definition_of(double thickness, int32_t layers, int64_t refine_to)
{
    ShvMeshDefinition definition = shv_mesh_default();
    definition.kind = SHV_MESH_SHELL;
    definition.thickness = thickness;
    definition.layers = layers;
    definition.refine_to = refine_to;
    return definition;
}

static ShvMesh make_shell(const char *path, double thickness, int32_t layers, int64_t refine_to)
{
    ShvError error;
    ShvMesh mesh;
    const ShvMeshDefinition definition = definition_of(thickness, layers, refine_to);
    check_ok(shv_mesh_shell(&mesh, NULL, &definition, path, &error), error);
    return mesh;
}

/* Valid, and the walls of neighbouring prisms conform: only the outside and the inside are left without partner. */
static void check_conforms(const ShvMesh *mesh, int32_t triangles)
{
    ShvError error;
    ShvAdjacency adjacency;
    check_ok(shv_mesh_validate(mesh, "shell", &error), error);
    check_ok(shv_adjacency_build(&adjacency, mesh, &error), error);
    assert_int_equal(adjacency.facet_count - adjacency.interior_count, 2 * triangles);
    shv_adjacency_release(&adjacency);
}

static double depth_of(const ShvMesh *mesh, int32_t layers, int32_t node)
{
    const int32_t inner = node + mesh->node_count / (layers + 1) * layers;
    return shv_norm(shv_sub(shv_mesh_position(mesh, node), shv_mesh_position(mesh, inner)));
}

/* Its normals are radial by symmetry, so the inside is an octahedron too: V = 4/3 (1 − (1 − t)³). */
static void octahedron_has_the_exact_volume(void **state)
{
    (void)state;
    const TemporaryFile file = temporary_file("octahedron.obj");
    write_bytes(file.path, octahedron, strlen(octahedron));
    for (int32_t layers = 1; layers <= 5; layers++)
        for (int i = 1; i <= 2; i++) {
            const double t = 0.1 * i;
            const ShvMesh mesh = make_shell(file.path, t, layers, 0);
            assert_int_equal(mesh.node_count, (layers + 1) * 6);
            assert_int_equal(mesh.element_count, 3 * layers * 8);
            check_conforms(&mesh, 8);
            check_near(mesh_volume(&mesh), 4.0 / 3.0 * (1.0 - (1.0 - t) * (1.0 - t) * (1.0 - t)), 1e-14);
            ShvMesh done = mesh;
            shv_mesh_release(&done);
        }
    remove_temporary_file(&file);
}

/* Weights by angle give a cube's corner its diagonal, however the faces are cut: the inside is a cube whose half edge
   is smaller by t/√3. Weights by triangle would tilt it. */
static void cube_does_not_depend_on_its_diagonals(void **state)
{
    (void)state;
    const double t = 0.2, inner = 0.5 - t / sqrt(3.0);
    const TemporaryFile file = temporary_file("cube.obj");
    write_box(file.path, unit_cube, (const int[]){1, 1, 1});
    ShvMesh mesh = make_shell(file.path, t, 2, 0);
    assert_int_equal(mesh.node_count, 24);
    assert_int_equal(mesh.element_count, 72);
    check_conforms(&mesh, 12);
    for (int v = 16; v < 24; v++)
        for (int k = 0; k < 3; k++) check_near(fabs(mesh.positions[3 * v + k]), inner, 1e-14);
    check_near(mesh_volume(&mesh), 1.0 - 8.0 * inner * inner * inner, 1e-14);
    shv_mesh_release(&mesh);
    remove_temporary_file(&file);
}

/* Near the edges of a cube full depth would turn prisms over. Depth is lost there, not in the faces, by slopes of one
   half along edges. */
static void reduces_depth_at_sharp_edges(void **state)
{
    (void)state;
    const double t = 0.2;
    ShvError error;
    ShvSurface surface;
    const TemporaryFile file = temporary_file("cube.obj");
    write_box(file.path, unit_cube, (const int[]){16, 16, 16});
    for (int32_t layers = 1; layers <= 3; layers++) {
        ShvMesh mesh = make_shell(file.path, t, layers, 0);
        assert_int_equal(mesh.element_count, 3 * layers * 3072);
        assert_int_equal(mesh.node_count, (layers + 1) * 1538);
        check_conforms(&mesh, 3072);
        check_ok(shv_surface_read(&surface, NULL, SHV_PART_MESH, file.path, 1.0, &error), error);
        int full = 0, reduced = 0;
        for (int v = 0; v < 1538; v++) {
            const double depth = depth_of(&mesh, layers, v);
            assert_true(depth >= 0.05 * t - 1e-15 && depth <= t + 1e-15);
            full += depth > t - 1e-12;
            reduced += depth < t - 1e-12;
        }
        assert_true(full > 100 && reduced > 100);
        for (int i = 0; i < 3 * 3072; i++) {
            const int32_t a = surface.triangles[i], b = surface.triangles[i / 3 * 3 + (i + 1) % 3];
            const double edge = shv_norm(shv_sub(shv_mesh_position(&mesh, a), shv_mesh_position(&mesh, b)));
            assert_true(depth_of(&mesh, layers, a) <= depth_of(&mesh, layers, b) + 0.5 * edge + 1e-12);
        }
        shv_surface_release(&surface);
        shv_mesh_release(&mesh);
    }
    remove_temporary_file(&file);
}

/* In a plate thinner than two walls each wall keeps 0.45 of it, and none passes the middle. */
static void opposite_walls_do_not_meet(void **state)
{
    (void)state;
    static const double plate[3] = {1.0, 1.0, 0.1};
    const TemporaryFile file = temporary_file("plate.obj");
    write_box(file.path, plate, (const int[]){20, 20, 2});
    ShvMesh mesh = make_shell(file.path, 0.08, 1, 0);
    const int32_t outer = mesh.node_count / 2;
    int faces = 0;
    check_conforms(&mesh, 2 * (2 * 400 + 4 * 40));
    for (int32_t v = 0; v < outer; v++) {
        const ShvVec3 x = shv_mesh_position(&mesh, v), y = shv_mesh_position(&mesh, v + outer);
        if (fabs(x.x) > 0.35 || fabs(x.y) > 0.35) continue; /* the rim's slopes do not reach here */
        faces++;
        check_near(y.z, x.z > 0.0 ? 0.005 : -0.005, 1e-14);
    }
    assert_true(faces > 200);
    assert_true(mesh_volume(&mesh) < 0.1);
    shv_mesh_release(&mesh);
    remove_temporary_file(&file);
}

static void refuses_what_has_no_room(void **state)
{
    (void)state;
    ShvError error = {0};
    ShvMesh mesh;
    const TemporaryFile file = temporary_file("needle.obj");
    /* A plate a fiftieth as thick as its shell should be, and a needle of which nothing would be left at the tip. */
    ShvMeshDefinition definition = definition_of(0.5, 1, 0);
    static const double plate[3] = {1.0, 1.0, 0.01};
    write_box(file.path, plate, (const int[]){4, 4, 1});
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error,
                "there is no room for a shell of 0.5 m at triangle");
    assert_null(mesh.positions);
    const char *needle = "v 0 0 10\nv 0.1 0 0\nv -0.05 0.09 0\nv -0.05 -0.09 0\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
    write_bytes(file.path, needle, strlen(needle));
    definition.thickness = 0.1;
    definition.refine_to = 2000;
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error,
                "needle.obj: there is no room");
    remove_temporary_file(&file);
}

static void refuses_bad_definitions(void **state)
{
    (void)state;
    ShvError error = {0};
    ShvMesh mesh;
    const TemporaryFile file = temporary_file("octahedron.obj");
    write_bytes(file.path, octahedron, strlen(octahedron));
    static const double thicknesses[] = {0.0, -0.1, (double)NAN, HUGE_VAL};
    for (int i = 0; i < 4; i++) {
        const ShvMeshDefinition bad = definition_of(thicknesses[i], 1, 0);
        check_fails(shv_mesh_shell(&mesh, NULL, &bad, file.path, &error), SHV_BAD_INPUT, error, "thickness");
    }
    ShvMeshDefinition definition = definition_of(0.1, 0, 0);
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error, "at least 1 layer");
    definition = definition_of(0.1, 1, -1);
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error, "refine_to");
    definition = definition_of(0.1, INT32_MAX, 0);
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error,
                "too many for one mesh");
    assert_null(mesh.positions);
    /* Larger than the body: whatever the reduction leaves is no such shell. */
    definition = definition_of(1e300, 1, 0);
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error, "no room");
    write_bytes(file.path, octahedron, strlen(octahedron) - 8);
    definition = definition_of(0.1, 1, 0);
    check_fails(shv_mesh_shell(&mesh, NULL, &definition, file.path, &error), SHV_BAD_INPUT, error, "not closed");
    remove_temporary_file(&file);
}

/* Distance to a plane and the side of its edges, for every triangle that does not meet at the node. */
static double brute_force_room(const ShvShell *shell, int32_t node)
{
    const ShvVec3 from = shv_surface_position(&shell->surface, node);
    const ShvVec3 direction = shv_scale(shv_load3(shell->normals + 3 * (int64_t)node), -1.0);
    double nearest = HUGE_VAL;
    for (int32_t t = 0; t < shell->surface.triangle_count; t++) {
        const int32_t *c = shv_shell_corners(shell, t);
        if (c[0] == node || c[1] == node || c[2] == node) continue;
        ShvVec3 x[3];
        for (int k = 0; k < 3; k++) x[k] = shv_surface_position(&shell->surface, c[k]);
        const ShvVec3 normal = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
        if (shv_dot(direction, normal) <= 0.0) continue;
        const double distance = shv_dot(shv_sub(x[0], from), normal) / shv_dot(direction, normal);
        const ShvVec3 hit = shv_madd(from, distance, direction);
        bool inside = distance > 0.0;
        for (int k = 0; k < 3; k++)
            inside = inside && shv_dot(shv_cross(shv_sub(x[(k + 1) % 3], x[k]), shv_sub(hit, x[k])), normal) >= 0.0;
        if (inside) nearest = fmin(nearest, distance);
    }
    return nearest;
}

/* A ball-like surface with random dents and random directions: no ray goes through an edge. */
static void sees_what_brute_force_sees(void **state)
{
    (void)state;
    ShvError error;
    ShvShell shell = {.layers = 1};
    const TemporaryFile file = temporary_file("octahedron.obj");
    write_bytes(file.path, octahedron, strlen(octahedron));
    check_ok(shv_surface_read(&shell.surface, NULL, SHV_PART_MESH, file.path, 1.0, &error), error);
    check_ok(shv_surface_refine(&shell.surface, 1500, &error), error);
    const int32_t nodes = shell.surface.node_count;
    shell.normals = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)nodes, 3 * sizeof(double));
    shell.depths = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)nodes, sizeof(double));
    for (int64_t v = 0; v < nodes; v++) {
        double *x = shell.surface.positions + 3 * v;
        const ShvVec3 unit = shv_unit(shv_load3(x));
        shv_store3(x, shv_scale(unit, 0.8 + 0.2 * shv_random_uniform(1, (uint64_t)v)));
        const ShvVec3 tilt = {shv_random_uniform(2, (uint64_t)v) - 0.5, shv_random_uniform(3, (uint64_t)v) - 0.5,
                              shv_random_uniform(4, (uint64_t)v) - 0.5};
        shv_store3(shell.normals + 3 * v, shv_unit(shv_add(unit, tilt)));
    }
    for (double reach = 0.01; reach < 1000.0; reach *= 7.0) {
        int hits = 0;
        for (int32_t v = 0; v < nodes; v++) shell.depths[v] = 0.5 * reach;
        check_ok(shv_shell_cap_by_room(&shell, 0.5, reach, &error), error);
        for (int32_t v = 0; v < nodes; v++) {
            const double room = brute_force_room(&shell, v);
            hits += room < reach;
            check_near(shell.depths[v], 0.5 * fmin(room, reach), 1e-12 * fmin(1.0, reach) + 1e-13);
        }
        if (reach > 2.0) assert_true(hits > nodes / 2);
    }
    shv_surface_release(&shell.surface);
    shv_release(shell.normals);
    shv_release(shell.depths);
    remove_temporary_file(&file);
}

static ShvStatus shell_once(ShvMemory *memory, const char *path, ShvError *error)
{
    ShvMesh mesh;
    const ShvMeshDefinition definition = definition_of(0.1, 2, 100);
    const ShvStatus status = shv_mesh_shell(&mesh, memory, &definition, path, error);
    if (status != SHV_OK) {
        assert_null(mesh.positions);
        return status;
    }
    shv_mesh_release(&mesh);
    return SHV_OK;
}

static void survives_failing_allocations(void **state)
{
    (void)state;
    const TemporaryFile file = temporary_file("octahedron.obj");
    write_bytes(file.path, octahedron, strlen(octahedron));
    check_allocation_failures(shell_once, file.path);
    remove_temporary_file(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(octahedron_has_the_exact_volume), cmocka_unit_test(cube_does_not_depend_on_its_diagonals),
        cmocka_unit_test(reduces_depth_at_sharp_edges),    cmocka_unit_test(opposite_walls_do_not_meet),
        cmocka_unit_test(refuses_what_has_no_room),        cmocka_unit_test(refuses_bad_definitions),
        cmocka_unit_test(sees_what_brute_force_sees),      cmocka_unit_test(survives_failing_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
