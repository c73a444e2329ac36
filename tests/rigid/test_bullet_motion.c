/* Motion in closed form: flight, spin, bounces, sliding and rolling, under Bullet. */
#include "check.h"

#include "bullet_world.h"

/* A box on its own, its lowest face `height` above z = 0. */
static void box_world(World *world, double height)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05 + height;
}

/* Far from the box that every world has. */
static ShvObstacleDefinition *free_sphere(World *world, double radius, double mass)
{
    ShvObstacleDefinition *sphere = world_obstacle(world, SHV_OBSTACLE_SPHERE);
    sphere->radius = radius;
    sphere->motion = SHV_OBSTACLE_FREE;
    sphere->mass = mass;
    return sphere;
}

/* ---- free flight ---- */

static void test_ballistic_motion(void **unused)
{
    (void)unused;
    static const double steps[] = {1e-4, 3e-3, 0.7};
    for (int s = 0; s < 3; s++) {
        World world;
        box_world(&world, 10.0);
        world.objects[0].placement.velocity[0] = 3.0;
        world_build(&world);
        bullet_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        const ShvVec3 start = fragment->position;
        const int count = (int)(2.1 / steps[s]);
        for (int i = 0; i < count; i++) world_advance(&world, i * steps[s], steps[s], earth, NULL, NULL, NULL);
        const double time = count * steps[s];
        check_near(fragment->position.z - start.z, -0.5 * 9.81 * time * time, 1e-12 * 0.5 * 9.81 * time * time);
        check_near(fragment->position.x - start.x, 3.0 * time, 1e-12 * 3.0 * time);
        check_near(fragment->velocity.z, -9.81 * time, 1e-12 * 9.81 * time);
        world_end(&world);
    }
}

/* I = (1, 2, 3) about its own axes from ω = (0.01, 1, 0.01): ω2 vanishes at 10.917, 30.470, 50.023 s. */
static void test_torque_free_top(void **unused)
{
    (void)unused;
    static const double flips[3] = {10.917, 30.470, 50.023};
    World world;
    box_world(&world, 0.0);
    world_build(&world);
    ShvFragment *fragment = &world.fragments.items[0];
    fragment->inertia = (ShvMat3){{{1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 3.0}}};
    bullet_fly(&world);
    fragment->angular_velocity = shv_vec3(0.01, 1.0, 0.01);
    const ShvVec3 start = shv_vec3(0.01, 2.0, 0.03);
    const double kinetic = 0.5 * (1e-4 + 2.0 + 3e-4);
    double last = 1.0;
    int found = 0;
    for (int i = 0; i < 55000; i++) {
        world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        const ShvVec3 spin = shv_rotate(shv_quat_conjugate(fragment->orientation), fragment->angular_velocity);
        if (last * spin.y < 0.0) {
            assert_true(found < 3);
            check_near((i + last / (last - spin.y)) * 1e-3, flips[found], 1e-3);
            found++;
        }
        last = spin.y;
    }
    assert_int_equal(found, 3);
    check_near(shv_fragment_kinetic(fragment), kinetic, 1e-6 * kinetic);
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 end = shv_apply(&inertia, fragment->angular_velocity);
    check_near(shv_norm(shv_sub(end, start)), 0.0, 1e-8 * shv_norm(start));
    world_end(&world);
}

/* ---- bounces ---- */

/* From 1 m with e = 0.8: impacts at 0.45152, 1.17396, 1.75191, 2.21427 s, apices e^(2n). */
static void bounce(bool sphere, double step)
{
    static const double moments[4] = {0.4515236, 1.1739614, 1.7519117, 2.2142719};
    World world;
    box_world(&world, sphere ? 1000.0 : 1.0);
    world_floor(&world, 0.3, 0.8);
    if (sphere) free_sphere(&world, 0.05, 1.0)->placement.position[2] = 1.05;
    world_build(&world);
    bullet_fly(&world);
    const ShvVec3 *position = sphere ? &world.obstacles.items[1].position : &world.fragments.items[0].position;
    const ShvVec3 *velocity = sphere ? &world.obstacles.items[1].velocity : &world.fragments.items[0].velocity;
    const double start = bullet_energy(&world, earth);
    int found = 0;
    for (int i = 0; i < (int)(2.6 / step); i++) {
        const ShvVec3 from = *position, before = *velocity;
        world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
        check_near(bullet_energy(&world, earth), start, 1e-10 * start);
        assert_true(position->z > 0.05 - 1e-6);
        if (velocity->z <= before.z || found == 4) continue;
        const double meets = i * step + (before.z + sqrt(before.z * before.z + 2.0 * 9.81 * (from.z - 0.05))) / 9.81;
        check_near(meets, moments[found], 0.01 * moments[found]);
        found++;
        const double apex = position->z - 0.05 + 0.5 * velocity->z * velocity->z / 9.81;
        double exact = 1.0;
        for (int n = 0; n < found; n++) exact *= 0.64;
        check_near(apex, exact, 0.01 * exact);
    }
    assert_int_equal(found, 4);
    world_end(&world);
}

static void test_bounces_do_not_depend_on_the_step(void **unused)
{
    (void)unused;
    for (int sphere = 0; sphere < 2; sphere++) {
        bounce(sphere, 1e-2);
        bounce(sphere, 1e-3);
        bounce(sphere, 1e-4);
    }
}

/* ---- rest, sliding, rolling ---- */

