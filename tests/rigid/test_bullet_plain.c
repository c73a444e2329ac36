/* Plain Bullet: that it is Bullet's own integrator, detection and sleep, and what each override makes of them. */
#include "check.h"

#include "bullet_world.h"

static const ShvBulletPlainDefinition stock = {.unit = 1.0, .margin = 0.04};
/* For boxes of 10 cm: without a skin, so that they meet where they are. */
static const ShvBulletPlainDefinition fitting = {.unit = 0.1};

static void begin_under(World *world, const ShvBulletPlainDefinition *settings)
{
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(shv_bullet_plain_create(&world->backend, &rigid, settings, &error), error);
}

static void add_fragment(World *world, int32_t fragment)
{
    ShvError error = {0};
    shv_fragment_fit(&world->fragments.items[fragment], &world->fragments, &world->state);
    check_ok(world->backend->functions->add(world->backend, fragment, &error), error);
}

static void fly_plain(World *world, const ShvBulletPlainDefinition *settings)
{
    begin_under(world, settings);
    for (int32_t i = 0; i < world->fragments.count; i++) add_fragment(world, i);
}

static ShvObjectDefinition *box_at(World *world, double x, double z)
{
    ShvObjectDefinition *box = world_box(world, 0.1, 0.1, 0.1, 0.1);
    box->placement.position[0] = x;
    box->placement.position[2] = z;
    return box;
}

static void go(World *world, int from, int to)
{
    for (int i = from; i < to; i++) world_advance(world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
}

/* ---- flight ---- */

/* Bullet takes gravity by whole steps: after n of them it has fallen ½ g t² (1 + 1/n). */
static void test_free_fall(void **unused)
{
    (void)unused;
    for (int exact = 0; exact < 2; exact++) {
        World world;
        world_begin(&world);
        box_at(&world, 0.0, 10.0);
        world_build(&world);
        ShvBulletPlainDefinition settings = stock;
        settings.exact_flight = exact;
        fly_plain(&world, &settings);
        go(&world, 0, 1000);
        check_near(10.0 - world.fragments.items[0].position.z, 4.905 * (exact ? 1.0 : 1.001), 1e-11);
        world_end(&world);
    }
}

/* A spinning slab: Bullet's implicit step loses energy of rotation, exact flight none. */
static void test_free_rotation(void **unused)
{
    (void)unused;
    double lost[2];
    for (int exact = 0; exact < 2; exact++) {
        World world;
        world_begin(&world);
        ShvObjectDefinition *slab = world_box(&world, 0.3, 0.2, 0.1, 0.1);
        slab->placement.angular_velocity[0] = 0.1;
        slab->placement.angular_velocity[1] = 10.0;
        world_build(&world);
        ShvBulletPlainDefinition settings = stock;
        settings.exact_flight = exact;
        fly_plain(&world, &settings);
        const double before = shv_fragment_kinetic(&world.fragments.items[0]);
        for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        lost[exact] = (before - shv_fragment_kinetic(&world.fragments.items[0])) / before;
        world_end(&world);
    }
    assert_true(lost[0] > 1e-3);
    check_near(lost[1], 0.0, 1e-12);
}

/* ---- contact ---- */

/* From 1 m with 0.8 it comes back to 0.64 m above the floor, at any step; without the override it does not. */
static void test_rebound(void **unused)
{
    (void)unused;
    static const double steps[] = {1e-2, 1e-3, 1e-4};
    for (int sharp = 0; sharp < 2; sharp++)
        for (int s = 0; s < 3; s++) {
            World world;
            world_begin(&world);
            box_at(&world, 0.0, 1.05);
            world_floor(&world, 0.0, 0.8);
            world_build(&world);
            ShvBulletPlainDefinition settings = fitting;
            settings.exact_flight = settings.sharp_impacts = sharp;
            fly_plain(&world, &settings);
            const ShvFragment *fragment = &world.fragments.items[0];
            double apex = 0.0;
            for (int i = 0; i < (int)(1.1 / steps[s]); i++) {
                world_advance(&world, i * steps[s], steps[s], earth, NULL, NULL, NULL);
                const double left = fmax(0.0, fragment->velocity.z) * fragment->velocity.z / (2.0 * 9.81);
                if (i * steps[s] > 0.5) apex = fmax(apex, fragment->position.z - 0.05 + left);
            }
            if (sharp) check_near(apex, 0.64, 1e-3 * 0.64); /* ten iterations leave that much between the corners */
            if (!sharp) assert_true(fabs(apex - 0.64) > 0.0064);
            world_end(&world);
        }
}

/* The skin of 0.04 units keeps bodies that far apart; after 2 s of rest Bullet puts them to sleep. */
static void test_sleep(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    box_at(&world, 0.0, 0.1);
    world_floor(&world, 0.5, 0.0);
    world_build(&world);
    fly_plain(&world, &stock);
    const ShvFragment *fragment = &world.fragments.items[0];
    go(&world, 0, 4000);
    check_near(fragment->position.z, 0.05 + 0.04, 1e-3);
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    const ShvVec3 position = fragment->position;
    go(&world, 4000, 4010);
    assert_memory_equal(&position, &fragment->position, sizeof position);
    static const double sideways[3] = {9.81, 0.0, 0.0};
    for (int i = 0; i < 10; i++) world_advance(&world, 4.01 + i * 1e-3, 1e-3, sideways, NULL, NULL, NULL);
    assert_true(fragment->velocity.x > 0.01);
    world_end(&world);
}

/* A cube of 1 mm falls on to the floor and stays there, in units of its size; in metres it is refused (test_refusals). */
static void test_millimetres(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 1e-3, 1e-3, 1e-3, 1e-3)->placement.position[2] = 1.5e-3;
    world_floor(&world, 0.5, 0.0);
    world_build(&world);
    const ShvBulletPlainDefinition settings = {.unit = 1e-3};
    fly_plain(&world, &settings);
    for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-4, 1e-4, earth, NULL, NULL, NULL);
    check_near(world.fragments.items[0].position.z, 0.5e-3, 1e-5);
    world_end(&world);
}

