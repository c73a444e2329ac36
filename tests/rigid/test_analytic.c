#include "check.h"

#include <unistd.h>

#include "world.h"

static const double no_gravity[3] = {0.0, 0.0, 0.0}, earth[3] = {0.0, 0.0, -9.81};

/* A box on its own, its lowest face `height` above z = 0. */
static void box_world(World *world, double height)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05 + height;
}

static double kinetic(const ShvFragment *fragment)
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    return 0.5 * fragment->mass * shv_dot(fragment->velocity, fragment->velocity) +
           0.5 * shv_dot(fragment->angular_velocity, shv_apply(&inertia, fragment->angular_velocity));
}

static double energy(const World *world, const double gravity[3])
{
    double sum = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        sum += kinetic(fragment) - fragment->mass * shv_dot(shv_load3(gravity), fragment->position);
    }
    for (int32_t o = 0; o < world->obstacles.count; o++) sum += shv_obstacle_kinetic(&world->obstacles.items[o]);
    return sum - world->backend->contact_work - world->backend->friction_work;
}

/* What does not close is the weight of a body that has come to rest. */
static bool never(void *data, const ShvRigidContact *contact)
{
    (void)data;
    assert_true(contact->closing_speed > 0.0 || (contact->obstacle < 0 && contact->load > 0.0));
    return false;
}

static bool always(void *data, const ShvRigidContact *contact)
{
    (void)data;
    return contact->closing_speed > 0.0;
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
        world_fly(&world);
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

/* A single tet, far from regular, spins: L and energy are kept, and the state's own L agrees. */
static void test_single_tet_spins_freely(void **unused)
{
    (void)unused;
    static const double points[] = {0, 0, 0, 0.3, 0, 0, 0, 0.1, 0, 0.05, 0, 0.02};
    static const int32_t tet[] = {0, 1, 2, 3};
    World world;
    world_begin(&world);
    world_tets(&world, points, 4, tet, 1);
    ShvFragment *fragment = &world.fragments.items[0];
    fragment->angular_velocity = shv_vec3(20.0, -7.0, 33.0);
    shv_fragment_scatter(fragment, &world.fragments, &world.state);
    world_fly(&world);
    ShvVec3 p0, l0, p1, l1;
    double k0, k1;
    shv_fragment_momentum(fragment, &world.fragments, &world.state, &p0, &l0, &k0);
    for (int i = 0; i < 10000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    shv_fragment_scatter(fragment, &world.fragments, &world.state);
    shv_fragment_momentum(fragment, &world.fragments, &world.state, &p1, &l1, &k1);
    check_near(shv_norm(shv_sub(l1, l0)), 0.0, 1e-12 * shv_norm(l0));
    check_near(k1, k0, 1e-12 * k0);
    world_end(&world);
}

/* The record may be changed between steps, as events of the time line do. */
static void test_new_velocity_in_the_record_counts(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 10.0);
    world_build(&world);
    world_fly(&world);
    ShvFragment *fragment = &world.fragments.items[0];
    world_advance(&world, 0.0, 0.1, no_gravity, NULL, NULL, NULL);
    fragment->velocity = shv_vec3(0.0, 1.0, 0.0);
    fragment->angular_velocity = shv_vec3(0.0, 0.0, 2.0);
    world_advance(&world, 0.1, 0.1, no_gravity, NULL, NULL, NULL);
    check_near(fragment->position.y, 0.1, 1e-14);
    check_near(fragment->orientation.z, shv_quat_exponential(shv_vec3(0.0, 0.0, 0.2)).z, 1e-13);
    world_end(&world);
}

/* ---- impacts ---- */

/* Dropped from 1 m on a floor of restitution 0.8: it meets the floor at 0.45152, 1.17396, 1.75191 and 2.21427 s. */
static void bounce(double step)
{
    static const double moments[4] = {0.4515236, 1.1739614, 1.7519117, 2.2142719};
    World world;
    box_world(&world, 1.0);
    world_floor(&world, 0.3, 0.8);
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    const double start = energy(&world, earth);
    int found = 0;
    for (int i = 0; i < (int)(2.3 / step); i++) {
        const ShvVec3 position = fragment->position, velocity = fragment->velocity;
        world_advance(&world, i * step, step, earth, never, NULL, NULL);
        check_near(energy(&world, earth), start, 1e-10 * start);
        assert_true(fragment->position.z > 0.05 - 1e-6 * fragment->radius);
        if (fragment->velocity.z <= velocity.z) continue;
        assert_true(found < 4);
        /* the parabola before meets the floor */
        const double drop = position.z - 0.05, v = velocity.z;
        const double meets = i * step + (v + sqrt(v * v + 2.0 * 9.81 * drop)) / 9.81;
        check_near(meets, moments[found], 1e-5 * moments[found]);
        found++;
    }
    assert_int_equal(found, 4);
    check_near(shv_norm(fragment->angular_velocity), 0.0, 1e-6);
    world_end(&world);
}

static void test_bounces_do_not_depend_on_the_step(void **unused)
{
    (void)unused;
    bounce(1e-2);
    bounce(1e-3);
    bounce(1e-4);
}

/* Later it rests: on the floor, without motion, for a million steps. */
static void test_comes_to_rest_and_stays(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.1);
    world_floor(&world, 0.3, 0.5);
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    const double start = energy(&world, earth);
    for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
    const ShvVec3 position = fragment->position;
    check_near(position.z, 0.05, 1e-6 * fragment->radius);
    check_near(energy(&world, earth), start, 1e-9 * start);
    for (int i = 0; i < 1000000; i++) world_advance(&world, 2.0 + i * 1e-3, 1e-3, earth, never, NULL, NULL);
    assert_memory_equal(&fragment->position, &position, sizeof position);
    assert_true(kinetic(fragment) == 0.0);
    world_end(&world);
}

