/* The parts of the frame loop that a whole run does not show by itself. */
#include "coupling/stage.h"

#include <stdlib.h>

#include "coupling/hybrid.h"

static void start(ShvHybrid *hybrid, const Stage *stage)
{
    ShvError error = {SHV_OK, ""};
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
}

/* Until `inserted` facets have opened, a step at a time. */
static void advance_to_cracks(ShvHybrid *hybrid, int32_t inserted)
{
    ShvError error = {SHV_OK, ""};
    for (int step = 0; step < 2000 && hybrid->cohesive.count < inserted; step++) {
        int64_t taken = 0;
        check_ok(shv_hybrid_advance(hybrid, hybrid->scene->duration, 1, &taken, &error), error);
    }
    assert_true(hybrid->cohesive.count >= inserted);
}

/* Until some bond has failed that was the last of a piece. */
static void advance_to_split(ShvHybrid *hybrid)
{
    ShvError error = {SHV_OK, ""};
    const int32_t known = hybrid->fragments.count;
    for (int step = 0; step < 20000 && hybrid->fragments.count == known; step++) {
        int64_t taken = 0;
        check_ok(shv_hybrid_advance(hybrid, hybrid->scene->duration, 1, &taken, &error), error);
    }
    assert_true(hybrid->fragments.count > known);
}

/* Looking at a time makes a step that is not taken: positions, velocities, histories and obstacles stay as they are, bit by
   bit. Forces are those of the time afterwards, so that a second look changes nothing at all. */
static void test_observing_leaves_no_trace(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make_breaking_bar(&stage);
    ShvHybrid hybrid;
    start(&hybrid, &stage);
    advance_to_cracks(&hybrid, 20);
    ShvError error = {SHV_OK, ""};
    const size_t bytes = 3 * (size_t)hybrid.state.node_count * sizeof(double);
    double *displacement = malloc(bytes), *velocity = malloc(bytes);
    assert_non_null(displacement);
    assert_non_null(velocity);
    memcpy(displacement, hybrid.state.displacement, bytes);
    memcpy(velocity, hybrid.state.velocity, bytes);
    const double time = hybrid.state.time, last_step = hybrid.state.last_step;
    check_ok(shv_hybrid_observe(&hybrid, &error), error);
    assert_memory_equal(displacement, hybrid.state.displacement, bytes);
    assert_memory_equal(velocity, hybrid.state.velocity, bytes);
    assert_true(hybrid.state.time == time && hybrid.state.last_step == last_step);
    const ShvLedgerView balance = hybrid.observer.balance;
    const uint64_t hash = shv_state_hash(&hybrid.state);
    const size_t variables = 3 * (size_t)hybrid.cohesive.count * sizeof(ShvInternalVariables);
    ShvInternalVariables *internal = malloc(variables);
    assert_non_null(internal);
    memcpy(internal, hybrid.cohesive.internal, variables);
    check_ok(shv_hybrid_observe(&hybrid, &error), error);
    assert_true(shv_state_hash(&hybrid.state) == hash);
    assert_memory_equal(internal, hybrid.cohesive.internal, variables);
    assert_memory_equal(&balance, &hybrid.observer.balance, sizeof balance);
    free(displacement);
    free(velocity);
    free(internal);
    shv_hybrid_release(&hybrid);
}

/* The sum of its elements' masses in their order is a fragment's mass, bit by bit; the elements of all children are those of the
   parent, so that nothing is lost or made by a split. */
static void check_fragment(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double mass = 0.0;
    for (int32_t k = 0; k < fragment->element_count; k++) {
        const int32_t element = hybrid->fragments.elements[fragment->element_begin + k];
        assert_int_equal(hybrid->state.element_fragment[element], fragment->id);
        if (k > 0) assert_true(element > hybrid->fragments.elements[fragment->element_begin + k - 1]);
        mass += hybrid->state.element_mass[element];
    }
    assert_true(mass == fragment->mass);
}

