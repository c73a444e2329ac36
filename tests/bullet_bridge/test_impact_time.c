#include "check.h"

#include <stdlib.h>

#include "base/deterministic.h"
#include "base/random.h"
#include "base/timer.h"
#include "base/vector.h"
#include "bullet_bridge/depth.h"
#include "bullet_bridge/impact_time.h"

static const double tolerance = 1e-6;
static const double pi = 3.14159265358979323846;

static double draw(uint64_t seed, uint64_t *index)
{
    return 2.0 * shv_random_uniform(seed, (*index)++) - 1.0;
}

static ShvVec3 draw_vector(uint64_t seed, uint64_t *index)
{
    const double x = draw(seed, index), y = draw(seed, index);
    return shv_vec3(x, y, draw(seed, index));
}

static ShvImpactBody body_of(const ShvImpactShape *shape, ShvVec3 position, ShvVec3 velocity)
{
    ShvImpactBody body = {.shape = shape, .motion = {.orientation = {1.0, 0.0, 0.0, 0.0}}};
    shv_store3(body.motion.position, position);
    shv_store3(body.motion.velocity, velocity);
    return body;
}

static void orient(ShvImpactBody *body, ShvQuat q)
{
    const double values[4] = {q.w, q.x, q.y, q.z};
    memcpy(body->motion.orientation, values, sizeof values);
}

static ShvImpactShape *box(double x, double y, double z)
{
    const double half[3] = {x, y, z};
    ShvImpactShape *shape;
    ShvError error;
    check_ok(shv_impact_box_create(&shape, half, &error), error);
    return shape;
}

static ShvImpactShape *sphere(double radius)
{
    ShvImpactShape *shape;
    ShvError error;
    check_ok(shv_impact_sphere_create(&shape, radius, &error), error);
    return shape;
}

static ShvImpactShape *floor_plane(void)
{
    const double normal[3] = {0.0, 0.0, 1.0};
    ShvImpactShape *shape;
    ShvError error;
    check_ok(shv_impact_plane_create(&shape, normal, 0.0, &error), error);
    return shape;
}

/* Either order of the bodies must give the same. */
static bool impact_of(const ShvImpactBody *a, const ShvImpactBody *b, double step, double slowest, ShvImpact *impact)
{
    const ShvImpactSettings settings = {.step = step, .tolerance = tolerance, .slowest = slowest};
    ShvError error;
    bool found, found_back;
    ShvImpact back;
    check_ok(shv_impact_time(a, b, &settings, &found, impact, &error), error);
    check_ok(shv_impact_time(b, a, &settings, &found_back, &back, &error), error);
    assert_int_equal(found, found_back);
    if (!found) return false;
    const double size = 1e-3 + shv_norm(shv_sub(shv_load3(a->motion.position), shv_load3(b->motion.position)));
    check_near(impact->time, back.time, 1e-5 * size / impact->closing + 1e-12 * step);
    check_near(shv_dot(shv_load3(impact->normal), shv_load3(back.normal)), -1.0, 1e-3);
    return true;
}

/* `exact`, or earlier by what the tolerance allows. */
static void check_time(const ShvImpact *impact, double exact, double size)
{
    const double early = tolerance * size / impact->closing;
    check_near(impact->time, exact - 0.5 * early, 0.5 * early + 1e-14);
}