/* Without ever being put to rest (steps too few in a row) it does not creep either. */
static void test_rest_without_sleep(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    world_floor(&world, 0.0, 0.5);
    world_build(&world);
    world_fly(&world);
    ShvFragment *fragment = &world.fragments.items[0];
    double gravity[3] = {0.0, 0.0, -9.81};
    for (int i = 0; i < 5000; i++) {
        gravity[2] = i % 2 ? -9.81 : -9.80; /* a change of gravity ends any rest */
        world_advance(&world, i * 1e-3, 1e-3, gravity, never, NULL, NULL);
    }
    check_near(fragment->position.z, 0.05, 1e-6 * fragment->radius);
    check_near(hypot(fragment->position.x, fragment->position.y), 0.0, 1e-9);
    check_near(kinetic(fragment), 0.0, 1e-20);
    world_end(&world);
}

/* Gravity turned instead of the floor: slides with g (sin − µ cos), or sticks. */
static void test_incline(void **unused)
{
    (void)unused;
    const double slope = 0.5235987755982988, steps[] = {1e-2, 1e-3};
    const double gravity[3] = {9.81 * sin(slope), 0.0, -9.81 * cos(slope)};
    for (int s = 0; s < 2; s++)
        for (int sticks = 0; sticks < 2; sticks++) {
            World world;
            box_world(&world, 0.0);
            world_floor(&world, sticks ? 0.6 : 0.3, 0.0);
            world_build(&world);
            world_fly(&world);
            const ShvFragment *fragment = &world.fragments.items[0];
            const double start = energy(&world, gravity);
            const int count = (int)(1.0 / steps[s]);
            for (int i = 0; i < count; i++) world_advance(&world, i * steps[s], steps[s], gravity, never, NULL, NULL);
            const double a = sticks ? 0.0 : 9.81 * (sin(slope) - 0.3 * cos(slope));
            check_near(fragment->velocity.x, a, 1e-6);
            check_near(fragment->position.x, 0.5 * a, 1e-6);
            check_near(fragment->position.z, 0.05, 1e-6 * fragment->radius);
            check_near(energy(&world, gravity), start, 1e-6 * 0.5 * fragment->mass * 2.4 * 2.4);
            if (!sticks)
                assert_true(world.backend->friction_work < -0.9 * fragment->mass * 0.3 * 9.81 * cos(slope) * 0.5 * a);
            check_near(world.backend->contact_work, 0.0, 1e-6);
            world_end(&world);
        }
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
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
    /* 4/(2 · 0.4 · 9.81), but for the last step in which it stops */
    check_near(fragment->position.y, 0.509684, 1e-5);
    assert_true(kinetic(fragment) == 0.0);
    world_end(&world);
}

