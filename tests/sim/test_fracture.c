/* Whole impacts: a bar that falls on its end and breaks into a few pieces. */
#include "sim/stage.h"

#include <stdlib.h>

#include "base/random.h"

/* Keeps what has woken awake: an explicit run to the end. */
static void stay_awake(Stage *stage)
{
    stage->scene.fracture.quiet_checks = 1000000;
    stage->scene.fracture.longest = 1e3;
}

/* 0.26 m/s cracks the bar, where facets are judged one by one: disks of this coarse lattice hold half as much again. Bonds hold
   its pieces. */
static void make_gentle_break(Stage *stage)
{
    stage_make_breaking_bar(stage);
    stage->objects[0].placement.velocity[2] = -0.26;
    stage->scene.fracture.criterion = SHV_CRITERION_TRACTION;
    stage->scene.fracture.threshold = 0.9;
}

static void test_ledger_closes(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stay_awake(&stage);
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_next(simulation);
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    }
    assert_true(frame->inserted > 10 && frame->failed < frame->inserted && frame->alive_count < 10);
    assert_true(frame->ledger.fracture_dissipation > 0.0);
    assert_true(frame->ledger.contact < 0.0 && frame->ledger.friction < 0.0);
    shv_simulation_destroy(simulation);
}

/* Ids count up, a child starts when its parent ends, and all pieces together have the tets of the whole. */
static void check_genealogy(const ShvFrameView *frame)
{
    int32_t alive = 0, tets = 0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        assert_int_equal(fragment->id, i);
        assert_true(fragment->parent < i);
        if (fragment->parent >= 0) {
            const ShvFragmentView *parent = &frame->fragments[fragment->parent];
            assert_int_equal(parent->mode, SHV_FRAGMENT_DEAD);
            assert_true(parent->death == fragment->birth);
        }
        if (fragment->mode == SHV_FRAGMENT_DEAD) {
            assert_true(fragment->death >= fragment->birth);
            continue;
        }
        assert_true(isnan(fragment->death));
        alive++;
        tets += fragment->tets;
    }
    assert_int_equal(alive, frame->alive_count);
    assert_int_equal(tets, frame->fragments[0].tets);
}

/* Every tet belongs to a living piece, and together the pieces weigh what the whole did. */
static void check_masses(const ShvSimulation *simulation, const ShvFrameView *frame, double density)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    int32_t *owner = malloc((size_t)mesh.element_count * sizeof *owner);
    int32_t *tets = calloc((size_t)frame->fragment_count, sizeof *tets);
    assert_non_null(owner);
    assert_non_null(tets);
    shv_simulation_element_state(simulation, owner, NULL);
    double whole = 0.0;
    for (int32_t i = 0; i < frame->fragment_count; i++)
        if (frame->fragments[i].mode != SHV_FRAGMENT_DEAD) whole += frame->fragments[i].mass;
    check_near(whole, frame->fragments[0].mass, 1e-14 * whole);
    for (int32_t e = 0; e < mesh.element_count; e++) {
        assert_true(frame->fragments[owner[e]].mode != SHV_FRAGMENT_DEAD);
        tets[owner[e]]++;
    }
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        assert_int_equal(tets[i], fragment->tets);
        check_near(fragment->mass, density * fragment->volume, 1e-14 * fragment->mass);
    }
    free(owner);
    free(tets);
}

static void test_genealogy(void **state)
{
    (void)state;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.scene.output.fracture_every = 5;
    stage.scene.fracture.energy_bound = 1.0;
    ShvSimulation *simulation = stage_start(&stage);
    int32_t known = 0, off_grid = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        assert_true(frame->fragment_count >= known);
        known = frame->fragment_count;
        check_genealogy(frame);
        off_grid += !frame->animation;
    }
    check_masses(simulation, shv_simulation_frame(simulation), stage.material.density);
    assert_true(known > 10);
    assert_true(off_grid > 10);
    shv_simulation_destroy(simulation);
}