static void test_split(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make_breaking_bar(&stage);
    ShvHybrid hybrid;
    start(&hybrid, &stage);
    const int32_t known = hybrid.fragments.count;
    advance_to_cracks(&hybrid, 40);
    assert_int_equal(hybrid.fragments.count, known); /* inserting splits nothing */
    advance_to_split(&hybrid);
    int32_t elements = 0, nodes = 0, splits = 0;
    for (int32_t i = 0; i < hybrid.log.count; i++) splits += hybrid.log.items[i].kind == SHV_RUN_SPLIT;
    assert_true(splits > 0);
    for (int32_t i = 0; i < hybrid.fragments.count; i++) {
        const ShvFragment *fragment = &hybrid.fragments.items[i];
        assert_int_equal(fragment->id, i);
        if (fragment->parent >= 0) assert_true(hybrid.fragments.items[fragment->parent].death == fragment->birth);
        if (fragment->mode == SHV_MODE_DEAD) continue;
        check_fragment(&hybrid, fragment);
        elements += fragment->element_count;
        nodes += fragment->node_count;
    }
    assert_int_equal(elements, hybrid.state.element_count);
    assert_int_equal(nodes, hybrid.state.node_count);
    /* Copies of nodes share what the node had: in extended precision, as the sums themselves round. */
    long double of_nodes = 0.0L, of_elements = 0.0L;
    for (int32_t i = 0; i < hybrid.state.node_count; i++) of_nodes += (long double)hybrid.state.mass[i];
    for (int32_t e = 0; e < hybrid.state.element_count; e++) of_elements += (long double)hybrid.state.element_mass[e];
    check_near((double)(of_nodes - of_elements), 0.0, 1e-14 * (double)of_elements);
    /* Everything awake is listed once. */
    assert_int_equal(hybrid.awake.node_count, hybrid.state.node_count);
    shv_hybrid_release(&hybrid);
}

/* A fresh clock looks at each step; while nothing grows it looks more and more rarely, up to every tenth; growth that would
   pass the strength before the next look brings it forward. */
static void test_clock(void **unused)
{
    (void)unused;
    ShvCheckClock clock;
    shv_check_clock_start(&clock);
    assert_int_equal(clock.due, 1);
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].placement.velocity[2] = -0.1; /* half of the strength at most: nothing opens */
    stage.scene.rigid.wake = SHV_WAKE_CONTACT;
    stage.scene.fracture.quiet_checks = 1000000;
    ShvHybrid hybrid;
    start(&hybrid, &stage);
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    while (hybrid.awake.count == 0)
        check_ok(shv_hybrid_advance(&hybrid, hybrid.state.time + 1e-3, 1, &taken, &error), error);
    int32_t rarest = 0;
    for (int step = 0; step < 300; step++) {
        check_ok(shv_hybrid_advance(&hybrid, 1.0, 1, &taken, &error), error);
        assert_true(hybrid.check.clock.due >= 1 && hybrid.check.clock.due <= 10);
        if (step < 5) assert_int_equal(hybrid.check.clock.due, 1);
        if (hybrid.check.clock.due > 1)
            assert_true(hybrid.check.clock.last + (hybrid.check.clock.due - 1) * hybrid.check.clock.rate <=
                        1.05 * stage.scene.fracture.threshold);
        rarest = hybrid.check.clock.due > rarest ? hybrid.check.clock.due : rarest;
    }
    assert_int_equal(hybrid.cohesive.count, 0);
    assert_int_equal(rarest, 10);
    shv_hybrid_release(&hybrid);
}

static void test_given_interval(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].placement.velocity[2] = -0.1;
    stage.scene.rigid.wake = SHV_WAKE_CONTACT;
    stage.scene.fracture.check_every = 7;
    ShvHybrid hybrid;
    start(&hybrid, &stage);
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    while (hybrid.state.step < 2)
        check_ok(shv_hybrid_advance(&hybrid, hybrid.state.time + 1e-3, 1, &taken, &error), error);
    for (int step = 0; step < 30; step++) {
        assert_int_equal(hybrid.check.clock.due, 7);
        assert_int_equal(hybrid.check.clock.since, (hybrid.state.step - 1) % 7);
        check_ok(shv_hybrid_advance(&hybrid, 1.0, 1, &taken, &error), error);
    }
    shv_hybrid_release(&hybrid);
}