/* A plank that glides over the edges of a smooth block, its middle over it: nodes and edges of its flat face that come over the block,
   or leave it, have nothing to do with the block's sides. Nothing slows or turns it. */
static void test_glides_over_edges(void **unused)
{
    (void)unused;
    uint64_t index = 0;
    for (int k = 0; k < 12; k++) {
        World world;
        world_begin(&world);
        ShvObjectDefinition *plank = world_box(&world, 0.3, 0.06, 0.03, 0.012);
        ShvObstacleDefinition *block = world_obstacle(&world, SHV_OBSTACLE_BOX);
        const double heights[] = {0.0, 1e-8, 1e-9}, angle = draw(&index, 0.0, 6.28), speed = draw(&index, 0.1, 1.0);
        plank->placement.position[0] = draw(&index, -0.02, 0.02);
        plank->placement.position[1] = draw(&index, -0.02, 0.02);
        plank->placement.position[2] = 0.015 + heights[k % 3];
        plank->placement.velocity[0] = speed * cos(angle);
        plank->placement.velocity[1] = speed * sin(angle);
        block->size[0] = block->size[1] = 0.16;
        block->size[2] = 0.02;
        block->placement.position[2] = -0.01;
        block->placement.rotation_degrees = k % 2 ? draw(&index, 0.0, 90.0) : 0.0; /* about z */
        world_build(&world);
        world_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        for (int i = 0; i < 30; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        check_near(fragment->velocity.x, speed * cos(angle), 1e-9);
        check_near(fragment->velocity.y, speed * sin(angle), 1e-9);
        check_near(shv_norm(fragment->angular_velocity), 0.0, 1e-9);
        world_end(&world);
    }
}

/* Splinters that skid over a smooth floor while they spin meet it hundreds of times in a step; nothing slows them on their way. */
static void test_a_step_with_many_impacts_is_a_whole_step(void **unused)
{
    (void)unused;
    static const int32_t tet[] = {0, 1, 2, 3};
    uint64_t index = 0;
    for (int splinter = 0; splinter < 40; splinter++) {
        const ShvVec3 a = draw3(&index, 0.02), b = draw3(&index, 0.02), c = draw3(&index, 0.02);
        const double side = shv_dot(a, shv_cross(b, c)) > 0.0 ? 1.0 : -1.0;
        const double points[] = {0.0, 0.0, 0.06,       a.x,        a.y,        0.06 + a.z,
                                 b.x, b.y, 0.06 + b.z, side * c.x, side * c.y, 0.06 + side * c.z};
        World world;
        world_begin(&world);
        world_floor(&world, 0.0, 0.0);
        world_tets(&world, points, 4, tet, 1);
        ShvFragment *fragment = &world.fragments.items[0];
        fragment->velocity = shv_vec3(36.0, 0.0, -33.0);
        fragment->angular_velocity = draw3(&index, 800.0);
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        world_fly(&world);
        const double start = fragment->position.x, step = 2e-3;
        for (int i = 0; i < 20; i++) {
            world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
            check_near(fragment->position.x - start, 36.0 * (i + 1) * step, 1e-9);
        }
        world_end(&world);
    }
}

/* ---- wakes ---- */

static void test_wake_stops_at_the_impact(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 1.0);
    world_floor(&world, 0.3, 0.8);
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    ShvRigidContact wake;
    assert_int_equal(world_advance(&world, 5.0, 1.0, earth, always, NULL, &wake), 1);
    const double fall = sqrt(2.0 / 9.81);
    check_near(wake.time, 5.0 + fall, 1e-6);
    check_near(wake.closing_speed, 9.81 * fall, 1e-5);
    check_near(fragment->velocity.z, -9.81 * fall, 1e-5);
    check_near(fragment->position.z, 0.05, 1e-6 * fragment->radius);
    check_near(wake.normal.z, 1.0, 0.0);
    assert_true(wake.fresh && wake.obstacle == 0 && wake.fragment == 0);
    assert_true(world.backend->contact_work == 0.0);
    /* it has left: nothing moves it any more */
    const ShvVec3 position = fragment->position;
    assert_int_equal(world_advance(&world, 6.0, 1.0, earth, always, NULL, &wake), 0);
    assert_memory_equal(&position, &fragment->position, sizeof position);
    /* it may come back, and what it touches then is not fresh */
    ShvError error = {0};
    world.fragments.items[0].velocity.z = -0.5;
    check_ok(world.backend->functions->add(world.backend, 0, &error), error);
    assert_int_equal(world_advance(&world, 7.0, 1e-3, earth, always, NULL, &wake), 1);
    assert_false(wake.fresh);
    world.backend->functions->remove(world.backend, 0);
    world_end(&world);
}

