#include "check.h"

#include <stdlib.h>

#include "base/random.h"
#include "base/timer.h"
#include "base/vector.h"
#include "bullet_bridge/depth.h"

static double draw(uint64_t seed, uint64_t *index)
{
    return 2.0 * shv_random_uniform(seed, (*index)++) - 1.0;
}

static ShvVec3 draw_vector(uint64_t seed, uint64_t *index)
{
    const double x = draw(seed, index), y = draw(seed, index);
    return shv_vec3(x, y, draw(seed, index));
}

static ShvQuat random_turn(uint64_t seed, uint64_t *index)
{
    const ShvVec3 v = draw_vector(seed, index);
    return shv_quat_unit((ShvQuat){draw(seed, index), v.x, v.y, v.z});
}

static ShvConvex body_of(const double *points, int32_t count, ShvVec3 position, ShvQuat turn)
{
    ShvConvex body = {.points = points, .count = count};
    const ShvMat3 m = shv_quat_to_matrix(turn);
    shv_store3(body.position, position);
    memcpy(body.rotation, m.m, sizeof m.m);
    return body;
}

static void box_points(ShvVec3 half, double points[24])
{
    for (int i = 0; i < 8; i++)
        shv_store3(points + 3 * i,
                   shv_vec3(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z));
}

static ShvVec3 world(const ShvConvex *body, int32_t i)
{
    ShvMat3 m;
    memcpy(m.m, body->rotation, sizeof m.m);
    return shv_add(shv_load3(body->position), shv_apply(&m, shv_load3(body->points + 3 * i)));
}

/* Gap across a direction, by all points. */
static double gap_across(const ShvConvex *a, const ShvConvex *b, ShvVec3 normal)
{
    double high = -HUGE_VAL, low = HUGE_VAL;
    for (int32_t i = 0; i < a->count; i++) high = fmax(high, shv_dot(normal, world(a, i)));
    for (int32_t i = 0; i < b->count; i++) low = fmin(low, shv_dot(normal, world(b, i)));
    return low - high - a->radius - b->radius;
}

static void check_consistent(const ShvConvex *a, const ShvConvex *b, const ShvConvexGap *gap, double size)
{
    const ShvVec3 normal = shv_load3(gap->normal);
    check_near(shv_norm(normal), 1.0, 1e-14);
    check_near(gap_across(a, b, normal), gap->gap, 1e-13 * size);
    const ShvVec3 difference = shv_sub(shv_load3(gap->second), shv_load3(gap->first));
    check_near(shv_norm(shv_sub(difference, shv_scale(normal, gap->gap))), 0.0, 1e-9 * size);
}

static ShvConvexGap gap_of(const ShvConvex *a, const ShvConvex *b)
{
    ShvConvexGap gap;
    ShvError error;
    check_ok(shv_convex_gap(a, b, &gap, &error), error);
    return gap;
}

static void test_boxes_by_hand(void **unused)
{
    (void)unused;
    for (double size = 1e-3; size < 1e3; size *= 100.0) {
        double points[24], slab[24];
        box_points(shv_vec3(size, size, size), points);
        box_points(shv_vec3(3.0 * size, 2.0 * size, 0.01 * size), slab);
        const ShvConvex cube = body_of(points, 8, shv_vec3(5.0, 0.0, 0.0), shv_quat_identity());
        const double gaps[] = {0.5 * size, 1e-6 * size, 1e-9 * size, 0.0, -1e-9 * size, -1e-6 * size, -0.4 * size};
        for (size_t i = 0; i < sizeof gaps / sizeof *gaps; i++) {
            const ShvVec3 at = shv_vec3(5.0 + 0.3 * size, 0.2 * size, 1.01 * size + gaps[i]);
            const ShvConvex other = body_of(slab, 8, at, shv_quat_identity());
            const ShvConvexGap gap = gap_of(&cube, &other);
            check_consistent(&cube, &other, &gap, fmax(size, 5.0));
            check_near(gap.gap, gap.gap < -0.02 * size ? -0.4 * size : gaps[i], 1e-13 * fmax(size, 1.0));
            check_near(gap.normal[2], 1.0, 1e-9);
        }
    }
}

