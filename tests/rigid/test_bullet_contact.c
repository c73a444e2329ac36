/* Bodies that meet, under Bullet: momentum, times of impact, wakes, stacks, scale, and the same bits again. */
#include "check.h"

#include "bullet_world.h"

static bool always(void *data, const ShvRigidContact *contact)
{
    (void)data;
    return contact->closing_speed > 1e-6;
}

/* ---- momentum ---- */

/* P and L about the origin of fragments and free obstacles, and Σ m |v|. */
static void sums(const World *world, ShvVec3 *momentum, ShvVec3 *angular, double *scale)
{
    *momentum = *angular = shv_vec3(0.0, 0.0, 0.0);
    *scale = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
        const ShvVec3 p = shv_scale(fragment->velocity, fragment->mass);
        *momentum = shv_add(*momentum, p);
        *angular = shv_add(*angular,
                           shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_cross(fragment->position, p)));
        *scale += shv_norm(p);
    }
    for (int32_t o = 0; o < world->obstacles.count; o++) {
        const ShvObstacle *obstacle = &world->obstacles.items[o];
        if (obstacle->motion != SHV_OBSTACLE_FREE) continue;
        *momentum = shv_madd(*momentum, obstacle->mass, obstacle->velocity);
        *angular = shv_add(*angular, shv_obstacle_angular_momentum(obstacle));
        *scale += obstacle->mass * shv_norm(obstacle->velocity);
    }
}

/* Two spinning boxes fly into each other in zero gravity, again and again with other orientations. */
static void test_two_fragments_keep_momentum(void **unused)
{
    (void)unused;
    uint64_t index = 100;
    int met = 0;
    for (int trial = 0; trial < 20; trial++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.05);
        world_box(&world, 0.2, 0.1, 0.05, 0.05)->placement.position[0] = 0.5;
        world_build(&world);
        bullet_fly(&world);
        world.backend->fragment_friction = 0.4;
        world.backend->fragment_restitution = trial % 3 * 0.5;
        for (int f = 0; f < 2; f++) {
            ShvFragment *fragment = &world.fragments.items[f];
            fragment->orientation = draw_rotation(&index);
            fragment->angular_velocity = draw3(&index, 10.0);
            fragment->velocity = shv_add(shv_vec3(f ? -2.0 : 3.0, 0.0, 0.0), draw3(&index, 0.2));
        }
        ShvVec3 p0, l0, p1, l1;
        double scale;
        sums(&world, &p0, &l0, &scale);
        const double start = bullet_energy(&world, no_gravity);
        for (int i = 0; i < 300; i++) world_advance(&world, i * 1e-3, 1e-3, no_gravity, NULL, NULL, NULL);
        sums(&world, &p1, &l1, &scale);
        check_near(shv_norm(shv_sub(p1, p0)), 0.0, 1e-10 * scale);
        /* impulses act at one point on both; but where corners turn into the other body within a step, overlaps of some 1e-3 of
           a size are undone, which moves bodies without momentum and changes x × p by as much */

        check_near(shv_norm(shv_sub(l1, l0)), 0.0, 1e-3 * scale * 0.5);
        check_near(bullet_energy(&world, no_gravity), start, 1e-9 * start);
        assert_true(world.backend->contact_work + world.backend->friction_work <= 1e-9 * start);
        met += world.backend->contact_work != 0.0;
        world_end(&world);
    }
    assert_true(met >= 18);
}