static bool wakes_first(void *data, const ShvRigidContact *contact)
{
    int *judged = data;
    judged[contact->fragment]++;
    assert_true(contact->fresh);
    return contact->fragment == 0;
}

/* One of two wakes; the other bounces on as if alone, and meets the floor afresh at every bounce. */
static void test_only_the_accepted_fragment_wakes(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.5);
    ShvObjectDefinition *second = world_box(&world, 0.1, 0.1, 0.1, 0.05);
    second->placement.position[0] = 0.12;
    second->placement.position[2] = 1.05;
    world_floor(&world, 0.3, 0.8);
    world_build(&world);
    world_fly(&world);
    ShvRigidContact wakes[2];
    int judged[2] = {0, 0}, woken = 0;
    for (int i = 0; i < 130; i++) woken += world_advance(&world, i * 0.01, 0.01, earth, wakes_first, judged, wakes);
    assert_int_equal(woken, 1);
    assert_int_equal(wakes[0].fragment, 0);
    assert_int_equal(judged[0], 1);
    assert_int_equal(judged[1], 2); /* at 0.45 and 1.17 s */
    check_near(wakes[0].time, sqrt(1.0 / 9.81), 1e-6);
    /* third arc: from the floor at 1.1739614 s with 0.64 of the first speed */
    const double since = 1.3 - 1.1739614, up = 0.64 * sqrt(2.0 * 9.81);
    check_near(world.fragments.items[1].position.z, 0.05 + up * since - 0.5 * 9.81 * since * since, 1e-5);
    world_end(&world);
}

/* 1 km/s against a box of 1 mm, 1 ms steps: caught at its face, spinning or not. */
static void test_fast_fragment_meets_a_thin_obstacle(void **unused)
{
    (void)unused;
    for (int spinning = 0; spinning < 2; spinning++) {
        World world;
        box_world(&world, 0.5);
        world.objects[0].placement.velocity[2] = -1000.0;
        if (spinning) world.objects[0].placement.angular_velocity[0] = 300.0;
        ShvObstacleDefinition *plate = world_obstacle(&world, SHV_OBSTACLE_BOX);
        plate->size[0] = plate->size[1] = 0.3;
        plate->size[2] = 1e-3;
        world_build(&world);
        world_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        ShvRigidContact wake;
        assert_int_equal(world_advance(&world, 0.0, 1e-3, no_gravity, always, NULL, &wake), 1);
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        double lowest = 1.0;
        for (int32_t n = 0; n < world.state.node_count; n++)
            lowest = fmin(lowest, shv_state_position(&world.state, n).z);
        check_near(lowest, 5e-4, 1e-6 * fragment->radius);
        if (!spinning) check_near(wake.time, (0.5 - 5e-4) / 1000.0, 1e-9);
        world_end(&world);
    }
}

