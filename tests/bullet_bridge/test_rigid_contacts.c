/* Contacts of random hulls against the exact gap (depth.h, itself judged by FCL and libccd). */
#include "check.h"

#include "base/random.h"
#include "base/vector.h"
#include "bullet_bridge/depth.h"
#include "bullet_bridge/rigid_world.h"

enum { MOST_POINTS = 24, TRIALS = 2000 };
static uint64_t next;

static double draw(double size)
{
    return size * (2.0 * shv_random_uniform(31, next++) - 1.0);
}

static ShvVec3 draw3(double size)
{
    const double x = draw(size), y = draw(size);
    return shv_vec3(x, y, draw(size));
}

typedef struct Body {
    double points[3 * MOST_POINTS], radius; /* m, about the mean of the points */
    int32_t count;
    ShvConvex convex;
} Body;

/* A hull of 4 to 24 points, some of them flat or long. */
static void make(Body *body, ShvBulletWorld *world, int32_t number, ShvVec3 position)
{
    const double sizes[3] = {1.0, number ? 0.1 + 0.4 * shv_random_uniform(31, next++) : 1.0, 1.0};
    body->count = 4 + (int32_t)(20.0 * shv_random_uniform(31, next++));
    for (int32_t i = 0; i < body->count; i++)
        for (int k = 0; k < 3; k++) body->points[3 * i + k] = draw(sizes[k]);
    ShvVec3 mean = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = 0; i < body->count; i++) mean = shv_madd(mean, 1.0 / body->count, shv_load3(body->points + 3 * i));
    body->radius = 0.0;
    for (int32_t i = 0; i < body->count; i++)
        body->radius = fmax(body->radius, shv_norm(shv_sub(shv_load3(body->points + 3 * i), mean)));
    const ShvMat3 axes = shv_quat_to_matrix(shv_quat_exponential(draw3(2.0)));
    body->convex = (ShvConvex){.points = body->points, .count = body->count};
    shv_store3(body->convex.position, position);
    for (int i = 0; i < 9; i++) body->convex.rotation[i] = axes.m[i / 3][i % 3];
    const int32_t begin[2] = {0, body->count};
    const ShvBulletShape shape = {
        .kind = SHV_BULLET_HULLS, .hull_count = 1, .hull_begin = begin, .vertices = body->points};
    const double moment[3] = {1.0, 1.0, 1.0};
    ShvError error;
    check_ok(shv_bullet_world_add(world, number, &shape, 1.0, moment, &error), error);
    shv_bullet_world_place(world, number, body->convex.position, body->convex.rotation);
}

static const ShvBulletOverrides all = {true, true, true};

typedef struct Seen {
    ShvBulletPair pairs[16];
    int32_t count;
} Seen;

static ShvStatus note_pairs(void *data, const ShvBulletPair *pairs, int32_t count, ShvBulletTask *task, ShvError *error)
{
    (void)task;
    (void)error;
    Seen *seen = data;
    for (seen->count = 0; seen->count < count && seen->count < 16; seen->count++)
        seen->pairs[seen->count] = pairs[seen->count];
    return SHV_OK;
}

/* All in one place: particles meet obstacles, planes among them, and neither bodies nor one another. */
static void test_layers(void **unused)
{
    (void)unused;
    static const ShvBulletLayer layers[] = {SHV_BULLET_BODY, SHV_BULLET_PARTICLE, SHV_BULLET_OBSTACLE,
                                            SHV_BULLET_PARTICLE, SHV_BULLET_BODY};
    enum { COUNT = 5, PLANE = 5 };
    static const ShvBulletPair expected[] = {{0, 2}, {0, 4}, {0, 5}, {1, 2}, {1, 5}, {2, 3}, {2, 4}, {3, 5}, {4, 5}};
    const double moment[3] = {1.0, 1.0, 1.0}, none[3] = {0.0, 0.0, 0.0}, axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    ShvBulletWorld *world;
    ShvError error;
    check_ok(shv_bullet_world_create(&world, 1.0, &all, &error), error);
    for (int32_t i = 0; i < COUNT; i++) {
        const ShvBulletShape ball = {.kind = SHV_BULLET_SPHERE, .layer = layers[i], .radius = 0.5};
        const double inverse_mass = layers[i] == SHV_BULLET_OBSTACLE ? 0.0 : 1.0;
        check_ok(shv_bullet_world_add(world, i, &ball, inverse_mass, moment, &error), error);
        shv_bullet_world_place(world, i, none, axes);
        check_ok(shv_bullet_world_reach(world, i, none, 0.0, 0.0, &error), error);
    }
    const ShvBulletShape plane = {.kind = SHV_BULLET_PLANE, .layer = SHV_BULLET_OBSTACLE, .normal = {0.0, 0.0, 1.0}};
    check_ok(shv_bullet_world_add(world, PLANE, &plane, 0.0, none, &error), error);
    Seen seen = {.count = 0};
    check_ok(shv_bullet_world_step(world, 1.0, note_pairs, &seen, &error), error);
    assert_int_equal(seen.count, sizeof expected / sizeof *expected);
    assert_memory_equal(seen.pairs, expected, sizeof expected);
    shv_bullet_world_destroy(world);
}

/* The direction of contact is that of the nearest points of cores that are smaller by 0.005 of their radii, and gaps along any
   direction are at most the true one: the least gap found is at most so much below it. (Interior points move the radius' centre,
   hence twice.) Contacts of faces may be 1e-3 of the smaller radius off. */
static void test_gaps(void **unused)
{
    (void)unused;
    const double reach = 0.3;
    int touching = 0, apart = 0, far = 0;
    for (int trial = 0; trial < TRIALS; trial++) {
        ShvBulletWorld *world;
        ShvError error;
        check_ok(shv_bullet_world_create(&world, 1.0, &all, &error), error);
        Body a, b;
        make(&a, world, 0, draw3(0.1));
        make(&b, world, 1, shv_add(shv_vec3(1.7, 0.0, 0.0), draw3(0.7)));
        ShvConvexGap exact;
        check_ok(shv_convex_gap(&a.convex, &b.convex, &exact, &error), error);
        ShvBulletContact *contacts;
        int32_t count;
        check_ok(shv_bullet_world_collide(world, 0, 1, reach, &contacts, &count, &error), error);
        const double smaller = fmin(a.radius, b.radius), loss = 2.0 * 0.005 * (a.radius + b.radius) + 1e-3 * smaller;
        double least = HUGE_VAL;
        for (int32_t i = 0; i < count; i++) least = fmin(least, contacts[i].gap);
        if (exact.gap > reach + loss) {
            far++;
            assert_int_equal(count, 0);
        } else if (exact.gap > -0.003 * smaller && exact.gap < reach - loss) {
            assert_true(count > 0);
            assert_true(least <= exact.gap + 1e-3 * smaller && least >= exact.gap - loss);
            if (exact.gap > 0.02)
                apart++;
            else
                touching++;
        }
        shv_bullet_world_destroy(world);
    }
    print_message("%d near, %d touching, %d out of reach\n", apart, touching, far);
    assert_true(apart > 100 && touching > 20 && far > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_layers), cmocka_unit_test(test_gaps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
