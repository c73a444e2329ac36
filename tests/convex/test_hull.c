#include "check.h"

#include "base/random.h"
#include "convex/hull.h"
#include "rigid/world.h"

enum { MOST_POINTS = 300 };

/* Every half-space holds every point, but for 2⁻²⁴ of the size by which points may be left outside and half of 2⁻²⁵ along each
   axis from rounding to the grid; triangles narrower than 2⁻¹² of the size give no half-space, so over the size the latter
   grows at most to √3 · 2⁻²⁵ · 2¹². */
static void check_holds(const ShvPolytope *polytope, const double *points, int32_t count, double size)
{
    ShvPlanes planes;
    shv_polytope_planes(polytope, &planes);
    for (int32_t f = 0; f < planes.count; f++)
        for (int32_t p = 0; p < count; p++)
            assert_true(shv_dot(shv_load3(planes.planes[f]), shv_load3(points + 3 * p)) <=
                        planes.planes[f][3] + 0x1p-12 * size);
}

/* Closed and oriented: every edge runs once each way, and the polyhedron has the topology of a sphere. */
static void check_closed(const ShvHull *hull)
{
    uint8_t runs[SHV_HULL_VERTICES][SHV_HULL_VERTICES] = {{0}};
    assert_int_equal(hull->face_count, 2 * hull->vertex_count - 4);
    for (int32_t f = 0; f < hull->face_count; f++)
        for (int i = 0; i < 3; i++) {
            assert_true(hull->faces[f][i] < hull->vertex_count);
            runs[hull->faces[f][i]][hull->faces[f][(i + 1) % 3]]++;
        }
    for (int32_t a = 0; a < hull->vertex_count; a++)
        for (int32_t b = 0; b < hull->vertex_count; b++) {
            assert_true(runs[a][b] <= 1);
            assert_int_equal(runs[a][b], runs[b][a]);
        }
}

static double six_volumes(const double *points, int32_t a, int32_t b, int32_t c, int32_t d)
{
    const ShvVec3 o = shv_load3(points + 3 * a);
    const ShvVec3 u = shv_sub(shv_load3(points + 3 * b), o), v = shv_sub(shv_load3(points + 3 * c), o),
                  w = shv_sub(shv_load3(points + 3 * d), o);
    return shv_dot(u, shv_cross(v, w));
}

/* Volume by brute force: every triple with all points on one side is a face; the pyramids over them from point 0. Points in
   general position. */
static double brute_volume(const double *points, int32_t count)
{
    double volume = 0.0;
    for (int32_t a = 0; a < count; a++)
        for (int32_t b = a + 1; b < count; b++)
            for (int32_t c = b + 1; c < count; c++) {
                int32_t above = 0, below = 0;
                for (int32_t d = 0; d < count; d++) {
                    if (d == a || d == b || d == c) continue;
                    const double side = six_volumes(points, a, b, c, d);
                    above += side > 0.0;
                    below += side < 0.0;
                }
                if (above == 0 || below == 0) volume += fabs(six_volumes(points, a, b, c, 0)) / 6.0;
            }
    return volume;
}

static void test_random_points_against_brute_force(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    ShvHullScratch scratch = {0};
    for (int trial = 0; trial < 200; trial++) {
        double points[3 * 30];
        const int32_t count = 4 + trial % 27;
        for (int32_t i = 0; i < 3 * count; i++) points[i] = draw(&index, -1.0, 1.0);
        ShvPolytope polytope;
        ShvError error = {0};
        check_ok(shv_polytope_make(&polytope, &scratch, points, count, &error), error);
        assert_int_equal(polytope.hull.rank, SHV_HULL_SOLID);
        assert_false(polytope.hull.reduced);
        check_closed(&polytope.hull);
        check_holds(&polytope, points, count, 2.0);
        check_near(polytope.hull.volume, brute_volume(points, count), 1e-6);
        for (int32_t v = 0; v < polytope.hull.vertex_count; v++)
            assert_memory_equal(polytope.vertices + 3 * v, points + 3 * polytope.hull.points[v], 3 * sizeof(double));
    }
    shv_hull_scratch_release(&scratch);
}

/* Points of a coarse lattice, many of them alike, in line or in one plane, and turned so that rounding spoils the planes. */
static void test_lattices(void **unused)
{
    (void)unused;
    uint64_t index = 9000;
    ShvHullScratch scratch = {0};
    for (int trial = 0; trial < 600; trial++) {
        double points[3 * MOST_POINTS], size = 1e-3;
        const int32_t count = 1 + (int32_t)draw(&index, 0.0, (double)MOST_POINTS), steps = 1 + trial % 5;
        const ShvQuat turn = trial % 2 ? draw_rotation(&index) : shv_quat_identity();
        double flat[3] = {size, size, size};
        if (trial % 3 == 0) flat[trial % 9 / 3] = 0.0;
        for (int32_t p = 0; p < count; p++) {
            double x[3];
            for (int i = 0; i < 3; i++) x[i] = flat[i] * floor(draw(&index, 0.0, steps + 1.0)) / steps;
            shv_store3(points + 3 * p, shv_rotate(turn, shv_load3(x)));
        }
        ShvPolytope polytope;
        ShvError error = {0};
        check_ok(shv_polytope_make(&polytope, &scratch, points, count, &error), error);
        if (trial % 3 == 0 && trial % 2 == 0) assert_true(polytope.hull.rank != SHV_HULL_SOLID);
        if (polytope.hull.rank != SHV_HULL_SOLID) continue;
        check_closed(&polytope.hull);
        if (!polytope.hull.reduced) check_holds(&polytope, points, count, sqrt(3.0) * size);
        assert_true(polytope.hull.volume <= 1.0000001 * size * size * size);
    }
    shv_hull_scratch_release(&scratch);
}

