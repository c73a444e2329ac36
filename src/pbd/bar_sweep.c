#include "pbd/bar_kernel.h"
#include "pbd/bars.h"

static void sweep_chunk(const ShvBars *bars, const ShvBarChunk *chunk, double stiffness, const double *anchors,
                        double *shifts)
{
    const ShvWide k = shv_wide_set1(stiffness);
    const int32_t last = chunk->first + chunk->count;
    if (bars->form == SHV_BARS_EDGE)
        for (int64_t b = chunk->first; b < last; b++)
            shv_bar_batch(k, bars->ends + b * (2 * SHV_LANES), bars->rest + b * SHV_LANES, anchors, shifts);
    else
        for (int64_t b = chunk->first; b < last; b++)
            shv_tet_batch(k, bars->ends + b * (4 * SHV_LANES), bars->rest + b * (6 * SHV_LANES), anchors, shifts);
}

void shv_bars_sweep(const ShvBars *bars, double stiffness, const double *anchors, double *shifts)
{
#pragma omp parallel num_threads(bars->model->threads) if (bars->model->threads > 1)
    for (int32_t colour = 0; colour < bars->colour_count; colour++) {
#pragma omp for schedule(dynamic, 4)
        for (int32_t i = bars->colour_start[colour]; i < bars->colour_start[colour + 1]; i++)
            sweep_chunk(bars, &bars->chunks[bars->chunk_order[i]], stiffness, anchors, shifts);
    }
}

static double largest_lane(ShvWide wide)
{
    _Alignas(64) double lanes[SHV_WIDE_LANES];
    shv_wide_store(lanes, wide);
    double largest = 0.0;
    for (int i = 0; i < SHV_WIDE_LANES; i++) largest = fmax(largest, lanes[i]);
    return largest;
}

/* |length − rest|/rest of one edge of eight items, from the excess; zero where the rest length is. */
static ShvWide strain_of(const ShvBars *bars, int64_t batch, int edge, const double *anchors, const double *shifts)
{
    const int32_t *ends = bars->ends + batch * bars->corners * SHV_LANES;
    const ShvWide rest = shv_wide_load(bars->rest + (batch * bars->edges + edge) * SHV_LANES);
    ShvWide anchor[2][4], shift[2][4];
    for (int end = 0; end < 2; end++) {
        shv_wide_load_quads(anchors, ends + shv_tet_edges[edge][end] * SHV_LANES, anchor[end]);
        shv_wide_load_quads(shifts, ends + shv_tet_edges[edge][end] * SHV_LANES, shift[end]);
    }
    const ShvBarShape shape = shv_bar_shape(anchor[0], anchor[1], shift[0], shift[1]);
    const ShvWide divisor = shv_wide_mul(rest, shv_wide_add(shape.length, rest));
    const ShvWide strain = shv_wide_div(shape.excess, divisor), zero = shv_wide_zero();
    return shv_wide_select(shv_wide_less(zero, divisor), shv_wide_max(strain, shv_wide_sub(zero, strain)), zero);
}

static double strain_of_chunk(const ShvBars *bars, const ShvBarChunk *chunk, const double *anchors,
                              const double *shifts)
{
    ShvWide largest = shv_wide_zero();
    for (int64_t b = chunk->first; b < chunk->first + chunk->count; b++)
        for (int edge = 0; edge < bars->edges; edge++)
            largest = shv_wide_max(strain_of(bars, b, edge, anchors, shifts), largest);
    return largest_lane(largest);
}

double shv_bars_largest_strain(const ShvBars *bars, const double *anchors, const double *shifts)
{
    double largest = 0.0;
#pragma omp parallel for num_threads(bars->model->threads) if (bars->model->threads > 1) reduction(max : largest)
    for (int32_t i = 0; i < bars->chunk_count; i++)
        largest = fmax(largest, strain_of_chunk(bars, &bars->chunks[i], anchors, shifts));
    return largest;
}
