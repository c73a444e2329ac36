/* Gap, depth and time of impact against FCL and libccd, which share no code with ours. */
#include "check.h"

#include "base/random.h"
#include "base/vector.h"
#include "bullet_bridge/depth.h"
#include "bullet_bridge/impact_time.h"
#include "bullet_bridge/oracle/oracle.h"

enum { MOST_POINTS = 12, PAIRS = 3000 };

typedef struct Hull {
    double points[3 * MOST_POINTS];
    ShvQuat turn;
    ShvConvex convex;
} Hull;

static double draw(uint64_t seed, uint64_t *index)
{
    return 2.0 * shv_random_uniform(seed, (*index)++) - 1.0;
}

static ShvVec3 draw_vector(uint64_t seed, uint64_t *index)
{
    const double x = draw(seed, index), y = draw(seed, index);
    return shv_vec3(x, y, draw(seed, index));
}

/* 4 to 12 points in a cube of side 2, every fifth hull a flat one, within `reach` of the origin along each axis. */
static void random_hull(Hull *hull, int kind, double reach, uint64_t seed, uint64_t *index)
{
    const int32_t count = 4 + kind % (MOST_POINTS - 3);
    const double flat = kind % 5 == 4 ? 0.05 : 1.0;
    for (int32_t i = 0; i < count; i++) {
        const ShvVec3 p = draw_vector(seed, index);
        shv_store3(hull->points + 3 * i, shv_vec3(p.x, p.y, flat * p.z));
    }
    const ShvVec3 v = draw_vector(seed, index);
    hull->turn = shv_quat_unit((ShvQuat){draw(seed, index), v.x, v.y, v.z});
    const ShvMat3 m = shv_quat_to_matrix(hull->turn);
    hull->convex = (ShvConvex){.points = hull->points, .count = count};
    memcpy(hull->convex.rotation, m.m, sizeof m.m);
    shv_store3(hull->convex.position, shv_scale(draw_vector(seed, index), reach));
}

static void random_pair(Hull hulls[2], int trial, double reach, uint64_t seed, uint64_t *index)
{
    random_hull(&hulls[0], trial, 0.5, seed, index);
    random_hull(&hulls[1], trial / 2, reach, seed, index);
}

static ShvConvexGap gap_of(const ShvConvex *a, const ShvConvex *b)
{
    ShvConvexGap gap;
    ShvError error;
    check_ok(shv_convex_gap(a, b, &gap, &error), error);
    return gap;
}

static ShvConvex moved(const ShvConvex *body, ShvVec3 way)
{
    ShvConvex copy = *body;
    shv_store3(copy.position, shv_add(shv_load3(body->position), way));
    return copy;
}

static void test_distances(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    int apart_count = 0;
    for (int trial = 0; trial < PAIRS; trial++) {
        Hull hulls[2];
        random_pair(hulls, trial, 1.5, 31, &index);
        const ShvConvexGap gap = gap_of(&hulls[0].convex, &hulls[1].convex);
        if (fabs(gap.gap) < 1e-5) continue; /* FCL need not know */
        bool apart;
        double distance;
        ShvError error;
        check_ok(shv_oracle_distance(&hulls[0].convex, &hulls[1].convex, &apart, &distance, &error), error);
        assert_true(apart == (gap.gap > 0.0));
        if (!apart) continue;
        apart_count++;
        check_near(gap.gap, distance, 1e-9 * distance + 1e-13); /* what FCL is asked for; round-off of a few metres */
    }
    assert_true(apart_count > PAIRS / 4 && apart_count < 3 * PAIRS / 4);
}

static void check_overlap(const ShvConvex *a, const ShvConvex *b, bool expected)
{
    bool by_gjk, by_mpr;
    double way[3];
    ShvError error;
    check_ok(shv_oracle_overlap(a, b, &by_gjk, &error), error);
    check_ok(shv_oracle_separation(a, b, &by_mpr, way, &error), error);
    assert_true(by_gjk == expected && by_mpr == expected);
}

/* As they lie, and moved along our normal until they are a little apart or overlap a little (at a corner the move may leave
   them apart, or overlap by less). 1e-5 is what the GJK of libccd still tells apart. */
static void test_overlaps(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    int counts[2] = {0, 0};
    for (int trial = 0; trial < PAIRS; trial++) {
        Hull hulls[2];
        random_pair(hulls, trial, 1.0, 32, &index);
        const ShvConvex *a = &hulls[0].convex, *b = &hulls[1].convex;
        const ShvConvexGap gap = gap_of(a, b);
        const double wanted[] = {gap.gap, 1e-3, 1.1e-5, -1e-3, -1.1e-5};
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
            const ShvConvex other = moved(b, shv_scale(shv_load3(gap.normal), wanted[i] - gap.gap));
            const double seen = gap_of(a, &other).gap;
            if (wanted[i] > 0.0) check_near(seen, wanted[i], 1e-12);
            if (fabs(seen) < 1e-5) continue;
            check_overlap(a, &other, seen < 0.0);
            counts[seen < 0.0]++;
        }
    }
    print_message("%d apart, %d overlapping\n", counts[0], counts[1]);
    assert_true(counts[0] > PAIRS && counts[1] > PAIRS);
}

