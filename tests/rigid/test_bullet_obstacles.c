/* Obstacles of all shapes and motions, under Bullet. */
#include "check.h"

#include <unistd.h>

#include "bullet_world.h"

static void box_world(World *world, double height)
{
    world_begin(world);
    world_box(world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05 + height;
}

static bool always(void *data, const ShvRigidContact *contact)
{
    (void)data;
    return contact->closing_speed > 1e-6;
}

/* A closed triangle surface: caught at 1 km/s through a plate of 1 mm, and a plate to slide on to rest. */
static void test_mesh_obstacle(void **unused)
{
    (void)unused;
    char path[512];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/shiver_bullet_plate_%ld.obj", folder ? folder : "/tmp", (long)getpid());
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
        bullet_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        ShvRigidContact wake;
        if (fast) assert_int_equal(world_advance(&world, 0.0, 1e-3, no_gravity, always, NULL, &wake), 1);
        for (int i = 0; i < 1000 && !fast; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        check_near(fragment->position.z, 0.0505, 1e-5 * fragment->radius);
        if (!fast) assert_true(shv_fragment_kinetic(fragment) == 0.0);
        world_end(&world);
    }
    remove(path);
}

/* A ram that comes to the fragment, and a blade that turns into it. */
static void test_moving_obstacles(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    ShvObstacleDefinition *ram = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
    ram->radius = 0.1;
    world_build(&world);
    ShvObstacle *obstacle = &world.obstacles.items[0];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    bullet_fly(&world);
    obstacle->position = shv_vec3(-1.0, 0.0, 0.05);
    obstacle->velocity = shv_vec3(100.0, 0.0, 0.0);
    ShvRigidContact wake;
    assert_int_equal(world_advance(&world, 0.0, 0.1, no_gravity, always, NULL, &wake), 1);
    check_near(wake.time, 0.0085, 1e-8);
    check_near(wake.closing_speed, 100.0, 1e-6);
    check_near(wake.normal.x, 1.0, 1e-6);
    world_end(&world);

    box_world(&world, 0.0);
    ShvObstacleDefinition *blade = world_obstacle(&world, SHV_OBSTACLE_BOX);
    blade->size[0] = 2.0;
    blade->size[1] = 0.01;
    blade->size[2] = 0.2;
    world_build(&world);
    obstacle = &world.obstacles.items[0];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    bullet_fly(&world);
    obstacle->position = shv_vec3(-0.8, 0.0, 0.05);
    obstacle->orientation = shv_quat_exponential(shv_vec3(0.0, 0.0, -1.0));
    obstacle->angular_velocity = shv_vec3(0.0, 0.0, 10.0);
    assert_int_equal(world_advance(&world, 0.0, 0.2, no_gravity, always, NULL, &wake), 1);
    /* The blade's upper face first meets the lower edge at x = 0.05 or −0.05: the gap of each corner is its distance to the
       face's plane, −sin(a) dx + cos(a) dy − 0.005 from the hub, and crosses zero at wake.time. */
    const double angle = -1.0 + 10.0 * wake.time;
    double gap = 1.0;
    for (int side = -1; side <= 1; side++)
        gap = fmin(gap, -(cos(angle) * 0.05 + sin(angle) * (0.8 + 0.05 * side)) - 0.005);
    check_near(gap, 0.0, 1e-5 * world.fragments.items[0].radius);
    world_end(&world);
}

/* A box sleeps on a platform; the platform starts to rise and to drive, and takes it along. */
static void test_platform_carries(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    ShvObstacleDefinition *platform = world_obstacle(&world, SHV_OBSTACLE_BOX);
    platform->size[0] = platform->size[1] = 1.0;
    platform->size[2] = 0.1;
    platform->friction = 0.5;
    platform->placement.position[2] = -0.05;
    world_build(&world);
    ShvObstacle *obstacle = &world.obstacles.items[0];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    for (int i = 0; i < 100; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    obstacle->velocity = shv_vec3(0.2, 0.0, 0.3);
    for (int i = 0; i < 500; i++) {
        world_advance(&world, 0.1 + i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        obstacle->position = shv_madd(obstacle->position, 1e-3, obstacle->velocity);
    }
    check_near(fragment->velocity.x, 0.2, 1e-4);
    check_near(fragment->velocity.z, 0.3, 1e-4);
    check_near(fragment->position.z, 0.05 + 0.15, 1e-3);
    /* the jerk upwards rubs as well and gives µ · 0.3 m/s at once; then it slides until friction has brought it to speed */
    check_near(fragment->position.x, 0.1 - 0.05 * 0.05 / (2.0 * 0.5 * 9.81), 1e-5);
    world_end(&world);
}

/* Random oblique impacts of a spinning box and a free sphere: P of the pair, and energy accounted for and never gained. */
static void test_oblique_impacts(void **unused)
{
    (void)unused;
    uint64_t index = 3000;
    int met = 0;
    for (int trial = 0; trial < 30; trial++) {
        World world;
        box_world(&world, 0.0);
        ShvObstacleDefinition *stone = world_obstacle(&world, SHV_OBSTACLE_SPHERE);
        stone->radius = 0.2;
        stone->motion = SHV_OBSTACLE_FREE;
        stone->mass = draw(&index, 0.5, 20.0);
        stone->restitution = draw(&index, 0.0, 1.0);
        stone->friction = 0.0;
        stone->placement.position[0] = 0.6;
        world_build(&world);
        bullet_fly(&world);
        ShvFragment *fragment = &world.fragments.items[0];
        ShvObstacle *other = &world.obstacles.items[0];
        fragment->velocity = shv_add(shv_vec3(10.0, 0.0, 0.0), draw3(&index, 1.0));
        fragment->angular_velocity = draw3(&index, 20.0);
        other->angular_velocity = draw3(&index, 20.0);
        const double start = bullet_energy(&world, no_gravity);
        const ShvVec3 p0 = shv_scale(fragment->velocity, fragment->mass);
        for (int i = 0; i < 100; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        const ShvVec3 p1 = shv_madd(shv_scale(fragment->velocity, fragment->mass), other->mass, other->velocity);
        check_near(shv_norm(shv_sub(p1, p0)), 0.0, 1e-12 * shv_norm(p0));
        check_near(bullet_energy(&world, no_gravity), start, 1e-11 * start);
        assert_true(world.backend->contact_work + world.backend->friction_work <= 1e-12 * start);
        met += world.backend->contact_work < 0.0;
        world_end(&world);
    }
    assert_true(met >= 25);
}

/* Plates that overlap by a hundredth of their size lie on each other as on a table: the contact's direction is not taken from
   the near edge. */
static void test_overhanging_plates(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    ShvObjectDefinition *plate = world_box(&world, 0.3, 0.3, 0.02, 0.04);
    plate->placement.position[0] = 0.12;
    plate->placement.position[2] = 0.01;
    for (int side = 0; side < 2; side++) {
        ShvObstacleDefinition *shelf = world_obstacle(&world, SHV_OBSTACLE_BOX);
        shelf->size[0] = 0.3;
        shelf->size[1] = 0.3;
        shelf->size[2] = 0.02;
        shelf->friction = 0.5;
        shelf->placement.position[0] = side ? 0.12 + 0.297 : 0.12 - 0.297;
        shelf->placement.position[2] = -0.01;
    }
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    for (int i = 0; i < 500; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    check_near(fragment->position.z, 0.01, 1e-5 * fragment->radius);
    check_near(fragment->position.x, 0.12, 1e-5 * fragment->radius);
    assert_true(shv_fragment_kinetic(fragment) == 0.0);
    world_end(&world);
}

/* A million metres from the origin nothing is different. */
static void test_far_from_the_origin(void **unused)
{
    (void)unused;
    ShvVec3 ends[2];
    for (int far = 0; far < 2; far++) {
        World world;
        box_world(&world, 0.1);
        ShvObstacleDefinition *table = world_obstacle(&world, SHV_OBSTACLE_BOX);
        table->size[0] = table->size[1] = 2.0;
        table->size[2] = 0.5;
        table->friction = 0.4;
        table->restitution = 0.5;
        table->placement.position[2] = -0.25;
        table->placement.position[0] = far ? 1048576.0 : 0.0;
        world.objects[0].placement.position[0] = table->placement.position[0];
        world.objects[0].placement.rotation_axis[1] = 1.0;
        world.objects[0].placement.rotation_degrees = 0.0;
        world.objects[0].placement.velocity[0] = 0.5;
        world_build(&world);
        bullet_fly(&world);
        for (int i = 0; i < 600; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        ends[far] = world.fragments.items[0].position;
        ends[far].x -= table->placement.position[0];
        world_end(&world);
    }
    /* positions there are known to 1e-10, which four bounces magnify */
    check_near(shv_norm(shv_sub(ends[0], ends[1])), 0.0, 1e-5);
}

/* Thrown back within a step, further than it came, onto a plate that was behind it: it stays between the two. */
static void test_between_two_plates(void **unused)
{
    (void)unused;
    World world;
    box_world(&world, 0.0);
    world.objects[0].placement.velocity[0] = 500.0;
    for (int i = 0; i < 2; i++) {
        ShvObstacleDefinition *plate = world_obstacle(&world, SHV_OBSTACLE_BOX);
        plate->size[0] = 0.002;
        plate->size[1] = plate->size[2] = 1.0;
        plate->placement.position[0] = i ? 0.251 : -0.081;
        plate->restitution = 1.0;
    }
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    int returns = 0;
    for (int i = 0; i < 50; i++) {
        const double before = fragment->velocity.x;
        world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        assert_true(fragment->position.x > -0.03 - 1e-6 && fragment->position.x < 0.2 + 1e-6);
        returns += fragment->velocity.x * before < 0.0;
    }
    assert_true(returns > 20);
    check_near(fabs(fragment->velocity.x), 500.0, 1e-6);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh_obstacle),      cmocka_unit_test(test_moving_obstacles),
        cmocka_unit_test(test_platform_carries),   cmocka_unit_test(test_oblique_impacts),
        cmocka_unit_test(test_overhanging_plates), cmocka_unit_test(test_far_from_the_origin),
        cmocka_unit_test(test_between_two_plates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