/* A frame every so many steps of the fracture phase, beside the animation grid. */
static void test_fracture_frames(void **state)
{
    (void)state;
    enum { EVERY = 7 };
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.006;
    stage.scene.output.fracture_every = EVERY;
    ShvSimulation *simulation = stage_start(&stage);
    int64_t due = EVERY;
    int frames = 0;
    double time = -1.0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        assert_true(frame->time > time);
        time = frame->time;
        assert_true(frame->steps <= due);
        if (frame->steps == due) {
            due += EVERY;
            frames++;
        } else {
            assert_true(frame->animation);
        }
    }
    assert_true(frames > 5);
    shv_simulation_destroy(simulation);
}

/* Nothing is lost at a mode switch but what is booked: momentum and angular momentum to 1e-12 of what the fragment's mass could
   carry at the speeds at hand. */
static void check_switch(const ShvEventView *event, const ShvFragmentView *fragment, int *wakes, int *sleeps)
{
    if (event->kind != SHV_RUN_WAKE && event->kind != SHV_RUN_SLEEP) return;
    *wakes += event->kind == SHV_RUN_WAKE;
    *sleeps += event->kind == SHV_RUN_SLEEP;
    const double speed = sqrt(2.0 * fmax(event->kinetic_before, event->kinetic_after) / fragment->mass), arm = 0.2;
    for (int k = 0; k < 3; k++) {
        check_near(event->momentum_after[k], event->momentum_before[k], 1e-12 * fragment->mass * speed);
        check_near(event->angular_after[k], event->angular_before[k], 1e-12 * fragment->mass * speed * arm);
    }
    if (event->kind == SHV_RUN_WAKE)
        check_near(event->kinetic_after, event->kinetic_before, 1e-12 * event->kinetic_before);
    else
        check_near(event->value, event->kinetic_before + event->strain_before - event->kinetic_after,
                   1e-12 * (event->kinetic_before + event->strain_before));
}

static void test_mode_switches(void **state)
{
    (void)state;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].placement.angular_velocity[1] = 3.0;
    stage.material.breakable = false;
    stage.scene.rigid.wake = SHV_WAKE_CONTACT;
    stage.scene.fracture.enabled = false;
    stage.scene.duration = 0.05;
    ShvSimulation *simulation = stage_start(&stage);
    int wakes = 0, sleeps = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++)
            check_switch(&frame->events[i], &frame->fragments[frame->events[i].fragment], &wakes, &sleeps);
        check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    }
    assert_true(wakes > 0);
    assert_true(sleeps > 0);
    shv_simulation_destroy(simulation);
}

typedef struct Policy {
    ShvDeformation deformation;
    ShvDust dust;
    ShvRigidEngine engine;
} Policy;

/* A bar that breaks, whose pieces go to rest and meet the floor and each other. */
static void run_policy(const Policy *policy, int *kept, int *binned)
{
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.scene.duration = 0.04;
    stage.scene.fracture.longest = 3e-3;
    stage.scene.fracture.deformation = policy->deformation;
    stage.scene.rigid.engine = policy->engine;
    stage.scene.rigid.dust = policy->dust;
    stage.scene.rigid.dust_size = policy->dust == SHV_DUST_KEEP ? 0.0 : 0.018;
    stage.scene.audit.momentum = 1e-12;
    /* The run itself holds the ledger to it; cohesive tractions, which go on as long as bonds hold, are off their law by 1 %. */
    stage.scene.fracture.energy_bound = 0.02;
    ShvSimulation *simulation = stage_start(&stage);
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++) {
            *binned += frame->events[i].kind == SHV_RUN_BIN;
            *kept += frame->events[i].kind == SHV_RUN_SLEEP && frame->events[i].strain_after > 0.0;
        }
    }
    check_masses(simulation, shv_simulation_frame(simulation), stage.material.density);
    shv_simulation_destroy(simulation);
}

/* Whatever a scene decides about deformation and dust, the ledger closes, mass is there and no switch changes momentum. */
static void test_policies_of_rest(void **state)
{
    (void)state;
    for (int deformation = 0; deformation < 2; deformation++)
        for (int dust = 0; dust < 3; dust++) {
            const Policy policy = {(ShvDeformation)deformation, (ShvDust)dust,
                                   (deformation + dust) % 2 ? SHV_RIGID_BULLET : SHV_RIGID_ANALYTIC};
            int kept = 0, binned = 0;
            run_policy(&policy, &kept, &binned);
            /* what has a crack open wide is kept in any case */
            assert_true(kept > 0 || policy.deformation == SHV_DEFORMATION_DROP);
            assert_true((binned > 0) == (policy.dust == SHV_DUST_BIN));
        }
}