/* An obstacle that comes to the fragment, and one that turns into it. */
static void test_moving_obstacles(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    ShvObstacleDefinition *ram = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
    ram->radius = 0.1;
    world_build(&world);
    world_fly(&world);
    ShvObstacle *obstacle = &world.obstacles.items[0];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    obstacle->position = shv_vec3(-1.0, 0.0, 0.05);
    obstacle->velocity = shv_vec3(100.0, 0.0, 0.0);
    ShvRigidContact wake;
    assert_int_equal(world_advance(&world, 0.0, 0.1, no_gravity, always, NULL, &wake), 1);
    check_near(wake.time, 0.0085, 1e-9); /* a node stands at the face's middle */
    check_near(wake.closing_speed, 100.0, 1e-9);
    check_near(wake.normal.x, 1.0, 1e-12);
    world_end(&world);

    box_world(&world, 0.0);
    ShvObstacleDefinition *blade = world_obstacle(&world, SHV_OBSTACLE_BOX);
    blade->size[0] = 2.0;
    blade->size[1] = 0.01;
    blade->size[2] = 0.2;
    world_build(&world);
    world_fly(&world);
    obstacle = &world.obstacles.items[0];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    obstacle->position = shv_vec3(-0.8, 0.0, 0.05);
    obstacle->orientation = shv_quat_exponential(shv_vec3(0.0, 0.0, -1.0));
    obstacle->angular_velocity = shv_vec3(0.0, 0.0, 10.0);
    assert_int_equal(world_advance(&world, 0.0, 0.2, no_gravity, always, NULL, &wake), 1);
    /* The blade's upper face first meets the lower edge at x = 0.05 or −0.05: the gap of each corner is its distance to
       the face's plane, −sin(a) dx + cos(a) dy − 0.005 from the hub, and crosses zero at wake.time. */
    const double angle = -1.0 + 10.0 * wake.time;
    double gap = 1.0;
    for (int side = -1; side <= 1; side++)
        gap = fmin(gap, -(cos(angle) * 0.05 + sin(angle) * (0.8 + 0.05 * side)) - 0.005);
    check_near(gap, 0.0, 2e-6 * world.fragments.items[0].radius);
    world_end(&world);
}

/* A closed triangle surface: caught at 1 km/s through a plate of 1 mm, and a plate to rest on. */
static void test_mesh_obstacle(void **unused)
{
    (void)unused;
    char path[512];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/shiver_plate_%ld.obj", folder ? folder : "/tmp", (long)getpid());
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int n = 0; n < 8; n++)
        fprintf(file, "v %s %s %s\n", n & 1 ? "0.3" : "-0.3", n & 2 ? "0.3" : "-0.3", n & 4 ? "0.0005" : "-0.0005");
    fprintf(file, "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    fclose(file);
    for (int fast = 0; fast < 2; fast++) {
        World world;
        box_world(&world, fast ? 0.5 : 0.02);
        world.objects[0].placement.velocity[0] = 0.1;
        if (fast) world.objects[0].placement.velocity[2] = -1000.0;
        ShvObstacleDefinition *plate = world_obstacle(&world, SHV_OBSTACLE_MESH);
        plate->file = path;
        plate->friction = 0.3;
        plate->restitution = 0.2;
        world_build(&world);
        world_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        ShvRigidContact wake;
        if (fast) assert_int_equal(world_advance(&world, 0.0, 1e-3, no_gravity, always, NULL, &wake), 1);
        for (int i = 0; i < 500 && !fast; i++) world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
        check_near(fragment->position.z, 0.0505, 1e-6 * fragment->radius);
        if (!fast) assert_true(kinetic(fragment) == 0.0);
        world_end(&world);
    }
    remove(path);
}

/* ---- free obstacles ---- */