static void test_sphere_falls_on_plane(void **unused)
{
    (void)unused;
    ShvImpactShape *ball = sphere(0.05), *ground = floor_plane();
    ShvImpactBody a = body_of(ball, shv_vec3(0.3, 0.2, 1.05), shv_vec3(1.0, 0.0, -2.0));
    a.motion.acceleration[2] = -9.81;
    a.motion.angular_velocity[0] = 1e4; /* moves no surface */
    ShvImpactBody b = body_of(ground, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    const double exact = (sqrt(4.0 + 2.0 * 9.81) - 2.0) / 9.81;
    ShvImpact impact;
    assert_true(impact_of(&a, &b, 1.0, 0.0, &impact));
    check_time(&impact, exact, 0.1);
    check_near(impact.closing, 2.0 + 9.81 * exact, 1e-6);
    check_near(impact.normal[2], -1.0, 1e-15);
    check_near(impact.first[0], 0.3 + exact, 1e-6);
    assert_true(impact.evaluations < 10);
    assert_false(impact_of(&a, &b, exact - 1e-6, 0.0, &impact));
    b.motion.velocity[2] = -10.0; /* runs away, and is caught up: −2 t − ½ g t² + 10 t = −1 */
    const double later = (8.0 + sqrt(64.0 + 2.0 * 9.81)) / 9.81;
    assert_true(impact_of(&a, &b, 3.0, 0.0, &impact));
    check_time(&impact, later, 0.1);
    shv_impact_shape_release(ball);
    shv_impact_shape_release(ground);
}

/* A plane that turns about the y axis meets a ball at rest: the distance is h cos ω t − x sin ω t. */
static void test_turning_plane(void **unused)
{
    (void)unused;
    ShvImpactShape *ball = sphere(0.1), *ground = floor_plane();
    const ShvImpactBody a = body_of(ball, shv_vec3(-2.0, 0.0, 1.0), shv_vec3(0.0, 0.0, 0.0));
    ShvImpactBody b = body_of(ground, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    b.motion.angular_velocity[1] = 3.0; /* lifts the side of negative x */
    ShvImpact impact;
    assert_true(impact_of(&a, &b, 1.0, 0.0, &impact));
    const double exact = (acos(2.0 / sqrt(5.0)) - asin(0.1 / sqrt(5.0))) / 3.0;
    check_time(&impact, exact, 0.2);
    shv_impact_shape_release(ball);
    shv_impact_shape_release(ground);
}

/* Height of the lowest corner of a falling box that turns about the y axis. */
static double lowest_corner(double time)
{
    const double angle = 0.2 + 7.0 * time, height = 0.6 - 0.5 * time - 0.5 * 9.81 * time * time;
    return height - 0.3 * fabs(sin(angle)) - 0.1 * fabs(cos(angle));
}

static void test_spinning_box_on_plane(void **unused)
{
    (void)unused;
    ShvImpactShape *brick = box(0.3, 0.2, 0.1), *ground = floor_plane();
    ShvImpactBody a = body_of(brick, shv_vec3(0.0, 0.0, 0.6), shv_vec3(0.0, 0.0, -0.5));
    a.motion.acceleration[2] = -9.81;
    a.motion.angular_velocity[1] = 7.0;
    orient(&a, shv_quat_from_axis_angle(shv_vec3(0.0, 1.0, 0.0), 0.2));
    const ShvImpactBody b = body_of(ground, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    double above = 0.0, below = 0.0;
    while (lowest_corner(below) > 0.0) below += 1e-5;
    above = below - 1e-5;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (above + below);
        if (lowest_corner(middle) > 0.0)
            above = middle;
        else
            below = middle;
    }
    ShvImpact impact;
    assert_true(impact_of(&a, &b, 1.0, 0.0, &impact));
    check_time(&impact, above, 0.6);
    assert_true(impact.evaluations < 15);
    const double h = 1e-6;
    check_near(impact.closing, (lowest_corner(above - h) - lowest_corner(above + h)) / (2.0 * h), 1e-4);
    shv_impact_shape_release(brick);
    shv_impact_shape_release(ground);
}

static void test_edge_on_edge(void **unused)
{
    (void)unused;
    ShvImpactShape *cube = box(0.01, 0.01, 0.01);
    ShvImpactBody a = body_of(cube, shv_vec3(1e-4, 2e-4, 0.1), shv_vec3(0.0, 0.0, -5.0));
    ShvImpactBody b = body_of(cube, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 1.0));
    orient(&a, shv_quat_from_axis_angle(shv_vec3(1.0, 0.0, 0.0), 0.25 * pi));
    orient(&b, shv_quat_from_axis_angle(shv_vec3(0.0, 1.0, 0.0), 0.25 * pi));
    ShvImpact impact;
    assert_true(impact_of(&a, &b, 0.1, 0.0, &impact));
    check_time(&impact, (0.1 - 0.02 * sqrt(2.0)) / 6.0, 0.02 * sqrt(2.0));
    check_near(impact.closing, 6.0, 1e-9);
    check_near(impact.first[0], 0.0, 1e-6);
    check_near(impact.first[1], 2e-4, 1e-6);
    shv_impact_shape_release(cube);
}

static void test_bullet_through_thin_plate(void **unused)
{
    (void)unused;
    ShvImpactShape *cube = box(0.005, 0.005, 0.005), *plate = box(0.1, 0.1, 0.0005);
    ShvImpactBody a = body_of(cube, shv_vec3(0.01, 0.02, 0.5), shv_vec3(0.0, 0.0, -1000.0));
    const ShvImpactBody b = body_of(plate, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    ShvImpact impact;
    assert_true(impact_of(&a, &b, 1e-3, 0.0, &impact));
    check_time(&impact, (0.5 - 0.0055) / 1000.0, 0.01);
    check_near(impact.closing, 1000.0, 1e-6);
    for (double spin = 10.0; spin < 2e5; spin *= 10.0) { /* up to 100 rad on the way: the corner's time by its height */
        shv_store3(a.motion.angular_velocity, shv_vec3(spin, 0.0, 0.0));
        assert_true(impact_of(&a, &b, 1e-3, 0.0, &impact));
        const double angle = spin * impact.time;
        const double reach = 0.005 * (fabs(sin(angle)) + fabs(cos(angle)));
        const double gap = 0.5 - 1000.0 * impact.time - reach - 0.0005;
        assert_true(gap >= -1e-12 && gap <= tolerance * 0.02);
    }
    shv_impact_shape_release(cube);
    shv_impact_shape_release(plate);
}

static void test_bar_sweeps_into_post(void **unused)
{
    (void)unused;
    ShvImpactShape *bar = box(1.0, 0.02, 0.05), *post = sphere(0.03);
    ShvImpactBody a = body_of(bar, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    const ShvImpactBody b = body_of(post, shv_vec3(0.0, 0.9, 0.0), shv_vec3(0.0, 0.0, 0.0));
    for (double spin = 0.1; spin < 2e3; spin *= 10.0) {
        shv_store3(a.motion.angular_velocity, shv_vec3(0.0, 0.0, spin));
        const double exact = (0.5 * pi - asin(0.05 / 0.9)) / spin;
        ShvImpact impact;
        assert_true(impact_of(&a, &b, 20.0 / spin, 0.0, &impact));
        check_time(&impact, exact, 0.06);
        check_near(impact.closing, spin * sqrt(0.81 - 0.0025), 1e-4 * spin);
        assert_false(impact_of(&a, &b, 0.999 * exact, 0.0, &impact));
    }
    shv_impact_shape_release(bar);
    shv_impact_shape_release(post);
}

/* Turns about z and, in turned axes, about x: ω = a z + b Rz x, |dω/dt| = |a b|. */
typedef struct Wobble {
    ShvQuat start;
    double a, b;
} Wobble;

static void wobble_at(const void *data, double time, double orientation[4], double angular_velocity[3])
{
    const Wobble *wobble = data;
    const ShvQuat about_z = shv_quat_from_axis_angle(shv_vec3(0.0, 0.0, 1.0), wobble->a * time);
    const ShvQuat about_x = shv_quat_from_axis_angle(shv_vec3(1.0, 0.0, 0.0), wobble->b * time);
    const ShvQuat q = shv_quat_multiply(shv_quat_multiply(about_z, about_x), wobble->start);
    const double values[4] = {q.w, q.x, q.y, q.z};
    memcpy(orientation, values, sizeof values);
    shv_store3(angular_velocity,
               shv_vec3(wobble->b * shv_cos(wobble->a * time), wobble->b * shv_sin(wobble->a * time), wobble->a));
}

static void give_wobble(ShvImpactBody *body, const Wobble *wobble)
{
    body->motion.turn = wobble_at;
    body->motion.data = wobble;
    body->motion.fastest = sqrt(wobble->a * wobble->a + wobble->b * wobble->b);
    body->motion.angular_acceleration = fabs(wobble->a * wobble->b);
}

typedef struct Hull {
    double points[3 * 12];
    int32_t count;
    Wobble wobble;
    ShvImpactShape *shape;
    ShvImpactBody body;
} Hull;

static void random_hull(Hull *hull, uint64_t *index, ShvVec3 position, double speed, double spin)
{
    ShvError error;
    hull->count = 4 + (int32_t)(8.0 * shv_random_uniform(11, (*index)++));
    for (int32_t i = 0; i < hull->count; i++) shv_store3(hull->points + 3 * i, shv_scale(draw_vector(11, index), 0.5));
    const int32_t begin[2] = {0, hull->count};
    check_ok(shv_impact_hulls_create(&hull->shape, hull->points, begin, 1, &error), error);
    hull->body = body_of(hull->shape, position, shv_scale(draw_vector(11, index), speed));
    shv_store3(hull->body.motion.acceleration, shv_scale(draw_vector(11, index), speed));
    const ShvVec3 start = draw_vector(11, index), rates = draw_vector(11, index);
    hull->wobble =
        (Wobble){shv_quat_unit((ShvQuat){rates.z, start.x, start.y, start.z}), spin * rates.x, spin * rates.y};
    give_wobble(&hull->body, &hull->wobble);
}

static ShvConvex placed(const Hull *hull, double time)
{
    ShvConvex convex = {.points = hull->points, .count = hull->count};
    const ShvImpactMotion *motion = &hull->body.motion;
    const ShvVec3 moved = shv_madd(shv_load3(motion->position), time, shv_load3(motion->velocity));
    shv_store3(convex.position, shv_madd(moved, 0.5 * time * time, shv_load3(motion->acceleration)));
    double q[4], spin[3];
    wobble_at(&hull->wobble, time, q, spin);
    const ShvMat3 m = shv_quat_to_matrix((ShvQuat){q[0], q[1], q[2], q[3]});
    memcpy(convex.rotation, m.m, sizeof m.m);
    return convex;
}

static double gap_at(const Hull *a, const Hull *b, double time)
{
    const ShvConvex one = placed(a, time), other = placed(b, time);
    ShvConvexGap gap;
    ShvError error;
    check_ok(shv_convex_gap(&one, &other, &gap, &error), error);
    return gap.gap;
}

/* Bodies apart at the start, with rotation that is not constant, against fine samples of the gap. */
static void test_random_pairs(void **unused)
{
    (void)unused;
    enum { SAMPLES = 400 };
    uint64_t index = 0;
    int hits = 0, misses = 0;
    long evaluations = 0;
    for (int trial = 0; trial < 400; trial++) {
        Hull a, b;
        const double spin = trial % 4 == 3 ? 40.0 : 3.0;
        random_hull(&a, &index, shv_vec3(0.0, 0.0, 0.0), 1.0, spin);
        const ShvVec3 from = shv_scale(draw_vector(11, &index), 2.0);
        random_hull(&b, &index, from, 1.0, spin);
        shv_store3(b.body.motion.velocity, shv_madd(shv_load3(b.body.motion.velocity), -1.2, from));
        const double start = gap_at(&a, &b, 0.0);
        if (start > 1e-3) {
            ShvImpact impact = {0};
            const bool found = impact_of(&a.body, &b.body, 1.0, 0.0, &impact);
            const double end = found ? impact.time : 1.0;
            for (int i = 0; i <= SAMPLES; i++) assert_true(gap_at(&a, &b, end * i / SAMPLES) > (found ? 0.0 : -1e-6));
            if (found) {
                assert_true(gap_at(&a, &b, impact.time) <= tolerance);
                check_near(gap_at(&a, &b, impact.time), impact.gap, 1e-9); /* 1e-16/1e-6 rad × 1 m */
                assert_true(impact.closing > 0.0);
                evaluations += impact.evaluations;
            }
            hits += found;
            misses += !found;
        }
        shv_impact_shape_release(a.shape);
        shv_impact_shape_release(b.shape);
    }
    print_message("%d hits, %d misses, %.1f evaluations a hit\n", hits, misses, (double)evaluations / hits);
    assert_true(hits > 50 && misses > 50);
}

static void test_contact_at_the_start(void **unused)
{
    (void)unused;
    ShvImpactShape *cube = box(0.01, 0.01, 0.01), *plate = box(0.1, 0.1, 0.01), *ground = floor_plane();
    const ShvImpactBody grounds[2] = {body_of(ground, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0)),
                                      body_of(plate, shv_vec3(0.0, 0.0, -0.01), shv_vec3(0.0, 0.0, 0.0))};
    ShvImpact impact;
    for (int i = 0; i < 2; i++) {
        const double gaps[] = {0.0, 1e-9, -1e-9, -1e-4};
        for (int k = 0; k < 4; k++) {
            ShvImpactBody a = body_of(cube, shv_vec3(0.0, 0.0, 0.01 + gaps[k]), shv_vec3(0.0, 0.0, 0.1));
            assert_false(impact_of(&a, &grounds[i], 1e-2, 0.0, &impact)); /* parts */
            shv_store3(a.motion.velocity, shv_vec3(1.0, 0.0, 0.0));
            assert_false(impact_of(&a, &grounds[i], 1e-2, 0.0, &impact)); /* slides */
            shv_store3(a.motion.velocity, shv_vec3(1.0, 0.0, -0.1));
            assert_true(impact_of(&a, &grounds[i], 1e-2, 0.0, &impact)); /* closes */
            check_near(impact.time, 0.0, 0.0);
            check_near(impact.closing, 0.1, 1e-12);
            a.motion.acceleration[2] = -9.81; /* rests */
            shv_store3(a.motion.velocity, shv_vec3(0.0, 0.0, 0.0));
            assert_false(impact_of(&a, &grounds[i], 1e-3, 2e-2, &impact));
            assert_true(impact_of(&a, &grounds[i], 1e-3, 0.0, &impact));
            check_near(impact.time, 0.0, 0.0);
            shv_store3(a.motion.velocity, shv_vec3(0.0, 0.0, 0.1)); /* jumps and comes back */
            assert_true(impact_of(&a, &grounds[i], 0.1, 2e-2, &impact));
            if (gaps[k] > -1e-6) check_near(impact.time, 0.2 / 9.81, 1e-6);
        }
        /* rocks: one edge lifts, the other comes down */
        ShvImpactBody a = body_of(cube, shv_vec3(0.0, 0.0, 0.01), shv_vec3(0.0, 0.0, 0.0));
        a.motion.angular_velocity[1] = 5.0;
        assert_true(impact_of(&a, &grounds[i], 1e-3, 0.0, &impact));
        check_near(impact.time, 0.0, 0.0);
        check_near(impact.closing, 0.05, 1e-4);
    }
    shv_impact_shape_release(cube);
    shv_impact_shape_release(plate);
    shv_impact_shape_release(ground);
}

static const double corner[24] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1, -1, -1, 1, 1, -1, 1, -1, 1, 1, 1, 1, 1};
static const int32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/* A box as a surface and as eight hulls meets everything when the box does. */
static void test_mesh_and_compound_equal_box(void **unused)
{
    (void)unused;
    double cells[8 * 24];
    int32_t begin[9];
    for (int cell = 0; cell <= 8; cell++) begin[cell] = 8 * cell;
    for (int i = 0; i < 64; i++)
        for (int axis = 0; axis < 3; axis++)
            cells[3 * i + axis] = 0.5 * (corner[3 * (i / 8) + axis] + corner[3 * (i % 8) + axis]);
    ShvImpactShape *shapes[3] = {box(1.0, 1.0, 1.0), NULL, NULL}, *ball = sphere(0.3), *stick = box(0.7, 0.1, 0.1);
    ShvError error;
    check_ok(shv_impact_mesh_create(&shapes[1], corner, 8, faces, 12, &error), error);
    check_ok(shv_impact_hulls_create(&shapes[2], cells, begin, 8, &error), error);
    uint64_t index = 0;
    int hits = 0;
    for (int trial = 0; trial < 200; trial++) {
        const ShvVec3 from = shv_scale(shv_unit(draw_vector(13, &index)), 2.9);
        ShvImpactBody a = body_of(trial % 2 ? ball : stick, from, shv_scale(draw_vector(13, &index), 3.0));
        shv_store3(a.motion.velocity, shv_madd(shv_load3(a.motion.velocity), -1.5, from));
        ShvImpactBody b = body_of(NULL, shv_vec3(0.0, 0.0, 0.0), draw_vector(13, &index));
        shv_store3(a.motion.angular_velocity, shv_scale(draw_vector(13, &index), 5.0));
        shv_store3(b.motion.angular_velocity, shv_scale(draw_vector(13, &index), 5.0));
        ShvImpact impact[3] = {0};
        bool found[3];
        for (int i = 0; i < 3; i++) {
            b.shape = shapes[i];
            found[i] = impact_of(&a, &b, 0.5, 0.0, &impact[i]);
        }
        assert_true(found[0] == found[1] && found[0] == found[2]);
        hits += found[0];
        for (int i = 1; i < 3 && found[0]; i++) check_near(impact[i].time, impact[0].time, 1e-5 / impact[0].closing);
    }
    print_message("%d of 200 hit\n", hits);
    assert_true(hits > 50 && hits < 190);
    for (int i = 0; i < 3; i++) shv_impact_shape_release(shapes[i]);
    shv_impact_shape_release(ball);
    shv_impact_shape_release(stick);
}

/* The cells of a cut box touch each other from the start: bodies of four cells each, interlocked in turn. */
static void test_pieces_of_one_body(void **unused)
{
    (void)unused;
    double cells[2][4 * 24];
    const int32_t begin[5] = {0, 8, 16, 24, 32};
    int32_t next[2] = {0, 0};
    for (int cell = 0; cell < 8; cell++) {
        const int owner = (cell & 1) ^ (cell >> 1 & 1) ^ (cell >> 2 & 1);
        for (int i = 0; i < 8; i++)
            for (int axis = 0; axis < 3; axis++)
                cells[owner][next[owner]++] = 0.5 * (corner[3 * cell + axis] + corner[3 * i + axis]);
    }
    ShvImpactShape *shapes[2];
    ShvError error;
    for (int i = 0; i < 2; i++) check_ok(shv_impact_hulls_create(&shapes[i], cells[i], begin, 4, &error), error);
    const ShvQuat turn = shv_quat_unit((ShvQuat){0.3, 0.5, -0.2, 0.7});
    ShvImpactBody a = body_of(shapes[0], shv_vec3(3.0, 2.0, 1.0), shv_vec3(5.0, -3.0, 2.0)), b = a;
    b.shape = shapes[1];
    orient(&a, turn);
    orient(&b, turn);
    ShvImpact impact;
    assert_false(impact_of(&a, &b, 1.0, 0.0, &impact)); /* fly together */
    shv_store3(b.motion.velocity, shv_add(shv_load3(a.motion.velocity), shv_rotate(turn, shv_vec3(0.0, 0.0, 0.1))));
    assert_true(impact_of(&a, &b, 1.0, 0.0, &impact)); /* locked along the axes */
    check_near(impact.time, 0.0, 0.0);
    check_near(impact.closing, 0.1, 1e-9);
    assert_false(impact_of(&a, &b, 1.0, 0.2, &impact)); /* slow contact is passed over */
    for (int i = 0; i < 2; i++) shv_impact_shape_release(shapes[i]);
}

static void test_refusals(void **unused)
{
    (void)unused;
    ShvImpactShape *shape;
    ShvError error;
    const double bad_half[3] = {1.0, 0.0, 1.0}, long_normal[3] = {0.0, 0.0, 2.0};
    const int32_t outside[3] = {0, 1, 8}, empty[2] = {0, 0};
    check_fails(shv_impact_box_create(&shape, bad_half, &error), SHV_BAD_INPUT, error, "half sizes");
    assert_null(shape);
    check_fails(shv_impact_sphere_create(&shape, (double)NAN, &error), SHV_BAD_INPUT, error, "radius");
    check_fails(shv_impact_plane_create(&shape, long_normal, 0.0, &error), SHV_BAD_INPUT, error, "length 1");
    check_fails(shv_impact_mesh_create(&shape, corner, 8, outside, 1, &error), SHV_BAD_INPUT, error, "triangles");
    check_fails(shv_impact_hulls_create(&shape, corner, empty, 1, &error), SHV_BAD_INPUT, error, "vertex");
    ShvImpactShape *ball = sphere(1.0);
    ShvImpactBody a = body_of(ball, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0)), b = a;
    ShvImpactSettings settings = {.step = 1.0, .tolerance = 0.0, .slowest = 0.0};
    bool found;
    ShvImpact impact;
    check_fails(shv_impact_time(&a, &b, &settings, &found, &impact, &error), SHV_BAD_INPUT, error, "tolerance");
    settings.tolerance = tolerance;
    b.motion.velocity[1] = (double)NAN;
    check_fails(shv_impact_time(&a, &b, &settings, &found, &impact, &error), SHV_BAD_INPUT, error, "finite");
    shv_impact_shape_release(ball);
}

