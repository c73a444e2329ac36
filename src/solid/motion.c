#include "solid/motion.h"

/* Partial sums are cut by the number of nodes alone, so that their order never depends on the threads. */
enum { POWER_BLOCKS = 64 };

/* Below this many nodes, starting threads costs more than they save. */
enum { FEWEST_PARALLEL_NODES = 4096 };

static int32_t listed(const ShvState *state, const int32_t *nodes, int32_t count)
{
    return nodes ? count : state->node_count;
}

static inline int64_t component(const int32_t *nodes, int32_t i)
{
    return 3 * (int64_t)(nodes ? nodes[i] : i);
}

void shv_motion_clear_force(ShvState *state, const int32_t *nodes, int32_t count, int32_t threads)
{
    const int32_t total = listed(state, nodes, count);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && total >= FEWEST_PARALLEL_NODES)
    for (int32_t i = 0; i < total; i++)
        for (int c = 0; c < 3; c++) state->force[component(nodes, i) + c] = 0.0;
}

void shv_motion_kick(ShvState *state, const int32_t *nodes, int32_t count, double kick, const double gravity[3],
                     int32_t threads)
{
    const int32_t total = listed(state, nodes, count);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && total >= FEWEST_PARALLEL_NODES)
    for (int32_t i = 0; i < total; i++) {
        const int64_t k = component(nodes, i);
        const double inverse_mass = 1.0 / state->mass[k / 3];
        for (int c = 0; c < 3; c++) state->velocity[k + c] += kick * (state->force[k + c] * inverse_mass + gravity[c]);
    }
}

void shv_motion_drift(ShvState *state, const int32_t *nodes, int32_t count, double step, int32_t threads)
{
    const int32_t total = listed(state, nodes, count);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && total >= FEWEST_PARALLEL_NODES)
    for (int32_t i = 0; i < total; i++) {
        const int64_t k = component(nodes, i);
        for (int c = 0; c < 3; c++) state->displacement[k + c] += step * state->velocity[k + c];
    }
}

static double block_power(const ShvState *state, const double *force, const int32_t *nodes, int32_t begin, int32_t end)
{
    double sum = 0.0;
    for (int32_t i = begin; i < end; i++) {
        const int64_t k = component(nodes, i);
        for (int c = 0; c < 3; c++) sum += force[k + c] * state->velocity[k + c];
    }
    return sum;
}

double shv_motion_power(const ShvState *state, const double *force, const int32_t *nodes, int32_t count,
                        int32_t threads)
{
    double partial[POWER_BLOCKS];
    const int64_t total = listed(state, nodes, count);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && total >= FEWEST_PARALLEL_NODES)
    for (int block = 0; block < POWER_BLOCKS; block++)
        partial[block] = block_power(state, force, nodes, (int32_t)(total * block / POWER_BLOCKS),
                                     (int32_t)(total * (block + 1) / POWER_BLOCKS));
    double sum = 0.0;
    for (int block = 0; block < POWER_BLOCKS; block++) sum += partial[block];
    return sum;
}