/* Splinters: a fan of tets that share an edge, in so many hulls as it takes, falls whole. */
static void test_many_hulls(void **unused)
{
    (void)unused;
    enum { BLADES = 24 };
    double points[3 * (2 + 2 * BLADES)] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.02};
    int32_t tets[4 * BLADES];
    for (int b = 0; b < BLADES; b++) {
        for (int side = 0; side < 2; side++) {
            const double angle = 2.0 * 3.14159265358979 * (b + 0.3 * side) / BLADES;
            const double place[3] = {0.05 * cos(angle), 0.05 * sin(angle), 0.01};
            memcpy(points + 3 * (2 + 2 * b + side), place, sizeof place);
        }
        const int32_t tet[4] = {0, 2 + 2 * b, 3 + 2 * b, 1};
        memcpy(tets + 4 * b, tet, sizeof tet);
    }
    World world;
    world_begin(&world);
    world_floor(&world, 0.5, 0.0);
    world_tets(&world, points, 2 + 2 * BLADES, tets, BLADES);
    fly_plain(&world, &fitting);
    assert_true(world.fragments.items[0].hulls > 1);
    world.fragments.items[0].position.z += 0.05;
    go(&world, 0, 500);
    assert_true(world.fragments.items[0].position.z > 0.005 && world.fragments.items[0].position.z < 0.03);
    world_end(&world);
}

/* What somebody else changes in a record wakes the body and counts. */
static void test_events(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    box_at(&world, 0.0, 0.05);
    world_floor(&world, 0.0, 0.0);
    world_build(&world);
    fly_plain(&world, &fitting);
    go(&world, 0, 3000);
    ShvFragment *fragment = &world.fragments.items[0];
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    fragment->velocity.x = 1.0;
    go(&world, 3000, 3100);
    check_near(fragment->position.x, 0.1, 1e-3);
    world_end(&world);
}

