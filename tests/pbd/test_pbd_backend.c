/* Fragments in flight as nodes with bars and damping, behind the interface of rigid engines. */
#include "rigid/world.h"

#include "pbd/bars.h"
#include "pbd/damping.h"
#include "pbd/pbd_backend.h"

static const double no_gravity[3] = {0.0, 0.0, 0.0}, down[3] = {0.0, 0.0, -9.81};

static ShvPbdDefinition settings_of(double stiffness, int32_t iterations, double damping, bool exact)
{
    return (ShvPbdDefinition){.stiffness = stiffness,
                              .iterations = iterations,
                              .form = SHV_BARS_EDGE,
                              .damping = damping,
                              .exact_rotation = exact};
}

static void fly(World *world, const ShvPbdDefinition *settings)
{
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(shv_pbd_create(&world->backend, &rigid, settings, &error), error);
    assert_true(world->backend->keeps_nodes);
    for (int32_t i = 0; i < world->fragments.count; i++) {
        if (world->fragments.items[i].mode == SHV_MODE_DEAD) continue;
        shv_fragment_fit(&world->fragments.items[i], &world->fragments, &world->state);
        check_ok(world->backend->functions->add(world->backend, i, &error), error);
    }
}

typedef struct Verdict {
    bool accept; /* fresh contacts wake */
    int32_t asked, fresh;
} Verdict;

static bool judge(void *data, const ShvRigidContact *contact)
{
    Verdict *verdict = data;
    verdict->asked++;
    verdict->fresh += contact->fresh;
    assert_true(contact->closing_speed > 0.0);
    return verdict->accept && contact->fresh;
}

static int32_t advance(World *world, double time, double step, const double gravity[3], Verdict *verdict,
                       ShvRigidContact *wakes)
{
    ShvError error = {0};
    ShvRigidContact own[16];
    int32_t count = 0;
    check_ok(world->backend->functions->advance(world->backend, time, step, gravity, judge, verdict,
                                                wakes ? wakes : own, &count, &error),
             error);
    shv_obstacles_advance(&world->obstacles, step, gravity);
    return count;
}

static double largest_strain(const World *world)
{
    double largest = 0.0;
    for (int32_t e = 0; e < world->state.element_count; e++)
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < i; j++) {
                const int32_t a = shv_state_node(&world->state, e, i), b = shv_state_node(&world->state, e, j);
                const double rest = shv_norm(
                    shv_sub(shv_load3(world->state.reference + 3 * a), shv_load3(world->state.reference + 3 * b)));
                const double now =
                    shv_norm(shv_sub(shv_state_position(&world->state, a), shv_state_position(&world->state, b)));
                largest = fmax(largest, fabs(now / rest - 1.0));
            }
    return largest;
}

static double energy(const World *world, const double gravity[3])
{
    double sum = 0.0;
    for (int32_t i = 0; i < world->state.node_count; i++) {
        const ShvVec3 v = shv_load3(world->state.velocity + 3 * i);
        sum += world->state.mass[i] *
               (0.5 * shv_dot(v, v) - shv_dot(shv_load3(gravity), shv_state_position(&world->state, i)));
    }
    return sum;
}

static double all_work(const World *world)
{
    const ShvRigidBackend *b = world->backend;
    return b->contact_work + b->friction_work + b->bars_work + b->damping_work;
}

/* ---- flight ---- */

/* x = −½ g t² at every step; 0.1 s of fall, 5 % of a metre: 1e-10 is round-off of 20,000 steps. */
static void free_fall_is_exact_at_every_step(void **state)
{
    (void)state;
    const double steps[] = {1e-3, 1e-4, 5e-6};
    for (int k = 0; k < 6; k++) {
        const double dt = steps[k % 3];
        const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, k / 3);
        World world;
        Verdict verdict = {0};
        world_begin(&world);
        world_box(&world, 0.2, 0.1, 0.1, 0.1)->placement.position[2] = 1.0;
        world_build(&world);
        fly(&world, &settings);
        const int32_t count = (int32_t)lround(0.1 / dt);
        for (int32_t i = 0; i < count; i++) advance(&world, i * dt, dt, down, &verdict, NULL);
        const double t = count * dt;
        for (int32_t i = 0; i < world.state.node_count; i++) {
            check_near(world.state.displacement[3 * i + 2], -0.5 * 9.81 * t * t, 1e-10);
            check_near(world.state.displacement[3 * i], 0.0, 1e-10);
            check_near(world.state.velocity[3 * i + 2], -9.81 * t, 1e-10);
        }
        check_near(world.fragments.items[0].position.z, 1.0 - 0.5 * 9.81 * t * t, 1e-10);
        check_near(world.fragments.items[0].velocity.z, -9.81 * t, 1e-10);
        assert_int_equal(verdict.asked, 0);
        world_end(&world);
    }
}