/* Head on, frictionless: Newton's restitution between two fragments, and between a fragment and a free obstacle. */
static void test_central_impacts(void **unused)
{
    (void)unused;
    static const double steps[] = {1e-2, 1e-3};
    for (int s = 0; s < 2; s++)
        for (int obstacle = 0; obstacle < 2; obstacle++) {
            World world;
            world_begin(&world);
            world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.velocity[0] = 3.0;
            if (obstacle) {
                ShvObstacleDefinition *anvil = world_obstacle(&world, SHV_OBSTACLE_BOX);
                anvil->size[0] = anvil->size[1] = anvil->size[2] = 0.2;
                anvil->motion = SHV_OBSTACLE_FREE;
                anvil->mass = 5.0;
                anvil->restitution = 0.6;
                anvil->placement.position[0] = 0.3;
                anvil->placement.velocity[0] = -1.0;
            } else {
                ShvObjectDefinition *anvil = world_box(&world, 0.2, 0.2, 0.2, 0.1);
                anvil->placement.position[0] = 0.3;
                anvil->placement.velocity[0] = -1.0;
            }
            world_build(&world);
            bullet_fly(&world);
            world.backend->fragment_friction = 0.0;
            world.backend->fragment_restitution = 0.6;
            const ShvFragment *first = &world.fragments.items[0];
            const int count = (int)(0.1 / steps[s] + 0.5);
            for (int i = 0; i < count; i++) world_advance(&world, i * steps[s], steps[s], no_gravity, NULL, NULL, NULL);
            const double m = first->mass, other = obstacle ? 5.0 : world.fragments.items[1].mass;
            const double common = (3.0 * m - other) / (m + other), relative = 4.0;
            const ShvVec3 velocity = obstacle ? world.obstacles.items[0].velocity : world.fragments.items[1].velocity;
            check_near(first->velocity.x, common - 0.6 * relative * other / (m + other), 1e-6);
            check_near(velocity.x, common + 0.6 * relative * m / (m + other), 1e-6);
            /* the gap of 0.15 closes after 0.0375 s */
            check_near(first->position.x, 3.0 * 0.0375 + first->velocity.x * 0.0625, 1e-6);
            world_end(&world);
        }
}

/* ---- wakes ---- */

static void test_wake_stops_at_the_impact(void **unused)
{
    (void)unused;
    static const double steps[] = {0.1, 1e-2, 1e-3};
    for (int s = 0; s < 3; s++) {
        World world;
        world_begin(&world);
        world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 1.05;
        world_floor(&world, 0.3, 0.8);
        world_build(&world);
        bullet_fly(&world);
        const ShvFragment *fragment = &world.fragments.items[0];
        ShvRigidContact wake;
        int woken = 0, i = 0;
        for (; !woken && i < 1000; i++)
            woken = world_advance(&world, 5.0 + i * steps[s], steps[s], earth, always, NULL, &wake);
        const double fall = sqrt(2.0 / 9.81);
        assert_int_equal(woken, 1);
        check_near(wake.time, 5.0 + fall, 1e-6);
        check_near(wake.closing_speed, 9.81 * fall, 1e-5);
        check_near(fragment->velocity.z, -9.81 * fall, 1e-5);
        check_near(fragment->position.z, 0.05, 2e-6 * fragment->radius);
        check_near(wake.normal.z, 1.0, 1e-12);
        assert_true(wake.fresh && wake.obstacle == 0 && wake.fragment == 0 && wake.other == -1);
        assert_true(isinf(wake.other_mass) && wake.load == 0.0);
        const ShvVec3 position = fragment->position;
        assert_int_equal(world_advance(&world, 10.0, 1e-3, earth, always, NULL, &wake), 0);
        assert_memory_equal(&position, &fragment->position, sizeof position);
        /* it may come back, and what it touches then is not fresh */
        ShvError error = {0};
        world.fragments.items[0].velocity.z = -0.5;
        check_ok(world.backend->functions->add(world.backend, 0, &error), error);
        assert_int_equal(world_advance(&world, 11.0, 1e-3, earth, always, NULL, &wake), 1);
        assert_false(wake.fresh);
        world_end(&world);
    }
}

static bool wakes_second(void *data, const ShvRigidContact *contact)
{
    ShvRigidContact *seen = data;
    seen[contact->fragment] = *contact;
    return contact->fragment == 1;
}

/* Both sides of a contact of two fragments are judged, each for itself; the one that does not wake flies on. */
static void test_two_fragments_are_judged_apart(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.velocity[0] = 4.0;
    world_box(&world, 0.2, 0.1, 0.1, 0.05)->placement.position[0] = 0.25;
    world_build(&world);
    bullet_fly(&world);
    ShvRigidContact seen[2] = {{0}}, wake;
    int woken = 0;
    for (int i = 0; i < 100 && !woken; i++)
        woken = world_advance(&world, i * 1e-2, 1e-2, no_gravity, wakes_second, seen, &wake);
    assert_int_equal(woken, 1);
    assert_true(wake.fragment == 1 && wake.other == 0 && wake.obstacle == -1);
    assert_true(seen[0].other == 1 && seen[0].obstacle == -1);
    check_near(seen[0].normal.x, -1.0, 1e-9);
    check_near(seen[1].normal.x, 1.0, 1e-9);
    check_near(wake.time, 0.1 / 4.0, 1e-7);
    check_near(wake.closing_speed, 4.0, 1e-9);
    check_near(seen[1].other_mass, world.fragments.items[0].mass, 1e-12);
    check_near(seen[0].other_mass, world.fragments.items[1].mass, 1e-12);
    check_near(wake.point.x, 0.15, 1e-6);
    check_near(world.fragments.items[0].velocity.x, 4.0, 0.0);
    check_near(world.fragments.items[0].position.x, 0.1, 1e-6);
    world_end(&world);
}

