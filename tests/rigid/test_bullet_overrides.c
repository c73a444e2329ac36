/* What each override of Bullet's world is good for: the same small world with it and without. */
#include "check.h"

#include "bullet_world.h"
#include "fragment/free_rotation.h"

static const double step = 1e-3;

static void advance(World *world, int32_t steps, const double gravity[3])
{
    for (int32_t i = 0; i < steps; i++) world_advance(world, i * step, step, gravity, NULL, NULL, NULL);
}

static void begin(World *world)
{
    world_begin(world);
    world->scene.rigid.bullet = (ShvBulletDefinition){true, true, true, true, true, true};
}

static ShvVec3 angular_momentum(const ShvFragment *fragment)
{
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    return shv_free_rotation_momentum(&rotation, fragment->orientation, fragment->angular_velocity);
}

/* Change of the angular momentum of a tumbling box in 0.5 s, of all of it. */
static double momentum_lost(bool exact_flight)
{
    World world;
    begin(&world);
    world.scene.rigid.bullet.exact_flight = exact_flight;
    ShvObjectDefinition *box = world_box(&world, 0.1, 0.2, 0.3, 0.1);
    box->placement.angular_velocity[0] = 3.0;
    box->placement.angular_velocity[1] = 10.0;
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[0];
    const ShvVec3 before = angular_momentum(fragment);
    advance(&world, 500, no_gravity);
    const ShvVec3 change = shv_sub(angular_momentum(fragment), before);
    world_end(&world);
    return shv_norm(change) / shv_norm(before);
}

static void test_exact_flight(void **unused)
{
    (void)unused;
    assert_true(momentum_lost(true) < 1e-12);
    assert_true(momentum_lost(false) > 1e-2);
}

/* Height of a box, above where it lies, some time after it fell 0.1 m with a restitution of 0.8. */
static double height_after_impact(bool times_of_impact)
{
    World world;
    begin(&world);
    world.scene.rigid.bullet.times_of_impact = times_of_impact;
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.15;
    world_floor(&world, 0.0, 0.8);
    world_build(&world);
    bullet_fly(&world);
    advance(&world, 200, earth);
    const double height = world.fragments.items[0].position.z - 0.05;
    world_end(&world);
    return height;
}

static void test_times_of_impact(void **unused)
{
    (void)unused;
    const double touch = sqrt(2.0 * 0.1 / 9.81), left = 0.2 - touch;
    const double height = 0.8 * 9.81 * touch * left - 0.5 * 9.81 * left * left;
    check_near(height_after_impact(true), height, 1e-9);
    assert_true(height_after_impact(false) < 0.9 * height);
}

/* How far the upper of two boxes on a floor is from where it was put after 0.2 s; it is so many times as dense. */
static double stack_moves(const ShvBulletDefinition *overrides, double ratio)
{
    World world;
    begin(&world);
    world.scene.rigid.bullet = *overrides;
    ShvMaterialDefinition materials[2] = {world.material, world.material};
    materials[1].name = "lead";
    materials[1].density *= ratio;
    world.scene.materials = materials;
    world.scene.material_count = 2;
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.05;
    ShvObjectDefinition *upper = world_box(&world, 0.1, 0.1, 0.1, 0.1);
    upper->placement.position[2] = 0.15;
    upper->material = "lead";
    world_floor(&world, 0.5, 0.0);
    world_build(&world);
    bullet_fly(&world);
    const ShvFragment *fragment = &world.fragments.items[1];
    const ShvVec3 before = fragment->position;
    advance(&world, 200, earth);
    const double moved = shv_norm(shv_sub(fragment->position, before));
    world_end(&world);
    return moved;
}

static void test_exact_contacts(void **unused)
{
    (void)unused;
    ShvBulletDefinition overrides = {true, true, true, true, true, true};
    assert_true(stack_moves(&overrides, 1.0) < 1e-7);
    overrides.exact_contacts = false;
    assert_true(stack_moves(&overrides, 1.0) > 1e-4);
}

static void test_settled_impulses(void **unused)
{
    (void)unused;
    ShvBulletDefinition overrides = {true, true, true, true, true, true};
    assert_true(stack_moves(&overrides, 1e6) < 1e-7);
    overrides.settled_impulses = false;
    assert_true(stack_moves(&overrides, 1e6) > 1e-3);
}

/* What boxes are in the tree's past, not the answer: a stack stands with Bullet's own islands, too. */
static void test_touching_islands(void **unused)
{
    (void)unused;
    const ShvBulletDefinition overrides = {true, true, true, true, false, true};
    assert_true(stack_moves(&overrides, 1.0) < 1e-7);
}

/* How far two boxes that overlap by 1 cm part in 0.1 s. */
static double overlap_undone(bool keep_overlaps)
{
    World world;
    begin(&world);
    world.scene.rigid.bullet.keep_overlaps = keep_overlaps;
    world_box(&world, 0.1, 0.1, 0.1, 0.1);
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[0] = 0.09;
    world_build(&world);
    bullet_fly(&world);
    advance(&world, 100, no_gravity);
    const double apart = world.fragments.items[1].position.x - world.fragments.items[0].position.x;
    world_end(&world);
    return apart - 0.09;
}

static void test_keep_overlaps(void **unused)
{
    (void)unused;
    assert_true(fabs(overlap_undone(true)) < 1e-12);
    check_near(overlap_undone(false), 0.01, 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_exact_flight),     cmocka_unit_test(test_times_of_impact),
                                       cmocka_unit_test(test_exact_contacts),   cmocka_unit_test(test_settled_impulses),
                                       cmocka_unit_test(test_touching_islands), cmocka_unit_test(test_keep_overlaps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