/* MPR leads to some point of the surface of first − second; none is nearer than the depth. Moved there, the bodies touch. */
static void test_depths(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    int overlapping = 0;
    double excess = 0.0;
    for (int trial = 0; trial < PAIRS; trial++) {
        Hull hulls[2];
        random_pair(hulls, trial, 0.5, 33, &index);
        const ShvConvex *a = &hulls[0].convex, *b = &hulls[1].convex;
        const double depth = -gap_of(a, b).gap;
        if (depth < 1e-5) continue;
        bool overlap;
        double way[3];
        ShvError error;
        check_ok(shv_oracle_separation(a, b, &overlap, way, &error), error);
        assert_true(overlap);
        const double theirs = shv_norm(shv_load3(way));
        assert_true(depth <= theirs + 1e-12);
        const ShvConvex clear = moved(b, shv_load3(way));
        check_near(gap_of(a, &clear).gap, 0.0, 1e-9); /* MPR stops within 1e-10 of the surface */
        overlapping++;
        excess += theirs / depth - 1.0;
    }
    print_message("%d overlapping pairs, MPR deeper by %.1f %%\n", overlapping, 100.0 * excess / overlapping);
    assert_true(overlapping > PAIRS / 2);
}

static ShvImpactBody flying(const Hull *hull, ShvVec3 velocity)
{
    ShvImpactShape *shape;
    ShvError error;
    const int32_t begin[2] = {0, hull->convex.count};
    check_ok(shv_impact_hulls_create(&shape, hull->points, begin, 1, &error), error);
    ShvImpactBody body = {.shape = shape};
    const double turn[4] = {hull->turn.w, hull->turn.x, hull->turn.y, hull->turn.z};
    memcpy(body.motion.orientation, turn, sizeof turn);
    memcpy(body.motion.position, hull->convex.position, sizeof body.motion.position);
    shv_store3(body.motion.velocity, velocity);
    return body;
}

/* Without rotation and acceleration the distance is convex in time: closing only slows down, so the closing at the later of
   two times bounds how far apart they are. Ours may stop at a gap of 1e-6 of a size of 2 √3 at most, theirs at 1e-9 m. */
static void check_impact(const Hull hulls[2], ShvVec3 move, const ShvImpact *impact, double share)
{
    const ShvConvex there = moved(&hulls[1].convex, shv_scale(move, share));
    const ShvConvexGap gap = gap_of(&hulls[0].convex, &there);
    check_near(gap.gap, 0.0, 2e-9);
    const double closing = -shv_dot(shv_load3(gap.normal), move);
    assert_true((share - impact->time) * closing <= 2e-6 * sqrt(3.0) + 2e-9);
    assert_true((impact->time - share) * impact->closing <= 2e-9);
}

static void test_impacts(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    int hits = 0, misses = 0;
    for (int trial = 0; trial < PAIRS; trial++) {
        Hull hulls[2];
        random_pair(hulls, trial, 3.0, 34, &index);
        const ShvVec3 aim = shv_scale(draw_vector(34, &index), 3.0);
        const ShvVec3 move = shv_madd(aim, -1.5, shv_load3(hulls[1].convex.position));
        if (gap_of(&hulls[0].convex, &hulls[1].convex).gap < 1e-3)
            continue; /* a contact at the start is ours to define */
        ShvImpactBody a = flying(&hulls[0], shv_vec3(0.0, 0.0, 0.0)), b = flying(&hulls[1], move);
        const ShvImpactSettings settings = {.step = 1.0, .tolerance = 1e-6, .slowest = 0.0};
        bool found, expected;
        ShvImpact impact;
        double share, way[3];
        ShvError error;
        shv_store3(way, move);
        check_ok(shv_impact_time(&a, &b, &settings, &found, &impact, &error), error);
        check_ok(shv_oracle_impact(&hulls[0].convex, &hulls[1].convex, way, &expected, &share, &error), error);
        assert_true(found == expected);
        if (found) check_impact(hulls, move, &impact, share);
        hits += found;
        misses += !found;
        shv_impact_shape_release((ShvImpactShape *)a.shape);
        shv_impact_shape_release((ShvImpactShape *)b.shape);
    }
    print_message("%d hits, %d misses\n", hits, misses);
    assert_true(hits > PAIRS / 4 && misses > PAIRS / 10);
}

/* The judges, judged by two tets whose faces x + y + z = 1 and = 2 look at each other. */
static void test_oracles_by_hand(void **unused)
{
    (void)unused;
    const double low[12] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const double high[12] = {1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.0};
    ShvConvex a = {.points = low, .count = 4, .rotation = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}}, b = a;
    b.points = high;
    bool yes;
    double distance, share;
    ShvError error;
    check_ok(shv_oracle_distance(&a, &b, &yes, &distance, &error), error);
    assert_true(yes);
    check_near(distance, 1.0 / sqrt(3.0), 1e-12);
    check_overlap(&a, &b, false);
    const double move[3] = {-1.0, 0.0, -1.0}, away[3] = {1.0, 0.0, -0.5};
    check_ok(shv_oracle_impact(&a, &b, move, &yes, &share, &error), error);
    assert_true(yes);
    check_near(share, 0.5, 2e-9);
    check_ok(shv_oracle_impact(&a, &b, away, &yes, &share, &error), error);
    assert_false(yes);
    shv_store3(b.position, shv_vec3(-0.5, -0.5, -0.5));
    check_overlap(&a, &b, true);
    b.radius = 0.1;
    check_fails(shv_oracle_overlap(&a, &b, &yes, &error), SHV_BAD_INPUT, error, "hulls of points");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracles_by_hand), cmocka_unit_test(test_distances), cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_depths),          cmocka_unit_test(test_impacts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
