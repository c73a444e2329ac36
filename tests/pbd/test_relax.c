/* One step of relaxation: obstacles, restitution, friction, free obstacles, imposed components, works. Here the bars' own
   stiffness is mostly 0, so that every node is a point mass with a closed form. */
#include "rigid/world.h"

#include "pbd/relax.h"

typedef struct Scene {
    World world;
    ShvBars bars;
    ShvRelax relax;
    int32_t *nodes;
    ShvRelaxStep step;
} Scene;

/* A box of 1 m whose lowest nodes stand at z = `gap`, with obstacles added by the caller before. */
static void scene_make(Scene *scene, double gap)
{
    ShvError error = {0};
    world_box(&scene->world, 1.0, 1.0, 1.0, 0.5)->placement.position[2] = 0.5 + gap;
    world_build(&scene->world);
    const ShvState *state = &scene->world.state;
    check_ok(shv_bars_create(&scene->bars, &scene->world.model, SHV_BARS_EDGE, &error), error);
    check_ok(shv_bars_update(&scene->bars, state, NULL, &error), error);
    check_ok(shv_relax_create(&scene->relax, &scene->world.model, &scene->world.obstacles, &error), error);
    scene->nodes = malloc((size_t)state->node_count * sizeof *scene->nodes);
    for (int32_t i = 0; i < state->node_count; i++) scene->nodes[i] = i;
    scene->step = (ShvRelaxStep){.step = 1e-2, .iterations = 1};
}

static void scene_end(Scene *scene)
{
    free(scene->nodes);
    shv_relax_release(&scene->relax);
    shv_bars_release(&scene->bars);
    world_end(&scene->world);
}

static void set_velocity(Scene *scene, double x, double y, double z)
{
    for (int32_t i = 0; i < scene->world.state.node_count; i++)
        shv_store3(scene->world.state.velocity + 3 * i, shv_vec3(x, y, z));
}

static ShvStatus try_step(Scene *scene, ShvError *error)
{
    ShvState *state = &scene->world.state;
    const int32_t count = state->node_count;
    SHV_TRY(shv_relax_begin(&scene->relax, state, scene->nodes, count, error));
    shv_relax_predict(&scene->relax, state, scene->nodes, count, scene->step.step);
    SHV_TRY(shv_relax_detect(&scene->relax, state, &scene->world.obstacles, scene->nodes, count, &scene->step, error));
    return shv_relax_run(&scene->relax, &scene->bars, state, &scene->world.obstacles, scene->nodes, count, &scene->step,
                         error);
}

static void take_step(Scene *scene)
{
    ShvError error = {0};
    check_ok(try_step(scene, &error), error);
}

static double kinetic(const ShvState *state)
{
    double sum = 0.0;
    for (int32_t i = 0; i < state->node_count; i++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * i);
        sum += 0.5 * state->mass[i] * shv_dot(v, v);
    }
    return sum;
}

static double all_work(const ShvRelax *relax)
{
    double sum = 0.0;
    for (int half = 0; half < 2; half++)
        sum += relax->work.bars[half] + relax->work.contact[half] + relax->work.friction[half] +
               relax->work.constraint[half];
    return sum;
}

static bool is_lowest(const Scene *scene, int32_t node, double gap)
{
    return scene->world.state.reference[3 * node + 2] < gap + 1e-9;
}

/* Nodes fall 3 m/s × 10 ms onto a floor 10 mm below them: stopped after a third of the way, they leave with e × 3 m/s, and
   not with e × what the projection left of their speed. */
static void restitution_counts_from_the_speed_before_projection(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double e = 0.5 * k, gap = 0.01;
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        world_floor(&scene.world, 0.0, e);
        scene_make(&scene, gap);
        set_velocity(&scene, 0.0, 0.0, -3.0);
        take_step(&scene);
        const ShvState *now = &scene.world.state;
        for (int32_t i = 0; i < now->node_count; i++) {
            const bool lowest = is_lowest(&scene, i, gap);
            check_near(now->velocity[3 * i + 2], lowest ? 3.0 * e : -3.0, 1e-12);
            check_near(now->displacement[3 * i + 2], lowest ? -gap : -0.03, 1e-15);
            assert_int_equal(scene.relax.touched[i], lowest);
        }
        scene_end(&scene);
    }
}

/* Pulling a node out of an overlap is no velocity; a node that leaves already keeps its own. */
static void overlaps_are_undone_without_throwing_anything_out(void **state)
{
    (void)state;
    const double speeds[] = {0.0, 0.2, -0.2};
    for (int k = 0; k < 3; k++) {
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        world_floor(&scene.world, 0.0, 0.0);
        scene_make(&scene, -0.1);
        set_velocity(&scene, 0.0, 0.0, speeds[k]);
        take_step(&scene);
        for (int32_t i = 0; i < scene.world.state.node_count; i++)
            if (is_lowest(&scene, i, -0.1)) {
                check_near(scene.world.state.velocity[3 * i + 2], fmax(speeds[k], 0.0), 1e-12);
                check_near(shv_state_position(&scene.world.state, i).z, 0.0, 1e-15);
            }
        scene_end(&scene);
    }
}

