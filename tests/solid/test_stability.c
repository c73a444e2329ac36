/* Central difference over many steps: bounded below the stable step, growing above it, waves at their speed. */
#include "block.h"

static const double no_gravity[3] = {0.0, 0.0, 0.0};

static void advance(Block *block, double kick, double step)
{
    block_force(block);
    shv_motion_kick(&block->state, NULL, 0, kick, no_gravity, block->model.threads);
    shv_motion_drift(&block->state, NULL, 0, step, block->model.threads);
}

/* Kinetic energy at time n from the velocities before and after, which the linear scheme conserves with the strain
   energy exactly: Σ ½ m v₋·v₊. The force and v₊ are those of time n; v₋ = v₊ − step × f/m. Call between kick and
   drift. */
static double energy_at(const Block *block, double step)
{
    const ShvState *state = &block->state;
    double kinetic = 0.0;
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++)
        kinetic += 0.5 * state->velocity[i] * (state->mass[i / 3] * state->velocity[i] - step * state->force[i]);
    return kinetic + shv_solid_strain_energy(&block->solid, state);
}

static double step_and_energy(Block *block, double step)
{
    block_force(block);
    shv_motion_kick(&block->state, NULL, 0, step, no_gravity, 1);
    const double energy = energy_at(block, step);
    shv_motion_drift(&block->state, NULL, 0, step, 1);
    return energy;
}

/* Strains near 1e-4: quadratic terms of the strain change the energy by about that share, up and down, and no more
   in the last tenth of the steps than in the first. */
static void check_bounded(ShvKinematics kinematics, int32_t steps)
{
    Block block;
    BlockShape shape = block_shape(2, 2, 2);
    shape.kinematics = kinematics;
    block_create(&block, &shape);
    block_shake(&block, 3e-5 * shape.edge, 31);
    const double step = 0.9 * shv_solid_stable_step(&block.solid, NULL);
    advance(&block, 0.5 * step, step);
    const double start = step_and_energy(&block, step);
    double early = 0.0, late = 0.0;
    for (int32_t i = 0; i < steps; i++) {
        const double error = fabs(step_and_energy(&block, step) / start - 1.0);
        if (i < steps / 10) early = fmax(early, error);
        if (i >= steps - steps / 10) late = fmax(late, error);
    }
    check_near(early, 0.0, 1e-3);
    check_near(late, 0.0, 2.0 * early);
    block_release(&block);
}

static void energy_is_bounded_below_the_stable_step(void **unused)
{
    (void)unused;
    check_bounded(SHV_GREEN_STRAIN, 100000);
    check_bounded(SHV_COROTATIONAL, 20000);
}

/* Largest ω of the assembly by power iteration on the internal force at tiny displacements: from below, and within
   1e-3 when the last thousand steps changed it by less than 1e-6. */
static double largest_frequency(Block *block, double size)
{
    enum { ITERATIONS = 4000 };
    ShvState *state = &block->state;
    const int64_t count = 3 * (int64_t)state->node_count;
    double square = 0.0, before = 0.0;
    block_shake(block, size, 41);
    for (int k = 0; k < ITERATIONS; k++) {
        block_force(block);
        double largest = 0.0, up = 0.0, down = 0.0;
        for (int64_t i = 0; i < count; i++) {
            up -= state->displacement[i] * state->force[i];
            down += state->mass[i / 3] * state->displacement[i] * state->displacement[i];
            state->displacement[i] = -state->force[i] / state->mass[i / 3];
            largest = fmax(largest, fabs(state->displacement[i]));
        }
        for (int64_t i = 0; i < count; i++) state->displacement[i] *= size / largest;
        square = up / down;
        if (k == ITERATIONS - 1000) before = square;
    }
    check_near(square / before, 1.0, 1e-6);
    return sqrt(square);
}