/* Flat central impact of equal restitution: velocities by the textbook, momentum and energy to round-off. */
static void test_free_obstacle_exchanges_momentum(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    world.objects[0].placement.position[2] = 0.0;
    world.objects[0].placement.velocity[0] = 3.0;
    ShvObstacleDefinition *anvil = world_obstacle(&world, SHV_OBSTACLE_BOX);
    anvil->size[0] = anvil->size[1] = anvil->size[2] = 0.2;
    anvil->motion = SHV_OBSTACLE_FREE;
    anvil->mass = 5.0;
    anvil->restitution = 0.6;
    anvil->friction = 0.5;
    anvil->placement.position[0] = 0.3;
    anvil->placement.velocity[0] = -1.0;
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    const ShvObstacle *other = &world.obstacles.items[0];
    const double m = fragment->mass, start = energy(&world, no_gravity);
    for (int i = 0; i < 10; i++) {
        world_advance(&world, i * 0.01, 0.01, no_gravity, never, NULL, NULL);
        shv_obstacles_advance(&world.obstacles, 0.01, no_gravity);
    }
    const double common = (3.0 * m - 5.0) / (m + 5.0), relative = 4.0;
    check_near(fragment->velocity.x, common - 0.6 * relative * 5.0 / (m + 5.0), 1e-9);
    check_near(other->velocity.x, common + 0.6 * relative * m / (m + 5.0), 1e-9);
    check_near(energy(&world, no_gravity), start, 1e-12 * start);
    /* the gap of 0.15 closes after 0.0375 s; from there on both go with their new velocities */
    check_near(fragment->position.x, 3.0 * 0.0375 + fragment->velocity.x * 0.0625, 1e-6);
    check_near(other->position.x, 0.3 - 0.0375 + other->velocity.x * 0.0625, 1e-6);
    world_end(&world);
}

/* Random oblique impacts of a spinning fragment and a free sphere: P and L of the pair kept, energy accounted for. */
static void test_oblique_impacts_keep_momentum(void **unused)
{
    (void)unused;
    uint64_t index = 3000;
    int met = 0;
    for (int trial = 0; trial < 30; trial++) {
        World world;
        box_world(&world, 0.0);
        world.objects[0].placement.position[2] = 0.0;
        ShvObstacleDefinition *stone = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
        stone->radius = 0.2;
        stone->motion = SHV_OBSTACLE_FREE;
        stone->mass = draw(&index, 0.5, 20.0);
        stone->restitution = draw(&index, 0.0, 1.0);
        stone->friction = draw(&index, 0.0, 1.0);
        stone->placement.position[0] = 0.6;
        world_build(&world);
        world_fly(&world);
        ShvFragment *fragment = &world.fragments.items[0];
        ShvObstacle *other = &world.obstacles.items[0];
        fragment->velocity = shv_add(shv_vec3(10.0, 0.0, 0.0), draw3(&index, 1.0));
        fragment->angular_velocity = draw3(&index, 20.0);
        other->angular_velocity = draw3(&index, 20.0);
        const double start = energy(&world, no_gravity);
        ShvMat3 inertia = shv_fragment_world_inertia(fragment);
        const ShvVec3 p0 = shv_scale(fragment->velocity, fragment->mass);
        const ShvVec3 l0 =
            shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_obstacle_angular_momentum(other));
        for (int i = 0; i < 10; i++) {
            world_advance(&world, i * 0.01, 0.01, no_gravity, never, NULL, NULL);
            shv_obstacles_advance(&world.obstacles, 0.01, no_gravity);
        }
        inertia = shv_fragment_world_inertia(fragment);
        const ShvVec3 own = shv_scale(fragment->velocity, fragment->mass);
        const ShvVec3 p1 = shv_madd(own, other->mass, other->velocity);
        const ShvVec3 l1 =
            shv_add(shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_cross(fragment->position, own)),
                    shv_obstacle_angular_momentum(other));
        check_near(shv_norm(shv_sub(p1, p0)), 0.0, 1e-12 * shv_norm(p0));
        /* impulses act at nodes within 1e-6 of the radius of the surface, on both at the same point: L is exact */
        check_near(shv_norm(shv_sub(l1, l0)), 0.0, 1e-11 * shv_norm(p0));
        check_near(energy(&world, no_gravity), start, 1e-11 * start);
        assert_true(world.backend->contact_work + world.backend->friction_work <= 0.0);
        met += world.backend->contact_work < 0.0;
        world_end(&world);
    }
    assert_true(met >= 25);
}