/* A rule that takes every impact for harmless, on a bar that falls at `speed`: what the audit of one impact finds. */
static ShvFrameView audit_one(double speed, int32_t wakes)
{
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].placement.velocity[2] = -speed;
    stage.scene.rigid.wake_fraction = 1e9;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.audit_wakes = wakes;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_create(&simulation, &stage.scene, &options, &error), error);
    bool woke = false;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++) {
            if (frame->events[i].kind != SHV_RUN_WAKE) continue;
            assert_int_equal(frame->events[i].reason, SHV_REASON_AUDIT);
            woke = true;
        }
    }
    assert_true(woke == (wakes > 0));
    const ShvFrameView last = *shv_simulation_frame(simulation);
    shv_simulation_destroy(simulation);
    return last;
}

static void test_audit_of_the_wake_rule(void **state)
{
    (void)state;
    const ShvFrameView breaks = audit_one(1.0, 1), holds = audit_one(0.05, 1), unasked = audit_one(1.0, 0);
    assert_int_equal(breaks.audited, 1);
    assert_int_equal(breaks.missed, 1);
    assert_int_equal(holds.audited, 1);
    assert_int_equal(holds.missed, 0);
    assert_int_equal(unasked.audited, 0);
    assert_int_equal(unasked.inserted, 0);
}

/* Two bars of which the second strikes while the first is cracking: no copy of a node is forgotten when the lists of what is
   awake are made anew, so that momentum obeys gravity and the floor, and the ledger closes. */
static void test_wake_beside_cracking(void **state)
{
    (void)state;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage_box(&stage, "second", (const double[3]){0.02, 0.02, 0.1}, 0.01, 0.05145)->placement.velocity[2] = -1.0;
    stage.objects[1].placement.position[0] = 0.1;
    stage.scene.duration = 0.003;
    stage.scene.rigid.time_step = 3e-3;
    stage.scene.output.rate = 1.0 / 3e-3;
    stay_awake(&stage);
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    int wakes = 0;
    double first_insertion = 1.0, second_wake = 0.0;
    for (int32_t i = 0; i < frame->event_count; i++) {
        const ShvEventView *event = &frame->events[i];
        if (event->kind == SHV_RUN_INSERTION) first_insertion = fmin(first_insertion, event->time);
        if (event->kind == SHV_RUN_WAKE) {
            wakes++;
            second_wake = event->time;
        }
    }
    assert_int_equal(wakes, 2);
    assert_true(first_insertion < second_wake);
    check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    shv_simulation_destroy(simulation);
}

static void test_same_bits(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.0045;
    const uint64_t hash = stage_hash(&stage);
    assert_true(stage_hash(&stage) == hash);
    for (int32_t threads = 2; threads <= 3; threads++) {
        stage.scene.threads = threads;
        assert_true(stage_hash(&stage) == hash);
    }
    stage.objects[0].placement.velocity[2] += 1e-12;
    assert_true(stage_hash(&stage) != hash);
}

/* How often frames are taken changes nothing but when pieces get their names (and so, when one of them may rest: here all stay
   awake). */
static void test_watching_changes_nothing(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stay_awake(&stage);
    stage.scene.duration = 0.006;
    ShvSimulation *plain = stage_start(&stage);
    const ShvLedgerView alone = stage_finish(plain)->ledger;
    stage.scene.output.fracture_every = 3;
    ShvSimulation *watched = stage_start(&stage);
    const ShvLedgerView seen = stage_finish(watched)->ledger;
    /* Sums over nodes go fragment by fragment: their order alone may differ. */
    check_near(seen.kinetic, alone.kinetic, 1e-12 * alone.kinetic);
    check_near(seen.strain, alone.strain, 1e-12 * alone.largest);
    check_near(seen.fracture_dissipation, alone.fracture_dissipation, 1e-12 * alone.largest);
    shv_simulation_destroy(plain);
    shv_simulation_destroy(watched);
}

typedef struct Asked {
    const ShvSimulation *simulation;
    int times, awake; /* asked; and of these times, with work ahead */
    double duration;
} Asked;