static void at_rest_without_gravity_not_a_bit_changes(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ShvPbdDefinition settings = settings_of(1.0, 4, 1.0, k);
        World world;
        Verdict verdict = {0};
        world_begin(&world);
        world_floor(&world, 0.5, 0.5);
        world_box(&world, 1.0, 1.0, 1.0, 0.5)->placement.position[2] = 0.5; /* touches the floor exactly */
        world_build(&world);
        fly(&world, &settings);
        const uint64_t start = shv_state_hash(&world.state);
        for (int i = 0; i < 100; i++) advance(&world, i * 1e-3, 1e-3, no_gravity, &verdict, NULL);
        assert_true(shv_state_hash(&world.state) == start);
        assert_int_equal(verdict.asked, 0);
        world_end(&world);
    }
}

static void spinning_tet(World *world, double spin)
{
    static const double points[12] = {0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.13, 0.0, 0.0, 0.0, 0.17};
    static const int32_t tet[4] = {0, 1, 2, 3};
    world_begin(world);
    world_tets(world, points, 4, tet, 1);
    ShvFragment *fragment = &world->fragments.items[0];
    shv_fragment_fit(fragment, &world->fragments, &world->state);
    fragment->angular_velocity = shv_scale(shv_vec3(0.3, -0.5, 0.8), spin);
    shv_fragment_scatter(fragment, &world->fragments, &world->state);
}

/* Exact rotation: the motion is that of a free rigid body, L is kept and no length changes, at any speed: here up to ten
   radians a step. Round-off of 1000 steps. */
static void a_tet_spins_freely(void **state)
{
    (void)state;
    const double spins[] = {5.0, 1e4};
    for (int k = 0; k < 2; k++) {
        const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, true);
        World world;
        Verdict verdict = {0};
        ShvVec3 momentum, before, after;
        double kinetic[2];
        spinning_tet(&world, spins[k]);
        fly(&world, &settings);
        shv_fragment_momentum(&world.fragments.items[0], &world.fragments, &world.state, &momentum, &before,
                              &kinetic[0]);
        for (int i = 0; i < 1000; i++) advance(&world, i * 1e-3, 1e-3, no_gravity, &verdict, NULL);
        shv_fragment_momentum(&world.fragments.items[0], &world.fragments, &world.state, &momentum, &after,
                              &kinetic[1]);
        check_near(shv_norm(shv_sub(after, before)), 0.0, 1e-11 * shv_norm(before));
        check_near(kinetic[1], kinetic[0], 1e-11 * kinetic[0]);
        assert_true(largest_strain(&world) < 1e-11);
        check_near(all_work(&world), 0.0, 1e-11 * kinetic[0]);
        world_end(&world);
    }
}

/* A thin ring about its axis: on tangents radii grow by ½ (ω dt)² a step until the bars hold against it; on circles they
   do not. ω dt = 0.1. */
static void exact_rotation_removes_the_drift_of_radii(void **state)
{
    (void)state;
    double strain[2];
    for (int exact = 0; exact < 2; exact++) {
        const ShvPbdDefinition settings = settings_of(0.5, 1, 1.0, exact);
        World world;
        Verdict verdict = {0};
        world_begin(&world);
        ShvObjectDefinition *ring = world_box(&world, 1.0, 1.0, 1.0, 0.1);
        ring->mesh.kind = SHV_MESH_CYLINDER;
        ring->mesh.radius = 0.5;
        ring->mesh.inner_radius = 0.4;
        ring->mesh.height = 0.1;
        ring->placement.angular_velocity[2] = 100.0;
        world_build(&world);
        fly(&world, &settings);
        for (int i = 0; i < 200; i++) advance(&world, i * 1e-3, 1e-3, no_gravity, &verdict, NULL);
        strain[exact] = largest_strain(&world);
        world_end(&world);
    }
    assert_true(strain[0] > 1e-3 && strain[0] < 0.5);
    assert_true(strain[1] < 1e-12);
}

/* After every step with k = 1 damping, what flies is rigid as soon as it is damped again; here its velocity field before
   that is looked at through a copy. */
