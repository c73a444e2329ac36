#include "solid/domain.h"
#include "solid/kernel.h"

void shv_solid_stress(const ShvSolid *solid, const ShvState *state, double *stress)
{
    shv_solid_smooth(solid, state);
#pragma omp parallel for schedule(static) num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t batch = 0; batch < solid->batch_count; batch++)
        if (solid->batch_active[batch])
            shv_batch_cauchy(solid, state, batch, stress + (int64_t)batch * (6 * SHV_LANES));
}

void shv_solid_stress_of(const ShvSolid *solid, const ShvState *state, const int32_t *batches, int32_t count,
                         double *stress)
{
#pragma omp parallel for schedule(static) num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t k = 0; k < count; k++)
        shv_batch_cauchy(solid, state, batches[k], stress + (int64_t)batches[k] * (6 * SHV_LANES));
}

void shv_solid_batch_stress(const ShvSolid *solid, const ShvState *state, int32_t batch, double *stress)
{
    shv_smoothing_find_batch(solid, state, batch);
    shv_batch_cauchy(solid, state, batch, stress);
}

void shv_solid_nodal_stress(const ShvSolid *solid, const ShvState *state, const double *stress, int32_t node,
                            double voigt[6])
{
    double sum[6] = {0.0}, volume = 0.0;
    const int32_t *corners = state->corners + state->corner_start[node];
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = corners[i] / 4;
        const double own = solid->volumes[element];
        for (int c = 0; c < 6; c++) sum[c] += own * stress[shv_stress_slot(element, c)];
        volume += own;
    }
    for (int c = 0; c < 6; c++) voigt[c] = sum[c] / volume;
}

static int32_t inverted_in_batch(const ShvSolid *solid, const ShvState *state, int32_t batch, int32_t *first)
{
    _Alignas(64) double ratio[SHV_LANES];
    ShvWide h[3][3];
    shv_batch_displacement_gradient(solid, state, batch, h);
    shv_wide_store(ratio, shv_wide_volume_ratio(h));
    int32_t count = 0;
    for (int lane = SHV_LANES - 1; lane >= 0; lane--) {
        const int32_t element = batch * SHV_LANES + lane;
        if (element >= state->element_count || ratio[lane] > 0.0) continue;
        count++;
        *first = element;
    }
    return count;
}

int32_t shv_solid_inverted(const ShvSolid *solid, const ShvState *state, int32_t *first)
{
    int32_t count = 0, lowest = INT32_MAX;
#pragma omp parallel for schedule(static) reduction(+ : count) reduction(min : lowest)                                 \
    num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t batch = 0; batch < solid->batch_count; batch++) {
        if (!solid->batch_active[batch]) continue;
        int32_t own = INT32_MAX;
        count += inverted_in_batch(solid, state, batch, &own);
        if (own < lowest) lowest = own;
    }
    *first = count > 0 ? lowest : -1;
    return count;
}