/* Growth of the largest displacement over some steps, from a state of size `size` where all modes take part. */
static double growth(Block *block, double size, double step, int steps)
{
    ShvState *state = &block->state;
    block_shake(block, size, 42);
    memset(state->velocity, 0, 3 * (size_t)state->node_count * sizeof(double));
    for (int i = 0; i < steps; i++) advance(block, i ? step : 0.5 * step, step);
    double largest = 0.0;
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++) largest = fmax(largest, fabs(state->displacement[i]));
    return largest / size;
}

/* A mode with ω dt = 2s grows by r a step, r + 1/r = 4s² − 2: r = 1.33 at s = 1.01 (60 steps: 2e7), 1.88 at 1.05 (30
   steps: 1e8), of which the mode's share of the start, above 1e-3, is left. Below 1 every mode keeps to 1/√(1−s²) of
   its start, 7.1 at 0.99, so that Σ m u² keeps to 7.1² of its start and no component to more than
   7.1 √(3 Σm / its m). */
static void motion_grows_above_the_assembled_limit_only(void **unused)
{
    (void)unused;
    Block block;
    BlockShape shape = block_shape(3, 3, 3);
    block_create(&block, &shape);
    const double size = 1e-10 * shape.edge, limit = 2.0 / largest_frequency(&block, size);
    assert_true(limit >= shv_solid_stable_step(&block.solid, NULL));
    double mass = 0.0, lightest = (double)INFINITY;
    for (int32_t i = 0; i < block.state.node_count; i++) {
        mass += block.state.mass[i];
        lightest = fmin(lightest, block.state.mass[i]);
    }
    check_near(growth(&block, size, 0.99 * limit, 2000), 0.0, 7.1 * sqrt(3.0 * mass / lightest));
    assert_true(growth(&block, size, 1.01 * limit, 60) > 1e4);
    assert_true(growth(&block, size, 1.05 * limit, 30) > 1e5);
    block_release(&block);
}

/* The first longitudinal mode of a free bar without Poisson effect: u = A cos(πx/L), ω = πc/L. Its amplitude crosses
   zero after a quarter period. Elements of n to the length are off by (π/n)²/24 along the bar, and lumping that is
   not even across it adds as much again. */
static double quarter_period_error(int32_t cells)
{
    Block block;
    BlockShape shape = block_shape(cells, 2, 2);
    shape.poissons_ratio = 0.0;
    shape.jitter = 0.0;
    shape.edge = 1.0 / cells;
    block_create(&block, &shape);
    ShvState *state = &block.state;
    const double pi = 3.141592653589793, speed = block.model.materials[0].bar_speed;
    for (int32_t i = 0; i < state->node_count; i++)
        state->displacement[3 * (int64_t)i] = 1e-7 * cos(pi * state->reference[3 * (int64_t)i]);
    const double step = 0.2 * shv_solid_stable_step(&block.solid, NULL);
    double before = 1.0, amplitude = 1.0, time = 0.0;
    for (int i = 0; amplitude > 0.0; i++) {
        advance(&block, i ? step : 0.5 * step, step);
        before = amplitude;
        amplitude = 0.0;
        for (int32_t k = 0; k < state->node_count; k++)
            amplitude +=
                state->mass[k] * state->displacement[3 * (int64_t)k] * cos(pi * state->reference[3 * (int64_t)k]);
        time += step;
    }
    time -= step * amplitude / (amplitude - before);
    block_release(&block);
    return time * speed / 0.5 - 1.0;
}

static void waves_travel_at_their_speed(void **unused)
{
    (void)unused;
    const double coarse = quarter_period_error(10), fine = quarter_period_error(20);
    const double expected = 9.869604401089358 / 24.0 / 400.0;
    check_near(fine, 0.0, 2.0 * expected);
    check_near(coarse / fine, 4.0, 0.8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energy_is_bounded_below_the_stable_step),
        cmocka_unit_test(motion_grows_above_the_assembled_limit_only),
        cmocka_unit_test(waves_travel_at_their_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
