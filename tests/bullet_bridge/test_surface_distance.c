/* FCL's distance of surfaces against the gap of depth.h, which knows convex bodies alone. */
#include "check.h"

#include "base/random.h"
#include "bullet_bridge/depth.h"
#include "bullet_bridge/surface_distance.h"

static uint64_t next;
static const int32_t faces[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

static void draw_tet(double points[12], double size, double away)
{
    for (int i = 0; i < 12; i++) points[i] = size * shv_random_uniform(7, next++);
    for (int i = 0; i < 4; i++) points[3 * i] += away;
}

static ShvDistanceSurface *surface_of(const double tet[12])
{
    ShvDistanceSurface *surface = NULL;
    ShvError error;
    check_ok(shv_distance_surface_create(&surface, tet, faces, 4, &error), error);
    return surface;
}

static void check_pair(const ShvConvex *first, const ShvConvex *second, const ShvSurfaceDistance *nearest, double size)
{
    ShvConvexGap gap;
    ShvError error;
    check_ok(shv_convex_gap(first, second, &gap, &error), error);
    if (gap.gap <= 0.0) return; /* one may lie within the other: its surface is not there */
    double square = 0.0;
    for (int k = 0; k < 3; k++)
        square += (nearest->second[k] - nearest->first[k]) * (nearest->second[k] - nearest->first[k]);
    check_near(nearest->distance, gap.gap, 1e-9 * size);
    check_near(sqrt(square), gap.gap, 1e-6 * size);
}

/* From a micrometre to a kilometre. */
static void tets_are_as_far_apart_as_their_hulls(void **state)
{
    (void)state;
    int apart = 0;
    for (int i = 0; i < 4000; i++) {
        const double size = pow(10.0, 9.0 * shv_random_uniform(7, next++) - 6.0);
        double one[12], two[12];
        draw_tet(one, size, 0.0);
        draw_tet(two, size, size * (0.5 + shv_random_uniform(7, next++)));
        ShvDistanceSurface *first = surface_of(one), *second = surface_of(two);
        ShvSurfaceDistance nearest;
        ShvError error;
        check_ok(shv_surface_distance(first, second, &nearest, &error), error);
        const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        ShvConvex hull = {.points = one, .count = 4}, other = {.points = two, .count = 4};
        memcpy(hull.rotation, axes, sizeof axes);
        memcpy(other.rotation, axes, sizeof axes);
        check_pair(&hull, &other, &nearest, size);
        apart += nearest.distance > 0.0;
        const ShvConvex sphere = {.points = (const double[3]){0, 0, 0},
                                  .count = 1,
                                  .radius = 0.2 * size,
                                  .position = {1.5 * size, 0, 0},
                                  .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        check_ok(shv_surface_distance_to_sphere(first, sphere.position, sphere.radius, &nearest, &error), error);
        check_pair(&hull, &sphere, &nearest, size);
        shv_distance_surface_destroy(first);
        shv_distance_surface_destroy(second);
    }
    assert_true(apart > 2000);
}

static void what_crosses_is_not_apart(void **state)
{
    (void)state;
    const double tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    double other[12];
    for (int i = 0; i < 12; i++) other[i] = tet[i] + 0.1;
    ShvDistanceSurface *first = surface_of(tet), *second = surface_of(other);
    ShvSurfaceDistance nearest;
    ShvError error;
    check_ok(shv_surface_distance(first, second, &nearest, &error), error);
    assert_true(nearest.distance == 0.0);
    check_ok(shv_surface_distance_to_sphere(first, (const double[3]){0, 0, 0.5}, 0.1, &nearest, &error), error);
    assert_true(nearest.distance < 1e-12);
    shv_distance_surface_destroy(first);
    shv_distance_surface_destroy(second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(tets_are_as_far_apart_as_their_hulls),
                                       cmocka_unit_test(what_crosses_is_not_apart)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