/* A contact is as good a reason at any time, but under Bullet a body is not asked twice within a rigid step of its last wake. */
static void test_contact_wakes_once_a_rigid_step(void **unused)
{
    (void)unused;
    const ShvRigidEngine engines[] = {SHV_RIGID_BULLET, SHV_RIGID_ANALYTIC};
    for (int i = 0; i < 2; i++) {
        Stage stage;
        stage_make_breaking_bar(&stage);
        stage.scene.rigid.engine = engines[i];
        stage.scene.rigid.wake = SHV_WAKE_CONTACT;
        ShvHybrid hybrid;
        start(&hybrid, &stage);
        ShvFragment *fragment = &hybrid.fragments.items[0];
        const double step = stage.scene.rigid.time_step;
        ShvRigidContact contact = {
            .fragment = 0, .obstacle = 0, .other = -1, .fresh = 1, .other_mass = (double)INFINITY};
        contact.time = 0.5 * step;
        assert_true(shv_hybrid_judge(&hybrid, &contact)); /* it has never been awake */
        fragment->wake_energy = 1.0;
        fragment->last_insertion = 0.4 * step;
        assert_int_equal(shv_hybrid_judge(&hybrid, &contact), engines[i] != SHV_RIGID_BULLET);
        contact.time = 1.5 * step;
        assert_true(shv_hybrid_judge(&hybrid, &contact));
        shv_hybrid_release(&hybrid);
    }
}

/* A ball that bounces, and one a metre beside it that may fly: one interval of flight. Returns the steps of fracture mode that it took. */
static int64_t bounce_once(bool beside, ShvFragment *ball)
{
    Stage stage;
    stage_make(&stage);
    for (int k = 0; k < (beside ? 2 : 1); k++) {
        ShvObjectDefinition *object =
            stage_box(&stage, k == 0 ? "ball" : "other", (const double[3]){0, 0, 0}, 0.005, 0.011 + k);
        object->mesh.kind = SHV_MESH_BALL;
        object->mesh.radius = 0.01;
        if (k == 0) object->placement.velocity[2] = -1.0;
    }
    stage_floor(&stage);
    stage.scene.rigid.time_step = stage.scene.duration = 0.05;
    stage.scene.gravity[2] = 0.0;
    stage.scene.fracture.threshold = 1e3; /* it wakes, but nothing breaks */
    ShvHybrid hybrid;
    ShvError error = {SHV_OK, ""};
    int64_t taken = 0;
    start(&hybrid, &stage);
    check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration, 0, &taken, &error), error);
    *ball = hybrid.fragments.items[0];
    assert_int_equal(ball->mode, SHV_MODE_FLIGHT);
    shv_hybrid_release(&hybrid);
    return taken;
}

/* For a body that is all that moves nobody has flown: it rests as soon as it may, and flies the rest of the interval, to where it comes
   in the end when it waits. */
static void test_a_body_alone_rests_within_an_interval(void **unused)
{
    (void)unused;
    ShvFragment alone, beside;
    const int64_t steps = bounce_once(false, &alone), all = bounce_once(true, &beside);
    assert_true(steps > 0 && 5 * steps < all);
    assert_true(beside.velocity.z > 0.5);
    check_near(alone.velocity.z, beside.velocity.z, 1e-3);
    check_near(alone.position.z, beside.position.z, 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_observing_leaves_no_trace),
        cmocka_unit_test(test_split),
        cmocka_unit_test(test_clock),
        cmocka_unit_test(test_given_interval),
        cmocka_unit_test(test_contact_wakes_once_a_rigid_step),
        cmocka_unit_test(test_a_body_alone_rests_within_an_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