static bool ask(void *data)
{
    Asked *asked = data;
    if (!asked->simulation) return false;
    const ShvAwakeView view = shv_simulation_awake(asked->simulation);
    const ShvSimulationSummary summary = shv_simulation_summary(asked->simulation);
    assert_true(view.rest >= summary.time && view.rest <= asked->duration * (1.0 + 1e-12));
    assert_true(view.ahead >= 0.0 && view.ahead <= view.load * (view.rest - summary.time) * (1.0 + 1e-12));
    assert_int_equal(view.load > 0.0, summary.fracture);
    asked->times++;
    asked->awake += view.ahead > 0.0;
    return false;
}

/* Whoever asks what is awake, while it breaks and goes to rest, changes no bit. */
static void test_asking_changes_nothing(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    Asked asked = {.duration = stage.scene.duration};
    ShvSimulationOptions options = shv_simulation_options_default();
    options.stop = ask;
    options.stop_data = &asked;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_create(&simulation, &stage.scene, &options, &error), error);
    asked.simulation = simulation;
    const ShvFrameView *frame = stage_finish(simulation);
    assert_true(asked.times > 0 && asked.awake > 0 && frame->inserted > 0);
    assert_true(shv_simulation_hash(simulation) == stage_hash(&stage));
    shv_simulation_destroy(simulation);
}

/* A strength that rises in steps no greater than those of the stress is met within a tenth. */
static void test_checks_keep_up(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.006;
    ShvSimulation *simulation = stage_start(&stage);
    const double automatic = stage_finish(simulation)->worst_overshoot;
    assert_true(automatic >= 0.9 && automatic <= 1.1);
    shv_simulation_destroy(simulation);
}

typedef struct Outcome {
    double first; /* s: of the first insertion; infinite: none */
    int32_t inserted;
    ShvLedgerView ledger;
} Outcome;

static Outcome run(const Stage *stage)
{
    Outcome outcome = {.first = HUGE_VAL};
    ShvSimulation *simulation = stage_start(stage);
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++)
            if (frame->events[i].kind == SHV_RUN_INSERTION) outcome.first = fmin(outcome.first, frame->events[i].time);
        outcome.inserted = frame->inserted;
        outcome.ledger = frame->ledger;
        assert_true(isfinite(frame->ledger.kinetic + frame->ledger.strain + frame->ledger.residual));
    }
    shv_simulation_destroy(simulation);
    return outcome;
}

/* Rare checks find a crack later, and neither creates energy. */
static void test_check_interval(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.006;
    stage.scene.fracture.energy_bound = 1.0;
    stage.scene.fracture.check_every = 1;
    const Outcome often = run(&stage);
    stage.scene.fracture.check_every = 10;
    const Outcome rarely = run(&stage);
    assert_true(isfinite(often.first) && isfinite(rarely.first));
    assert_true(often.first <= rarely.first);
    const double given = 0.5 * 0.048 * 0.26 * 0.26 + 0.048 * 9.81 * 0.001;
    assert_true(often.ledger.fracture_dissipation <= given && rarely.ledger.fracture_dissipation <= given);
    assert_true(often.ledger.kinetic + often.ledger.strain <= 1.01 * given);
    assert_true(rarely.ledger.kinetic + rarely.ledger.strain <= 1.01 * given);
}

/* A body of ice that flies apart tears everywhere at once. Checks that wait for fronts to run, or that part one of neighbours alone, let
   it hold several times its strength, the longer the step the more, and take half of its motion as what closing faces lose. */
static void test_torn_all_over(void **state)
{
    (void)state;
    Outcome outcome[2];
    for (int finer = 0; finer < 2; finer++) {
        Stage stage;
        const double size[3] = {0.1, 0.1, 0.1};
        stage_make(&stage);
        ShvObjectDefinition *object = stage_box(&stage, "cube", size, 0.02, 0.0);
        for (int c = 0; c < 3; c++) object->placement.stretch_rate[c] = 50.0;
        stage.material.density = 917.0;
        stage.material.youngs_modulus = 9.33e9;
        stage.material.poissons_ratio = 0.325;
        stage.material.cohesive_strength = 1.5e6;
        stage.material.fracture_energy = 0.96;
        stage.material.unresolved = SHV_UNRESOLVED_TIP_STRENGTH;
        if (finer) stage.scene.fracture.safety = 0.3;
        stage.scene.duration = 60e-6;
        outcome[finer] = run(&stage);
    }
    assert_true(outcome[1].inserted > 500);
    check_near(outcome[0].ledger.kinetic / outcome[1].ledger.kinetic, 1.0, 0.04); /* 0.75 and 0.88 by such checks */
}

