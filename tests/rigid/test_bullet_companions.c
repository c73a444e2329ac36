/* Companions under Bullet: somebody else moves them; contacts with what is in flight give mean forces on them. */
#include "check.h"

#include "bullet_world.h"
#include "rigid/free_rotation.h"

static const double step = 1e-3;

static ShvFragment *fragment_of(World *world, int32_t index)
{
    return &world->fragments.items[index];
}

/* What the caller does over a step: the mean force and torque on an otherwise free body, half before and half after. */
static void carry(ShvFragment *fragment, const double gravity[3])
{
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    ShvVec3 momentum = shv_free_rotation_momentum(&rotation, fragment->orientation, fragment->angular_velocity);
    const ShvVec3 pull = shv_madd(shv_load3(gravity), 1.0 / fragment->mass, fragment->contact_force);
    fragment->position = shv_madd(shv_madd(fragment->position, step, fragment->velocity), 0.5 * step * step, pull);
    fragment->velocity = shv_madd(fragment->velocity, step, pull);
    momentum = shv_madd(momentum, step, fragment->contact_torque);
    fragment->orientation = shv_free_rotation_advance(&rotation, fragment->orientation, momentum, step);
    fragment->angular_velocity = shv_free_rotation_velocity(&rotation, fragment->orientation, momentum);
}

static void check_same(ShvVec3 a, ShvVec3 b)
{
    assert_true(a.x == b.x && a.y == b.y && a.z == b.z);
}

static void check_same_record(const ShvFragment *a, const ShvFragment *b)
{
    check_same(a->position, b->position);
    check_same(a->velocity, b->velocity);
    check_same(a->angular_velocity, b->angular_velocity);
    assert_true(a->orientation.w == b->orientation.w && a->orientation.x == b->orientation.x &&
                a->orientation.y == b->orientation.y && a->orientation.z == b->orientation.z);
}

/* Two boxes of which the second is a companion. */
static void two_boxes(World *world, double second_size)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05);
    world_box(world, second_size, second_size, second_size, 0.05)->placement.position[0] = 0.4;
    world_build(world);
    bullet_fly(world);
    fragment_of(world, 1)->companion = true;
}

/* Momentum of the companion's share and its partner, and its record, over tumbling impacts. */
static void test_momentum(void **unused)
{
    (void)unused;
    uint64_t index = 300;
    int met = 0;
    for (int trial = 0; trial < 10; trial++) {
        World world;
        two_boxes(&world, 0.15);
        world.backend->fragment_friction = 0.4;
        world.backend->fragment_restitution = trial % 3 * 0.5;
        ShvFragment *flying = fragment_of(&world, 0), *companion = fragment_of(&world, 1);
        for (int f = 0; f < 2; f++) {
            fragment_of(&world, f)->orientation = draw_rotation(&index);
            fragment_of(&world, f)->angular_velocity = draw3(&index, 10.0);
            fragment_of(&world, f)->velocity = shv_add(shv_vec3(f ? -2.0 : 3.0, 0.0, 0.0), draw3(&index, 0.2));
        }
        const double scale = 3.0 * flying->mass;
        for (int i = 0; i < 200; i++) {
            const ShvFragment before = *companion, other = *flying;
            world_advance(&world, i * step, step, no_gravity, NULL, NULL, NULL);
            check_same_record(companion, &before);
            const ShvVec3 given = shv_scale(shv_sub(flying->velocity, other.velocity), flying->mass);
            check_near(shv_norm(shv_madd(given, step, companion->contact_force)), 0.0, 1e-13 * scale);
            met += shv_norm(companion->contact_force) > 0.0;
            carry(companion, no_gravity);
        }
        world_end(&world);
    }
    assert_true(met >= 8);
}

/* Head on, frictionless: the velocities after are those of two free bodies with Newton's restitution, and the torque vanishes;
   off centre the angular impulse on the companion is that of the impulse at the point. */