static void full_damping_makes_shells_rigid(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, false);
        World world;
        Verdict verdict = {0};
        world_begin(&world);
        ShvObjectDefinition *object = world_box(&world, 0.4, 0.3, 0.04, 0.05);
        if (k) {
            object->mesh.kind = SHV_MESH_HOLLOW_BALL;
            object->mesh.radius = 0.2;
            object->mesh.inner_radius = 0.17;
        }
        object->placement.angular_velocity[1] = 7.0;
        world_build(&world);
        fly(&world, &settings);
        const ShvFragment *fragment = &world.fragments.items[0];
        const int32_t *nodes = world.fragments.nodes + fragment->node_begin;
        for (int i = 0; i < 20; i++) {
            advance(&world, i * 1e-3, 1e-3, down, &verdict, NULL);
            shv_damp_velocities(&world.state, nodes, fragment->node_count, 1.0, NULL);
            for (int32_t a = 0; a < fragment->node_count; a += 7)
                for (int32_t b = 0; b < a; b += 5) {
                    const ShvVec3 x =
                        shv_sub(shv_state_position(&world.state, nodes[a]), shv_state_position(&world.state, nodes[b]));
                    const ShvVec3 v = shv_sub(shv_load3(world.state.velocity + 3 * nodes[a]),
                                              shv_load3(world.state.velocity + 3 * nodes[b]));
                    check_near(shv_dot(x, v), 0.0, 1e-12 * shv_norm(x) * 3.0);
                }
        }
        world_end(&world);
    }
}

/* ---- impact ---- */

/* Drops a plate flat-ish on the floor; the largest edge strain from the impact on. */
static double drop_plate(double dt)
{
    const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, false);
    World world;
    Verdict verdict = {0};
    world_begin(&world);
    world_floor(&world, 0.3, 0.3);
    ShvObjectDefinition *plate = world_box(&world, 0.4, 0.2, 0.04, 0.04);
    plate->placement.position[2] = 0.15;
    plate->placement.rotation_axis[1] = 1.0;
    plate->placement.rotation_degrees = 20.0;
    plate->placement.velocity[2] = -1.0;
    world_build(&world);
    fly(&world, &settings);
    const double start = energy(&world, down);
    double largest = 0.0;
    const int32_t steps = (int32_t)lround(0.3 / dt);
    for (int32_t i = 0; i < steps; i++) {
        advance(&world, i * dt, dt, down, &verdict, NULL);
        largest = fmax(largest, largest_strain(&world));
    }
    assert_true(verdict.asked > 0);
    /* The works explain the change of energy of the nodes to round-off. */
    check_near(energy(&world, down) - start, all_work(&world), 1e-9 * fabs(start));
    assert_true(all_work(&world) < 0.0);
    world_end(&world);
    return largest;
}

static void a_plate_deforms_less_at_smaller_steps(void **state)
{
    (void)state;
    const double coarse = drop_plate(2e-3), middle = drop_plate(1e-3), fine = drop_plate(1e-4);
    print_message("largest edge strain of a dropped plate: %.3e at 2 ms, %.3e at 1 ms, %.3e at 0.1 ms\n", coarse,
                  middle, fine);
    assert_true(coarse > middle && middle > fine && fine > 0.0);
}

/* A new contact stops the fragment where its step began, unmoved; told to fly on, it bounces. */
static void a_new_contact_is_judged_at_the_start_of_the_step(void **state)
{
    (void)state;
    for (int accept = 0; accept < 2; accept++) {
        const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, true);
        World world;
        Verdict verdict = {.accept = accept};
        ShvRigidContact wakes[4];
        world_begin(&world);
        world_floor(&world, 0.0, 0.5);
        ShvObjectDefinition *object = world_box(&world, 0.1, 0.1, 0.1, 0.1);
        object->placement.position[2] = 0.05 + 0.0103;
        object->placement.velocity[2] = -1.0;
        world_build(&world);
        fly(&world, &settings);
        int32_t woken = 0;
        for (int i = 0; i < 10; i++) assert_int_equal(advance(&world, i * 1e-3, 1e-3, no_gravity, &verdict, wakes), 0);
        assert_int_equal(verdict.asked, 0);
        const uint64_t before = shv_state_hash(&world.state);
        woken = advance(&world, 0.01, 1e-3, no_gravity, &verdict, wakes);
        assert_int_equal(verdict.asked, 1);
        assert_int_equal(verdict.fresh, 1);
        assert_int_equal(woken, accept);
        if (accept) {
            assert_true(shv_state_hash(&world.state) == before);
            check_near(wakes[0].time, 0.01, 0.0);
            check_near(wakes[0].closing_speed, 1.0, 1e-12);
            assert_int_equal(wakes[0].fragment, 0);
            assert_int_equal(advance(&world, 0.011, 1e-3, no_gravity, &verdict, wakes), 0);
            assert_true(shv_state_hash(&world.state) == before);
        } else {
            assert_true(world.fragments.items[0].velocity.z > -1.0);
            assert_true(world.backend->contact_work < 0.0);
        }
        world_end(&world);
    }
}

