/* A ball cut in place: its pieces' hulls overlap at birth. */
#include "check.h"

#include "bullet_world.h"

enum { SEEDS = 20 };

/* A ball of radius 0.1 m about `height`, its tets given to the nearest of random seeds. */
static void cut_ball(World *world, double edge, double height, bool floor)
{
    world_begin(world);
    ShvObjectDefinition *ball = world_box(world, 0.1, 0.1, 0.1, edge);
    ball->mesh.kind = SHV_MESH_BALL;
    ball->mesh.radius = 0.1;
    ball->placement.position[2] = height;
    if (floor) world_floor(world, 0.5, 0.0);
    world_build(world);
    const ShvState *state = &world->state;
    uint64_t index = 77;
    ShvVec3 seeds[SEEDS];
    for (int s = 0; s < SEEDS; s++) seeds[s] = shv_add(draw3(&index, 0.09), shv_vec3(0.0, 0.0, height));
    int32_t *group = calloc((size_t)state->element_count, sizeof *group);
    for (int32_t e = 0; e < state->element_count; e++) {
        ShvVec3 centre = shv_vec3(0.0, 0.0, 0.0);
        for (int a = 0; a < 4; a++)
            centre = shv_madd(centre, 0.25, shv_state_position(state, shv_state_node(state, e, a)));
        for (int s = 1; s < SEEDS; s++)
            if (shv_norm(shv_sub(centre, seeds[s])) < shv_norm(shv_sub(centre, seeds[group[e]]))) group[e] = s;
    }
    world_separate(world, group);
    free(group);
    ShvError error = {0};
    int32_t parts;
    check_ok(shv_fragments_split(&world->fragments, &world->model, &world->state, 0, &parts, &error), error);
    assert_true(parts >= SEEDS / 2);
    bullet_fly(world);
}

static double kinetic(const World *world)
{
    double sum = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++)
        if (world->fragments.items[f].mode != SHV_MODE_DEAD) sum += shv_fragment_kinetic(&world->fragments.items[f]);
    return sum;
}

/* At rest in zero gravity: nothing moves, ever. */
static void test_pieces_stay(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, 0.04, 0.0, false);
    for (int i = 0; i < 200; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    assert_true(kinetic(&world) == 0.0);
    world_end(&world);
}

static void set_radial(World *world, double speed)
{
    for (int32_t f = 0; f < world->fragments.count; f++) {
        ShvFragment *fragment = &world->fragments.items[f];
        fragment->velocity = shv_scale(fragment->position, speed / 0.1);
        fragment->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
    }
}

/* Sent outward they keep their energy; sent back they collide. */
static void test_pieces_part_and_collide(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, 0.04, 0.0, false);
    world.backend->fragment_friction = 0.0;
    set_radial(&world, 0.05);
    const double start = kinetic(&world);
    for (int i = 0; i < 1000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    check_near(kinetic(&world), start, 0.01 * start);
    for (int32_t f = 0; f < world.fragments.count; f++)
        world.fragments.items[f].velocity = shv_scale(world.fragments.items[f].velocity, -1.0);
    for (int i = 0; i < 2000; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
    assert_true(kinetic(&world) < 0.5 * start);
    world_end(&world);
}

/* On a floor under gravity: the heap's energy never grows, and it comes to rest on the floor. */
static void test_heap_gains_nothing(void **unused)
{
    (void)unused;
    World world;
    cut_ball(&world, 0.04, 0.1, true);
    double last = bullet_energy(&world, earth) + world.backend->contact_work + world.backend->friction_work;
    const double start = last, mass = 4.19 * 2.5;
    for (int i = 0; i < 3000; i++) {
        world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
        const double now = bullet_energy(&world, earth) + world.backend->contact_work + world.backend->friction_work;
        assert_true(now <= start + 1e-3 * mass * 9.81 * 0.1);
        last = now;
    }
    assert_true(kinetic(&world) < 1e-4 * mass * 9.81 * 0.1);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pieces_stay),
        cmocka_unit_test(test_pieces_part_and_collide),
        cmocka_unit_test(test_heap_gains_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
