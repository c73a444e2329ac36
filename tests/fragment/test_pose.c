#include "check.h"

#include "rigid/world.h"

/* Two boxes of different size in the air. */
static void two_boxes(World *world)
{
    world_begin(world);
    ShvObjectDefinition *first = world_box(world, 0.3, 0.2, 0.1, 0.05);
    first->placement.position[0] = 3.0;
    first->mesh.jitter = 0.2;
    world_box(world, 0.1, 0.1, 0.15, 0.05)->placement.position[2] = -2.0;
    world_build(world);
}

/* Σ m|v| and Σ m|r||v|: the scales of momentum and angular momentum. */
static void scales(const World *world, const ShvFragment *fragment, double *momentum, double *angular)
{
    *momentum = *angular = 0.0;
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const int32_t node = world->fragments.nodes[fragment->node_begin + i];
        const double mv = world->state.mass[node] * shv_norm(shv_load3(world->state.velocity + 3 * (int64_t)node));
        *momentum += mv;
        *angular += mv * shv_norm(shv_state_position(&world->state, node));
    }
}

static void check_round_trip(World *world, ShvFragment *fragment, double kinetic_tolerance)
{
    ShvVec3 p0, l0, p1, l1;
    double k0, k1, p_scale, l_scale;
    scales(world, fragment, &p_scale, &l_scale);
    shv_fragment_momentum(fragment, &world->fragments, &world->state, &p0, &l0, &k0);
    shv_fragment_fit(fragment, &world->fragments, &world->state);
    shv_fragment_scatter(fragment, &world->fragments, &world->state);
    shv_fragment_momentum(fragment, &world->fragments, &world->state, &p1, &l1, &k1);
    check_near(shv_norm(shv_sub(p1, p0)), 0.0, 1e-12 * p_scale);
    check_near(shv_norm(shv_sub(l1, l0)), 0.0, 1e-12 * l_scale);
    check_near(k1, k0, kinetic_tolerance * k0);
}

/* Any rigid motion goes into the nodes and comes back. */
static void test_rigid_motion_round_trip(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world);
    uint64_t index = 10;
    for (int trial = 0; trial < 40; trial++)
        for (int32_t f = 0; f < 2; f++) {
            ShvFragment *fragment = &world.fragments.items[f];
            const ShvVec3 position = draw3(&index, 5.0), velocity = draw3(&index, 10.0), spin = draw3(&index, 50.0);
            const ShvQuat orientation = draw_rotation(&index);
            fragment->position = position;
            fragment->velocity = velocity;
            fragment->angular_velocity = spin;
            fragment->orientation = orientation;
            shv_fragment_scatter(fragment, &world.fragments, &world.state);
            check_round_trip(&world, fragment, 1e-13);
            const double size = fragment->radius;
            /* positions near 5 m carry round-off of 1e-15 m */
            check_near(shv_norm(shv_sub(fragment->position, position)), 0.0, 1e-12 * size);
            check_near(shv_norm(shv_sub(fragment->velocity, velocity)), 0.0, 1e-12 * shv_norm(velocity));
            check_near(shv_norm(shv_sub(fragment->angular_velocity, spin)), 0.0, 1e-11 * shv_norm(spin));
            const ShvQuat turn = shv_quat_multiply(shv_quat_conjugate(orientation), fragment->orientation);
            check_near(shv_norm(shv_vec3(turn.x, turn.y, turn.z)), 0.0, 1e-12);
        }
    world_end(&world);
}

static void test_undeformed_fragment_stays_exactly(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world);
    ShvFragment *fragment = &world.fragments.items[0];
    shv_fragment_fit(fragment, &world.fragments, &world.state);
    check_near(shv_norm(shv_sub(fragment->position, fragment->reference_centre)), 0.0, 0.0);
    fragment->orientation = shv_quat_identity();
    shv_fragment_scatter(fragment, &world.fragments, &world.state);
    for (int64_t i = 0; i < 3 * (int64_t)world.state.node_count; i++) assert_true(world.state.displacement[i] == 0.0);
    world_end(&world);
}

