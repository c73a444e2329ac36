#include "check.h"

#include <string.h>

#include "base/random.h"
#include "mesh/delaunay.h"

static double volume6(const int32_t *x, const int32_t *tet)
{
    double d[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) d[i][k] = x[3 * tet[i + 1] + k] - x[3 * tet[0] + k];
    return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) + d[0][1] * (d[1][2] * d[2][0] - d[1][0] * d[2][2]) +
           d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

/* Centre of the sphere round a tet, by Cramer's rule, and its squared radius. */
static double sphere(const int32_t *x, const int32_t *tet, double centre[3])
{
    double m[3][3], right[3], det[4];
    for (int i = 0; i < 3; i++) {
        right[i] = 0.0;
        for (int k = 0; k < 3; k++) {
            m[i][k] = x[3 * tet[i + 1] + k] - x[3 * tet[0] + k];
            right[i] += 0.5 * m[i][k] * m[i][k];
        }
    }
    for (int c = 0; c < 4; c++) {
        double a[3][3];
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) a[i][k] = c == k + 1 ? right[i] : m[i][k];
        det[c] = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
                 a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    }
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double way = det[k + 1] / det[0];
        centre[k] = x[3 * tet[0] + k] + way;
        square += way * way;
    }
    return square;
}

/* Fills a hull of the volume `hull`, with no point inside any sphere. */
static void check_delaunay(const int32_t *x, int32_t count, double hull)
{
    ShvDelaunay d;
    ShvError error;
    double sum = 0.0;
    check_ok(shv_delaunay_make(&d, NULL, x, count, &error), error);
    for (int32_t t = 0; t < d.tet_count; t++) {
        const int32_t *tet = d.tets + 4 * t;
        const double six = volume6(x, tet);
        double centre[3];
        assert_true(six > 0.0);
        sum += six / 6.0;
        const double square = sphere(x, tet, centre);
        if (square > 1e14) continue; /* too flat for this judge */
        for (int32_t p = 0; p < count; p++) {
            double distance = 0.0;
            for (int k = 0; k < 3; k++) distance += (x[3 * p + k] - centre[k]) * (x[3 * p + k] - centre[k]);
            assert_true(distance > square * (1.0 - 1e-6));
        }
    }
    check_near(sum, hull, 1e-12 * hull);
    shv_delaunay_release(&d);
}

static int32_t draw(uint64_t seed, uint64_t index, int32_t most)
{
    return (int32_t)(shv_random_uniform(seed, index) * most);
}

static void points_at_random(void **state)
{
    (void)state;
    enum { COUNT = 400, SIDE = SHV_DELAUNAY_GRID - 1 };
    static int32_t x[3 * COUNT];
    for (uint64_t seed = 1; seed <= 4; seed++) {
        for (int32_t i = 0; i < COUNT; i++)
            for (int k = 0; k < 3; k++)
                x[3 * i + k] = i < 8 ? (i >> k & 1) * SIDE : draw(seed, (uint64_t)(3 * i + k), SIDE);
        check_delaunay(x, COUNT, (double)SIDE * SIDE * SIDE);
    }
}

/* Every sphere of eight neighbours has all of them on it, whole planes of points lie in the hull. */
static void points_in_rank_and_file(void **state)
{
    (void)state;
    enum { SIDE = 6 };
    static int32_t x[3 * SIDE * SIDE * SIDE];
    const int32_t steps[3] = {1, 1000, (SHV_DELAUNAY_GRID - 1) / (SIDE - 1)};
    for (int s = 0; s < 3; s++) {
        for (int32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
            x[3 * i] = i % SIDE * steps[s];
            x[3 * i + 1] = i / SIDE % SIDE * steps[s];
            x[3 * i + 2] = i / (SIDE * SIDE) * steps[s];
        }
        check_delaunay(x, SIDE * SIDE * SIDE, pow((SIDE - 1.0) * steps[s], 3.0));
    }
}

/* Points of one plane, and one off it: the triangles of the plane. */
static void a_plane_and_a_point(void **state)
{
    (void)state;
    enum { COUNT = 300, SIDE = SHV_DELAUNAY_GRID - 1 };
    static int32_t x[3 * COUNT + 3];
    ShvDelaunay d;
    ShvError error;
    for (int32_t i = 0; i < COUNT; i++)
        for (int k = 0; k < 2; k++) x[3 * i + k] = i < 4 ? (i >> k & 1) * SIDE : draw(5, (uint64_t)(3 * i + k), SIDE);
    x[3 * COUNT + 2] = SIDE;
    check_delaunay(x, COUNT + 1, (double)SIDE * SIDE * SIDE / 3.0);
    assert_int_equal(shv_delaunay_make(&d, NULL, x, COUNT, &error), SHV_BAD_INPUT);
    assert_non_null(strstr(error.message, "lie in one plane"));
    assert_int_equal(shv_delaunay_make(&d, NULL, x, 3, &error), SHV_BAD_INPUT);
}

static void memory_can_be_out(void **state)
{
    (void)state;
    enum { COUNT = 60 };
    int32_t x[3 * COUNT];
    ShvError error;
    for (int32_t i = 0; i < 3 * COUNT; i++) x[i] = draw(9, (uint64_t)i, 1000);
    ShvStatus status = SHV_NO_MEMORY;
    for (int64_t count = 0; status != SHV_OK; count++) {
        ShvMemory *memory = shv_memory_create();
        ShvDelaunay d;
        shv_memory_fail_after(memory, count);
        status = shv_delaunay_make(&d, memory, x, COUNT, &error);
        if (status == SHV_OK) shv_delaunay_release(&d);
        assert_true(status == SHV_OK || status == SHV_NO_MEMORY);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
        assert_true(count < 20);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(points_at_random), cmocka_unit_test(points_in_rank_and_file),
                                       cmocka_unit_test(a_plane_and_a_point), cmocka_unit_test(memory_can_be_out)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
