#include <string.h>

#include "solid/domain.h"

/* So many, and a sixteenth of all, may be found late before domains are laid out anew. */
enum { FEW_LATE = 256 };

/* Which edge a domain's i-th one is. */
static int32_t edge_of(const ShvSmoothedEdges *smoothing, int32_t domain, int32_t i)
{
    int32_t edge = SHV_TET_EDGES * *shv_domain_member(smoothing, domain, i);
    while (smoothing->edge_domain[edge] != domain) edge++;
    return edge;
}

static void nodes_of(const ShvSmoothedEdges *smoothing, const ShvState *state, int32_t domain, int32_t i,
                     int32_t nodes[2])
{
    const int32_t edge = edge_of(smoothing, domain, i);
    shv_edge_nodes(state, shv_edge_element(smoothing, edge), edge % SHV_TET_EDGES, nodes);
}

/* Brings those of a domain's edges from `first` on that have the nodes of the first one to the front, in order; returns their end. */
static int32_t gather_first(const ShvSmoothedEdges *smoothing, const ShvState *state, int32_t domain, int32_t first,
                            int32_t end)
{
    int32_t nodes[2], own[2], kept = first;
    nodes_of(smoothing, state, domain, first, nodes);
    for (int32_t i = first; i < end; i++) {
        nodes_of(smoothing, state, domain, i, own);
        if (own[0] != nodes[0] || own[1] != nodes[1]) continue;
        const int32_t lane = *shv_domain_member(smoothing, domain, i);
        for (int32_t k = i; k > kept; k--)
            *shv_domain_member(smoothing, domain, k) = *shv_domain_member(smoothing, domain, k - 1);
        *shv_domain_member(smoothing, domain, kept++) = lane;
    }
    return kept;
}

/* Mean over the tets of a domain, by volume. */
static void find_gradient(const ShvSmoothedEdges *smoothing, int32_t domain, double mean[9])
{
    const int32_t count = shv_domain_edge_count(smoothing, domain);
    for (int c = 0; c < 9; c++) mean[c] = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const int64_t lane = *shv_domain_member(smoothing, domain, i);
        for (int c = 0; c < 8; c++) mean[c] += smoothing->gradient[8 * lane + c];
        mean[8] += smoothing->gradient_zz[lane];
    }
    for (int c = 0; c < 9; c++) mean[c] *= smoothing->inverse_volume[domain];
}

static ShvMat3 deformation(const double gradient[9])
{
    ShvMat3 f;
    for (int c = 0; c < 9; c++) f.m[c / 3][c % 3] = gradient[c] + (c % 4 == 0 ? 1.0 : 0.0);
    return f;
}

/* G of a part: F (I + G) of the part as that of the whole, `gradient` less I. */
static void set_offset(const ShvSmoothedEdges *smoothing, int32_t domain, const double whole[9])
{
    double own[9], change[9], offset[9] = {0.0};
    ShvMat3 inverse;
    find_gradient(smoothing, domain, own);
    for (int c = 0; c < 9; c++) change[c] = whole[c] - own[c];
    const ShvMat3 f = deformation(own);
    if (shv_invert(&f, &inverse))
        for (int c = 0; c < 9; c++)
            for (int k = 0; k < 3; k++) offset[c] += inverse.m[c / 3][k] * change[3 * k + c % 3];
    for (int c = 0; c < 9; c++) *shv_domain_offset(smoothing, domain, c) = offset[c];
    if (shv_domain_has_offset(smoothing, domain)) smoothing->group_offset[domain / SHV_LANES] = 1;
}

/* (I + H) (I + G) − I of a domain. */
static void find_whole(const ShvSmoothedEdges *smoothing, int32_t domain, double whole[9])
{
    double own[9], offset[9];
    find_gradient(smoothing, domain, own);
    for (int c = 0; c < 9; c++) offset[c] = *shv_domain_offset(smoothing, domain, c);
    for (int c = 0; c < 9; c++) {
        whole[c] = own[c] + offset[c];
        for (int k = 0; k < 3; k++) whole[c] += own[3 * (c / 3) + k] * offset[3 * k + c % 3];
    }
}

/* The mean of a tet's edges is found when its last one is. */
static void make_late(ShvSmoothedEdges *smoothing, int32_t block)
{
    if (smoothing->block_late[block]) return;
    smoothing->block_late[block] = 1;
    smoothing->late_blocks[smoothing->late_count++] = block;
}