static ShvHullRank rank_of(const double *points, int32_t count)
{
    ShvHullScratch scratch = {0};
    ShvHull hull;
    ShvError error = {0};
    check_ok(shv_hull_make(&hull, &scratch, points, count, SHV_HULL_VERTICES, &error), error);
    shv_hull_scratch_release(&scratch);
    if (hull.rank != SHV_HULL_SOLID) assert_true(hull.vertex_count == 0 && hull.volume == 0.0);
    return hull.rank;
}

static void test_points_without_volume(void **unused)
{
    (void)unused;
    static const double same[] = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}, line[] = {0, 0, 0, 1, 1, 1, 2, 2, 2, 5, 5, 5},
                        plane[] = {0, 0, 1, 1, 0, 1, 0, 1, 1, 7, 3, 1, 2, 2, 1},
                        thin[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, 1e-9},
                        solid[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_int_equal(rank_of(same, 1), SHV_HULL_POINT);
    assert_int_equal(rank_of(same, 4), SHV_HULL_POINT);
    assert_int_equal(rank_of(line, 4), SHV_HULL_LINE);
    assert_int_equal(rank_of(plane, 5), SHV_HULL_FLAT);
    assert_int_equal(rank_of(thin, 4), SHV_HULL_FLAT);
    assert_int_equal(rank_of(solid, 4), SHV_HULL_SOLID);
}

/* Boxes of many nodes, turned any way: the eight corners; where two faces have points equally high over them, a point on an
   edge may have come in before the corners and stays. */
static void test_turned_boxes(void **unused)
{
    (void)unused;
    uint64_t index = 400;
    ShvHullScratch scratch = {0};
    for (int trial = 0; trial < 300; trial++) {
        double points[3 * MOST_POINTS];
        int32_t count = 0;
        const ShvQuat turn = trial == 0 ? shv_quat_identity() : draw_rotation(&index);
        const ShvVec3 size = shv_vec3(draw(&index, 0.02, 1.0), draw(&index, 0.02, 1.0), draw(&index, 0.02, 1.0));
        const ShvVec3 place = draw3(&index, 10.0);
        for (int i = 0; i < 8; i++)
            for (int j = 0; j < 6; j++)
                for (int k = 0; k < 6; k++)
                    shv_store3(points + 3 * count++,
                               shv_add(place, shv_rotate(turn, shv_vec3(size.x * i / 7.0, size.y * j / 5.0,
                                                                        size.z * k / 5.0))));
        ShvHull hull;
        ShvError error = {0};
        check_ok(shv_hull_make(&hull, &scratch, points, count, SHV_HULL_VERTICES, &error), error);
        assert_in_range(hull.vertex_count, 8, 10);
        assert_false(hull.reduced);
        check_near(hull.volume, size.x * size.y * size.z, 1e-12);
    }
    shv_hull_scratch_release(&scratch);
}

/* A cube with points inside, on edges and on faces keeps its eight corners; a hull of few vertices takes the far ones. */
static void test_cube_and_limit(void **unused)
{
    (void)unused;
    double points[3 * 125];
    int32_t count = 0;
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < 5; j++)
            for (int k = 0; k < 5; k++) shv_store3(points + 3 * count++, shv_vec3(i, j, k));
    ShvHullScratch scratch = {0};
    ShvHull hull;
    ShvError error = {0};
    check_ok(shv_hull_make(&hull, &scratch, points, count, SHV_HULL_VERTICES, &error), error);
    assert_int_equal(hull.vertex_count, 8);
    check_near(hull.volume, 64.0, 1e-12);
    for (int32_t most = 4; most < 8; most++) {
        check_ok(shv_hull_make(&hull, &scratch, points, count, most, &error), error);
        assert_true(hull.vertex_count <= most && hull.reduced);
        check_closed(&hull);
        /* any four corners of the cube span a sixth of it or more */
        assert_true(hull.volume >= 64.0 / 6.0 - 1e-12 && hull.volume < 64.0);
    }
    shv_hull_scratch_release(&scratch);
}

/* A sphere of many points: 64 vertices spread over it hold 4/3 π less what the caps over 124 equal triangles take, about
   2 π √3 / 9 · 4/124 of it, a tenth; uneven triangles at most double that. */
static void test_sphere_is_reduced(void **unused)
{
    (void)unused;
    enum { COUNT = 5000 };
    double *points = malloc(3 * COUNT * sizeof *points);
    uint64_t index = 77;
    for (int32_t p = 0; p < COUNT; p++) shv_store3(points + 3 * p, shv_unit(draw3(&index, 1.0)));
    ShvHullScratch scratch = {0};
    ShvPolytope polytope, again;
    ShvError error = {0};
    check_ok(shv_polytope_make(&polytope, &scratch, points, COUNT, &error), error);
    assert_int_equal(polytope.hull.vertex_count, SHV_HULL_VERTICES);
    assert_true(polytope.hull.reduced);
    check_closed(&polytope.hull);
    assert_true(polytope.hull.volume > 0.8 * 4.18879 && polytope.hull.volume < 4.18879);
    check_ok(shv_polytope_make(&again, &scratch, points, COUNT, &error), error);
    assert_memory_equal(again.vertices, polytope.vertices, sizeof polytope.vertices);
    assert_memory_equal(again.hull.faces, polytope.hull.faces, sizeof polytope.hull.faces);
    shv_hull_scratch_release(&scratch);
    free(points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_points_against_brute_force),
        cmocka_unit_test(test_lattices),
        cmocka_unit_test(test_points_without_volume),
        cmocka_unit_test(test_turned_boxes),
        cmocka_unit_test(test_cube_and_limit),
        cmocka_unit_test(test_sphere_is_reduced),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