/* 1 km/s against a box of 1 mm, 1 ms steps: caught at its face, spinning or not; and rebounds. */
static void test_fast_fragment_meets_a_thin_obstacle(void **unused)
{
    (void)unused;
    for (int spinning = 0; spinning < 2; spinning++)
        for (int wakes = 0; wakes < 2; wakes++) {
            World world;
            world_begin(&world);
            world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.55;
            world.objects[0].placement.velocity[2] = -1000.0;
            if (spinning) world.objects[0].placement.angular_velocity[0] = 300.0;
            ShvObstacleDefinition *plate = world_obstacle(&world, SHV_OBSTACLE_BOX);
            plate->size[0] = plate->size[1] = 0.3;
            plate->size[2] = 1e-3;
            plate->restitution = 0.5;
            world_build(&world);
            bullet_fly(&world);
            const ShvFragment *fragment = &world.fragments.items[0];
            ShvRigidContact wake;
            assert_int_equal(world_advance(&world, 0.0, 1e-3, no_gravity, wakes ? always : NULL, NULL, &wake), wakes);
            shv_fragment_scatter(fragment, &world.fragments, &world.state);
            double lowest = 1.0;
            for (int32_t n = 0; n < world.state.node_count; n++)
                lowest = fmin(lowest, shv_state_position(&world.state, n).z);
            if (wakes) check_near(lowest, 5e-4, 1e-5 * fragment->radius);
            if (!spinning && wakes) check_near(wake.time, (0.5 - 5e-4) / 1000.0, 1e-8);
            if (!spinning && !wakes) check_near(fragment->velocity.z, 500.0, 1e-5);
            assert_true(lowest > 5e-4 - 1e-5 * fragment->radius);
            world_end(&world);
        }
}

/* ---- rest ---- */

static void build_stack(World *world, double size, double gap)
{
    world_begin(world);
    for (int i = 0; i < 4; i++) {
        ShvObjectDefinition *box = world_box(world, size, size, size, 0.5 * size);
        box->placement.position[2] = 0.5 * size + i * (size + gap);
    }
    ShvObstacleDefinition *top = world_obstacle(world, SHV_OBSTACLE_BOX);
    top->size[0] = top->size[1] = top->size[2] = size;
    top->motion = SHV_OBSTACLE_FREE;
    top->mass = 2500.0 * size * size * size;
    top->friction = 0.5;
    top->placement.position[2] = 0.5 * size + 4 * (size + gap);
    world_floor(world, 0.5, 0.0);
    world_build(world);
    bullet_fly(world);
}

/* Five boxes on each other come to rest where they are, and stay there. */
static void test_stack_rests(void **unused)
{
    (void)unused;
    static const double steps[] = {1e-2, 1e-3};
    for (int s = 0; s < 2; s++) {
        World world;
        build_stack(&world, 0.1, 0.0);
        for (int i = 0; i < 3000; i++) world_advance(&world, i * steps[s], steps[s], earth, NULL, NULL, NULL);
        for (int f = 0; f < 4; f++) {
            const ShvFragment *fragment = &world.fragments.items[f];
            check_near(fragment->position.z, 0.05 + f * 0.1, 1e-4 * fragment->radius);
            check_near(hypot(fragment->position.x, fragment->position.y), 0.0, 1e-4 * fragment->radius);
            assert_true(shv_fragment_kinetic(fragment) == 0.0);
        }
        assert_true(shv_obstacle_kinetic(&world.obstacles.items[0]) == 0.0);
        world_end(&world);
    }
}

/* The load on each is its own weight and twice what lies on it; what is taken from below lets the rest fall. */
static bool note_load(void *data, const ShvRigidContact *contact)
{
    double *loads = data;
    loads[contact->fragment] = contact->load;
    return false;
}

