/* The hand-over between fracture mode and flight, both ways, of random fragments: what it keeps, what it drops, what it books. */
#include "coupling/stage.h"

#include <stdlib.h>

#include "base/random.h"
#include "coupling/hybrid.h"

enum { SEEDS = 12 };

static uint64_t draws;
static double uniform(double low, double high)
{
    return low + (high - low) * shv_random_uniform(7, draws++);
}

static ShvVec3 random_vector(double size)
{
    const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return shv_vec3(x, y, z);
}

/* A ball off the origin, with a window so short that whatever is awake may rest at once. */
static void stage_ball(Stage *stage, ShvRigidEngine engine)
{
    stage_make(stage);
    ShvObjectDefinition *ball = stage_box(stage, "ball", (const double[3]){0, 0, 0}, 0.01, 0.1);
    ball->mesh.kind = SHV_MESH_BALL;
    ball->mesh.radius = 0.04;
    ball->placement.position[0] = 0.05;
    stage->scene.rigid.engine = engine;
    stage->scene.fracture.longest = 1e-9;
    stage->scene.fracture.energy_bound = 1e30;
}

static void wake_by(ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    ShvError error = {SHV_OK, ""};
    hybrid->backend->functions->remove(hybrid->backend, contact->fragment);
    hybrid->state.last_step = 0.0;
    check_ok(shv_hybrid_wake(hybrid, contact, &error), error);
}

static void wake(ShvHybrid *hybrid, int32_t fragment)
{
    wake_by(hybrid, &(ShvRigidContact){.fragment = fragment, .obstacle = -1, .other = -1, .time = hybrid->state.time});
}

static void wake_all(ShvHybrid *hybrid)
{
    ShvError error = {SHV_OK, ""};
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].mode == SHV_MODE_FLIGHT) wake(hybrid, i);
    check_ok(shv_awake_refresh(hybrid, &error), error);
}

/* Time goes on without a step, so that windows end. */
static void rest_all(ShvHybrid *hybrid)
{
    ShvError error = {SHV_OK, ""};
    hybrid->state.time += 1e-3;
    check_ok(shv_hybrid_sleep_quiet(hybrid, &error), error);
    assert_int_equal(hybrid->awake.count, 0);
}

static int nearest_seed(const ShvHybrid *hybrid, const ShvVec3 *seeds, int32_t element)
{
    int best = 0;
    double least = HUGE_VAL;
    for (int s = 0; s < SEEDS; s++) {
        ShvVec3 centre = shv_vec3(0, 0, 0);
        for (int a = 0; a < 4; a++) {
            const int64_t node = shv_state_node(&hybrid->state, element, a);
            centre = shv_madd(centre, 0.25, shv_load3(hybrid->state.reference + 3 * node));
        }
        const double distance = shv_norm(shv_sub(centre, seeds[s]));
        if (distance < least) best = s;
        least = fmin(least, distance);
    }
    return best;
}

/* Facets between the cells of random seeds, and one in ten of all others, so that fragments have cracks of their own. */
static void cut(ShvHybrid *hybrid)
{
    ShvError error = {SHV_OK, ""};
    const ShvAdjacency *adjacency = &hybrid->model.adjacency;
    ShvVec3 seeds[SEEDS];
    for (int s = 0; s < SEEDS; s++) seeds[s] = shv_add(shv_vec3(0.05, 0.0, 0.1), random_vector(0.03));
    int32_t *facets = malloc((size_t)adjacency->interior_count * sizeof *facets), count = 0, copies = 0, parts = 0;
    assert_non_null(facets);
    for (int32_t f = 0; f < adjacency->interior_count; f++) {
        const int32_t *elements = adjacency->facet_elements + 2 * (int64_t)f;
        const bool between = nearest_seed(hybrid, seeds, elements[0]) != nearest_seed(hybrid, seeds, elements[1]);
        if (between || uniform(0, 1) < 0.1) facets[count++] = f;
    }
    check_ok(shv_cohesive_insert(&hybrid->cohesive, &hybrid->state, NULL, facets, count, &copies, &error), error);
    for (int32_t i = 0; i < hybrid->cohesive.count; i++) hybrid->cohesive.bonded[i] = false;
    check_ok(shv_fragments_split(&hybrid->fragments, &hybrid->model, &hybrid->state, 0, &parts, &error), error);
    assert_true(parts >= SEEDS);
    free(facets);
    hybrid->awake.stale = true;
    check_ok(shv_awake_refresh(hybrid, &error), error);
}

