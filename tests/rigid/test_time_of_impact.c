#include "check.h"

#include "rigid/time_of_impact.h"
#include "world.h"

enum { NODES = 20, SAMPLES = 2000 };

static double lowest_gap(const ShvFlight *flight, const ShvArms *arms, const ShvObstacle *obstacle, double time)
{
    const ShvObstacle later = shv_obstacle_later(obstacle, time);
    const ShvQuat q = shv_flight_orientation(flight, time);
    double lowest = 1e30;
    for (int32_t i = 0; i < arms->count; i++) {
        const ShvVec3 arm = shv_rotate(q, shv_load3(arms->offsets + 3 * i));
        lowest = fmin(lowest, shv_obstacle_closest(&later, shv_add(shv_flight_position(flight, time), arm), 1e3).gap);
    }
    return lowest;
}

/* A spiky cloud of nodes, flying and spinning at random, against an obstacle that moves and spins: when a contact pair is
   reported the gap there is closed and was open at all sampled moments before; when none is, it was always open. */
static void check_random_flights(ShvObstacleShape shape, double spin, double obstacle_spin, uint64_t seed)
{
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.1);
    ShvObstacleDefinition *definition = world_obstacle(&world, shape);
    definition->radius = 0.5;
    definition->size[0] = 3.0;
    definition->size[1] = 2.0;
    definition->size[2] = 0.01;
    world_build(&world);
    ShvObstacle *obstacle = &world.obstacles.items[0];
    uint64_t index = seed;
    int met = 0;
    for (int trial = 0; trial < 12; trial++) {
        const ShvMat3 inertia = {{{1.0, 0.1, 0.0}, {0.1, 1.5, 0.2}, {0.0, 0.2, 2.0}}};
        const ShvFreeRotation rotation = shv_free_rotation_make(&inertia);
        double offsets[3 * NODES], radius = 0.0;
        for (int i = 0; i < NODES; i++) {
            shv_store3(offsets + 3 * i, draw3(&index, 0.2));
            radius = fmax(radius, shv_norm(shv_load3(offsets + 3 * i)));
        }
        const ShvArms arms = {.offsets = offsets, .count = NODES, .radius = radius};
        ShvFlight flight = {.position = shv_add(shv_vec3(0.0, 0.0, 1.0), draw3(&index, 0.2)),
                            .velocity = shv_add(shv_vec3(0.0, 0.0, -12.0), draw3(&index, 6.0)),
                            .acceleration = draw3(&index, 10.0),
                            .orientation = draw_rotation(&index),
                            .rotation = &rotation};
        flight.angular_momentum = shv_free_rotation_momentum(&rotation, flight.orientation, draw3(&index, spin));
        flight.fastest = shv_free_rotation_fastest(&rotation, flight.orientation, flight.angular_momentum);
        obstacle->position = draw3(&index, 0.1);
        obstacle->orientation = draw_rotation(&index);
        obstacle->velocity = draw3(&index, 3.0);
        obstacle->angular_velocity = draw3(&index, obstacle_spin);
        const double slop = 1e-6 * radius, step = 0.1;
        if (!(lowest_gap(&flight, &arms, obstacle, 0.0) > slop)) continue;
        double time = step;
        const bool found = shv_time_of_impact(&flight, &arms, obstacle, slop, &time);
        met += found;
        if (found) {
            const double gap = lowest_gap(&flight, &arms, obstacle, time);
            assert_true(gap <= 0.75 * slop * (1.0 + 1e-6) && gap > 0.0);
        } else {
            assert_true(time == step);
        }
        for (int sample = 0; sample < SAMPLES; sample++)
            assert_true(lowest_gap(&flight, &arms, obstacle, time * sample / SAMPLES) > 0.25 * slop);
    }
    assert_true(met > 3);
    world_end(&world);
}

static void test_sphere(void **unused)
{
    (void)unused;
    check_random_flights(SHV_OBSTACLE_SPHERE, 0.0, 0.0, 100);
    check_random_flights(SHV_OBSTACLE_SPHERE, 50.0, 10.0, 200);
}

static void test_thin_box(void **unused)
{
    (void)unused;
    check_random_flights(SHV_OBSTACLE_BOX, 0.0, 0.0, 300);
    check_random_flights(SHV_OBSTACLE_BOX, 50.0, 0.0, 400);
    check_random_flights(SHV_OBSTACLE_BOX, 20.0, 20.0, 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sphere), cmocka_unit_test(test_thin_box)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