/* Two boxes that stand in each other by 1 cm: Bullet drives them apart, unless that is let be. */
static void test_overlaps(void **unused)
{
    (void)unused;
    for (int kept = 0; kept < 2; kept++) {
        World world;
        world_begin(&world);
        box_at(&world, 0.0, 0.0);
        box_at(&world, 0.09, 0.0);
        world_build(&world);
        ShvBulletPlainDefinition settings = fitting;
        settings.keep_overlaps = kept;
        fly_plain(&world, &settings);
        for (int i = 0; i < 200; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        const double apart = world.fragments.items[1].position.x - world.fragments.items[0].position.x;
        if (kept) check_near(apart, 0.09, 1e-12);
        if (!kept) assert_true(apart > 0.0999);
        world_end(&world);
    }
}

/* A free ball, a ram that is driven, and a fixed mesh take part; a particle meets them, but no other fragment. */
static void test_obstacles(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    box_at(&world, -0.3, 0.0);
    box_at(&world, 0.15, 0.0);
    ShvObstacleDefinition *ball = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
    ball->radius = 0.05;
    ball->mass = 1.0;
    ball->motion = SHV_OBSTACLE_FREE;
    ball->placement.position[0] = 1.0;
    ball->placement.velocity[0] = -1.0;
    world_build(&world);
    world.fragments.items[1].dust = true;
    fly_plain(&world, &fitting);
    assert_true(world.backend->moves_obstacles);
    world.fragments.items[0].velocity.x = 0.2;
    const double energy = bullet_energy(&world, no_gravity);
    for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    /* the particle was hit by the ball, and has passed through the other box */
    assert_true(world.fragments.items[1].position.x < world.fragments.items[0].position.x);
    assert_true(world.fragments.items[1].velocity.x < -0.1);
    check_near(bullet_energy(&world, no_gravity), energy, 1e-12);
    world_end(&world);
}

/* ---- wakes ---- */

typedef struct Seen {
    ShvRigidContact contacts[8];
    int count;
} Seen;

static bool accept_second(void *data, const ShvRigidContact *contact)
{
    Seen *seen = data;
    if (seen->count < 8) seen->contacts[seen->count++] = *contact;
    return contact->fragment == 1;
}

/* Both sides are asked before any impulse; what wakes leaves as it came, and its partner flies on as if it were not there. */
static void test_wake(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    box_at(&world, 0.0, 0.0)->placement.velocity[0] = 2.0;
    box_at(&world, 0.12, 0.0);
    world_build(&world);
    fly_plain(&world, &fitting);
    const ShvVec3 place = world.fragments.items[1].position;
    Seen seen = {.count = 0};
    ShvRigidContact wakes[2];
    int32_t woken = 0;
    for (int i = 0; i < 20 && !woken; i++)
        woken = world_advance(&world, i * 1e-3, 1e-3, no_gravity, accept_second, &seen, wakes);
    assert_int_equal(woken, 1);
    assert_int_equal(seen.count, 2);
    assert_true(seen.contacts[0].fragment == 0 && seen.contacts[1].fragment == 1 && wakes[0].other == 0);
    assert_true(wakes[0].fresh && wakes[0].obstacle == -1);
    check_near(wakes[0].normal.x, 1.0, 1e-9);
    check_near(wakes[0].closing_speed, 2.0, 1e-9);
    check_near(wakes[0].time, 0.01, 1.001e-3);
    check_near(wakes[0].other_mass, world.fragments.items[0].mass, 0.0);
    assert_true(world.fragments.items[1].velocity.x == 0.0);
    for (int i = 20; i < 40; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    check_near(world.fragments.items[0].velocity.x, 2.0, 1e-12);
    assert_memory_equal(&world.fragments.items[1].position, &place, sizeof place);
    world_end(&world);
}

/* What joins when the others have taken a step already flies freely to its end, and they stay where they are. */
static void test_latecomer(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    box_at(&world, 0.0, 1.0)->placement.velocity[0] = 1.0;
    box_at(&world, 1.0, 1.0)->placement.velocity[0] = 1.0;
    world_build(&world);
    begin_under(&world, &fitting);
    add_fragment(&world, 0);
    world_advance(&world, 0.0, 1e-3, no_gravity, NULL, NULL, NULL);
    add_fragment(&world, 1);
    world_advance(&world, 4e-4, 6e-4, no_gravity, NULL, NULL, NULL);
    check_near(world.fragments.items[0].position.x, 1e-3, 1e-12);
    check_near(world.fragments.items[1].position.x, 1.0 + 6e-4, 1e-12);
    world_advance(&world, 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    for (int f = 0; f < 2; f++) check_near(world.fragments.items[f].position.x, f + 2e-3 - 4e-4 * f, 1e-12);
    world_end(&world);
}

/* ---- determinism ---- */

static void tumble(bool sorted, int order, ShvVec3 positions[3])
{
    World world;
    world_begin(&world);
    for (int i = 0; i < 3; i++) {
        ShvObjectDefinition *box = box_at(&world, 0.02 * i, 0.2 + 0.15 * i);
        box->placement.rotation_axis[1] = 1.0;
        box->placement.rotation_degrees = 20.0 * (i + 1);
    }
    world_floor(&world, 0.5, 0.4);
    world_build(&world);
    ShvBulletPlainDefinition settings = fitting;
    settings.sorted_pairs = sorted;
    begin_under(&world, &settings);
    static const int32_t orders[2][3] = {{0, 1, 2}, {2, 0, 1}};
    for (int k = 0; k < 3; k++) add_fragment(&world, orders[order][k]);
    go(&world, 0, 1000);
    for (int f = 0; f < 3; f++) positions[f] = world.fragments.items[f].position;
    world_end(&world);
}

/* The same calls give the same bits; with sorted pairs the order in which bodies came does not matter either. */
static void test_same_bits(void **unused)
{
    (void)unused;
    ShvVec3 first[3], again[3];
    for (int sorted = 0; sorted < 2; sorted++) {
        tumble(sorted, 0, first);
        tumble(sorted, sorted, again);
        assert_memory_equal(first, again, sizeof first);
    }
}

/* ---- bad input ---- */

static void test_refusals(void **unused)
{
    (void)unused;
    World world;
    ShvError error = {0};
    world_begin(&world);
    world_box(&world, 0.02, 0.02, 0.02, 0.02);
    world_build(&world);
    begin_under(&world, &stock);
    check_fails(world.backend->functions->add(world.backend, 0, &error), SHV_BAD_INPUT, error,
                "fragment 0: its radius");
    world.backend->functions->destroy(world.backend);
    begin_under(&world, &fitting);
    world.fragments.items[0].mass = 0.0;
    check_fails(world.backend->functions->add(world.backend, 0, &error), SHV_BAD_INPUT, error, "mass");
    world.fragments.items[0].mass = 1.0;
    add_fragment(&world, 0);
    world.fragments.items[0].velocity.x = (double)NAN;
    int32_t count = 0;
    check_fails(world.backend->functions->advance(world.backend, 0.0, 1e-3, earth, NULL, NULL, NULL, &count, &error),
                SHV_DIVERGED, error, "not finite");
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_fall), cmocka_unit_test(test_free_rotation), cmocka_unit_test(test_rebound),
        cmocka_unit_test(test_sleep),     cmocka_unit_test(test_events),        cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_obstacles), cmocka_unit_test(test_wake),          cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_refusals),  cmocka_unit_test(test_millimetres),   cmocka_unit_test(test_many_hulls),
        cmocka_unit_test(test_latecomer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