/* Another pose, the same velocity. */
static void move(ShvFragment *fragment)
{
    const ShvVec3 axis = shv_unit(random_vector(1.0));
    const double half = uniform(0.0, 1.5);
    const ShvQuat turn = {cos(half), axis.x * sin(half), axis.y * sin(half), axis.z * sin(half)};
    fragment->orientation = shv_quat_unit(shv_quat_multiply(turn, fragment->orientation));
    fragment->position = shv_add(fragment->position, random_vector(0.5));
}

/* Every node of what is awake gets its own small displacement and its own velocity; fragments `apart` each a turn. */
static void shake(ShvHybrid *hybrid, bool apart)
{
    ShvError error = {SHV_OK, ""};
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        if (!hybrid->awake.flags[i]) continue;
        if (apart) move(fragment);
        shv_fragment_scatter(fragment, &hybrid->fragments, &hybrid->state);
        for (int32_t k = 0; k < fragment->node_count; k++) {
            const int64_t n = 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k];
            shv_add_to3(hybrid->state.displacement + n, random_vector(1e-5));
            shv_store3(hybrid->state.velocity + n, random_vector(5.0));
        }
    }
    check_ok(shv_hybrid_forces(hybrid, &error), error); /* cohesive facets look at their openings */
}

/* One object in pieces, awake and shaken. */
static void start(ShvHybrid *hybrid, Stage *stage, bool apart)
{
    ShvError error = {SHV_OK, ""};
    draws = 0;
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    wake_all(hybrid);
    cut(hybrid);
    shake(hybrid, apart);
}

/* Straight sums over a fragment's nodes. */
typedef struct Sums {
    ShvVec3 momentum, angular;
    double momentum_scale, angular_scale;
} Sums;

static Sums sums_of(const ShvHybrid *hybrid, int32_t index)
{
    Sums sums = {0};
    const ShvFragment *fragment = &hybrid->fragments.items[index];
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const ShvVec3 x = shv_state_position(&hybrid->state, node);
        const ShvVec3 p = shv_scale(shv_load3(hybrid->state.velocity + 3 * (int64_t)node), hybrid->state.mass[node]);
        sums.momentum = shv_add(sums.momentum, p);
        sums.angular = shv_add(sums.angular, shv_cross(x, p));
        sums.momentum_scale += shv_norm(p);
        sums.angular_scale += shv_norm(p) * shv_norm(x);
    }
    return sums;
}

/* Of the rigid body in the record. */
static void check_rigid(const ShvFragment *fragment, const Sums *sums)
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 p = shv_scale(fragment->velocity, fragment->mass);
    const ShvVec3 l = shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_cross(fragment->position, p));
    check_near(shv_norm(shv_sub(p, sums->momentum)), 0.0, 1e-12 * sums->momentum_scale);
    check_near(shv_norm(shv_sub(l, sums->angular)), 0.0, 1e-12 * sums->angular_scale);
}

static void check_mass(const ShvHybrid *hybrid, const ShvEventView *event)
{
    const ShvFragment *fragment = &hybrid->fragments.items[event->fragment];
    double mass = 0.0;
    for (int32_t k = 0; k < fragment->element_count; k++)
        mass += hybrid->state.element_mass[hybrid->fragments.elements[fragment->element_begin + k]];
    assert_true(mass == event->mass && mass == fragment->mass);
}

/* The event of a switch tells the same as the sums. */
static void check_event(const ShvEventView *event, const Sums *sums)
{
    check_near(event->momentum_scale, sums->momentum_scale, 1e-14 * sums->momentum_scale);
    check_near(event->angular_scale, sums->angular_scale, 1e-14 * sums->angular_scale);
    check_near(shv_norm(shv_sub(shv_load3(event->momentum_before), sums->momentum)), 0.0, 1e-12 * sums->momentum_scale);
    check_near(shv_norm(shv_sub(shv_load3(event->momentum_after), sums->momentum)), 0.0, 1e-12 * sums->momentum_scale);
    check_near(shv_norm(shv_sub(shv_load3(event->angular_before), sums->angular)), 0.0, 1e-12 * sums->angular_scale);
    check_near(shv_norm(shv_sub(shv_load3(event->angular_after), sums->angular)), 0.0, 1e-12 * sums->angular_scale);
    assert_true(event->dropped_vibration == event->kinetic_before - event->kinetic_after);
    assert_true(event->dropped_strain == event->strain_before - event->strain_after);
    assert_true(event->dropped_cohesive == event->cohesive_before - event->cohesive_after);
}

static void sums_of_all(const ShvHybrid *hybrid, Sums *all)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) all[i] = sums_of(hybrid, i);
}

