#include "pbd/bar_kernel.h"
#include "pbd/bars.h"

static bool has_pinned(const int32_t *ends, int corners, const double *anchors)
{
    for (int i = 0; i < corners * SHV_LANES; i++)
        if (!(anchors[4 * (int64_t)ends[i] + 3] > 0.0)) return true;
    return false;
}

/* A bar pushes its ends by −f e and f e (mass × length); what holds a pinned end gives the opposite. */
static void add_reaction(const double *anchors, int32_t node, double f, const double edge[3], double *reactions)
{
    if (anchors[4 * (int64_t)node + 3] > 0.0) return;
    for (int c = 0; c < 3; c++) reactions[3 * (int64_t)node + c] += f * edge[c];
}

static void add_reactions(const int32_t *ends, int edge, ShvWide f, const ShvBarShape *shape, const double *anchors,
                          double *reactions)
{
    _Alignas(64) double factors[SHV_WIDE_LANES], edges[3][SHV_WIDE_LANES];
    shv_wide_store(factors, f);
    for (int c = 0; c < 3; c++) shv_wide_store(edges[c], shape->edge[c]);
    for (int i = 0; i < SHV_LANES; i++) {
        if (i > 0 && ends[i] == ends[0]) continue; /* repeats the first item to fill the batch up */
        const double vector[3] = {edges[0][i], edges[1][i], edges[2][i]};
        add_reaction(anchors, ends[shv_tet_edges[edge][0] * SHV_LANES + i], factors[i], vector, reactions);
        add_reaction(anchors, ends[shv_tet_edges[edge][1] * SHV_LANES + i], -factors[i], vector, reactions);
    }
}

/* A batch edge by edge, with the reactions of its pinned nodes. */
static void sweep_held(const ShvBars *bars, int64_t batch, ShvWide stiffness, const double *anchors, double *shifts,
                       double *reactions)
{
    const int32_t *ends = bars->ends + batch * bars->corners * SHV_LANES;
    for (int edge = 0; edge < bars->edges; edge++) {
        const int32_t *first = ends + shv_tet_edges[edge][0] * SHV_LANES;
        const int32_t *second = ends + shv_tet_edges[edge][1] * SHV_LANES;
        const ShvWide rest = shv_wide_load(bars->rest + (batch * bars->edges + edge) * SHV_LANES);
        ShvWide a[4], b[4], u[4], v[4];
        shv_wide_load_quads(anchors, first, a);
        shv_wide_load_quads(anchors, second, b);
        shv_wide_load_quads(shifts, first, u);
        shv_wide_load_quads(shifts, second, v);
        const ShvBarShape shape = shv_bar_shape(a, b, u, v);
        const ShvWide f = shv_bar_factor(stiffness, rest, shv_wide_add(a[3], b[3]), &shape);
        shv_bar_move(f, &shape, a[3], b[3], u, v);
        shv_wide_store_quads(shifts, first, u);
        shv_wide_store_quads(shifts, second, v);
        add_reactions(ends, edge, f, &shape, anchors, reactions);
    }
}

static void sweep_chunk(const ShvBars *bars, const ShvBarChunk *chunk, double stiffness, const double *anchors,
                        double *shifts, double *reactions)
{
    const ShvWide k = shv_wide_set1(stiffness);
    const int64_t last = (int64_t)chunk->first + chunk->count;
    for (int64_t b = chunk->first; b < last; b++) {
        const int32_t *ends = bars->ends + b * bars->corners * SHV_LANES;
        const double *rest = bars->rest + b * bars->edges * SHV_LANES;
        if (reactions && has_pinned(ends, bars->corners, anchors))
            sweep_held(bars, b, k, anchors, shifts, reactions);
        else if (bars->form == SHV_BARS_EDGE)
            shv_bar_batch(k, ends, rest, anchors, shifts);
        else
            shv_tet_batch(k, ends, rest, anchors, shifts);
    }
}

void shv_bars_sweep_held(const ShvBars *bars, double stiffness, const double *anchors, double *shifts,
                         double *reactions)
{
#pragma omp parallel num_threads(bars->model->threads) if (bars->model->threads > 1)
    for (int32_t colour = 0; colour < bars->colour_count; colour++) {
#pragma omp for schedule(dynamic, 4)
        for (int32_t i = bars->colour_start[colour]; i < bars->colour_start[colour + 1]; i++)
            sweep_chunk(bars, &bars->chunks[bars->chunk_order[i]], stiffness, anchors, shifts, reactions);
    }
}

void shv_bars_sweep(const ShvBars *bars, double stiffness, const double *anchors, double *shifts)
{
    shv_bars_sweep_held(bars, stiffness, anchors, shifts, NULL);
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
