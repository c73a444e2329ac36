/* Fracture mode with bars while cohesive facets are open: which edges are bars, what the tractions answer, and what both leave
   of momentum and energy. */
#include "coupling/stage.h"

#include <stdlib.h>

#include "coupling/hybrid.h"

/* A bar that strikes the floor, half a dozen steps after `inserted` facets have opened. */
static void start(ShvHybrid *hybrid, Stage *stage, ShvBarForm form, int32_t inserted)
{
    ShvError error = {SHV_OK, ""};
    stage_make_breaking_bar(stage);
    stage->scene.fracture.stabiliser = SHV_STABILISER_BARS;
    stage->scene.fracture.energy_bound = 1e3;
    stage->scene.pbd.form = form;
    stage->scene.pbd.stiffness = 0.2;
    stage->scene.pbd.iterations = 2;
    check_ok(shv_hybrid_create(hybrid, NULL, &stage->scene, NULL, &error), error);
    int64_t taken = 0;
    for (int step = 0; step < 2000 && hybrid->cohesive.count < inserted; step++)
        check_ok(shv_hybrid_advance(hybrid, hybrid->scene->duration, 1, &taken, &error), error);
    assert_true(hybrid->cohesive.count >= inserted);
    check_ok(shv_hybrid_advance(hybrid, hybrid->scene->duration, 6, &taken, &error), error);
}

static int compare(const void *a, const void *b)
{
    const int64_t first = *(const int64_t *)a, second = *(const int64_t *)b;
    return (first > second) - (first < second);
}

/* Edges of all tets by their present nodes, once each. */
static int64_t count_edges(const ShvState *state)
{
    static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    const int64_t count = 6 * (int64_t)state->element_count;
    int64_t *keys = malloc((size_t)count * sizeof *keys), unique = 0;
    assert_non_null(keys);
    for (int64_t i = 0; i < count; i++) {
        const int64_t a = shv_state_node(state, (int32_t)(i / 6), ends[i % 6][0]);
        const int64_t b = shv_state_node(state, (int32_t)(i / 6), ends[i % 6][1]);
        keys[i] = a < b ? a * state->node_count + b : b * state->node_count + a;
    }
    qsort(keys, (size_t)count, sizeof *keys, compare);
    for (int64_t i = 0; i < count; i++) unique += i == 0 || keys[i] != keys[i - 1];
    free(keys);
    return unique;
}

/* A crack face has edges of its own: bars follow every duplication, and none joins the two sides of a facet. */
static void bars_follow_the_cracks(void **unused)
{
    (void)unused;
    for (int form = 0; form < 2; form++) {
        Stage stage;
        ShvHybrid hybrid;
        start(&hybrid, &stage, form ? SHV_BARS_ELEMENT : SHV_BARS_EDGE, 20);
        const int32_t nodes = hybrid.model.mesh.node_count;
        assert_true(hybrid.state.node_count > nodes);
        assert_int_equal(hybrid.stabiliser.bars.bar_count,
                         form ? 6 * (int64_t)hybrid.state.element_count : count_edges(&hybrid.state));
        shv_hybrid_release(&hybrid);
    }
}

static void sum_momenta(const ShvState *state, ShvVec3 *momentum, ShvVec3 *angular)
{
    *momentum = *angular = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = 0; i < state->node_count; i++) {
        const ShvVec3 p = shv_scale(shv_load3(state->velocity + 3 * (int64_t)i), state->mass[i]);
        *momentum = shv_add(*momentum, p);
        *angular = shv_add(*angular, shv_cross(shv_state_position(state, i), p));
    }
}

/* Lifted off the floor, without gravity, facets open: forces, tractions and bars are all internal. Tractions act on copies that
   are up to the final opening apart, which is the arm by which angular momentum may be off. */
static void internal_forces_keep_momentum(void **unused)
{
    (void)unused;
    Stage stage;
    ShvHybrid hybrid;
    start(&hybrid, &stage, SHV_BARS_EDGE, 20);
    ShvState *state = &hybrid.state;
    memset(hybrid.gravity, 0, sizeof hybrid.gravity);
    for (int32_t i = 0; i < state->node_count; i++) {
        state->displacement[3 * i + 2] += 0.01;
        state->velocity[3 * i + 2] += 1.0;
    }
    shv_surface_contact_invalidate(&hybrid.coupling.surface);
    const double opening = 2.0 * stage.material.fracture_energy / stage.material.cohesive_strength;
    double scale = 0.0;
    for (int32_t i = 0; i < state->node_count; i++)
        scale += state->mass[i] * shv_norm(shv_load3(state->velocity + 3 * (int64_t)i));
    /* Velocities gain differences of displacements of some 0.02 m over the step. */
    const double rounding = 0.048 * 0.02 * 2.2e-16 / hybrid.steps.last;
    ShvVec3 momentum, angular;
    sum_momenta(state, &momentum, &angular);
    for (int step = 0; step < 30; step++) {
        ShvError error = {SHV_OK, ""};
        int64_t taken = 0;
        const double booked = hybrid.observer.ledger.booked[SHV_WORK_COHESIVE];
        check_ok(shv_hybrid_advance(&hybrid, stage.scene.duration, 1, &taken, &error), error);
        assert_int_equal(taken, 1);
        assert_int_equal(hybrid.stabiliser.relax.touching, 0);
        assert_true(hybrid.stabiliser.relax.work.bars[0] != 0.0);
        assert_true(hybrid.observer.ledger.booked[SHV_WORK_COHESIVE] != booked);
        ShvVec3 now, turned;
        sum_momenta(state, &now, &turned);
        check_near(shv_norm(shv_sub(now, momentum)), 0.0, (step + 1) * rounding);
        check_near(shv_norm(shv_sub(turned, angular)), 0.0, scale * opening);
    }
    shv_hybrid_release(&hybrid);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bars_follow_the_cracks),
        cmocka_unit_test(internal_forces_keep_momentum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
