/* Coupled bodies under Bullet: somebody else moves them; what meets them in flight changes their velocities at once. */
#include "check.h"

#include "bullet_world.h"
#include "fragment/free_rotation.h"

static const double step = 1e-3;

static ShvFragment *fragment_of(World *world, int32_t index)
{
    return &world->fragments.items[index];
}

/* What the caller does over a step. */
static void carry(ShvFragment *fragment, const double gravity[3])
{
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    const ShvVec3 momentum = shv_free_rotation_momentum(&rotation, fragment->orientation, fragment->angular_velocity);
    const ShvVec3 fall = shv_load3(gravity);
    fragment->position = shv_madd(shv_madd(fragment->position, step, fragment->velocity), 0.5 * step * step, fall);
    fragment->velocity = shv_madd(fragment->velocity, step, fall);
    fragment->orientation = shv_free_rotation_advance(&rotation, fragment->orientation, momentum, step);
    fragment->angular_velocity = shv_free_rotation_velocity(&rotation, fragment->orientation, momentum);
}

static void check_same(ShvVec3 a, ShvVec3 b)
{
    assert_true(a.x == b.x && a.y == b.y && a.z == b.z);
}

static void check_same_pose(const ShvFragment *a, const ShvFragment *b)
{
    check_same(a->position, b->position);
    assert_true(a->orientation.w == b->orientation.w && a->orientation.x == b->orientation.x &&
                a->orientation.y == b->orientation.y && a->orientation.z == b->orientation.z);
}

static void check_same_record(const ShvFragment *a, const ShvFragment *b)
{
    check_same_pose(a, b);
    check_same(a->velocity, b->velocity);
    check_same(a->angular_velocity, b->angular_velocity);
}

/* About the origin. */
static ShvVec3 angular_momentum(const ShvFragment *fragment)
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    return shv_add(shv_apply(&inertia, fragment->angular_velocity),
                   shv_cross(fragment->position, shv_scale(fragment->velocity, fragment->mass)));
}

/* Two boxes of which the second is a coupled body. */
static void two_boxes(World *world, double second_size)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05);
    world_box(world, second_size, second_size, second_size, 0.05)->placement.position[0] = 0.4;
    world_build(world);
    bullet_fly(world);
    fragment_of(world, 1)->coupled = true;
}

/* Both sides' momentum and angular momentum at each step, and the works, over tumbling impacts. */
static void test_momentum(void **unused)
{
    (void)unused;
    uint64_t index = 300;
    int met = 0, exact = 0;
    for (int trial = 0; trial < 10; trial++) {
        World world;
        two_boxes(&world, 0.15);
        world.backend->fragment_friction = 0.4;
        world.backend->fragment_restitution = trial % 3 * 0.5;
        ShvFragment *flying = fragment_of(&world, 0), *coupled_body = fragment_of(&world, 1);
        for (int f = 0; f < 2; f++) {
            fragment_of(&world, f)->orientation = draw_rotation(&index);
            fragment_of(&world, f)->angular_velocity = draw3(&index, 10.0);
            fragment_of(&world, f)->velocity = shv_add(shv_vec3(f ? -2.0 : 3.0, 0.0, 0.0), draw3(&index, 0.2));
        }
        const double scale = 3.0 * flying->mass;
        for (int i = 0; i < 200; i++) {
            const ShvFragment before = *coupled_body, other = *flying;
            world_advance(&world, i * step, step, no_gravity, NULL, NULL, NULL);
            check_same_pose(coupled_body, &before);
            const ShvVec3 given = shv_scale(shv_sub(flying->velocity, other.velocity), flying->mass);
            const ShvVec3 got = shv_scale(shv_sub(coupled_body->velocity, before.velocity), coupled_body->mass);
            check_near(shv_norm(shv_add(given, got)), 0.0, 1e-13 * scale);
            const ShvVec3 turned = shv_sub(angular_momentum(flying), angular_momentum(&other));
            const ShvVec3 turned_back = shv_sub(angular_momentum(coupled_body), angular_momentum(&before));
            exact += shv_norm(shv_add(turned, turned_back)) < 1e-14 * scale;
            met += shv_norm(got) > 0.0;
            carry(coupled_body, no_gravity);
        }
        world_end(&world);
    }
    assert_true(met >= 8);
    /* where hulls overlap the one in flight is moved aside without a velocity, which shifts its momentum */
    assert_true(exact > 0.98 * 2000);
}

/* Head on, frictionless: the velocities after are those of two free bodies with Newton's restitution, and the torque vanishes;
   off centre the angular impulse on the coupled body is that of the impulse at the point. */