/* To rest and awake again: P and L to 1e-12 of Σ m|v| and Σ m|r||v|, the mass bit by bit. */
static void goes_both_ways(ShvRigidEngine engine, ShvDeformation deformation)
{
    Stage stage;
    stage_ball(&stage, engine);
    stage.scene.fracture.deformation = deformation;
    ShvHybrid hybrid;
    start(&hybrid, &stage, true);
    Sums *before = malloc((size_t)hybrid.fragments.count * sizeof *before);
    assert_non_null(before);
    sums_of_all(&hybrid, before);
    int32_t first = hybrid.log.count;
    rest_all(&hybrid);
    assert_true(hybrid.log.count - first >= SEEDS);
    for (int32_t e = first; e < hybrid.log.count; e++) {
        const ShvEventView *event = &hybrid.log.items[e];
        assert_int_equal(event->kind, SHV_RUN_SLEEP);
        assert_int_equal(event->reason, SHV_REASON_LONGEST);
        check_mass(&hybrid, event);
        check_event(event, &before[event->fragment]);
        check_rigid(&hybrid.fragments.items[event->fragment], &before[event->fragment]);
        const bool keeps = deformation == SHV_DEFORMATION_KEEP;
        assert_true(event->strain_before > 0.0 && event->strain_after == (keeps ? event->strain_before : 0.0));
        assert_true((engine == SHV_RIGID_BULLET) == (event->hulls > 0));
        assert_true(event->hull_outside >= 0.0 && event->hull_missing >= 0.0 && event->hull_missing < 1.0);
    }
    first = hybrid.log.count;
    wake_all(&hybrid);
    for (int32_t e = first; e < hybrid.log.count; e++) {
        const ShvEventView *event = &hybrid.log.items[e];
        const Sums now = sums_of(&hybrid, event->fragment);
        assert_int_equal(event->kind, SHV_RUN_WAKE);
        check_mass(&hybrid, event);
        check_event(event, &now);
        check_rigid(&hybrid.fragments.items[event->fragment], &now);
    }
    free(before);
    shv_hybrid_release(&hybrid);
}

static void random_fragments_keep_mass_and_momentum(void **unused)
{
    (void)unused;
    for (int engine = 0; engine < 2; engine++)
        for (int kept = 0; kept < 2; kept++)
            goes_both_ways(engine ? SHV_RIGID_BULLET : SHV_RIGID_ANALYTIC,
                           kept ? SHV_DEFORMATION_KEEP : SHV_DEFORMATION_DROP);
    goes_both_ways(SHV_RIGID_PBD, SHV_DEFORMATION_DROP);
}

/* An undeformed fragment comes back to its pose: to 1e-12 of its size, its motion to 1e-12 of its speeds. */
static void an_undeformed_fragment_keeps_its_pose(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_ANALYTIC);
    ShvHybrid hybrid;
    start(&hybrid, &stage, true);
    rest_all(&hybrid);
    const int32_t count = hybrid.fragments.count;
    ShvFragment *before = malloc((size_t)count * sizeof *before);
    assert_non_null(before);
    memcpy(before, hybrid.fragments.items, (size_t)count * sizeof *before);
    wake_all(&hybrid);
    rest_all(&hybrid);
    for (int32_t i = 0; i < count; i++) {
        const ShvFragment *now = &hybrid.fragments.items[i], *then = &before[i];
        if (now->mode == SHV_MODE_DEAD) continue;
        check_near(shv_norm(shv_sub(now->position, then->position)), 0.0, 1e-12 * now->radius);
        for (int k = 0; k < 3; k++) {
            const ShvVec3 arm = shv_vec3(k == 0 ? now->radius : 0, k == 1 ? now->radius : 0, k == 2 ? now->radius : 0);
            const ShvVec3 turned = shv_sub(shv_rotate(now->orientation, arm), shv_rotate(then->orientation, arm));
            check_near(shv_norm(turned), 0.0, 1e-12 * now->radius);
        }
        const double speed = shv_norm(then->velocity) + now->radius * shv_norm(then->angular_velocity);
        check_near(shv_norm(shv_sub(now->velocity, then->velocity)), 0.0, 1e-12 * speed);
        const ShvVec3 spun = shv_sub(now->angular_velocity, then->angular_velocity);
        check_near(now->radius * shv_norm(spun), 0.0, 1e-12 * speed);
    }
    free(before);
    shv_hybrid_release(&hybrid);
}

/* The ledger as it stands. */
static ShvLedgerView observe(ShvHybrid *hybrid)
{
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_observe(hybrid, &error), error);
    return hybrid->observer.balance;
}

