#include "solid/kernel.h"

/* One chunk, its batches in order. */
static void add_chunk(const ShvSolid *solid, ShvState *state, int32_t chunk)
{
    const int32_t begin = chunk * solid->chunk_batches;
    const int32_t end =
        begin + solid->chunk_batches < solid->batch_count ? begin + solid->chunk_batches : solid->batch_count;
    for (int32_t batch = begin; batch < end; batch++)
        if (solid->batch_active[batch]) shv_batch_add_force(solid, state, batch);
}

void shv_solid_add_internal_force(const ShvSolid *solid, ShvState *state)
{
#pragma omp parallel num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t colour = 0; colour < solid->colour_count; colour++) {
        /* The end of this loop waits for all threads: colours run one after another. */
#pragma omp for schedule(static)
        for (int32_t i = solid->colour_start[colour]; i < solid->colour_start[colour + 1]; i++)
            add_chunk(solid, state, solid->chunk_order[i]);
    }
}