/* Printed, not asserted. */
static void test_speed(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    for (int32_t count = 8; count <= 64; count *= 8)
        for (int kind = 0; kind < 4; kind++) {
            double points[192];
            const int32_t begin[2] = {0, count};
            for (int32_t i = 0; i < count; i++) shv_store3(points + 3 * i, shv_unit(draw_vector(19, &index)));
            ShvImpactShape *hull;
            ShvError error;
            check_ok(shv_impact_hulls_create(&hull, points, begin, 1, &error), error);
            const int repeats = 2000;
            long evaluations = 0;
            int hits = 0;
            const double start = shv_now();
            for (int i = 0; i < repeats; i++) {
                ShvImpactBody a = body_of(hull, shv_vec3(3.0, draw(19, &index), 0.0), shv_vec3(-5.0, 0.0, 0.0));
                ShvImpactBody b = body_of(hull, shv_vec3(0.0, 0.0, 0.0), draw_vector(19, &index));
                if (kind == 3) a.motion.velocity[0] = 1.0;
                const double spin = kind == 0 ? 0.0 : kind == 1 ? 1.0 : 20.0;
                shv_store3(a.motion.angular_velocity, shv_scale(draw_vector(19, &index), spin));
                shv_store3(b.motion.angular_velocity, shv_scale(draw_vector(19, &index), spin));
                const ShvImpactSettings settings = {.step = 1.0, .tolerance = tolerance, .slowest = 0.0};
                bool found;
                ShvImpact impact;
                check_ok(shv_impact_time(&a, &b, &settings, &found, &impact, &error), error);
                hits += found;
                evaluations += impact.evaluations;
            }
            const double seconds = shv_now() - start;
            static const char *const names[] = {"no spin", "slow spin", "fast spin", "parting"};
            print_message("%2d vertices, %-9s: %.2f us, %.1f evaluations, %d of %d hit\n", count, names[kind],
                          1e6 * seconds / repeats, (double)evaluations / repeats, hits, repeats);
            shv_impact_shape_release(hull);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_falls_on_plane),
        cmocka_unit_test(test_turning_plane),
        cmocka_unit_test(test_spinning_box_on_plane),
        cmocka_unit_test(test_edge_on_edge),
        cmocka_unit_test(test_bullet_through_thin_plate),
        cmocka_unit_test(test_bar_sweeps_into_post),
        cmocka_unit_test(test_random_pairs),
        cmocka_unit_test(test_contact_at_the_start),
        cmocka_unit_test(test_mesh_and_compound_equal_box),
        cmocka_unit_test(test_pieces_of_one_body),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