/* Sums of a time do not notice a switch: what is dropped is booked. To the rounding of sums of `largest`. */
static void check_closed(const ShvLedgerView *before, const ShvLedgerView *after)
{
    check_near(after->residual, before->residual, 1e-12 * before->largest);
    check_near(after->cohesive_defect, before->cohesive_defect, 1e-12 * before->largest);
    const double momentum = 12 * shv_norm(shv_load3(before->momentum)), angular = momentum * 0.5;
    for (int k = 0; k < 3; k++) {
        check_near(after->momentum[k], before->momentum[k], 1e-12 * momentum);
        check_near(after->angular_momentum[k], before->angular_momentum[k], 1e-12 * angular);
    }
}

/* With `keep` strain and open cracks go on after flight, wherever it led; with `drop` they are gone. Displacements of up to 1 m
   round to 1.1e-16 m, against 1e-5 m by which nodes were shaken: energies to some 1e-10. */
static void deformation_goes_on_or_is_dropped(void **unused)
{
    (void)unused;
    for (int kept = 0; kept < 2; kept++) {
        Stage stage;
        stage_ball(&stage, SHV_RIGID_ANALYTIC);
        stage.scene.gravity[2] = 0.0;
        stage.scene.fracture.deformation = kept ? SHV_DEFORMATION_KEEP : SHV_DEFORMATION_DROP;
        ShvHybrid hybrid;
        start(&hybrid, &stage, false);
        const ShvLedgerView awake = observe(&hybrid);
        assert_true(awake.strain > 0.0 && awake.cohesive_recoverable > 0.0);
        rest_all(&hybrid);
        const ShvLedgerView resting = observe(&hybrid);
        check_closed(&awake, &resting);
        assert_true(resting.cohesive_released > 0.0); /* by facets to other fragments at least */
        check_near(resting.strain, kept ? awake.strain : 0.0, 1e-10 * awake.strain);
        if (kept)
            assert_true(resting.cohesive_recoverable > 0.0);
        else
            check_near(resting.cohesive_recoverable, 0.0, 1e-10 * awake.cohesive_recoverable);
        for (int32_t i = 0; i < hybrid.fragments.count; i++) move(&hybrid.fragments.items[i]);
        const ShvLedgerView moved = observe(&hybrid);
        assert_true(moved.strain == resting.strain);
        wake_all(&hybrid);
        const ShvLedgerView woken = observe(&hybrid);
        check_closed(&moved, &woken);
        check_near(woken.strain, resting.strain, 1e-10 * awake.strain);
        check_near(woken.cohesive_recoverable, resting.cohesive_recoverable, 1e-10 * awake.cohesive_recoverable);
        shv_hybrid_release(&hybrid);
    }
}

/* Nodes fly on their own as they came to rest. Those that bars will not lead in fracture mode go back to the shape at the start
   when they wake: strain and openings have come to nothing, and what else they had is booked. */
static void flown_nodes_wake_in_their_shape(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_PBD);
    stage.scene.gravity[2] = 0.0;
    ShvHybrid hybrid;
    start(&hybrid, &stage, false);
    const ShvLedgerView awake = observe(&hybrid);
    rest_all(&hybrid);
    const ShvLedgerView resting = observe(&hybrid);
    check_closed(&awake, &resting);
    assert_true(resting.cohesive_recoverable > 0.0);
    wake_all(&hybrid);
    const ShvLedgerView woken = observe(&hybrid);
    check_closed(&resting, &woken);
    assert_true(woken.kinetic < resting.kinetic);
    check_near(woken.strain, 0.0, 1e-10 * awake.strain);
    check_near(woken.cohesive_recoverable, 0.0, 1e-10 * awake.cohesive_recoverable);
    shv_hybrid_release(&hybrid);
}

static double lowest_node(const ShvHybrid *hybrid)
{
    double lowest = HUGE_VAL;
    for (int32_t i = 0; i < hybrid->state.node_count; i++)
        lowest = fmin(lowest, shv_state_position(&hybrid->state, i).z);
    return lowest;
}

static void sink(ShvHybrid *hybrid, double depth)
{
    for (int32_t i = 0; i < hybrid->state.node_count; i++) hybrid->state.displacement[3 * i + 2] -= depth;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) hybrid->fragments.items[i].position.z -= depth;
}

/* In that shape they may stand in an obstacle, out of which bars would throw them in flight: out they go, each fragment as a
   whole, and the ledger knows. */