/* A fragment at rest is hit: it notices, and what it stood on keeps holding it. */
static void test_resting_fragment_is_hit(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    world_floor(&world, 0.0, 0.5);
    ShvObstacleDefinition *stone = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
    stone->radius = 0.05;
    stone->motion = SHV_OBSTACLE_FREE;
    stone->mass = 1.0;
    stone->restitution = 1.0;
    stone->placement.position[0] = -1.0;
    stone->placement.position[2] = 0.05;
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    ShvObstacle *other = &world.obstacles.items[1];
    for (int i = 0; i < 50; i++) world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
    assert_true(kinetic(fragment) == 0.0);
    other->velocity = shv_vec3(5.0, 0.0, 0.0);
    for (int i = 50; i < 350; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
        shv_obstacles_advance(&world.obstacles, 1e-3, no_gravity);
    }
    /* elastic, central, frictionless; the stone's centre and the struck node at the height of the box's own centre */
    const double m = fragment->mass;
    check_near(fragment->velocity.x, 2.0 * 5.0 / (1.0 + m), 1e-6);
    check_near(other->velocity.x, 5.0 * (1.0 - m) / (1.0 + m), 1e-6);
    check_near(fragment->position.z, 0.05, 1e-6 * fragment->radius);
    world_end(&world);
}

/* ---- hard cases ---- */

/* A wedge of two walls and a floor, friction and bounces: finite, never through, energy never grows. */
static void test_tumbling_in_a_corner(void **unused)
{
    (void)unused;
    uint64_t index = 5000;
    for (int trial = 0; trial < 10; trial++) {
        World world;
        box_world(&world, 0.5);
        world.objects[0].mesh.size[0] = 0.2;
        world_floor(&world, 0.4, 0.6);
        for (int w = 0; w < 2; w++) {
            ShvObstacleDefinition *wall = world_obstacle(&world, SHV_OBSTACLE_PLANE);
            const double tilt = w ? -0.8 : 0.8;
            wall->plane_normal[0] = tilt;
            wall->plane_normal[1] = 0.0;
            wall->plane_normal[2] = 0.6;
            wall->plane_offset = -0.1;
            wall->friction = 0.2;
            wall->restitution = 0.3;
        }
        world_build(&world);
        world_fly(&world);
        ShvFragment *fragment = &world.fragments.items[0];
        fragment->orientation = draw_rotation(&index);
        fragment->angular_velocity = draw3(&index, 20.0);
        /* on supports the body turns with the mean spin of the step, which is right to second order in the angle per step,
           here at most some 20 rad/s × 1 ms */
        const double tolerance = 4e-4;
        double last = kinetic(fragment) + 9.81 * fragment->mass * fragment->position.z;
        const double start = energy(&world, earth), scale = last;
        for (int i = 0; i < 3000; i++) {
            world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
            const double now = kinetic(fragment) + 9.81 * fragment->mass * fragment->position.z;
            assert_true(isfinite(now));
            assert_true(now <= last + tolerance * scale);
            last = now;
        }
        check_near(energy(&world, earth), start, tolerance * scale);
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        for (int32_t n = 0; n < world.state.node_count; n++)
            for (int32_t o = 0; o < 3; o++)
                assert_true(
                    shv_obstacle_closest(&world.obstacles.items[o], shv_state_position(&world.state, n), 1.0).gap >
                    -1e-5 * fragment->radius);
        world_end(&world);
    }
}

/* Opposite planes that overlap the fragment: bounded and finite. */
static void test_squeezed(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, -0.02);
    world_floor(&world, 0.3, 0.5);
    ShvObstacleDefinition *lid = world_obstacle(&world, SHV_OBSTACLE_PLANE);
    lid->plane_normal[0] = lid->plane_normal[1] = 0.0;
    lid->plane_normal[2] = -1.0;
    lid->plane_offset = -0.07;
    world_build(&world);
    world_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    for (int i = 0; i < 500; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
        assert_true(shv_finite3(fragment->position) && fabs(fragment->position.z) < 0.2);
        assert_true(shv_norm(fragment->velocity) < 1.0);
    }
    world_end(&world);
}

