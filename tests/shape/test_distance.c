#include "check.h"

#include "shape/scene.h"

/* ---- oracles ---- */

static double segment_distance(ShvVec3 p, ShvVec3 a, ShvVec3 b)
{
    const ShvVec3 ab = shv_sub(b, a);
    const double t = fmax(0.0, fmin(1.0, shv_dot(shv_sub(p, a), ab) / shv_dot(ab, ab)));
    return shv_norm(shv_sub(p, shv_madd(a, t, ab)));
}

/* The foot of the perpendicular when it lies in the triangle, else the nearest edge. */
static double triangle_distance(ShvVec3 p, ShvVec3 a, ShvVec3 b, ShvVec3 c)
{
    const ShvVec3 normal = shv_unit(shv_cross(shv_sub(b, a), shv_sub(c, a)));
    const double height = shv_dot(shv_sub(p, a), normal);
    const ShvVec3 foot = shv_madd(p, -height, normal);
    if (shv_dot(shv_cross(shv_sub(b, a), shv_sub(foot, a)), normal) >= 0.0 &&
        shv_dot(shv_cross(shv_sub(c, b), shv_sub(foot, b)), normal) >= 0.0 &&
        shv_dot(shv_cross(shv_sub(a, c), shv_sub(foot, c)), normal) >= 0.0)
        return fabs(height);
    return fmin(segment_distance(p, a, b), fmin(segment_distance(p, b, c), segment_distance(p, c, a)));
}

/* Solid angle of a triangle (A. Van Oosterom and J. Strackee, 1983); summed over the surface 4π inside, 0 outside. */
static double solid_angle(ShvVec3 p, ShvVec3 a, ShvVec3 b, ShvVec3 c)
{
    const ShvVec3 u = shv_sub(a, p), v = shv_sub(b, p), w = shv_sub(c, p);
    const double x = shv_norm(u), y = shv_norm(v), z = shv_norm(w);
    return 2.0 *
           atan2(shv_dot(u, shv_cross(v, w)), x * y * z + shv_dot(u, v) * z + shv_dot(v, w) * x + shv_dot(w, u) * y);
}

static double brute_gap(const ShvObstacle *obstacle, ShvVec3 point)
{
    const ShvVec3 p = shv_rotate(shv_quat_conjugate(obstacle->orientation), shv_sub(point, obstacle->position));
    const ShvSurface *surface = &obstacle->surface;
    double distance = (double)INFINITY, angle = 0.0;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corners = surface->triangles + 3 * (int64_t)t;
        const ShvVec3 a = shv_surface_position(surface, corners[0]), b = shv_surface_position(surface, corners[1]),
                      c = shv_surface_position(surface, corners[2]);
        distance = fmin(distance, triangle_distance(p, a, b, c));
        angle += solid_angle(p, a, b, c);
    }
    return angle > 6.28 ? -distance : distance;
}

/* ---- meshes ---- */

/* What every answer promises: the point lies at the gap's distance, along the normal. */
static void check_consistent(ShvVec3 point, ShvSurfacePoint at)
{
    check_near(shv_norm(at.normal), 1.0, 1e-14);
    const ShvVec3 back = shv_madd(at.point, at.gap, at.normal);
    check_near(shv_norm(shv_sub(back, point)), 0.0, 1e-13 * (1.0 + shv_norm(point)));
}