static void flown_nodes_wake_outside_of_obstacles(void **unused)
{
    (void)unused;
    const double floor = 0.06, depth = 5e-4;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_PBD);
    stage_floor(&stage)->plane_offset = floor;
    ShvHybrid hybrid;
    start(&hybrid, &stage, false);
    rest_all(&hybrid);
    sink(&hybrid, lowest_node(&hybrid) - floor + depth);
    const ShvLedgerView resting = observe(&hybrid);
    wake_all(&hybrid);
    check_near(lowest_node(&hybrid), floor, 1e-12);
    const ShvLedgerView woken = observe(&hybrid);
    assert_true(woken.gravity_potential > resting.gravity_potential);
    check_near(woken.residual, resting.residual, 1e-12 * resting.largest);
    shv_hybrid_release(&hybrid);
}

/* Some fragments awake, some keep their deformation in flight, and batches of elements that hold both: strain counts once. */
static void kept_strain_counts_once(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_ANALYTIC);
    stage.scene.fracture.deformation = SHV_DEFORMATION_KEEP;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    start(&hybrid, &stage, true);
    rest_all(&hybrid);
    const ShvLedgerView resting = observe(&hybrid);
    for (int32_t i = 0; i < hybrid.fragments.count; i += 2)
        if (hybrid.fragments.items[i].mode == SHV_MODE_FLIGHT) wake(&hybrid, i);
    check_ok(shv_awake_refresh(&hybrid, &error), error);
    const ShvLedgerView mixed = observe(&hybrid);
    check_near(mixed.strain, resting.strain, 1e-10 * resting.strain);
    check_closed(&resting, &mixed);
    shv_hybrid_release(&hybrid);
}

/* Convex pieces touch before nodes do: what wakes waits for these, but no longer than vibration takes to decay (1e-9 s here). */
static void nodes_are_waited_for_while_vibration_lasts(void **unused)
{
    (void)unused;
    const double speeds[] = {1e-3, 1e9};
    Stage stage;
    stage_ball(&stage, SHV_RIGID_ANALYTIC);
    stage_floor(&stage);
    stage.scene.gravity[2] = 0.0;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    start(&hybrid, &stage, false);
    const double gap = lowest_node(&hybrid);
    for (int k = 0; k < 2; k++) {
        rest_all(&hybrid);
        for (int32_t i = 0; i < hybrid.fragments.count; i++) {
            ShvFragment *fragment = &hybrid.fragments.items[i];
            if (fragment->mode != SHV_MODE_FLIGHT) continue;
            const ShvRigidContact contact = {.fragment = i,
                                             .other = -1,
                                             .time = hybrid.state.time,
                                             .closing_speed = speeds[k],
                                             .normal = {0.0, 0.0, 1.0},
                                             .point = fragment->position,
                                             .other_mass = (double)INFINITY};
            wake_by(&hybrid, &contact);
            const double wait = fragment->touched - hybrid.state.time;
            if (k == 0)
                check_near(wait, 1e-9, 1e-15);
            else
                assert_true(wait >= 0.999 * gap / speeds[k] && wait < 5e-10);
        }
        check_ok(shv_awake_refresh(&hybrid, &error), error);
    }
    shv_hybrid_release(&hybrid);
}

/* Every fragment is dust: put away, they stand still where they are, and sums of mass, P, L and energy stay. */
static void binned_dust_stays_in_the_sums(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_BULLET);
    stage.scene.rigid.dust = SHV_DUST_BIN;
    stage.scene.rigid.dust_size = 1.0;
    stage.scene.gravity[2] = 0.0;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    start(&hybrid, &stage, true);
    const ShvLedgerView before = observe(&hybrid);
    const int32_t first = hybrid.log.count;
    rest_all(&hybrid);
    const ShvLedgerView after = observe(&hybrid);
    check_closed(&before, &after);
    assert_true(after.kinetic == 0.0 && before.kinetic > 0.0);
    double mass = 0.0;
    for (int32_t e = first; e < hybrid.log.count; e++) {
        const ShvEventView *event = &hybrid.log.items[e];
        assert_int_equal(event->kind, SHV_RUN_BIN);
        assert_int_equal(event->hulls, 0);
        assert_true(event->dropped_vibration == event->kinetic_before);
        mass += event->mass;
    }
    check_near(mass, hybrid.fragments.items[0].mass, 1e-13 * mass);
    const ShvVec3 there = hybrid.fragments.items[hybrid.fragments.count - 1].position;
    int64_t taken = 0;
    check_ok(shv_hybrid_advance(&hybrid, hybrid.state.time + 0.01, 0, &taken, &error), error);
    const ShvLedgerView later = observe(&hybrid);
    assert_memory_equal(later.momentum, after.momentum, sizeof after.momentum);
    assert_memory_equal(&there, &hybrid.fragments.items[hybrid.fragments.count - 1].position, sizeof there);
    shv_hybrid_release(&hybrid);
}

/* Particles fly: through one another, where rigid bodies would meet, but not through the floor, on which they come to rest.
   While nothing is hit P and L stay; energy is the ledger's. */