static void test_hopeless_motion_is_refused(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 1.0);
    world_build(&world);
    world_fly(&world);
    ShvFragment *fragment = &world.fragments.items[0];
    ShvError error = {0};
    int32_t count = 0;
    ShvRigidContact wakes[1];
    fragment->angular_velocity = shv_vec3(1e9, 0.0, 0.0);
    check_fails(world.backend->functions->advance(world.backend, 0.0, 1e-3, earth, NULL, NULL, wakes, &count, &error),
                SHV_DIVERGED, error, "rigid.time_step");
    fragment->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
    fragment->velocity.x = (double)NAN;
    check_fails(world.backend->functions->advance(world.backend, 0.0, 1e-3, earth, NULL, NULL, wakes, &count, &error),
                SHV_DIVERGED, error, "not finite");
    assert_int_equal(count, 0);
    world_end(&world);
}

/* ---- several fragments, repeats, memory ---- */

static void run_pair(ShvVec3 positions[2], ShvQuat orientations[2])
{
    World world;
    box_world(&world, 0.3);
    ShvObjectDefinition *second = world_box(&world, 0.15, 0.1, 0.05, 0.05);
    second->placement.position[0] = 1.0;
    second->placement.position[2] = 0.6;
    second->placement.rotation_axis[1] = 1.0;
    second->placement.rotation_degrees = 33.0;
    second->placement.angular_velocity[0] = 5.0;
    world_floor(&world, 0.5, 0.4);
    world_build(&world);
    world_fly(&world);
    for (int i = 0; i < 1500; i++) world_advance(&world, i * 1e-3, 1e-3, earth, never, NULL, NULL);
    for (int f = 0; f < 2; f++) {
        positions[f] = world.fragments.items[f].position;
        orientations[f] = world.fragments.items[f].orientation;
    }
    world_end(&world);
}

static void test_same_run_same_bits(void **unused)
{
    (void)unused;
    ShvVec3 p[2], p2[2];
    ShvQuat q[2], q2[2];
    run_pair(p, q);
    run_pair(p2, q2);
    assert_memory_equal(p, p2, sizeof p);
    assert_memory_equal(q, q2, sizeof q);
}

static void test_memory_runs_out(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.3);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[0] = 1.0;
    world_floor(&world, 0.5, 0.4);
    world_build(&world);
    const ShvRigidWorld rigid = {&world.model, &world.state, &world.fragments, &world.obstacles, &world.scene.rigid};
    bool done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        assert_true(allowed < 50);
        ShvError error = {0};
        ShvRigidBackend *backend = NULL;
        shv_memory_fail_after(world.memory, allowed);
        ShvStatus status = shv_analytic_create(&backend, &rigid, &error);
        if (status != SHV_OK) assert_null(backend);
        for (int32_t f = 1; f >= 0 && status == SHV_OK; f--) status = backend->functions->add(backend, f, &error);
        done = status == SHV_OK;
        if (!done) assert_int_equal(status, SHV_NO_MEMORY);
        shv_memory_fail_after(world.memory, -1);
        if (backend) backend->functions->destroy(backend);
    }
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ballistic_motion),
        cmocka_unit_test(test_single_tet_spins_freely),
        cmocka_unit_test(test_new_velocity_in_the_record_counts),
        cmocka_unit_test(test_bounces_do_not_depend_on_the_step),
        cmocka_unit_test(test_comes_to_rest_and_stays),
        cmocka_unit_test(test_rest_without_sleep),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_slides_to_a_stop),
        cmocka_unit_test(test_glides_over_edges),
        cmocka_unit_test(test_a_step_with_many_impacts_is_a_whole_step),
        cmocka_unit_test(test_wake_stops_at_the_impact),
        cmocka_unit_test(test_only_the_accepted_fragment_wakes),
        cmocka_unit_test(test_fast_fragment_meets_a_thin_obstacle),
        cmocka_unit_test(test_moving_obstacles),
        cmocka_unit_test(test_mesh_obstacle),
        cmocka_unit_test(test_free_obstacle_exchanges_momentum),
        cmocka_unit_test(test_oblique_impacts_keep_momentum),
        cmocka_unit_test(test_resting_fragment_is_hit),
        cmocka_unit_test(test_tumbling_in_a_corner),
        cmocka_unit_test(test_squeezed),
        cmocka_unit_test(test_hopeless_motion_is_refused),
        cmocka_unit_test(test_same_run_same_bits),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