static void test_containment(void **unused)
{
    (void)unused;
    double outer[24], inner[24];
    box_points(shv_vec3(1.0, 2.0, 3.0), outer);
    box_points(shv_vec3(0.1, 0.1, 0.1), inner);
    const ShvConvex a = body_of(outer, 8, shv_vec3(0.0, 0.0, 0.0), shv_quat_identity());
    ShvConvex b = body_of(inner, 8, shv_vec3(-0.3, 0.5, 1.0), shv_quat_identity());
    ShvConvexGap gap = gap_of(&a, &b);
    check_near(gap.gap, -0.8, 1e-12);
    check_near(gap.normal[0], -1.0, 1e-9);
    check_consistent(&a, &b, &gap, 1.0);
    shv_store3(b.position, shv_vec3(0.0, 0.0, 0.0)); /* equal centres */
    gap = gap_of(&a, &b);
    check_near(gap.gap, -1.1, 1e-12);
    check_near(fabs(gap.normal[0]), 1.0, 1e-9);
    gap = gap_of(&a, &a);
    check_near(gap.gap, -2.0, 1e-12);
}

static void test_spheres(void **unused)
{
    (void)unused;
    const double centre[3] = {0.0, 0.0, 0.0};
    ShvConvex a = body_of(centre, 1, shv_vec3(0.0, 0.0, 0.0), shv_quat_identity());
    ShvConvex b = body_of(centre, 1, shv_vec3(3.0, 4.0, 0.0), shv_quat_identity());
    a.radius = 2.0;
    const double radii[] = {1.0, 3.0, 3.5, 10.0};
    for (int i = 0; i < 4; i++) {
        b.radius = radii[i];
        const ShvConvexGap gap = gap_of(&a, &b);
        check_near(gap.gap, 3.0 - radii[i], 1e-14);
        check_near(gap.normal[0], 0.6, 1e-14);
        check_near(gap.first[1], 1.6, 1e-14);
    }
    shv_store3(b.position, shv_vec3(0.0, 0.0, 0.0));
    const ShvConvexGap gap = gap_of(&a, &b);
    check_near(gap.gap, -12.0, 1e-12);
    check_near(shv_norm(shv_load3(gap.normal)), 1.0, 1e-14);
}

/* Directions in which the gap of two overlapping polytopes can be largest: faces, and edges across each other. */
static double brute_gap(const ShvConvex *a, const ShvConvex *b)
{
    double best = -HUGE_VAL;
    const ShvConvex *bodies[2] = {a, b};
    for (int which = 0; which < 2; which++) {
        const ShvConvex *body = bodies[which];
        for (int32_t i = 0; i < body->count; i++)
            for (int32_t j = 0; j < i; j++)
                for (int32_t k = 0; k < j; k++) {
                    const ShvVec3 p = world(body, i);
                    const ShvVec3 n = shv_unit(shv_cross(shv_sub(world(body, j), p), shv_sub(world(body, k), p)));
                    if (shv_norm(n) < 0.5) continue;
                    best = fmax(best, fmax(gap_across(a, b, n), gap_across(a, b, shv_scale(n, -1.0))));
                }
    }
    for (int32_t i = 0; i < a->count; i++)
        for (int32_t j = 0; j < i; j++)
            for (int32_t k = 0; k < b->count; k++)
                for (int32_t l = 0; l < k; l++) {
                    const ShvVec3 n =
                        shv_unit(shv_cross(shv_sub(world(a, i), world(a, j)), shv_sub(world(b, k), world(b, l))));
                    if (shv_norm(n) < 0.5) continue;
                    best = fmax(best, fmax(gap_across(a, b, n), gap_across(a, b, shv_scale(n, -1.0))));
                }
    return best;
}