static void particles_fly_and_meet_obstacles_alone(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_BULLET);
    stage_floor(&stage)->friction = 0.5;
    stage.scene.rigid.dust = SHV_DUST_PARTICLE;
    stage.scene.rigid.dust_size = 1.0;
    stage.scene.duration = 10.0;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    draws = 0;
    check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
    wake_all(&hybrid);
    cut(&hybrid);
    rest_all(&hybrid); /* they lie against each other, and a push would be passed on */
    const int32_t pushed = hybrid.fragments.count - 1;
    const ShvVec3 centre = shv_vec3(0.05, 0.0, 0.1);
    ShvFragment *one = &hybrid.fragments.items[pushed];
    assert_true(one->dust);
    const ShvVec3 inwards = shv_scale(shv_unit(shv_sub(centre, one->position)), 2.0);
    one->velocity = inwards;
    const double given = observe(&hybrid).residual;
    const ShvVec3 from = one->position;
    const double flight = 0.02;
    int64_t taken = 0;
    check_ok(shv_hybrid_advance(&hybrid, hybrid.state.time + flight, 0, &taken, &error), error);
    const ShvVec3 way = shv_madd(shv_scale(inwards, flight), -0.5 * 9.81 * flight * flight, shv_vec3(0, 0, 1));
    one = &hybrid.fragments.items[pushed];
    check_near(shv_norm(shv_sub(shv_sub(one->position, from), way)), 0.0, 1e-12);
    check_ok(shv_hybrid_advance(&hybrid, 3.0, 0, &taken, &error), error);
    const ShvLedgerView end = observe(&hybrid);
    assert_int_equal(taken, 0);
    assert_true(end.contact < 0.0);
    check_near(end.residual, given, 1e-4 * end.largest); /* of rolling on corners, second order in the rigid step */
    for (int32_t i = 0; i < hybrid.fragments.count; i++) {
        const ShvFragment *fragment = &hybrid.fragments.items[i];
        if (fragment->mode != SHV_MODE_FLIGHT) continue;
        assert_true(fragment->position.z > 0.0 && fragment->position.z < fragment->radius);
        check_near(shv_norm(fragment->velocity), 0.0, 1e-6);
    }
    shv_hybrid_release(&hybrid);
}

/* A bound exceeded names the fragment, the figure, the bound and what to change; the event is in the log all the same. */
static void a_bound_ends_the_run(void **unused)
{
    (void)unused;
    static const struct {
        double momentum, dropped_share, hull_error;
        const char *message;
    } cases[] = {{1e-20, HUGE_VAL, HUGE_VAL, "more than audit.momentum 1e-20"},
                 {HUGE_VAL, 1e-3, HUGE_VAL, "more than audit.dropped_share 0.001; give a larger fracture.longest"},
                 {HUGE_VAL, HUGE_VAL, 1e-3, "more than audit.hull_error 0.001; give a finer mesh"}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        Stage stage;
        stage_ball(&stage, SHV_RIGID_BULLET);
        ShvHybrid hybrid;
        start(&hybrid, &stage, true);
        stage.scene.audit = (ShvAuditDefinition){cases[c].momentum, cases[c].dropped_share, cases[c].hull_error};
        ShvError error = {SHV_OK, ""};
        const int32_t known = hybrid.log.count;
        hybrid.state.time += 1e-3;
        check_fails(shv_hybrid_sleep_quiet(&hybrid, &error), SHV_DIVERGED, error, cases[c].message);
        assert_non_null(strstr(error.message, "fragment "));
        assert_true(hybrid.log.count > known);
        shv_hybrid_release(&hybrid);
    }
}

/* A ball has fallen 1 m and contacts have stopped it: of the energy that they took they may give back 0.05, and as much as lifts it by
   its radius of 0.04 m, though the balance closes; where an obstacle is driven they may give all. */
static void contacts_gain_no_energy(void **unused)
{
    (void)unused;
    for (int driven = 0; driven < 2; driven++) {
        Stage stage;
        ShvHybrid hybrid;
        ShvError error = {SHV_OK, ""};
        stage_ball(&stage, SHV_RIGID_BULLET);
        stage.scene.fracture.energy_bound = 0.05;
        stage_floor(&stage);
        check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
        if (driven) hybrid.obstacles.items[0].motion = SHV_OBSTACLE_SCRIPTED;
        observe(&hybrid);
        ShvFragment *ball = &hybrid.fragments.items[0];
        const double height = 1.0, energy = ball->mass * 9.81 * height;
        ball->position.z -= height;
        const double left[] = {1.0, 0.0, 0.085, 0.095};
        for (int i = 0; i < 4; i++) {
            ball->velocity = shv_vec3(0.0, 0.0, sqrt(2.0 * 9.81 * height * left[i]));
            hybrid.observer.ledger.booked[SHV_WORK_CONTACT] = (left[i] - 1.0) * energy;
            if (i < 3 || driven)
                observe(&hybrid);
            else
                check_fails(shv_hybrid_observe(&hybrid, &error), SHV_DIVERGED, error, "contacts have gained energy by");
            check_near(hybrid.observer.balance.residual, 0.0, 1e-12 * energy);
        }
        shv_hybrid_release(&hybrid);
    }
}