/* Left on the floor with v = 0: the contact was there when it was added, so it is never new, and nothing moves but the sag
   of the bars. */
static void a_body_placed_on_the_floor_does_not_wake(void **state)
{
    (void)state;
    const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, false);
    World world;
    Verdict verdict = {.accept = true};
    world_begin(&world);
    world_floor(&world, 0.5, 0.5);
    world_box(&world, 0.2, 0.2, 0.2, 0.1)->placement.position[2] = 0.1;
    world_build(&world);
    fly(&world, &settings);
    for (int i = 0; i < 500; i++) assert_int_equal(advance(&world, i * 1e-3, 1e-3, down, &verdict, NULL), 0);
    assert_int_equal(verdict.fresh, 0);
    check_near(world.fragments.items[0].position.z, 0.1, 1e-4);
    check_near(shv_norm(world.fragments.items[0].velocity), 0.0, 2.0 * 9.81 * 1e-3);
    world_end(&world);
}

/* A fragment that comes bent out of fracture mode springs back to its reference shape, not to the bent one. */
static void rest_lengths_are_those_of_the_reference(void **state)
{
    (void)state;
    const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, true);
    World world;
    Verdict verdict = {0};
    world_begin(&world);
    world_box(&world, 0.3, 0.1, 0.1, 0.1);
    world_build(&world);
    for (int32_t i = 0; i < world.state.node_count; i++)
        world.state.displacement[3 * i] = 0.05 * world.state.reference[3 * i];
    fly(&world, &settings);
    const double start = largest_strain(&world);
    assert_true(start > 0.04);
    for (int i = 0; i < 300; i++) advance(&world, i * 1e-3, 1e-3, no_gravity, &verdict, NULL);
    assert_true(largest_strain(&world) < 1e-6 * start);
    world_end(&world);
}

/* ---- together ---- */

static void results_do_not_depend_on_threads(void **state)
{
    (void)state;
    uint64_t first = 0;
    for (int32_t threads = 1; threads <= 3; threads++) {
        const ShvPbdDefinition settings = settings_of(0.8, 3, 0.5, true);
        World world;
        Verdict verdict = {0};
        world_begin(&world);
        world.scene.threads = threads;
        world_floor(&world, 0.3, 0.3);
        for (int i = 0; i < 2; i++) {
            ShvObjectDefinition *object = world_box(&world, 0.3, 0.3, 0.3, 0.035);
            object->placement.position[0] = i;
            object->placement.position[2] = 0.3;
            object->placement.rotation_axis[i] = 1.0;
            object->placement.rotation_degrees = 30.0;
            object->placement.velocity[2] = -20.0;
        }
        world_build(&world);
        fly(&world, &settings);
        for (int i = 0; i < 15; i++) advance(&world, i * 1e-3, 1e-3, down, &verdict, NULL);
        assert_true(verdict.asked > 0);
        const uint64_t hash = shv_state_hash(&world.state);
        if (threads == 1) first = hash;
        assert_true(hash == first);
        world_end(&world);
    }
}

/* One fragment wakes, the other flies on as if it were alone; then the first one comes back. */
static void fragments_come_and_go(void **state)
{
    (void)state;
    ShvError error = {0};
    const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, true);
    World world;
    Verdict verdict = {.accept = true};
    ShvRigidContact wakes[4];
    world_begin(&world);
    world_floor(&world, 0.0, 0.0);
    for (int i = 0; i < 2; i++) {
        ShvObjectDefinition *object = world_box(&world, 0.1, 0.1, 0.1, 0.1);
        object->placement.position[0] = i;
        object->placement.position[2] = i ? 5.0 : 0.0505;
    }
    world_build(&world);
    fly(&world, &settings);
    int32_t woken = 0, steps = 0;
    while (woken == 0 && steps < 100) woken = advance(&world, 1e-3 * steps++, 1e-3, down, &verdict, wakes);
    assert_int_equal(woken, 1);
    assert_int_equal(wakes[0].fragment, 0);
    const double kept = world.state.displacement[2];
    for (int i = 0; i < 20; i++) advance(&world, 1e-3 * steps++, 1e-3, down, &verdict, wakes);
    assert_true(world.state.displacement[2] == kept);
    const double t = 1e-3 * steps;
    check_near(world.fragments.items[1].position.z, 5.0 - 0.5 * 9.81 * t * t, 1e-12);
    check_ok(world.backend->functions->add(world.backend, 0, &error), error);
    world.backend->functions->remove(world.backend, 1);
    const double other = world.fragments.items[1].position.z;
    verdict.accept = false;
    advance(&world, t, 1e-3, down, &verdict, wakes);
    assert_true(world.state.displacement[2] != kept);
    assert_true(world.fragments.items[1].position.z == other);
    world_end(&world);
}

