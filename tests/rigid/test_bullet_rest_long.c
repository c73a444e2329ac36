/* A million steps of rest, under Bullet: nothing creeps. */
#include "check.h"

#include "bullet_world.h"

enum { STEPS = 1000000, SETTLE = 1000 };

static bool note_impact(void *data, const ShvRigidContact *contact)
{
    double *fastest = data;
    *fastest = fmax(*fastest, contact->closing_speed);
    return false;
}

static void build(World *world)
{
    world_begin(world);
    for (int i = 0; i < 2; i++) world_box(world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.05 + 0.1 * i;
    world_floor(world, 0.5, 0.0);
}

/* Two boxes on each other on a slope of 20° (gravity leans). Put to rest they stay, bit by bit. Kept awake by gravity that
   changes by 1e-9 of itself in every step, so that every step is solved, they stay within what a contact counts as a touch. */
static void test_stack_on_a_slope(void **unused)
{
    (void)unused;
    for (int awake = 0; awake < 2; awake++) {
        World world;
        build(&world);
        world_build(&world);
        bullet_fly(&world);
        world.backend->fragment_friction = 0.5;
        const double slope = 20.0 * 3.14159265358979323846 / 180.0;
        ShvVec3 start[2] = {{0}};
        double fastest = 0.0;
        for (int32_t i = 0; i < STEPS + SETTLE; i++) {
            if (i == SETTLE)
                for (int f = 0; f < 2; f++) start[f] = world.fragments.items[f].position;
            if (i == SETTLE) fastest = 0.0;
            const double gravity[3] = {9.81 * sin(slope), awake && i % 2 ? 1e-8 : 0.0, -9.81 * cos(slope)};
            world_advance(&world, i * 1e-3, 1e-3, gravity, note_impact, &fastest, NULL);
        }
        double creep = 0.0;
        for (int f = 0; f < 2; f++) creep = fmax(creep, shv_norm(shv_sub(world.fragments.items[f].position, start[f])));
        print_message("%s: %.2e m in a million steps, contacts close by at most %.1e m/s\n",
                      awake ? "every step solved" : "put to rest", creep, fastest);
        if (awake)
            check_near(creep, 0.0, 1e-5 * 9.81e-3 * 1e-3 * STEPS); /* as below */
        else
            assert_true(creep == 0.0);
        assert_true(fastest < 1e-3 * 9.81); /* of one step's fall: nothing that a wake rule would look at */
        world_end(&world);
    }
}

/* The same on a platform that travels 50 m in 1000 s: they go with it. */
static void test_stack_on_a_platform(void **unused)
{
    (void)unused;
    World world;
    build(&world);
    ShvObstacleDefinition *platform = world_obstacle(&world, SHV_OBSTACLE_BOX);
    platform->size[0] = platform->size[1] = 1.0;
    platform->size[2] = 0.1;
    platform->friction = 0.5;
    platform->placement.position[2] = 0.95;
    world.objects[0].placement.position[2] += 1.0;
    world.objects[1].placement.position[2] += 1.0;
    for (int i = 0; i < 2; i++) world.objects[i].placement.velocity[0] = 0.05;
    world_build(&world);
    ShvObstacle *obstacle = &world.obstacles.items[1];
    obstacle->motion = SHV_OBSTACLE_SCRIPTED;
    obstacle->velocity = shv_vec3(0.05, 0.0, 0.0);
    bullet_fly(&world);
    world.backend->fragment_friction = 0.5;
    double most = 0.0;
    for (int32_t i = 0; i < STEPS; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        obstacle->position = shv_vec3(0.05 * 1e-3 * (i + 1), 0.0, 0.95);
    }
    for (int f = 0; f < 2; f++) {
        const ShvVec3 there = shv_sub(world.fragments.items[f].position, obstacle->position);
        most = fmax(most, shv_norm(shv_sub(there, shv_vec3(0.0, 0.0, 0.1 + 0.1 * f))));
    }
    print_message("on a platform that travels: %.2e m beside their places after a million steps\n", most);
    /* the solver's iterations end at 1e-5 of a step's fall: that speed for 1000 s is what they may be off */
    check_near(most, 0.0, 1e-5 * 9.81e-3 * 1e-3 * STEPS);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stack_on_a_slope),
        cmocka_unit_test(test_stack_on_a_platform),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