/* A deformed, vibrating fragment: the hand-over keeps P and L; the kinetic energy of vibration is lost. */
static void test_vibrating_fragment_keeps_momentum(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world);
    uint64_t index = 400;
    for (int trial = 0; trial < 20; trial++)
        for (int32_t f = 0; f < 2; f++) {
            ShvFragment *fragment = &world.fragments.items[f];
            fragment->position = draw3(&index, 5.0);
            fragment->velocity = draw3(&index, 3.0);
            fragment->angular_velocity = draw3(&index, 30.0);
            fragment->orientation = draw_rotation(&index);
            shv_fragment_scatter(fragment, &world.fragments, &world.state);
            for (int32_t i = 0; i < fragment->node_count; i++) {
                const int64_t k = 3 * (int64_t)world.fragments.nodes[fragment->node_begin + i];
                shv_add_to3(world.state.displacement + k, draw3(&index, 0.003));
                shv_add_to3(world.state.velocity + k, draw3(&index, 1.0));
            }
            check_round_trip(&world, fragment, 1.0);
            check_round_trip(&world, fragment, 1e-12);
        }
    world_end(&world);
}

/* The fitted rotation is the best one: every small turn of it fits worse. */
static void test_rotation_is_the_best(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world);
    uint64_t index = 900;
    ShvFragment *fragment = &world.fragments.items[0];
    fragment->orientation = draw_rotation(&index);
    shv_fragment_scatter(fragment, &world.fragments, &world.state);
    for (int64_t i = 0; i < 3 * (int64_t)world.state.node_count; i++)
        world.state.displacement[i] += draw(&index, -0.02, 0.02);
    shv_fragment_fit(fragment, &world.fragments, &world.state);
    double misfit[7];
    for (int turn = 0; turn < 7; turn++) {
        const double angle = turn % 2 ? 1e-3 : -1e-3;
        const ShvVec3 vector =
            turn == 6 ? shv_vec3(0, 0, 0)
                      : shv_vec3(turn / 2 == 0 ? angle : 0, turn / 2 == 1 ? angle : 0, turn / 2 == 2 ? angle : 0);
        const ShvQuat q = shv_quat_multiply(shv_quat_exponential(vector), fragment->orientation);
        misfit[turn] = 0.0;
        for (int32_t i = 0; i < fragment->node_count; i++) {
            const int32_t node = world.fragments.nodes[fragment->node_begin + i];
            const ShvVec3 arm =
                shv_sub(shv_load3(world.state.reference + 3 * (int64_t)node), fragment->reference_centre);
            const ShvVec3 r =
                shv_sub(shv_state_position(&world.state, node), shv_add(fragment->position, shv_rotate(q, arm)));
            misfit[turn] += world.state.mass[node] * shv_dot(r, r);
        }
    }
    for (int turn = 0; turn < 6; turn++) assert_true(misfit[turn] > misfit[6]);
    world_end(&world);
}