static void test_comes_to_rest_and_stays(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.1);
    world_floor(&world, 0.3, 0.5);
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    const double start = bullet_energy(&world, earth);
    for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    const ShvVec3 position = fragment->position;
    check_near(position.z, 0.05, 1e-5 * fragment->radius);
    check_near(bullet_energy(&world, earth), start, 1e-9 * start);
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    for (int i = 0; i < 1000000; i++) world_advance(&world, 2.0 + i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    assert_memory_equal(&fragment->position, &position, sizeof position);
    world_end(&world);
}

/* Gravity turned instead of the floor: slides with g (sin − µ cos), or sticks. Along x, and along the diagonal, where a pyramid
   of friction would hold √2 times as much. */
static void test_incline(void **unused)
{
    (void)unused;
    const double slope = 0.5235987755982988, steps[] = {1e-2, 1e-3};
    const double down = 9.81 * sin(slope);
    for (int s = 0; s < 2; s++)
        for (int sticks = 0; sticks < 2; sticks++)
            for (int diagonal = 0; diagonal < 2; diagonal++) {
                const double x = diagonal ? sqrt(0.5) : 1.0, y = diagonal ? sqrt(0.5) : 0.0;
                const double gravity[3] = {down * x, down * y, -9.81 * cos(slope)};
                World world;
                box_world(&world, 0.0);
                world_floor(&world, sticks ? 0.6 : 0.5, 0.0); /* tan 30° = 0.577 */
                world_build(&world);
                bullet_fly(&world);
                const ShvFragment *fragment = &world.fragments.items[0];
                const double start = bullet_energy(&world, gravity);
                const int count = (int)(1.0 / steps[s]);
                for (int i = 0; i < count; i++)
                    world_advance(&world, i * steps[s], steps[s], gravity, NULL, NULL, NULL);
                const double a = sticks ? 0.0 : 9.81 * (sin(slope) - 0.5 * cos(slope));
                const double speed = fragment->velocity.x * x + fragment->velocity.y * y;
                const double way = fragment->position.x * x + fragment->position.y * y;
                check_near(speed, a, 0.01 * a + 1e-6);
                check_near(way, 0.5 * a, 0.01 * a + 1e-6);
                check_near(fragment->position.z, 0.05, 1e-5 * fragment->radius);
                check_near(bullet_energy(&world, gravity), start, 1e-9 * fragment->mass);
                world_end(&world);
            }
}

/* A homogeneous sphere rolls down with 5/7 g sin θ when µ is enough. */
static void test_rolling_sphere(void **unused)
{
    (void)unused;
    const double slope = 0.5235987755982988, steps[] = {1e-2, 1e-3};
    const double gravity[3] = {9.81 * sin(slope), 0.0, -9.81 * cos(slope)};
    for (int s = 0; s < 2; s++) {
        World world;
        box_world(&world, 1000.0);
        world_floor(&world, 0.5, 0.0);
        ShvObstacleDefinition *sphere = free_sphere(&world, 0.1, 2.0);
        sphere->friction = 0.5;
        sphere->placement.position[2] = 0.1;
        world_build(&world);
        bullet_fly(&world);
        const ShvObstacle *ball = &world.obstacles.items[1];
        const int count = (int)(1.0 / steps[s]);
        for (int i = 0; i < count; i++) world_advance(&world, i * steps[s], steps[s], gravity, NULL, NULL, NULL);
        const double a = 5.0 / 7.0 * 9.81 * sin(slope);
        check_near(ball->velocity.x, a, 0.01 * a);
        check_near(ball->position.x, 0.5 * a, 0.01 * 0.5 * a);
        check_near(ball->angular_velocity.y, a / 0.1, 0.01 * a / 0.1);
        world_end(&world);
    }
}

/* A sphere slid without spin at 2 m/s rolls after 2 v/(7 µ g) with 5/7 v. */
static void test_slip_to_roll(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 1000.0);
    world_floor(&world, 0.2, 0.0);
    ShvObstacleDefinition *sphere = free_sphere(&world, 0.1, 2.0);
    sphere->friction = 0.2;
    sphere->placement.position[2] = 0.1;
    sphere->placement.velocity[0] = 2.0;
    world_build(&world);
    bullet_fly(&world);
    const ShvObstacle *ball = &world.obstacles.items[1];
    double rolls = 0.0;
    for (int i = 0; i < 1000; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        if (rolls == 0.0 && fabs(ball->velocity.x - 0.1 * ball->angular_velocity.y) < 1e-6) rolls = (i + 1) * 1e-3;
    }
    check_near(rolls, 4.0 / (7.0 * 0.2 * 9.81), 0.01 * 0.2912 + 1e-3);
    check_near(ball->velocity.x, 10.0 / 7.0, 0.01 * 10.0 / 7.0);
    world_end(&world);
}

/* Slides to a stop after v²/(2 µ g). */
static void test_slides_to_a_stop(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    world.objects[0].placement.velocity[1] = 2.0;
    world_floor(&world, 0.4, 0.0);
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    check_near(fragment->position.y, 0.509684, 0.01 * 0.509684);
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ballistic_motion),
        cmocka_unit_test(test_torque_free_top),
        cmocka_unit_test(test_bounces_do_not_depend_on_the_step),
        cmocka_unit_test(test_comes_to_rest_and_stays),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_rolling_sphere),
        cmocka_unit_test(test_slip_to_roll),
        cmocka_unit_test(test_slides_to_a_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