/* Coulomb: a normal impulse of m (1 + e) 3 m/s takes at most µ (1 + e) 3 m/s of the 2 m/s along the floor. */
static void friction_is_bounded_by_the_whole_normal_impulse(void **state)
{
    (void)state;
    const double frictions[] = {0.0, 0.1, 0.3, 10.0};
    for (int k = 0; k < 8; k++) {
        const double mu = frictions[k / 2], e = 0.5 * (k % 2);
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        world_floor(&scene.world, mu, e);
        scene_make(&scene, 0.01);
        set_velocity(&scene, 2.0, 0.0, -3.0);
        const double before = kinetic(&scene.world.state);
        take_step(&scene);
        const ShvState *now = &scene.world.state;
        for (int32_t i = 0; i < now->node_count; i++)
            if (is_lowest(&scene, i, 0.01)) {
                check_near(now->velocity[3 * i], fmax(0.0, 2.0 - mu * (1.0 + e) * 3.0), 1e-12);
                check_near(now->velocity[3 * i + 1], 0.0, 1e-15);
            }
        check_near(all_work(&scene.relax), kinetic(now) - before, 1e-12 * before);
        assert_true(scene.relax.work.friction[0] + scene.relax.work.friction[1] <= 0.0);
        scene_end(&scene);
    }
}

/* A resting node is held by friction without creeping: not even its position follows the slope. */
static void a_slope_below_the_friction_angle_holds(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double slope = 0.3, mu = k ? 0.31 : 0.2, cosine = 1.0 / sqrt(1.0 + slope * slope);
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        ShvObstacleDefinition *floor = world_obstacle(&scene.world, SHV_OBSTACLE_PLANE);
        floor->plane_normal[0] = -slope * cosine;
        floor->plane_normal[1] = 0.0;
        floor->plane_normal[2] = cosine;
        floor->plane_offset = -0.5 * (1.0 + slope) * cosine; /* through the lowest corners, placed at height 0.5 */
        floor->friction = mu;
        scene_make(&scene, -0.5);
        scene.step.gravity[2] = -10.0;
        scene.step.rest_speed = 2.0 * scene.step.step * 10.0;
        ShvState *now = &scene.world.state;
        int32_t corner = -1;
        for (int32_t i = 0; i < now->node_count; i++)
            if (now->reference[3 * i] > 0.49 && now->reference[3 * i + 2] < -0.49) corner = i;
        floor->plane_offset = shv_dot(shv_load3(floor->plane_normal), shv_load3(now->reference + 3 * corner));
        scene.world.obstacles.items[0].offset = floor->plane_offset;
        for (int step = 0; step < 100; step++) {
            now->velocity[3 * corner + 2] -= 10.0 * scene.step.step;
            take_step(&scene);
        }
        /* Down the slope a = g (sin θ − µ cos θ); 100 steps of leapfrog from rest: a dt² 100 × 101/2. */
        const double expected = k ? 0.0 : 10.0 * cosine * (slope - mu) * 1e-4 * 5050.0;
        check_near(shv_norm(shv_load3(now->displacement + 3 * corner)), expected, 1e-9 + 1e-9 * expected);
        scene_end(&scene);
    }
}

/* 1 km/s through a plate of 1 mm in a step of 1 ms. */
static void thin_plates_stop_fast_nodes(void **state)
{
    (void)state;
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    ShvObstacleDefinition *plate = world_obstacle(&scene.world, SHV_OBSTACLE_BOX);
    plate->size[0] = plate->size[1] = 4.0;
    plate->size[2] = 1e-3;
    plate->placement.position[2] = -0.5e-3 - 0.3;
    scene_make(&scene, 0.0);
    scene.step.step = 1e-3;
    set_velocity(&scene, 0.0, 0.0, -1e3);
    take_step(&scene);
    for (int32_t i = 0; i < scene.world.state.node_count; i++) {
        const bool met = scene.world.state.reference[3 * i + 2] < 0.69;
        check_near(shv_state_position(&scene.world.state, i).z,
                   met ? -0.3 : scene.world.state.reference[3 * i + 2] - 1.0, 1e-12);
        check_near(scene.world.state.velocity[3 * i + 2], met ? 0.0 : -1e3, 1e-9);
    }
    scene_end(&scene);
}