static void contact_between_fragments_is_the_scenes(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_BULLET);
    stage.scene.rigid.friction = 0.125;
    stage.scene.rigid.restitution = 0.75;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
    assert_true(hybrid.backend->fragment_friction == 0.125);
    assert_true(hybrid.backend->fragment_restitution == 0.75);
    assert_true(hybrid.coupling.surface.friction == 0.125);
    shv_hybrid_release(&hybrid);
}

/* The second of two balls goes along with the first, which is awake. */
static ShvFragment *start_beside(ShvHybrid *hybrid, Stage *stage)
{
    stage_ball(stage, SHV_RIGID_BULLET);
    stage->objects[1] = stage->objects[0];
    stage->objects[1].name = "other";
    stage->objects[1].placement.position[0] = 0.15;
    stage->scene.object_count = 2;
    for (int k = 0; k < 3; k++) stage->scene.gravity[k] = 0.0;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    wake(hybrid, 0);
    check_ok(shv_awake_refresh(hybrid, &error), error);
    check_ok(shv_coupled_bodies_add(hybrid, 1, &error), error);
    hybrid->state.last_step = 2e-5;
    hybrid->interval_end = hybrid->state.time + 1e-3;
    return &hybrid->fragments.items[1];
}

/* Velocities are those of half steps, flight sees and changes those of now: what it gives acts at once, is kept over a step, and goes
   back with the body. */
static void impulses_in_flight_act_at_once(void **unused)
{
    (void)unused;
    for (int wakes = 0; wakes < 2; wakes++) {
        Stage stage;
        ShvHybrid hybrid;
        ShvFragment *other = start_beside(&hybrid, &stage);
        const double half = 0.5 * hybrid.state.last_step;
        const ShvVec3 given = shv_vec3(0.03, -0.02, 0.01), turned = shv_vec3(0.2, 0.3, -0.1);
        ShvCoupledBody *coupled_body = &hybrid.coupling.bodies.items[0];
        hybrid.gravity[1] = -10.0;
        shv_coupled_bodies_to_flight(&hybrid);
        check_near(other->velocity.y, -10.0 * half, 1e-18);
        other->velocity = shv_add(other->velocity, given);
        other->angular_velocity = turned;
        shv_coupled_bodies_from_flight(&hybrid);
        check_near(shv_norm(shv_sub(coupled_body->velocity, given)), 0.0, 1e-17);
        shv_coupled_bodies_kick(&hybrid, hybrid.state.last_step);
        shv_coupled_bodies_drift(&hybrid, hybrid.state.last_step);
        if (wakes)
            shv_coupled_bodies_remove(&hybrid, 1);
        else
            rest_all(&hybrid);
        assert_int_equal(hybrid.coupling.bodies.count, 0);
        check_near(shv_norm(shv_sub(other->velocity, shv_madd(given, 3.0 * half, shv_load3(hybrid.gravity)))), 0.0,
                   1e-17);
        check_near(shv_norm(shv_sub(other->angular_velocity, turned)), 0.0, 1e-9);
        shv_hybrid_release(&hybrid);
    }
}

/* Events of the time line move what can move. */
static void events_leave_binned_dust_alone(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_ANALYTIC);
    stage.scene.rigid.dust = SHV_DUST_BIN;
    stage.scene.rigid.dust_size = 1.0;
    stage_event(&stage, 0.002, SHV_EVENT_IMPULSE, "ball")->value[0] = 1.0;
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    start(&hybrid, &stage, false);
    rest_all(&hybrid);
    const ShvLedgerView before = observe(&hybrid);
    int64_t taken = 0;
    check_ok(shv_hybrid_advance(&hybrid, 0.004, 0, &taken, &error), error);
    const ShvLedgerView after = observe(&hybrid);
    assert_int_equal(hybrid.next_event, 1);
    check_closed(&before, &after);
    assert_true(after.event == 0.0);
    shv_hybrid_release(&hybrid);
}