static void check_against_brute_force(const char *text, uint64_t seed, int points)
{
    const SurfaceFile file = surface_file(text);
    ShvObstacleDefinition definition = mesh_definition("mesh", file.path, shv_vec3(0.3, -0.2, 0.1));
    turn(&definition, shv_vec3(1.0, 2.0, -0.5), 40.0);
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const ShvObstacle *mesh = &obstacles.items[0];
    uint64_t index = 0;
    int32_t inside = 0;
    for (int k = 0; k < points; k++) {
        /* Half of the points lie near the surface. */
        ShvVec3 point = shv_add(mesh->position, draw_vector(seed, &index, 1.6));
        if (k % 2) {
            const ShvSurfacePoint near = shv_obstacle_closest(mesh, point, (double)INFINITY);
            point = shv_add(near.point, draw_vector(seed, &index, 0.02));
        }
        const double expected = brute_gap(mesh, point);
        const ShvSurfacePoint at = shv_obstacle_closest(mesh, point, (double)INFINITY);
        check_near(at.gap, expected, 1e-13);
        check_consistent(point, at);
        inside += expected < 0.0;
        const ShvSurfacePoint limited = shv_obstacle_closest(mesh, point, 0.05);
        if (expected < 0.05)
            check_near(limited.gap, expected, 1e-13);
        else
            assert_true(limited.gap >= 0.05);
    }
    assert_in_range(inside, points / 50, points - points / 50);
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

static void test_box_mesh(void **state)
{
    (void)state;
    check_against_brute_force(box_text, 1, 4000);
}

static void test_reentrant_mesh(void **state)
{
    (void)state;
    check_against_brute_force(angle_text, 2, 4000);
}

static void test_sharp_mesh(void **state)
{
    (void)state;
    check_against_brute_force(spike_text, 3, 4000);
}

/* A bumpy ball of 1,280 triangles: the tree has depth, and most closest features are edges and vertices. */
static void test_refined_mesh(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    ShvObstacleDefinition definition = mesh_definition("mesh", file.path, shv_vec3(0.0, 0.0, 0.0));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvError error;
    ShvSurface fine;
    check_ok(shv_surface_read(&fine, NULL, SHV_PART_SHAPE, file.path, 1.0, &error), error);
    check_ok(shv_surface_refine(&fine, 1280, &error), error);
    uint64_t index = 0;
    for (int32_t i = 0; i < fine.node_count; i++) {
        const ShvVec3 from = shv_sub(shv_surface_position(&fine, i), shv_vec3(1.0, 0.5, 0.25));
        shv_store3(fine.positions + 3 * (int64_t)i, shv_scale(shv_unit(from), draw(4, &index, 0.9, 1.0)));
    }
    char *text = malloc(200000);
    assert_non_null(text);
    int length = 0;
    for (int32_t i = 0; i < fine.node_count; i++)
        length += snprintf(text + length, 200, "v %.17g %.17g %.17g\n", fine.positions[3 * i],
                           fine.positions[3 * i + 1], fine.positions[3 * i + 2]);
    for (int32_t t = 0; t < fine.triangle_count; t++)
        length += snprintf(text + length, 200, "f %d %d %d\n", fine.triangles[3 * t] + 1, fine.triangles[3 * t + 1] + 1,
                           fine.triangles[3 * t + 2] + 1);
    assert_true(length < 200000);
    check_against_brute_force(text, 5, 500);
    free(text);
    shv_surface_release(&fine);
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

/* The same solid as a box and as a mesh, whose file has its origin at a corner. */
static void test_box_equals_its_mesh(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    const ShvVec3 axis = {0.2, -1.0, 0.4}, corner = {0.4, 0.5, -0.6};
    ShvObstacleDefinition definitions[2] = {mesh_definition("mesh", file.path, corner),
                                            box_definition("box", shv_vec3(2.0, 1.0, 0.5), corner)};
    turn(&definitions[0], axis, 75.0);
    turn(&definitions[1], axis, 75.0);
    make_free(&definitions[0], 3.0);
    make_free(&definitions[1], 3.0);
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    ShvObstacle *mesh = &obstacles.items[0], *box = &obstacles.items[1];
    box->position = shv_add(corner, shv_rotate(box->orientation, shv_vec3(1.0, 0.5, 0.25)));
    check_near(shv_norm(shv_sub(mesh->position, box->position)), 0.0, 1e-15);
    check_near(mesh->bounding_radius, box->bounding_radius, 1e-15);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) check_near(mesh->inertia.m[i][j], box->inertia.m[i][j], 1e-14);
    uint64_t index = 0;
    for (int k = 0; k < 5000; k++) {
        const ShvVec3 point = shv_add(box->position, draw_vector(6, &index, 1.5));
        const ShvSurfacePoint a = shv_obstacle_closest(mesh, point, (double)INFINITY),
                              b = shv_obstacle_closest(box, point, (double)INFINITY);
        check_near(a.gap, b.gap, 1e-14);
        check_consistent(point, b);
        check_near(shv_norm(shv_sub(a.normal, b.normal)), 0.0, 1e-11);
    }
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

/* ---- simple shapes ---- */

static void test_plane_and_sphere(void **state)
{
    (void)state;
    const ShvObstacleDefinition definitions[2] = {plane_definition("floor", shv_vec3(0.0, 3.0, 4.0), 2.0),
                                                  sphere_definition("ball", 0.5, shv_vec3(1.0, 2.0, 3.0))};
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    ShvSurfacePoint at = shv_obstacle_closest(&obstacles.items[0], shv_vec3(7.0, 5.0, 5.0), 0.0);
    check_near(at.gap, 5.0, 1e-15); /* 0.6 · 5 + 0.8 · 5 − 2 */
    check_near(at.point.y, 2.0, 1e-15);
    at = shv_obstacle_closest(&obstacles.items[1], shv_vec3(1.0, 5.0, 7.0), (double)INFINITY);
    check_near(at.gap, 4.5, 1e-15);
    check_near(at.normal.z, 0.8, 1e-15);
    at = shv_obstacle_closest(&obstacles.items[1], shv_vec3(1.0, 2.0, 3.0), 0.0);
    check_near(at.gap, -0.5, 0.0);
    check_near(shv_norm(at.normal), 1.0, 0.0);
    shv_obstacles_release(&obstacles);
}

static void test_box_faces_edges_corners(void **state)
{
    (void)state;
    const ShvObstacleDefinition definition = box_definition("box", shv_vec3(2.0, 4.0, 6.0), shv_vec3(0.0, 0.0, 0.0));
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const ShvObstacle *box = &obstacles.items[0];
    const struct {
        ShvVec3 point;
        double gap;
        ShvVec3 normal;
    } cases[] = {{{3.0, 0.0, 0.0}, 2.0, {1.0, 0.0, 0.0}},
                 {{4.0, 6.0, 0.0}, 5.0, {0.6, 0.8, 0.0}},
                 {{-2.0, -4.0, -5.0}, 3.0, {-1.0 / 3.0, -2.0 / 3.0, -2.0 / 3.0}},
                 {{0.9, 0.0, 0.0}, -0.1, {1.0, 0.0, 0.0}},
                 {{0.0, -1.9, 2.5}, -0.1, {0.0, -1.0, 0.0}},
                 {{0.0, 0.0, 0.0}, -1.0, {1.0, 0.0, 0.0}},
                 {{0.3, 0.2, 3.0}, 0.0, {0.0, 0.0, 1.0}}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const ShvSurfacePoint at = shv_obstacle_closest(box, cases[k].point, (double)INFINITY);
        check_near(at.gap, cases[k].gap, 1e-15);
        check_near(shv_norm(shv_sub(at.normal, cases[k].normal)), 0.0, 1e-15);
    }
    shv_obstacles_release(&obstacles);
}

/* ---- crossings ---- */

/* Gaps along the way, looked at closely: positive up to the crossing, zero there; never clearly negative without one. */
static void check_crossing(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, int32_t *crossed)
{
    ShvCrossing crossing;
    const bool meets = shv_obstacle_sweep(obstacle, from, to, &crossing);
    const double upto = meets ? crossing.fraction : 1.0;
    for (int k = 1; k < 200; k++) {
        const ShvVec3 at = shv_madd(from, upto * k / 200.0, shv_sub(to, from));
        assert_true(shv_obstacle_closest(obstacle, at, (double)INFINITY).gap > -1e-9);
    }
    if (!meets) return;
    (*crossed)++;
    check_near(shv_obstacle_closest(obstacle, crossing.point, (double)INFINITY).gap, 0.0, 1e-12);
    assert_true(shv_dot(crossing.normal, shv_sub(to, from)) < 0.0);
    check_near(shv_norm(crossing.normal), 1.0, 1e-14);
}

static void test_sweep(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    ShvObstacleDefinition definitions[5] = {plane_definition("plane", shv_vec3(1.0, 1.0, 0.2), 0.3),
                                            sphere_definition("ball", 0.7, shv_vec3(0.5, 0.0, 0.0)),
                                            box_definition("plate", shv_vec3(2.0, 1.5, 1e-3), shv_vec3(0.0, 0.2, 0.1)),
                                            mesh_definition("angle", file.path, shv_vec3(-0.8, -0.8, -0.5)),
                                            mesh_definition("flake", file.path, shv_vec3(0.0, 0.0, 0.0))};
    turn(&definitions[2], shv_vec3(1.0, 0.4, 0.0), 30.0);
    turn(&definitions[3], shv_vec3(1.0, 0.4, 0.7), 60.0);
    definitions[4].scale = 1e-2;
    ShvObstacles obstacles = make_obstacles(definitions, 5);
    for (int32_t i = 0; i < 5; i++) {
        uint64_t index = 0;
        int32_t crossed = 0;
        for (int k = 0; k < 2000; k++) {
            const ShvVec3 from = draw_vector(20 + (uint64_t)i, &index, 2.0);
            const ShvVec3 to = shv_scale(draw_vector(20 + (uint64_t)i, &index, 2.0), i == 4 ? 0.005 : 1.0);
            if (shv_obstacle_closest(&obstacles.items[i], from, (double)INFINITY).gap < 0.0) {
                ShvCrossing crossing;
                assert_false(shv_obstacle_sweep(&obstacles.items[i], from, to, &crossing));
                continue;
            }
            check_crossing(&obstacles.items[i], from, to, &crossed);
        }
        assert_true(crossed > 200);
    }
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

/* Ways through the middle of edges and vertices of a mesh are not lost between triangles. */
static void test_sweep_through_edges(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    ShvObstacleDefinition definition = mesh_definition("mesh", file.path, shv_vec3(0.0, 0.0, 0.0));
    turn(&definition, shv_vec3(1.0, 2.0, 3.0), 25.0);
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const ShvObstacle *mesh = &obstacles.items[0];
    for (int32_t t = 0; t < mesh->surface.triangle_count; t++)
        for (int k = 0; k < 3; k++)
            for (int share = 0; share <= 4; share++) {
                const int32_t *corners = mesh->surface.triangles + 3 * t;
                const ShvVec3 a = shv_surface_position(&mesh->surface, corners[k]),
                              b = shv_surface_position(&mesh->surface, corners[(k + 1) % 3]);
                const ShvVec3 edge = shv_rotate(mesh->orientation, shv_madd(a, share / 4.0, shv_sub(b, a)));
                const ShvVec3 from = shv_madd(mesh->position, 3.0, edge);
                ShvCrossing crossing;
                assert_true(shv_obstacle_sweep(mesh, from, mesh->position, &crossing));
                check_near(crossing.fraction, 2.0 / 3.0, 1e-9);
            }
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_mesh),
        cmocka_unit_test(test_reentrant_mesh),
        cmocka_unit_test(test_sharp_mesh),
        cmocka_unit_test(test_refined_mesh),
        cmocka_unit_test(test_box_equals_its_mesh),
        cmocka_unit_test(test_plane_and_sphere),
        cmocka_unit_test(test_box_faces_edges_corners),
        cmocka_unit_test(test_sweep),
        cmocka_unit_test(test_sweep_through_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