static void test_impact(void **unused)
{
    (void)unused;
    for (int aside = 0; aside < 2; aside++) {
        World world;
        two_boxes(&world, 0.2);
        world.backend->fragment_friction = 0.0;
        world.backend->fragment_restitution = 0.6;
        ShvFragment *flying = fragment_of(&world, 0), *coupled_body = fragment_of(&world, 1);
        flying->velocity.x = 3.0;
        flying->position.y = aside ? 0.05 : 0.0;
        coupled_body->velocity.x = -1.0;
        const double m = flying->mass, n = coupled_body->mass, wanted = (m * 3.0 - n + 0.6 * n * -4.0) / (m + n);
        ShvVec3 impulse = shv_vec3(0.0, 0.0, 0.0), angular = impulse;
        const ShvMat3 inertia = shv_fragment_world_inertia(coupled_body), own = shv_fragment_world_inertia(flying);
        for (int i = 0; i < 100; i++) {
            world_advance(&world, i * step, step, no_gravity, NULL, NULL, NULL);
            impulse = shv_scale(
                shv_vec3(coupled_body->velocity.x + 1.0, coupled_body->velocity.y, coupled_body->velocity.z), n);
            angular = shv_apply(&inertia, coupled_body->angular_velocity);
            carry(coupled_body, no_gravity);
        }
        /* At the impact the flying centre lies (−0.15, ±0.05, 0) from the coupled body's, and no impulse has another direction than
           x: what both get about one point is opposite. */
        const double spin = shv_apply(&own, flying->angular_velocity).z;
        check_near(angular.z + spin + (aside ? 0.05 : 0.0) * impulse.x, 0.0, 1e-6 * impulse.x);
        assert_true(aside == (fabs(angular.z) > 0.01 * impulse.x));
        if (!aside) check_near(flying->velocity.x, wanted, 1e-6);
        check_near(n * coupled_body->velocity.x + m * flying->velocity.x, 3.0 * m - n, 1e-12 * m);
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
static void test_neither_floor_nor_coupled_bodies(void **unused)
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
        fragment_of(&world, f)->coupled = true;
        fragment_of(&world, f)->velocity.z = -1.0 - f;
    }
    const ShvFragment before[2] = {*fragment_of(&world, 0), *fragment_of(&world, 1)};
    int calls = 0;
    ShvRigidContact wakes[2];
    for (int i = 0; i < 100; i++)
        assert_int_equal(world_advance(&world, i * step, step, earth, never_called, &calls, wakes), 0);
    assert_int_equal(calls, 0);
    for (int f = 0; f < 2; f++) check_same_record(fragment_of(&world, f), &before[f]);
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

/* A brick on a box on the floor: the box becomes a coupled body, the floor holds it (here: the caller stops it). It gets the weight of
   the brick, which follows no faster than what both together gain from one step to the next, and overlaps left by that are let be. */
static void test_brick_on_coupled_body(void **unused)
{
    (void)unused;
    const double beat = 0.1 * step; /* of rigid intervals beside what is awake */
    for (int large = 0; large < 2; large++) {
        World world;
        brick_on_box(&world, large ? 0.4 : 0.06);
        for (int i = 0; i < 200; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        ShvFragment *coupled_body = fragment_of(&world, 0), *flying = fragment_of(&world, 1);
        const double ratio = flying->mass / coupled_body->mass, weight = 9.81 * flying->mass,
                     height = flying->position.z;
        const double least_work = world.backend->contact_work;
        double impulse = 0.0;
        coupled_body->coupled = true;
        for (int i = 0; i < 300; i++) {
            world_advance(&world, i * beat, beat, earth, NULL, NULL, NULL);
            if (i >= 200) impulse -= coupled_body->mass * coupled_body->velocity.z;
            assert_true(coupled_body->velocity.z > -1.01 * ratio * 9.81 * beat && coupled_body->velocity.z <= 0.0);
            coupled_body->velocity = coupled_body->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
        }
        check_near(impulse, weight * 100 * beat, 0.02 * weight * 100 * beat);
        assert_true(flying->position.z > height - 1.05 * (1.0 + ratio) * 9.81 * beat * 300 * beat);
        assert_true(world.backend->contact_work - least_work < 1.01 * weight * (height - flying->position.z));
        coupled_body->coupled = false;
        const double left = flying->position.z;
        for (int i = 0; i < 100; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        check_near(flying->position.z, left, 1e-4);
        check_near(coupled_body->position.z, 0.05, 1e-5);
        world_end(&world);
    }
}

/* Both fall: nothing passes between them. */
static void test_falling_together(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.0;
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.1;
    world_build(&world);
    bullet_fly(&world);
    ShvFragment *coupled_body = fragment_of(&world, 0), *flying = fragment_of(&world, 1);
    coupled_body->coupled = true;
    for (int i = 0; i < 200; i++) {
        world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        carry(coupled_body, earth);
    }
    check_near(flying->position.z - coupled_body->position.z, 0.1, 1e-9);
    coupled_body->coupled = false;
    for (int i = 0; i < 100; i++) world_advance(&world, 0.2 + i * step, step, earth, NULL, NULL, NULL);
    check_near(coupled_body->position.z, 1.0 - 0.5 * 9.81 * 0.09, 1e-9);
    world_end(&world);
}

static bool of_coupled_body(void *data, const ShvRigidContact *contact)
{
    return contact->fragment == *(int32_t *)data && contact->closing_speed > 1.0;
}

/* Struck by what flies it may wake: it leaves flight as its caller leads it, and is found once. */
static void test_wake(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world, 0.2);
    ShvFragment *flying = fragment_of(&world, 0), *coupled_body = fragment_of(&world, 1);
    flying->velocity.x = 10.0;
    int32_t own = 1;
    int wakes = 0;
    ShvRigidContact wake;
    for (int i = 0; i < 60; i++) {
        const ShvFragment before = *coupled_body;
        const int found = world_advance(&world, i * step, step, no_gravity, of_coupled_body, &own, &wake);
        if (found > 0) check_near(wake.time, 0.025, 1e-7);
        wakes += found;
        check_same_record(coupled_body, &before);
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
        cmocka_unit_test(test_neither_floor_nor_coupled_bodies),
        cmocka_unit_test(test_brick_on_coupled_body),
        cmocka_unit_test(test_falling_together),
        cmocka_unit_test(test_wake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