static void impossible_settings_are_refused(void **state)
{
    (void)state;
    ShvError error = {0};
    World world;
    world_begin(&world);
    world_box(&world, 0.1, 0.1, 0.1, 0.1);
    world_build(&world);
    const ShvRigidWorld rigid = {&world.model, &world.state, &world.fragments, &world.obstacles, &world.scene.rigid};
    const struct {
        double stiffness;
        int32_t iterations;
        double damping;
        const char *word;
    } cases[] = {{-0.1, 1, 0.0, "stiffness"},     {1.1, 1, 0.0, "stiffness"}, {(double)NAN, 1, 0.0, "stiffness"},
                 {1.0, 0, 0.0, "iterations"},     {1.0, 1, -1.0, "damping"},  {1.0, 1, 2.0, "damping"},
                 {1.0, 1, (double)NAN, "damping"}};
    for (int i = 0; i < 7; i++) {
        const ShvPbdDefinition settings = settings_of(cases[i].stiffness, cases[i].iterations, cases[i].damping, false);
        check_fails(shv_pbd_create(&world.backend, &rigid, &settings, &error), SHV_BAD_INPUT, error, cases[i].word);
        assert_null(world.backend);
    }
    world_end(&world);
}

static void running_out_of_memory_is_reported_and_leaks_nothing(void **state)
{
    (void)state;
    ShvError error = {0};
    const ShvPbdDefinition settings = settings_of(0.9, 3, 1.0, true);
    World world;
    world_begin(&world);
    world_floor(&world, 0.0, 0.0);
    world_box(&world, 0.1, 0.1, 0.1, 0.1)->placement.position[2] = 0.04;
    world_build(&world);
    const ShvRigidWorld rigid = {&world.model, &world.state, &world.fragments, &world.obstacles, &world.scene.rigid};
    const size_t held = shv_memory_bytes(world.memory, SHV_PART_COUNT);
    int64_t allowed = 0;
    for (;; allowed++) {
        ShvRigidContact wakes[4];
        int32_t count = 0;
        shv_memory_fail_after(world.memory, allowed);
        ShvStatus status = shv_pbd_create(&world.backend, &rigid, &settings, &error);
        if (status == SHV_OK) status = world.backend->functions->add(world.backend, 0, &error);
        if (status == SHV_OK)
            status =
                world.backend->functions->advance(world.backend, 0.0, 1e-3, down, NULL, NULL, wakes, &count, &error);
        if (status == SHV_OK) break;
        assert_int_equal(status, SHV_NO_MEMORY);
        if (world.backend) world.backend->functions->destroy(world.backend);
        world.backend = NULL;
        assert_int_equal(shv_memory_bytes(world.memory, SHV_PART_COUNT), held);
    }
    assert_true(allowed > 25);
    shv_memory_fail_after(world.memory, -1);
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_fall_is_exact_at_every_step),
        cmocka_unit_test(at_rest_without_gravity_not_a_bit_changes),
        cmocka_unit_test(a_tet_spins_freely),
        cmocka_unit_test(exact_rotation_removes_the_drift_of_radii),
        cmocka_unit_test(full_damping_makes_shells_rigid),
        cmocka_unit_test(a_plate_deforms_less_at_smaller_steps),
        cmocka_unit_test(a_new_contact_is_judged_at_the_start_of_the_step),
        cmocka_unit_test(a_body_placed_on_the_floor_does_not_wake),
        cmocka_unit_test(rest_lengths_are_those_of_the_reference),
        cmocka_unit_test(results_do_not_depend_on_threads),
        cmocka_unit_test(fragments_come_and_go),
        cmocka_unit_test(impossible_settings_are_refused),
        cmocka_unit_test(running_out_of_memory_is_reported_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