/* Random hulls, flat and needle-like ones among them. A gap is a lower bound of the distance by construction and its two
   points lie in the bodies, so check_consistent proves distances; depths are compared with every candidate direction. */
static void test_random_hulls(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    int32_t overlapping = 0;
    for (int trial = 0; trial < 1000; trial++) {
        double points[2][24];
        ShvConvex body[2];
        for (int which = 0; which < 2; which++) {
            const double flat = trial % 5 == 4 ? 1e-3 : 1.0, thin = trial % 10 == 9 ? 1e-3 : 1.0;
            const int32_t count = 4 + (trial + which) % 5;
            for (int32_t i = 0; i < count; i++) {
                const ShvVec3 p = draw_vector(1, &index);
                shv_store3(points[which] + 3 * i, shv_vec3(p.x, thin * p.y, flat * p.z));
            }
            const ShvVec3 at = shv_scale(draw_vector(1, &index), 0.5);
            body[which] = body_of(points[which], count, at, random_turn(1, &index));
        }
        const ShvConvexGap gap = gap_of(&body[0], &body[1]);
        check_consistent(&body[0], &body[1], &gap, 1.0);
        const double brute = brute_gap(&body[0], &body[1]);
        overlapping += brute < 0.0;
        if (brute < 0.0)
            check_near(gap.gap, brute, 1e-10);
        else
            assert_true(gap.gap >= brute - 1e-12);
    }
    assert_true(overlapping > 300);
}

/* The two halves of a hull cut by a plane touch exactly: gap 0, normal that of the cut; then apart and into each other. */
static void test_pieces_of_one_body(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    for (int trial = 0; trial < 300; trial++) {
        const ShvQuat turn = random_turn(5, &index);
        const ShvVec3 normal = shv_rotate(turn, shv_vec3(0.0, 0.0, 1.0));
        double points[2][15];
        ShvVec3 face[4];
        for (int i = 0; i < 4; i++)
            face[i] = shv_add(shv_rotate(turn, shv_vec3(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, 0.0)),
                              shv_rotate(turn, shv_scale(shv_vec3(draw(5, &index), 0.0, 0.0), 0.3)));
        for (int which = 0; which < 2; which++) {
            for (int i = 0; i < 4; i++) shv_store3(points[which] + 3 * i, face[i]);
            const ShvVec3 middle = shv_scale(shv_add(shv_add(face[0], face[1]), shv_add(face[2], face[3])), 0.25);
            const double height = (which ? 1.0 : -1.0) * (0.2 + shv_random_uniform(5, index++));
            shv_store3(points[which] + 12, shv_madd(middle, height, normal));
        }
        const double shifts[] = {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6, 1e-3, -1e-3};
        const ShvVec3 far = {3.0, -2.0, 1.0};
        for (size_t i = 0; i < sizeof shifts / sizeof *shifts; i++) {
            const ShvConvex a = body_of(points[0], 5, far, shv_quat_identity());
            const ShvConvex b = body_of(points[1], 5, shv_madd(far, shifts[i], normal), shv_quat_identity());
            const ShvConvexGap gap = gap_of(&a, &b);
            check_consistent(&a, &b, &gap, 1.0);
            check_near(gap.gap, shifts[i],
                       5e-13); /* rounding of coordinates of 3 turns a hundredth by 4e-14, 2.6 wide */
            check_near(shv_dot(shv_load3(gap.normal), normal), 1.0, 1e-12);
        }
    }
}