/* A domain of its own for edges begin … end − 1 of another. */
static ShvStatus part(ShvSolid *solid, int32_t from, int32_t begin, int32_t end, int32_t *domain, ShvError *error)
{
    enum { LIKELY_WIDTH = 4 };
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const bool first = smoothing->group_count == smoothing->settled_groups;
    SHV_TRY(shv_smoothing_add_domain(solid, smoothing, end - begin, LIKELY_WIDTH, first, smoothing->material[from],
                                     domain, error));
    for (int32_t i = begin; i < end; i++) {
        make_late(smoothing, *shv_domain_member(smoothing, from, i) / SHV_LANES);
        shv_smoothing_set_edge(smoothing, *domain, i - begin, edge_of(smoothing, from, i));
    }
    if (smoothing->group_active[from / SHV_LANES] > smoothing->group_active[*domain / SHV_LANES])
        smoothing->group_active[*domain / SHV_LANES] = smoothing->group_active[from / SHV_LANES];
    return SHV_OK;
}

/* Of a domain whose nodes may have been split. */
static ShvStatus split_domain(ShvSolid *solid, const ShvState *state, int32_t domain, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    if (!solid->model->materials[smoothing->material[domain]].smoothed) return SHV_OK;
    const int32_t end = shv_domain_edge_count(smoothing, domain);
    const int32_t own = gather_first(smoothing, state, domain, 0, end);
    if (own == end) return SHV_OK;
    double whole[9];
    find_whole(smoothing, domain, whole);
    for (int32_t begin = own, stop; begin < end; begin = stop) {
        int32_t other;
        stop = gather_first(smoothing, state, domain, begin, end);
        SHV_TRY(part(solid, domain, begin, stop, &other, error));
        shv_smoothing_close_domain(solid, smoothing, other, stop - begin);
        set_offset(smoothing, other, whole);
        smoothing->split[smoothing->split_count++] = other;
    }
    for (int32_t i = own; i < end; i++) *shv_domain_member(smoothing, domain, i) = shv_smoothing_no_lane(smoothing);
    shv_smoothing_close_domain(solid, smoothing, domain, own);
    set_offset(smoothing, domain, whole);
    smoothing->split[smoothing->split_count++] = domain;
    return SHV_OK;
}

/* All domains with a corner among their nodes. */
static ShvStatus split_at(ShvSolid *solid, const ShvState *state, int32_t corner, ShvError *error)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t element = corner / 4, block = smoothing->batch_block[element / SHV_LANES];
    if (block < 0) return SHV_OK;
    const int64_t edge = SHV_TET_EDGES * (SHV_LANES * (int64_t)block + element % SHV_LANES);
    for (int k = 0; k < SHV_TET_EDGES; k++)
        if (shv_tet_edges[k][0] == corner % 4 || shv_tet_edges[k][1] == corner % 4)
            SHV_TRY(split_domain(solid, state, smoothing->edge_domain[edge + k], error));
    return SHV_OK;
}

ShvStatus shv_solid_split(ShvSolid *solid, const ShvState *state, const int32_t *nodes, int32_t count, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    smoothing->split_count = 0;
    if (smoothing->block_count == 0) return SHV_OK;
    if (SHV_LANES * (smoothing->group_count - smoothing->settled_groups) > FEW_LATE + smoothing->domain_count / 16)
        SHV_TRY(shv_smoothing_lay_out(solid, state, error));
    for (int32_t i = 0; i < count; i++)
        for (int32_t n = 0; n < state->corner_count[nodes[i]]; n++)
            SHV_TRY(split_at(solid, state, state->corners[state->corner_start[nodes[i]] + n], error));
    return SHV_OK;
}

void shv_solid_reset_offsets(const ShvSolid *solid, const int32_t *elements, int32_t count)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    for (int32_t i = 0; i < count && smoothing->block_count > 0; i++) {
        const int32_t block = smoothing->batch_block[elements[i] / SHV_LANES];
        if (block < 0) continue;
        const int32_t *domains =
            smoothing->edge_domain + SHV_TET_EDGES * (SHV_LANES * (int64_t)block + elements[i] % SHV_LANES);
        for (int k = 0; k < SHV_TET_EDGES; k++)
            for (int c = 0; c < 9; c++) *shv_domain_offset(smoothing, domains[k], c) = 0.0;
    }
}
