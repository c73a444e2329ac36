#include "solid/domain.h"
#include "solid/kernel.h"

/* Partial sums are cut by the number of batches alone, so that their order never depends on the threads. */
enum { ENERGY_BLOCKS = 64 };

static double block_energy(const ShvSolid *solid, const ShvState *state, int32_t begin, int32_t end)
{
    _Alignas(64) double lanes[SHV_LANES];
    double sum = 0.0;
    for (int32_t batch = begin; batch < end; batch++) {
        if (!solid->batch_active[batch]) continue;
        shv_wide_store(lanes, shv_batch_energy(solid, state, batch));
        for (int lane = 0; lane < SHV_LANES; lane++) sum += lanes[lane];
    }
    return sum;
}

double shv_solid_strain_energy(const ShvSolid *solid, const ShvState *state)
{
    double partial[ENERGY_BLOCKS];
    const int64_t batches = solid->batch_count;
    shv_smoothing_find_energy(solid, state);
#pragma omp parallel for schedule(static) num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int block = 0; block < ENERGY_BLOCKS; block++)
        partial[block] = block_energy(solid, state, (int32_t)(batches * block / ENERGY_BLOCKS),
                                      (int32_t)(batches * (block + 1) / ENERGY_BLOCKS));
    double sum = 0.0;
    for (int block = 0; block < ENERGY_BLOCKS; block++) sum += partial[block];
    return sum;
}

static double energy_of(const ShvSolid *solid, const ShvState *state, int32_t element)
{
    _Alignas(64) double lanes[SHV_LANES];
    shv_wide_store(lanes, shv_batch_energy(solid, state, element / SHV_LANES));
    return lanes[element % SHV_LANES];
}

double shv_solid_element_energy(const ShvSolid *solid, const ShvState *state, int32_t element)
{
    shv_smoothing_find_batch(solid, state, element / SHV_LANES);
    return energy_of(solid, state, element);
}

double shv_solid_energy_of(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count)
{
    double sum = 0.0;
    shv_smoothing_find_body(solid, state, elements, count);
    for (int32_t k = 0; k < count; k++) sum += energy_of(solid, state, elements[k]);
    return sum;
}