/* Masses only on one line, in one plane, in one node: finite, L kept as far as the arrangement can carry it. */
static void test_degenerate_fragments(void **unused)
{
    (void)unused;
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t tet[] = {0, 1, 2, 3};
    for (int massive = 0; massive <= 4; massive++) {
        World world;
        world_begin(&world);
        world_tets(&world, points, 4, tet, 1);
        ShvFragment *fragment = &world.fragments.items[0];
        for (int n = 0; n < 4; n++) world.state.mass[n] = n < massive ? 1.0 : 0.0;
        fragment->mass = massive;
        shv_fragment_measure(fragment, &world.fragments, &world.model, &world.state);
        fragment->position = shv_vec3(1.0, 2.0, 3.0);
        fragment->velocity = shv_vec3(1.0, 0.0, -1.0);
        fragment->angular_velocity = shv_vec3(0.0, 0.3, 0.4);
        fragment->orientation = shv_quat_identity();
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        fragment->orientation = shv_quat_exponential(shv_vec3(0.2, 0.0, 0.0));
        ShvVec3 p0, l0, p1, l1;
        double k0, k1;
        shv_fragment_momentum(fragment, &world.fragments, &world.state, &p0, &l0, &k0);
        shv_fragment_fit(fragment, &world.fragments, &world.state);
        assert_true(shv_finite3(fragment->position) && shv_finite3(fragment->velocity));
        assert_true(shv_finite3(fragment->angular_velocity) && isfinite(fragment->orientation.w));
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        shv_fragment_momentum(fragment, &world.fragments, &world.state, &p1, &l1, &k1);
        check_near(shv_norm(shv_sub(p1, p0)), 0.0, 1e-14 * (1.0 + massive));
        check_near(shv_norm(shv_sub(l1, l0)), 0.0, 1e-13 * (1.0 + massive));
        /* what nodes on the x axis do not determine stays: the turn about it */
        if (massive <= 2) check_near(fragment->orientation.x, shv_quat_exponential(shv_vec3(0.2, 0.0, 0.0)).x, 1e-14);
        world_end(&world);
    }
}

/* Lumped masses of one tet: five times the inertia of the solid one (Σ m r rᵀ/4 against /20). */
static void test_single_tet_inertia(void **unused)
{
    (void)unused;
    static const double points[] = {0.1, 0.2, 0.3, 1.1, 0.1, 0.2, 0.3, 1.4, 0.1, 0.2, 0.1, 0.9};
    static const int32_t tet[] = {0, 1, 2, 3};
    World world;
    world_begin(&world);
    world_tets(&world, points, 4, tet, 1);
    const ShvFragment *fragment = &world.fragments.items[0];
    ShvVec3 centre = shv_vec3(0, 0, 0);
    for (int n = 0; n < 4; n++) centre = shv_madd(centre, 0.25, shv_load3(points + 3 * n));
    double xx = 0.0;
    for (int n = 0; n < 4; n++) {
        const ShvVec3 r = shv_sub(shv_load3(points + 3 * n), centre);
        xx += fragment->mass * (r.y * r.y + r.z * r.z) / 20.0;
    }
    check_near(fragment->inertia.m[0][0] / xx, 5.0, 1e-13);
    check_near(shv_norm(shv_sub(fragment->reference_centre, centre)), 0.0, 1e-15);
    world_end(&world);
}

/* World inertia and angular velocity give the nodes' own angular momentum. */
static void test_world_inertia(void **unused)
{
    (void)unused;
    World world;
    two_boxes(&world);
    uint64_t index = 77;
    ShvFragment *fragment = &world.fragments.items[1];
    fragment->position = shv_vec3(0.0, 0.0, 0.0);
    fragment->velocity = shv_vec3(0.0, 0.0, 0.0);
    fragment->orientation = draw_rotation(&index);
    fragment->angular_velocity = draw3(&index, 4.0);
    shv_fragment_scatter(fragment, &world.fragments, &world.state);
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 expected = shv_apply(&inertia, fragment->angular_velocity);
    ShvVec3 momentum, angular;
    double kinetic;
    shv_fragment_momentum(fragment, &world.fragments, &world.state, &momentum, &angular, &kinetic);
    check_near(shv_norm(shv_sub(angular, expected)), 0.0, 1e-13 * shv_norm(expected));
    check_near(kinetic, 0.5 * shv_dot(expected, fragment->angular_velocity), 1e-13 * kinetic);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rigid_motion_round_trip),
        cmocka_unit_test(test_undeformed_fragment_stays_exactly),
        cmocka_unit_test(test_vibrating_fragment_keeps_momentum),
        cmocka_unit_test(test_rotation_is_the_best),
        cmocka_unit_test(test_degenerate_fragments),
        cmocka_unit_test(test_single_tet_inertia),
        cmocka_unit_test(test_world_inertia),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