static void test_extreme_strength(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.006;
    stage.material.cohesive_strength = (double)INFINITY;
    assert_int_equal(run(&stage).inserted, 0);
    stage.material.cohesive_strength = 0.0;
    assert_true(run(&stage).inserted > 100);
}

static void test_extreme_fracture_energy(void **state)
{
    (void)state;
    Stage stage;
    make_gentle_break(&stage);
    stage.scene.duration = 0.006;
    stage.material.fracture_energy = 0.0;
    const Outcome brittle = run(&stage);
    assert_true(brittle.inserted > 0);
    check_near(brittle.ledger.fracture_dissipation, 0.0, 1e-12 * brittle.ledger.largest);
    stage.material.fracture_energy = 1e30;
    const Outcome tough = run(&stage);
    assert_true(tough.inserted > 0);
    assert_true(tough.ledger.failed_area == 0.0);
}

/* A slow touch is answered rigidly and in the end rests; the rule wakes by speed. */
static void test_wake_rule(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.01 + 1e-5);
    stage_floor(&stage)->friction = 0.3;
    stage.scene.duration = 0.2;
    /* From 10 µm: 14 mm/s, K ρ c₀ v = 0.4 of the strength; the level is 0.5. */
    assert_int_equal(run(&stage).inserted, 0);
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_int_equal(frame->steps, 0);
    check_near(frame->fragments[0].position[2], 0.01, 1e-6);
    check_near(frame->ledger.kinetic, 0.0, 1e-9);
    shv_simulation_destroy(simulation);
    stage.objects[0].placement.velocity[2] = -0.6;
    simulation = stage_start(&stage);
    assert_true(stage_finish(simulation)->steps > 0);
    shv_simulation_destroy(simulation);
}

/* What has broken, fallen and come to rest is left alone. */
static void test_rest_on_the_floor(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.011)->placement.velocity[2] = -0.6;
    stage_floor(&stage)->friction = 0.3;
    stage.scene.duration = 1.0; /* the last of the pieces turns over after 0.38 s */
    ShvSimulation *simulation = stage_start(&stage);
    int64_t half_way = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        if (frame->time <= 0.5) half_way = frame->steps;
    }
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    assert_true(half_way > 0);
    assert_int_equal(frame->steps, half_way);
    assert_false(frame->fracture);
    shv_simulation_destroy(simulation);
}

/* A body that lies on the floor from the start has no energy but rounding, which is no divergence. */
static void test_rest_from_the_start(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "cube", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.01);
    stage_floor(&stage);
    stage.scene.duration = 0.5;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_int_equal(frame->steps, 0);
    check_near(frame->fragments[0].position[2], 0.01, 1e-12);
    shv_simulation_destroy(simulation);
}

/* A free stone strikes a body: what one gives the other takes, at every time of the contact and with cracks. Cohesive tractions
   act on copies of nodes that are up to the final opening apart and need not lie on their line: that is the arm by which angular
   momentum may be off. */
static void test_momentum_with_a_free_body(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    stay_awake(&stage);
    stage_box(&stage, "cube", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.0);
    ShvObstacleDefinition *stone = stage_free_ball(&stage, "stone", 0.01, 0.01);
    stone->placement.position[0] = -0.05;
    stone->placement.position[1] = 0.002;
    stone->placement.velocity[0] = 0.7;
    memset(stage.scene.gravity, 0, sizeof stage.scene.gravity);
    stage.scene.duration = 0.065;
    stage.scene.output.fracture_every = 1;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvLedgerView start = stage_next(simulation)->ledger;
    const double momentum = 0.007, opening = 2.0 * stage.material.fracture_energy / stage.material.cohesive_strength;
    check_near(start.momentum[0], momentum, 1e-15);
    while (!shv_simulation_finished(simulation)) {
        const ShvLedgerView now = stage_next(simulation)->ledger;
        for (int k = 0; k < 3; k++) {
            check_near(now.momentum[k], start.momentum[k], 1e-12 * momentum);
            check_near(now.angular_momentum[k], start.angular_momentum[k], momentum * opening);
        }
        check_near(now.residual, 0.0, 1e-3 * now.largest);
    }
    assert_true(shv_simulation_frame(simulation)->inserted > 0);
    /* Slower than it would go on with a cube that sticks to it. */
    assert_true(shv_simulation_frame(simulation)->obstacles[0].velocity[0] < momentum / (0.01 + 0.0096));
    shv_simulation_destroy(simulation);
}