/* A free ball takes what the nodes lose, in momentum and, without restitution below 1, in energy. */
static void free_obstacles_take_the_opposite_impulse(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        ShvObstacleDefinition *ball = world_obstacle(&scene.world, SHV_OBSTACLE_SPHERE);
        ball->motion = SHV_OBSTACLE_FREE;
        ball->mass = 300.0;
        ball->radius = 0.3;
        ball->friction = 0.4;
        ball->restitution = k;
        ball->placement.position[0] = 0.05;
        ball->placement.position[2] = -0.31;
        ball->placement.velocity[2] = 4.0;
        ball->placement.angular_velocity[1] = 3.0;
        scene_make(&scene, 0.0);
        scene.step.stiffness = 0.5;
        scene.step.iterations = 3;
        ShvState *now = &scene.world.state;
        ShvObstacle *free_ball = &scene.world.obstacles.items[0];
        const double before = kinetic(now), other = shv_obstacle_kinetic(free_ball);
        take_step(&scene);
        ShvVec3 momentum = shv_scale(free_ball->velocity, free_ball->mass);
        for (int32_t i = 0; i < now->node_count; i++)
            momentum = shv_madd(momentum, now->mass[i], shv_load3(now->velocity + 3 * i));
        check_near(shv_norm(shv_sub(momentum, shv_vec3(0.0, 0.0, 1200.0))), 0.0, 1e-10);
        assert_true(scene.relax.touching > 0);
        check_near(all_work(&scene.relax), kinetic(now) - before, 1e-10 * other);
        check_near(scene.relax.obstacle_work, shv_obstacle_kinetic(free_ball) - other, 1e-10 * other);
        assert_true(scene.relax.obstacle_work < 0.0);
        scene_end(&scene);
    }
}

/* Work of bars: nodes with random velocities, no obstacle near. */
static void works_add_up_to_the_change_of_kinetic_energy(void **state)
{
    (void)state;
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    scene_make(&scene, 1.0);
    ShvState *now = &scene.world.state;
    scene.step.stiffness = 0.7;
    scene.step.iterations = 4;
    uint64_t index = 0;
    for (int32_t i = 0; i < now->node_count; i++) shv_store3(now->velocity + 3 * i, draw3(&index, 10.0));
    for (int k = 0; k < 10; k++) {
        const double before = kinetic(now);
        take_step(&scene);
        check_near(all_work(&scene.relax), kinetic(now) - before, 1e-12 * before);
        assert_true(scene.relax.work.contact[0] == 0.0 && scene.relax.touching == 0);
        assert_true(scene.relax.largest_projection > 0.0);
    }
    ShvLedger ledger = {.booked = {0.0}};
    shv_relax_book(&scene.relax, &ledger);
    assert_true(ledger.booked[SHV_WORK_BARS] == scene.relax.work.bars[0] + scene.relax.work.bars[1]);
    assert_true(ledger.pending[SHV_WORK_BARS] == scene.relax.work.bars[1]);
    assert_true(shv_relax_largest_strain(&scene.relax, &scene.bars) > 0.0);
    scene_end(&scene);
}

static void imposed_components_are_not_touched(void **state)
{
    (void)state;
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    world_floor(&scene.world, 0.0, 0.0);
    scene_make(&scene, 0.0);
    ShvState *now = &scene.world.state;
    uint8_t *fixed = calloc((size_t)now->node_count, 1);
    scene.step.stiffness = 1.0;
    scene.step.iterations = 4;
    scene.step.fixed = fixed;
    uint64_t index = 0;
    double start[3 * 100];
    assert_true(now->node_count <= 100);
    for (int32_t i = 0; i < now->node_count; i++) {
        fixed[i] = (uint8_t)(i % 8);
        shv_store3(now->velocity + 3 * i, draw3(&index, 10.0));
    }
    memcpy(start, now->velocity, 3 * (size_t)now->node_count * sizeof(double));
    take_step(&scene);
    for (int i = 0; i < 3 * now->node_count; i++)
        if (fixed[i / 3] & (1 << i % 3)) {
            assert_true(now->velocity[i] == start[i]);
            assert_true(now->displacement[i] == scene.step.step * start[i]);
        } else {
            assert_true(now->velocity[i] != start[i]);
        }
    free(fixed);
    scene_end(&scene);
}

/* Nodes carried along at one velocity V, in all components or in z alone, give the others momentum through bars: the work of what
   holds them is V times that, and the rest of the change of kinetic energy is the bars'. */