static bool holds_cracks(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return shv_cohesive_holds_cracks(&hybrid->cohesive, hybrid->fragments.elements + fragment->element_begin,
                                     fragment->element_count);
}

/* Of a fragment that has just woken; `longest` as the scene says. */
static double latest_rest(Stage *stage, ShvHybrid *hybrid, ShvFragment *fragment, double longest, bool cracked)
{
    double soonest, latest;
    stage->scene.fracture.longest = longest;
    fragment->last_insertion = hybrid->state.time;
    fragment->last_crack = cracked ? hybrid->state.time : -HUGE_VAL;
    shv_hybrid_rest_between(hybrid, fragment, &soonest, &latest);
    return latest - hybrid->state.time;
}

static void cracked_bodies_tremble_longer(void **unused)
{
    (void)unused;
    Stage stage;
    stage_ball(&stage, SHV_RIGID_ANALYTIC);
    ShvHybrid hybrid;
    start(&hybrid, &stage, false);
    hybrid.fragments.bonds = &hybrid.cohesive;
    memset(hybrid.cohesive.bonded, 1, (size_t)hybrid.cohesive.count);
    ShvFragment *fragment = hybrid.fragments.items, *end = fragment + hybrid.fragments.count;
    while (fragment < end && !holds_cracks(&hybrid, fragment)) fragment++;
    assert_true(fragment < end);
    const double whole = latest_rest(&stage, &hybrid, fragment, 0.0, false);
    assert_true(whole > 0.0);
    check_near(latest_rest(&stage, &hybrid, fragment, 0.0, true), 5.0 * whole, 1e-9 * whole);
    check_near(latest_rest(&stage, &hybrid, fragment, 0.1, false), 0.1, 1e-12); /* who says how long means it */
    check_near(latest_rest(&stage, &hybrid, fragment, 0.1, true), 0.1, 1e-12);
    memset(hybrid.cohesive.bonded, 0, (size_t)hybrid.cohesive.count); /* its cracks hold nothing any more */
    check_near(latest_rest(&stage, &hybrid, fragment, 0.0, true), whole, 1e-9 * whole);
    fragment->woken_transit *= 3.0; /* what woke was larger: the piece bears its blow for as long */
    check_near(latest_rest(&stage, &hybrid, fragment, 0.0, true), 3.0 * whole, 1e-9 * whole);
    shv_hybrid_release(&hybrid);
}

/* Growth of damage is told from what a body had: of a piece that has just come off its own share, not that of the whole. */
static void pieces_begin_with_their_own_damage(void **unused)
{
    (void)unused;
    enum { STEPS = 4000 };
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "block", (const double[3]){0.08, 0.04, 0.04}, 0.01, 0.0201)->placement.velocity[2] = -6.0;
    stage_floor(&stage);
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_create(&hybrid, NULL, &stage.scene, NULL, &error), error);
    int32_t seen = 0;
    for (int step = 0; step < STEPS && seen < 5; step++) {
        int64_t taken;
        const int32_t before = hybrid.fragments.count;
        check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration, 1, &taken, &error), error);
        for (int32_t i = before; i < hybrid.fragments.count; i++) {
            const ShvFragment *piece = &hybrid.fragments.items[i];
            if (piece->mode != SHV_MODE_FRACTURE) continue;
            const double own = shv_cohesive_dissipated(
                &hybrid.cohesive, hybrid.fragments.elements + piece->element_begin, piece->element_count);
            assert_true(piece->growth_sum <= own);
            assert_true(piece->growth_time >= piece->birth);
            seen++;
        }
    }
    assert_true(seen >= 5);
    shv_hybrid_release(&hybrid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_fragments_keep_mass_and_momentum),
        cmocka_unit_test(impulses_in_flight_act_at_once),
        cmocka_unit_test(contacts_gain_no_energy),
        cmocka_unit_test(an_undeformed_fragment_keeps_its_pose),
        cmocka_unit_test(deformation_goes_on_or_is_dropped),
        cmocka_unit_test(kept_strain_counts_once),
        cmocka_unit_test(nodes_are_waited_for_while_vibration_lasts),
        cmocka_unit_test(flown_nodes_wake_in_their_shape),
        cmocka_unit_test(flown_nodes_wake_outside_of_obstacles),
        cmocka_unit_test(binned_dust_stays_in_the_sums),
        cmocka_unit_test(particles_fly_and_meet_obstacles_alone),
        cmocka_unit_test(a_bound_ends_the_run),
        cmocka_unit_test(contact_between_fragments_is_the_scenes),
        cmocka_unit_test(events_leave_binned_dust_alone),
        cmocka_unit_test(cracked_bodies_tremble_longer),
        cmocka_unit_test(pieces_begin_with_their_own_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