static void test_impact(void **unused)
{
    (void)unused;
    for (int aside = 0; aside < 2; aside++) {
        World world;
        two_boxes(&world, 0.2);
        world.backend->fragment_friction = 0.0;
        world.backend->fragment_restitution = 0.6;
        ShvFragment *flying = fragment_of(&world, 0), *companion = fragment_of(&world, 1);
        flying->velocity.x = 3.0;
        flying->position.y = aside ? 0.05 : 0.0;
        companion->velocity.x = -1.0;
        const double m = flying->mass, n = companion->mass, wanted = (m * 3.0 - n + 0.6 * n * -4.0) / (m + n);
        ShvVec3 impulse = shv_vec3(0.0, 0.0, 0.0), angular = impulse;
        for (int i = 0; i < 100; i++) {
            world_advance(&world, i * step, step, no_gravity, NULL, NULL, NULL);
            impulse = shv_madd(impulse, step, companion->contact_force);
            angular = shv_madd(angular, step, companion->contact_torque);
            carry(companion, no_gravity);
        }
        /* At the impact the flying centre lies (−0.15, ±0.05, 0) from the companion's, and no impulse has another direction than
           x: what both get about one point is opposite. */
        const ShvMat3 inertia = shv_fragment_world_inertia(flying);
        const double spin = shv_apply(&inertia, flying->angular_velocity).z;
        check_near(angular.z + spin + (aside ? 0.05 : 0.0) * impulse.x, 0.0, 1e-6 * impulse.x);
        assert_true(aside == (fabs(angular.z) > 0.01 * impulse.x));
        if (!aside) check_near(flying->velocity.x, wanted, 1e-6);
        check_near(n * companion->velocity.x + m * flying->velocity.x, 3.0 * m - n, 1e-12 * m);
        world_end(&world);
    }
}

static bool never_called(void *data, const ShvRigidContact *contact)
{
    (void)contact;
    ++*(int *)data;
    return true;
}

/* Deep in the floor and in each other, and closing: not flight's affair. */
static void test_neither_floor_nor_companions(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.04;
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.12;
    world_floor(&world, 0.5, 0.5);
    world_build(&world);
    bullet_fly(&world);
    for (int f = 0; f < 2; f++) {
        fragment_of(&world, f)->companion = true;
        fragment_of(&world, f)->velocity.z = -1.0 - f;
    }
    const ShvFragment before[2] = {*fragment_of(&world, 0), *fragment_of(&world, 1)};
    int calls = 0;
    ShvRigidContact wakes[2];
    for (int i = 0; i < 100; i++)
        assert_int_equal(world_advance(&world, i * step, step, earth, never_called, &calls, wakes), 0);
    assert_int_equal(calls, 0);
    for (int f = 0; f < 2; f++) {
        check_same_record(fragment_of(&world, f), &before[f]);
        check_same(fragment_of(&world, f)->contact_force, shv_vec3(0.0, 0.0, 0.0));
    }
    check_near(world.backend->contact_work, 0.0, 0.0);
    world_end(&world);
}

/* A brick, a little off the middle, on a box on the floor. */
static void brick_on_box(World *world, double width)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05;
    ShvObjectDefinition *brick = world_box(world, width, width, 0.1, 0.1);
    brick->placement.position[0] = 0.01;
    brick->placement.position[2] = 0.15;
    world_floor(world, 0.5, 0.0);
    world_build(world);
    bullet_fly(world);
}