/* Bodies without volume, alone or together: coplanar triangles, crossing needles, equal points. */
static void test_flat_bodies(void **unused)
{
    (void)unused;
    const double triangle[9] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const double needle[6] = {-1.0, 0.0, 0.0, 1.0, 0.0, 0.0};
    uint64_t index = 0;
    for (int trial = 0; trial < 100; trial++) {
        const ShvQuat turn = random_turn(23, &index);
        const ShvVec3 normal = shv_rotate(turn, shv_vec3(0.0, 0.0, 1.0));
        const ShvVec3 across = shv_rotate(turn, shv_vec3(0.2, 0.1, 0.0));
        ShvConvex a = body_of(triangle, 3, shv_vec3(1.0, 2.0, 3.0), turn), b = a;
        const double heights[] = {0.0, 1e-9, 0.1};
        for (int i = 0; i < 3; i++) {
            shv_store3(b.position, shv_madd(shv_add(shv_load3(a.position), across), heights[i], normal));
            const ShvConvexGap gap = gap_of(&a, &b);
            check_consistent(&a, &b, &gap, 1.0);
            check_near(gap.gap, heights[i], 5e-13);
            check_near(fabs(shv_dot(shv_load3(gap.normal), normal)), 1.0, 1e-9);
        }
        a = body_of(needle, 2, shv_vec3(0.1, 0.2, 0.3), turn);
        b = body_of(needle, 2, shv_vec3(0.1, 0.2, 0.3), random_turn(23, &index));
        const ShvConvexGap crossing = gap_of(&a, &b);
        check_consistent(&a, &b, &crossing, 1.0);
        check_near(crossing.gap, 0.0, 5e-13);
        a.count = b.count = 1;
        b.points = a.points;
        memcpy(b.rotation, a.rotation, sizeof b.rotation);
        check_near(gap_of(&a, &b).gap, 0.0, 1e-15);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    double points[24];
    box_points(shv_vec3(1.0, 1.0, 1.0), points);
    const ShvConvex good = body_of(points, 8, shv_vec3(0.0, 0.0, 0.0), shv_quat_identity());
    ShvConvexGap gap;
    ShvError error;
    ShvConvex bad = good;
    bad.count = 0;
    check_fails(shv_convex_gap(&good, &bad, &gap, &error), SHV_BAD_INPUT, error, "at least one point");
    bad = good;
    bad.radius = -1.0;
    check_fails(shv_convex_gap(&bad, &good, &gap, &error), SHV_BAD_INPUT, error, "radius");
    bad = good;
    bad.position[1] = (double)NAN;
    check_fails(shv_convex_gap(&good, &bad, &gap, &error), SHV_BAD_INPUT, error, "finite");
    points[5] = (double)INFINITY;
    check_fails(shv_convex_gap(&good, &good, &gap, &error), SHV_BAD_INPUT, error, "finite");
}

/* Printed, not asserted. */
static void test_speed(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    for (int32_t count = 8; count <= 64; count *= 8)
        for (int deep = 0; deep < 4; deep++) {
            double points[192];
            for (int32_t i = 0; i < count; i++) {
                shv_store3(points + 3 * i, shv_unit(draw_vector(7, &index)));
                if (deep == 3) points[3 * i] = i < count / 2 ? 0.0 : fabs(points[3 * i]);
            }
            const int repeats = 2000;
            double sum = 0.0;
            const double start = shv_now();
            for (int i = 0; i < repeats; i++) {
                const ShvConvex a = body_of(points, count, shv_vec3(0.0, 0.0, 0.0), random_turn(7, &index));
                const ShvVec3 at = shv_vec3(deep == 0 ? 2.5 : deep == 1 ? 1.2 : 0.2, 0.1, 0.2);
                ShvConvex b = body_of(points, count, at, random_turn(7, &index));
                if (deep == 3) { /* mirror halves: faces coincide */
                    b = a;
                    for (int k = 0; k < 9; k += 3) b.rotation[k] = -b.rotation[k];
                }
                sum += gap_of(&a, &b).gap;
            }
            const double seconds = shv_now() - start;
            print_message("%2d points: mean gap %6.3f, %.2f us\n", count, sum / repeats, 1e6 * seconds / repeats);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_boxes_by_hand),
        cmocka_unit_test(test_containment),
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_random_hulls),
        cmocka_unit_test(test_pieces_of_one_body),
        cmocka_unit_test(test_flat_bodies),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
