/* libccd's word on whether tets overlap, against the exact gap of depth.h. */
#include "check.h"

#include "base/random.h"
#include "bullet_bridge/convex_overlap.h"
#include "bullet_bridge/depth.h"

static uint64_t next;

static void draw_tet(double points[12], double size, double away)
{
    for (int i = 0; i < 12; i++) points[i] = size * shv_random_uniform(5, next++);
    for (int i = 0; i < 4; i++) points[3 * i] += away;
}

static double gap_of(const double first[12], const double second[12])
{
    const ShvConvex one = {.points = first, .count = 4, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const ShvConvex other = {.points = second, .count = 4, .rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    ShvConvexGap gap;
    ShvError error;
    check_ok(shv_convex_gap(&one, &other, &gap, &error), error);
    return gap.gap;
}

/* From a micrometre to a kilometre. */
static void agrees_with_the_gap(void **state)
{
    (void)state;
    int over = 0, apart = 0;
    for (int i = 0; i < 4000; i++) {
        const double size = pow(10.0, 9.0 * shv_random_uniform(5, next++) - 6.0);
        double first[12], second[12];
        draw_tet(first, size, 0.0);
        draw_tet(second, size, 0.5 * size * shv_random_uniform(5, next++));
        const double gap = gap_of(first, second);
        if (fabs(gap) < 1e-5 * size) continue;
        assert_true(shv_convex_overlap(first, 4, second, 4) == (gap < 0.0));
        *(gap < 0.0 ? &over : &apart) += 1;
    }
    assert_true(over > 500 && apart > 500);
}

static const double tet[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

static void what_touches_does_not_overlap(void **state)
{
    (void)state;
    double other[12];
    for (int i = 0; i < 12; i++) other[i] = tet[i] * (i % 3 == 2 ? -1.0 : 1.0); /* mirrored: a common face */
    assert_false(shv_convex_overlap(tet, 4, other, 4));
    for (int i = 2; i < 12; i += 3) other[i] += 1e-4;
    assert_true(shv_convex_overlap(tet, 4, other, 4));
    assert_true(shv_convex_overlap(tet, 4, tet, 4));
}

/* No corner and no middle of either lies in the other. */
static void needles_cross(void **state)
{
    (void)state;
    const double along_x[12] = {-1, -0.01, 0, 1, -0.01, 0, 0.9, 0.01, 0.01, 0.9, 0.01, -0.01};
    const double along_y[12] = {0, -1, 0, 0, 1, 0, 0.01, 0.9, 0.01, 0.01, 0.9, -0.01};
    assert_true(gap_of(along_x, along_y) < -1e-4);
    assert_true(shv_convex_overlap(along_x, 4, along_y, 4));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(agrees_with_the_gap),
                                       cmocka_unit_test(what_touches_does_not_overlap),
                                       cmocka_unit_test(needles_cross)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