/* A brick on a box on the floor: the box becomes a companion, the floor holds it (here: the caller leaves it as it is). */
static void test_brick_on_companion(void **unused)
{
    (void)unused;
    for (int large = 0; large < 2; large++) {
        World world;
        brick_on_box(&world, large ? 0.4 : 0.06);
        for (int i = 0; i < 200; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        ShvFragment *companion = fragment_of(&world, 0), *flying = fragment_of(&world, 1);
        const double weight = 9.81 * flying->mass;
        const ShvVec3 place = flying->position;
        companion->companion = true;
        for (int i = 0; i < 300; i++) {
            world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
            check_near(companion->contact_force.z, -weight, 0.01 * weight);
            check_near(companion->contact_torque.y, 0.01 * weight, 0.01 * 0.1 * weight);
            /* the brick stands still: it follows at what it would gain by falling for a few steps, no faster */
            assert_true(companion->contact_slack > 0.0 && companion->contact_power >= companion->contact_slack);
            assert_true(companion->contact_power < 3.0 * 9.81 * step * weight);
        }
        check_near(shv_norm(shv_sub(flying->position, place)), 0.0, 1e-6);
        companion->companion = false;
        for (int i = 0; i < 100; i++) {
            world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
            check_same(companion->contact_force, shv_vec3(0.0, 0.0, 0.0));
            check_same(companion->contact_torque, shv_vec3(0.0, 0.0, 0.0));
        }
        check_near(shv_norm(shv_sub(flying->position, place)), 0.0, 1e-6);
        check_near(companion->position.z, 0.05, 1e-6);
        world_end(&world);
    }
}

/* The companion has not taken a quarter of what the brick gave it: the brick gets that back, once, and the work is booked. */
static void test_untaken_goes_back(void **unused)
{
    (void)unused;
    World world;
    brick_on_box(&world, 0.06);
    for (int i = 0; i < 50; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
    ShvFragment *companion = fragment_of(&world, 0), *flying = fragment_of(&world, 1);
    companion->companion = true;
    for (int i = 0; i < 20; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
    const ShvVec3 before = flying->velocity, given = shv_scale(companion->contact_force, step);
    const double kinetic = shv_fragment_kinetic(flying), booked = world.backend->contact_work;
    assert_true(given.z < 0.0);
    companion->contact_untaken = 0.25 * step;
    world.backend->functions->take_back(world.backend);
    const ShvVec3 gained = shv_scale(shv_sub(flying->velocity, before), flying->mass);
    check_near(shv_norm(shv_madd(gained, -0.25, given)), 0.0, 1e-12 * shv_norm(given));
    check_near(world.backend->contact_work - booked, shv_fragment_kinetic(flying) - kinetic, 1e-12 * kinetic + 1e-18);
    const ShvVec3 after = flying->velocity;
    assert_true(companion->contact_untaken == 0.0);
    world.backend->functions->take_back(world.backend);
    check_same(flying->velocity, after);
    /* Between companions that come to each other it could have given anything: what it gets back is bounded. */
    companion->contact_untaken = 1e6 * step;
    world.backend->functions->take_back(world.backend);
    assert_true(shv_norm(shv_sub(flying->velocity, after)) < 4.0 * 9.81 * step);
    world_end(&world);
}

/* Both fall: nothing passes between them once the companion has been seen to fall. */
static void test_falling_together(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.0;
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.1;
    world_build(&world);
    bullet_fly(&world);
    ShvFragment *companion = fragment_of(&world, 0), *flying = fragment_of(&world, 1);
    companion->companion = true;
    for (int i = 0; i < 200; i++) {
        world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        check_near(shv_norm(companion->contact_force), 0.0, 1e-6 * 9.81 * flying->mass);
        carry(companion, earth);
    }
    check_near(flying->position.z - companion->position.z, 0.1, 1e-9);
    companion->companion = false;
    for (int i = 0; i < 100; i++) world_advance(&world, 0.2 + i * step, step, earth, NULL, NULL, NULL);
    check_near(companion->position.z, 1.0 - 0.5 * 9.81 * 0.09, 1e-9);
    world_end(&world);
}

static bool of_companion(void *data, const ShvRigidContact *contact)
{
    return contact->fragment == *(int32_t *)data && contact->closing_speed > 1.0;
}

/* Struck by what flies it may wake: it leaves flight as its caller leads it, and is found once. */
static void test_wake(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world, 0.2);
    ShvFragment *flying = fragment_of(&world, 0), *companion = fragment_of(&world, 1);
    flying->velocity.x = 10.0;
    int32_t own = 1;
    int wakes = 0;
    ShvRigidContact wake;
    for (int i = 0; i < 60; i++) {
        const ShvFragment before = *companion;
        const int found = world_advance(&world, i * step, step, no_gravity, of_companion, &own, &wake);
        if (found > 0) check_near(wake.time, 0.025, 1e-7);
        wakes += found;
        check_same_record(companion, &before);
    }
    assert_int_equal(wakes, 1);
    world.backend->functions->remove(world.backend, 1);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_impact),
        cmocka_unit_test(test_neither_floor_nor_companions),
        cmocka_unit_test(test_brick_on_companion),
        cmocka_unit_test(test_untaken_goes_back),
        cmocka_unit_test(test_falling_together),
        cmocka_unit_test(test_wake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