static void what_holds_imposed_components_does_their_work(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        Scene scene = {.nodes = NULL};
        world_begin(&scene.world);
        scene_make(&scene, 1.0);
        ShvState *now = &scene.world.state;
        uint8_t *fixed = calloc((size_t)now->node_count, 1);
        scene.step.stiffness = 0.9;
        scene.step.iterations = 3;
        scene.step.fixed = fixed;
        const ShvVec3 imposed = {0.0, k ? 0.0 : -2.0, 5.0};
        uint64_t index = 0;
        for (int32_t i = 0; i < now->node_count; i++) {
            fixed[i] = i % 3 ? 0 : k ? 4 : 7;
            shv_store3(now->velocity + 3 * i, fixed[i] ? imposed : draw3(&index, 10.0));
        }
        for (int step = 0; step < 10; step++) {
            const double before = kinetic(now);
            ShvVec3 given = {0.0, 0.0, 0.0};
            for (int32_t i = 0; i < now->node_count; i++)
                given = shv_madd(given, -now->mass[i], shv_load3(now->velocity + 3 * i));
            take_step(&scene);
            for (int32_t i = 0; i < now->node_count; i++)
                given = shv_madd(given, now->mass[i], shv_load3(now->velocity + 3 * i));
            const double *work = scene.relax.work.constraint;
            check_near(work[0] + work[1], shv_dot(imposed, given), 1e-12 * before);
            check_near(all_work(&scene.relax), kinetic(now) - before, 1e-12 * before);
            if (step == 0) assert_true(fabs(work[0] + work[1]) > 1e-3 * before);
        }
        ShvLedger ledger = {.booked = {0.0}};
        shv_relax_book(&scene.relax, &ledger);
        const double *work = scene.relax.work.constraint;
        assert_true(ledger.booked[SHV_WORK_CONSTRAINT] == work[0] + work[1]);
        assert_true(ledger.pending[SHV_WORK_CONSTRAINT] == work[1]);
        free(fixed);
        scene_end(&scene);
    }
}

/* Two floors that leave no room, and a wedge: answers are finite and the sweeps end. */
static void opposed_obstacles_stay_finite(void **state)
{
    (void)state;
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    world_floor(&scene.world, 0.3, 0.5);
    ShvObstacleDefinition *roof = world_obstacle(&scene.world, SHV_OBSTACLE_PLANE);
    roof->plane_normal[0] = 0.6;
    roof->plane_normal[2] = -0.8;
    roof->plane_offset = 0.1;
    scene_make(&scene, 0.0);
    scene.step.stiffness = 1.0;
    scene.step.iterations = 4;
    set_velocity(&scene, 1.0, 1.0, -5.0);
    for (int k = 0; k < 200; k++) take_step(&scene);
    assert_true(isfinite(kinetic(&scene.world.state)));
    scene_end(&scene);
}

static void motion_that_is_not_finite_is_refused(void **state)
{
    (void)state;
    ShvError error = {0};
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    scene_make(&scene, 0.0);
    scene.step.stiffness = 1.0;
    set_velocity(&scene, 0.0, 0.0, 0.0);
    scene.world.state.velocity[4] = 1e200;
    const double kept = scene.world.state.displacement[4];
    check_fails(try_step(&scene, &error), SHV_DIVERGED, error, "smaller time step");
    assert_true(scene.world.state.displacement[4] == kept);
    scene_end(&scene);
}

static void running_out_of_memory_is_reported_and_leaks_nothing(void **state)
{
    (void)state;
    ShvError error = {0};
    Scene scene = {.nodes = NULL};
    world_begin(&scene.world);
    world_floor(&scene.world, 0.0, 0.0);
    scene_make(&scene, 0.0);
    set_velocity(&scene, 0.0, 0.0, -1.0);
    shv_relax_release(&scene.relax);
    ShvMemory *memory = scene.world.memory;
    const size_t held = shv_memory_bytes(memory, SHV_PART_COUNT);
    int64_t allowed = 0;
    for (;; allowed++) {
        shv_memory_fail_after(memory, allowed);
        ShvStatus status = shv_relax_create(&scene.relax, &scene.world.model, &scene.world.obstacles, &error);
        if (status == SHV_OK) status = try_step(&scene, &error);
        if (status == SHV_OK) break;
        assert_int_equal(status, SHV_NO_MEMORY);
        shv_relax_release(&scene.relax);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), held);
    }
    assert_true(allowed > 10);
    shv_memory_fail_after(memory, -1);
    scene_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(restitution_counts_from_the_speed_before_projection),
        cmocka_unit_test(overlaps_are_undone_without_throwing_anything_out),
        cmocka_unit_test(friction_is_bounded_by_the_whole_normal_impulse),
        cmocka_unit_test(a_slope_below_the_friction_angle_holds),
        cmocka_unit_test(thin_plates_stop_fast_nodes),
        cmocka_unit_test(free_obstacles_take_the_opposite_impulse),
        cmocka_unit_test(works_add_up_to_the_change_of_kinetic_energy),
        cmocka_unit_test(imposed_components_are_not_touched),
        cmocka_unit_test(what_holds_imposed_components_does_their_work),
        cmocka_unit_test(opposed_obstacles_stay_finite),
        cmocka_unit_test(motion_that_is_not_finite_is_refused),
        cmocka_unit_test(running_out_of_memory_is_reported_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