/* A tet of a random shape, stretched by up to 4 % and let go, for thousands of steps. */
static void vibrate_alone(uint64_t seed)
{
    static const double regular[12] = {0, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0, 1};
    static const int32_t tet[4] = {0, 1, 2, 3};
    double corners[12];
    for (uint64_t i = 0; i < 12; i++) corners[i] = 0.01 * (regular[i] + 0.5 * (shv_random_uniform(seed, i) - 0.5));
    Stage stage;
    stage_make(&stage);
    const double size[3] = {0.01, 0.01, 0.01};
    ShvObjectDefinition *object = stage_box(&stage, "tet", size, 0.01, 0.0);
    object->mesh.kind = SHV_MESH_MEMORY;
    object->mesh.positions = corners;
    object->mesh.tets = tet;
    object->mesh.node_count = 4;
    object->mesh.tet_count = 1;
    for (uint64_t i = 0; i < 3; i++)
        object->placement.stretch_rate[i] = 900.0 * (2.0 * shv_random_uniform(seed, 20 + i) - 1.0);
    stage.scene.gravity[2] = 0.0;
    stay_awake(&stage);
    stage.scene.fracture.energy_bound = 10.0; /* judged here */
    stage.scene.duration = 0.1;
    stage.scene.output.rate = 1000.0;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_next(simulation);
    const double start = frame->ledger.kinetic + frame->ledger.strain;
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        assert_true(frame->ledger.kinetic + frame->ledger.strain <= start);
    }
    assert_true(frame->fracture && frame->steps > 1000);
    shv_simulation_destroy(simulation);
}

/* Where tets are torn to nothing that a solid bears the step does not go to nothing with them: the run ends. */
static void test_torn_tet(void **state)
{
    (void)state;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *box = stage_box(&stage, "box", (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.0);
    for (int i = 0; i < 3; i++) box->placement.stretch_rate[i] = 1e7;
    stage.material.breakable = false;
    stage.scene.gravity[2] = 0.0;
    ShvSimulation *simulation = stage_start(&stage);
    ShvError error;
    ShvStatus status = SHV_OK;
    while (status == SHV_OK && !shv_simulation_finished(simulation))
        status = shv_simulation_advance(simulation, &error);
    assert_int_equal(status, SHV_DIVERGED);
    assert_non_null(strstr(error.message, "stretched beyond what a solid bears"));
    shv_simulation_destroy(simulation);
}

/* Central difference's resonance of third order feeds what has nobody to pass its shortest waves on to. */
static void test_lone_tet(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 30; seed++) vibrate_alone(seed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ledger_closes),
        cmocka_unit_test(test_genealogy),
        cmocka_unit_test(test_fracture_frames),
        cmocka_unit_test(test_mode_switches),
        cmocka_unit_test(test_audit_of_the_wake_rule),
        cmocka_unit_test(test_policies_of_rest),
        cmocka_unit_test(test_wake_beside_cracking),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_watching_changes_nothing),
        cmocka_unit_test(test_asking_changes_nothing),
        cmocka_unit_test(test_checks_keep_up),
        cmocka_unit_test(test_check_interval),
        cmocka_unit_test(test_torn_all_over),
        cmocka_unit_test(test_extreme_strength),
        cmocka_unit_test(test_extreme_fracture_energy),
        cmocka_unit_test(test_wake_rule),
        cmocka_unit_test(test_rest_on_the_floor),
        cmocka_unit_test(test_rest_from_the_start),
        cmocka_unit_test(test_momentum_with_a_free_body),
        cmocka_unit_test(test_torn_tet),
        cmocka_unit_test(test_lone_tet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