static void test_loads_of_a_stack(void **unused)
{
    (void)unused;
    World world;
    build_stack(&world, 0.1, 0.0);
    double loads[4] = {0.0};
    for (int i = 0; i < 30; i++) world_advance(&world, i * 1e-3, 1e-3, earth, note_load, loads, NULL);
    const double weight = 2.5 * 9.81;
    for (int f = 0; f < 4; f++) check_near(loads[f], weight * (5 - f + 4 - f), 0.02 * weight);
    for (int i = 0; i < 100; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    world.backend->functions->remove(world.backend, 0);
    for (int i = 0; i < 10; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    check_near(world.fragments.items[1].velocity.z, -0.0981, 1e-6);
    check_near(world.obstacles.items[0].velocity.z, -0.0981, 1e-6);
    world_end(&world);
}

/* ---- scale ---- */

/* A stack with gaps, thrown sideways: position of the third box at the end over the size. Lengths and time² scale. `far`: size of a cube
   far away, 0 without one. */
static ShvVec3 thrown_beside(double size, double far)
{
    World world;
    world_begin(&world);
    for (int i = 0; i < 3; i++) {
        ShvObjectDefinition *box = world_box(&world, size, 0.5 * size, (0.4 + 0.1 * i) * size, 0.4 * size);
        box->placement.position[2] = (0.6 + i) * size;
        box->placement.position[0] = 0.21 * i * size;
        box->placement.rotation_axis[1] = 1.0;
        box->placement.rotation_degrees = 17.0 * i;
    }
    if (far > 0.0) world_box(&world, far, far, far, far)->placement.position[2] = 1000.0 * far;
    world_floor(&world, 0.4, 0.3);
    world_build(&world);
    bullet_fly(&world);
    const double step = 1e-3 * sqrt(size / 0.1);
    for (int i = 0; i < 400; i++) world_advance(&world, i * step, step, earth, NULL, NULL, NULL);
    const ShvVec3 end = shv_scale(world.fragments.items[2].position, 1.0 / size);
    world_end(&world);
    return end;
}

static ShvVec3 thrown(double size)
{
    return thrown_beside(size, 0.0);
}

/* Whatever the scene's largest body is, to the bit: Bullet takes simplices of less than 1e-8 of its units for flat. */
static void test_large_and_far_is_nothing_to_small(void **unused)
{
    (void)unused;
    const ShvVec3 alone = thrown(1e-3), beside = thrown_beside(1e-3, 100.0);
    check_near(beside.x, alone.x, 0.0);
    check_near(beside.y, alone.y, 0.0);
    check_near(beside.z, alone.z, 0.0);
}

static void test_small_and_large_behave_alike(void **unused)
{
    (void)unused;
    /* sizes that differ by 4^n: every number inside by a power of two, so that not even rounding differs */
    const ShvVec3 middle = thrown(0.1), small = thrown(0.1 / 256.0), large = thrown(0.1 * 64.0);
    check_near(shv_norm(shv_sub(small, middle)), 0.0, 1e-6);
    check_near(shv_norm(shv_sub(large, middle)), 0.0, 1e-6);
}

/* ---- determinism ---- */

static void tumble(World *world, bool detour, int32_t order, ShvVec3 positions[3], ShvQuat orientations[3])
{
    world_begin(world);
    for (int i = 0; i < 4; i++) {
        ShvObjectDefinition *box = world_box(world, 0.15, 0.1, 0.05 + 0.02 * i, 0.05);
        box->placement.position[2] = 0.2 + 0.15 * i;
        box->placement.position[0] = i == 3 ? 5.0 : 0.02 * i;
        box->placement.rotation_axis[1] = 1.0;
        box->placement.rotation_degrees = 20.0 * i;
    }
    world_floor(world, 0.5, 0.4);
    world_build(world);
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(shv_bullet_create(&world->backend, &rigid, &error), error);
    static const int32_t orders[2][3] = {{0, 1, 2}, {2, 0, 1}};
    if (detour) check_ok(world->backend->functions->add(world->backend, 3, &error), error);
    for (int k = 0; k < 3; k++) {
        shv_fragment_fit(&world->fragments.items[orders[order][k]], &world->fragments, &world->state);
        check_ok(world->backend->functions->add(world->backend, orders[order][k], &error), error);
    }
    for (int i = 0; i < 1000; i++) {
        if (detour && i == 10) world->backend->functions->remove(world->backend, 3);
        world_advance(world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    }
    for (int f = 0; f < 3; f++) {
        positions[f] = world->fragments.items[f].position;
        orientations[f] = world->fragments.items[f].orientation;
    }
    world_end(world);
}

static void test_same_run_same_bits(void **unused)
{
    (void)unused;
    ShvVec3 p[3], p2[3];
    ShvQuat q[3], q2[3];
    World world;
    tumble(&world, false, 0, p, q);
    for (int other = 0; other < 3; other++) {
        tumble(&world, other == 1, other == 2, p2, q2);
        assert_memory_equal(p, p2, sizeof p);
        assert_memory_equal(q, q2, sizeof q);
    }
}

/* ---- bad input ---- */

static void test_hopeless_bodies_are_refused(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05);
    world_build(&world);
    bullet_fly(&world);
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
    world.backend->functions->remove(world.backend, 0);
    fragment->mass = 0.0;
    check_fails(world.backend->functions->add(world.backend, 0, &error), SHV_BAD_INPUT, error, "mass");
    world_end(&world);
}

/* A single tet, a needle and a flat one: they fall on the floor and on each other, finite, above it. */
static void test_degenerate_tets_fall(void **unused)
{
    (void)unused;
    static const double points[] = {0.0, 0.0, 0.1, 0.1,   0.0, 0.1, 0.0, 0.1, 0.1, 0.0, 0.0, 0.2,  /* plain */
                                    0.5, 0.0, 0.1, 0.501, 0.0, 0.1, 0.5, 1.0, 0.1, 0.5, 0.5, 0.11, /* needle */
                                    0.0, 0.0, 0.3, 0.4,   0.0, 0.3, 0.0, 0.4, 0.3, 0.1, 0.1, 0.30001 /* flat */};
    static const int32_t tets[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    World world;
    world_begin(&world);
    world_floor(&world, 0.5, 0.2);
    world_tets(&world, points, 12, tets, 3);
    assert_int_equal(world.fragments.count, 3);
    bullet_fly(&world);
    for (int i = 0; i < 1500; i++) world_advance(&world, i * 1e-3, 1e-3, earth, NULL, NULL, NULL);
    for (int32_t f = 0; f < world.fragments.count; f++) {
        const ShvFragment *fragment = &world.fragments.items[f];
        assert_true(shv_finite3(fragment->position) && shv_finite3(fragment->angular_velocity));
        shv_fragment_scatter(fragment, &world.fragments, &world.state);
        for (int32_t k = 0; k < fragment->node_count; k++)
            assert_true(shv_state_position(&world.state, world.fragments.nodes[fragment->node_begin + k]).z >
                        -1e-3 * fragment->radius);
    }
    world_end(&world);
}

static void test_memory_runs_out(void **unused)
{
    (void)unused;
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.05;
    world_box(&world, 0.1, 0.1, 0.1, 0.05)->placement.position[2] = 0.15;
    world_floor(&world, 0.5, 0.4);
    world_build(&world);
    const ShvRigidWorld rigid = {&world.model, &world.state, &world.fragments, &world.obstacles, &world.scene.rigid};
    bool done = false;
    for (int64_t allowed = 0; !done; allowed++) {
        assert_true(allowed < 200);
        ShvError error = {0};
        ShvRigidBackend *backend = NULL;
        ShvRigidContact wakes[2];
        int32_t count = 0;
        shv_memory_fail_after(world.memory, allowed);
        ShvStatus status = shv_bullet_create(&backend, &rigid, &error);
        if (status != SHV_OK) assert_null(backend);
        for (int32_t f = 1; f >= 0 && status == SHV_OK; f--) status = backend->functions->add(backend, f, &error);
        for (int i = 0; i < 2 && status == SHV_OK; i++)
            status = backend->functions->advance(backend, 0.0, 1e-3, earth, NULL, NULL, wakes, &count, &error);
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
        cmocka_unit_test(test_two_fragments_keep_momentum),
        cmocka_unit_test(test_central_impacts),
        cmocka_unit_test(test_wake_stops_at_the_impact),
        cmocka_unit_test(test_two_fragments_are_judged_apart),
        cmocka_unit_test(test_fast_fragment_meets_a_thin_obstacle),
        cmocka_unit_test(test_stack_rests),
        cmocka_unit_test(test_loads_of_a_stack),
        cmocka_unit_test(test_small_and_large_behave_alike),
        cmocka_unit_test(test_large_and_far_is_nothing_to_small),
        cmocka_unit_test(test_same_run_same_bits),
        cmocka_unit_test(test_hopeless_bodies_are_refused),
        cmocka_unit_test(test_degenerate_tets_fall),
        cmocka_unit_test(test_memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
