#include "solid/domain.h"

#include <stdlib.h>
#include <string.h>

/* ---- domains in groups ---- */

/* Room for so many groups, and numbers of members, in all. */
static ShvStatus reserve(ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t groups, int32_t members, ShvError *error)
{
    ShvMemory *memory = solid->memory;
    static const char what[] = "smoothed edges";
    if (members > smoothing->member_capacity) {
        const size_t size = (size_t)members + (size_t)members / 2;
        SHV_RESIZE(memory, SHV_PART_STATE, smoothing->members, size, what, size * sizeof *smoothing->members, error);
        smoothing->member_capacity = (int32_t)size;
    }
    if (groups <= smoothing->group_capacity) return SHV_OK;
    const size_t count = (size_t)groups + (size_t)groups / 2, size = SHV_LANES * count, bytes = 200 * size;
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->group_member, count, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->group_width, count, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->group_active, count, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->group_offset, count, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->group_material, count, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->inverse_volume, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->stress, 8 * size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->stress_zz, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->energy, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->offset, 9 * size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->material, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->split, size, what, bytes, error);
    smoothing->group_capacity = (int32_t)count;
    return SHV_OK;
}

/* All of its lanes are empty, and of a material that is there. */
static ShvStatus open_group(ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t width, int16_t material,
                            ShvError *error)
{
    const int32_t group = smoothing->group_count, size = SHV_LANES * width;
    SHV_TRY(reserve(solid, smoothing, group + 1, smoothing->member_count + size, error));
    smoothing->group_member[group] = smoothing->member_count;
    smoothing->group_width[group] = width;
    smoothing->group_material[group] = material;
    for (int lane = 0; lane < SHV_LANES; lane++) smoothing->material[SHV_LANES * group + lane] = material;
    for (int32_t i = 0; i < size; i++) smoothing->members[smoothing->member_count++] = shv_smoothing_no_lane(smoothing);
    smoothing->group_count++;
    smoothing->last_lanes = 0;
    return SHV_OK;
}

ShvStatus shv_smoothing_add_domain(ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t count, int32_t width,
                                   bool apart, int16_t material, int32_t *domain, ShvError *error)
{
    const int32_t last = smoothing->group_count - 1;
    if (apart || last < 0 || smoothing->last_lanes == SHV_LANES || smoothing->group_width[last] < count)
        SHV_TRY(open_group(solid, smoothing, count > width ? count : width, material, error));
    const int32_t group = smoothing->group_count - 1;
    *domain = SHV_LANES * group + smoothing->last_lanes++;
    smoothing->domain_count++;
    smoothing->material[*domain] = material;
    if (smoothing->group_material[group] != material) smoothing->group_material[group] = -1;
    return SHV_OK;
}

void shv_smoothing_set_edge(ShvSmoothedEdges *smoothing, int32_t domain, int32_t i, int32_t edge)
{
    *shv_domain_member(smoothing, domain, i) = edge / SHV_TET_EDGES;
    smoothing->edge_domain[edge] = domain;
}

void shv_smoothing_close_domain(const ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t domain, int32_t count)
{
    double volume = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const int32_t lane = *shv_domain_member(smoothing, domain, i);
        volume += solid->volumes[smoothing->blocks[lane / SHV_LANES] * SHV_LANES + lane % SHV_LANES];
    }
    smoothing->inverse_volume[domain] = 1.0 / volume;
}

static void release_groups(const ShvSmoothedEdges *smoothing)
{
    shv_release(smoothing->edge_domain);
    shv_release(smoothing->group_member);
    shv_release(smoothing->group_width);
    shv_release(smoothing->group_active);
    shv_release(smoothing->group_offset);
    shv_release(smoothing->group_material);
    shv_release(smoothing->members);
    shv_release(smoothing->inverse_volume);
    shv_release(smoothing->stress);
    shv_release(smoothing->stress_zz);
    shv_release(smoothing->energy);
    shv_release(smoothing->offset);
    shv_release(smoothing->material);
    shv_release(smoothing->window_group);
    shv_release(smoothing->window_ready);
    shv_release(smoothing->ready_blocks);
    shv_release(smoothing->late_blocks);
    shv_release(smoothing->block_late);
    shv_release(smoothing->split);
}

void shv_smoothing_release(ShvSmoothedEdges *smoothing)
{
    release_groups(smoothing);
    shv_release(smoothing->blocks);
    shv_release(smoothing->lane_active);
    shv_release(smoothing->block_active);
    shv_release(smoothing->batch_block);
    shv_release(smoothing->gradient);
    shv_release(smoothing->gradient_zz);
    shv_release(smoothing->mean);
    *smoothing = (ShvSmoothedEdges){0};
}

/* ---- their order ---- */

/* An edge of a tet on its way to a domain. */
typedef struct Candidate {
    int32_t nodes[2]; /* the lower first; {−1, element} of what is not smoothed, {−1, domain} once there are domains */
    int32_t material, edge;
    int32_t first, count; /* edge of its domain, and how many it has */
    int32_t window;       /* in which all of them are there */
} Candidate;

/* What a window's tets and edges have fits beside what follows them into the second cache of a processor. */
enum { LARGEST_WINDOW = 128 };

static int by_domain(const void *a, const void *b)
{
    const Candidate *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->nodes[i] != y->nodes[i]) return x->nodes[i] < y->nodes[i] ? -1 : 1;
    if (x->material != y->material) return x->material < y->material ? -1 : 1;
    return (x->edge > y->edge) - (x->edge < y->edge);
}

/* In a window those of as many tets follow one another: a group is as wide as its widest domain. */
static int by_place(const void *a, const void *b)
{
    const Candidate *x = a, *y = b;
    if (x->window != y->window) return x->window < y->window ? -1 : 1;
    if (x->count != y->count) return x->count < y->count ? -1 : 1;
    if (x->first != y->first) return x->first < y->first ? -1 : 1;
    return (x->edge > y->edge) - (x->edge < y->edge);
}

static bool same_domain(const Candidate *a, const Candidate *b)
{
    return a->nodes[0] == b->nodes[0] && a->nodes[1] == b->nodes[1] && a->material == b->material;
}

static int32_t window_of(const ShvSmoothedEdges *smoothing, int32_t edge)
{
    return edge / (SHV_TET_EDGES * SHV_LANES * smoothing->window_blocks);
}

static int32_t region_begin(const ShvSmoothedEdges *smoothing, int32_t region)
{
    return (int32_t)((int64_t)smoothing->window_count * region / smoothing->region_count);
}

/* The window after which all between its first and its last edge are found; window_count: only when all regions are. */
static int32_t window_between(const ShvSmoothedEdges *smoothing, int32_t first, int32_t last)
{
    const int32_t begin = window_of(smoothing, first), end = window_of(smoothing, last);
    for (int32_t region = 1; region < smoothing->region_count; region++)
        if (begin < region_begin(smoothing, region) && end >= region_begin(smoothing, region))
            return smoothing->window_count;
    return end;
}

/* Those of one domain side by side. Padding lanes have none. Returns their number. */
static int32_t list_candidates(const ShvSolid *solid, const ShvState *state, Candidate *candidates)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    int32_t count = 0;
    for (int32_t edge = 0; edge < SHV_TET_EDGES * SHV_LANES * smoothing->block_count; edge++) {
        const int32_t element = shv_edge_element(smoothing, edge);
        if (element >= state->element_count) continue;
        Candidate *candidate = &candidates[count++];
        *candidate =
            (Candidate){.nodes = {-1, element}, .material = solid->model->element_material[element], .edge = edge};
        if (smoothing->domain_count > 0)
            candidate->nodes[1] = smoothing->edge_domain[edge];
        else if (shv_model_material(solid->model, element)->smoothed)
            shv_edge_nodes(state, element, edge % SHV_TET_EDGES, candidate->nodes);
    }
    qsort(candidates, (size_t)count, sizeof *candidates, by_domain);
    for (int32_t first = 0, end; first < count; first = end) {
        for (end = first; end < count && same_domain(&candidates[first], &candidates[end]);) end++;
        const int32_t window = window_between(smoothing, candidates[first].edge, candidates[end - 1].edge);
        for (int32_t i = first; i < end; i++) {
            candidates[i].first = candidates[first].edge;
            candidates[i].count = end - first;
            candidates[i].window = window;
        }
    }
    qsort(candidates, (size_t)count, sizeof *candidates, by_place);
    return count;
}

/* Edges of the widest domain that the group of the domain at `first` gets. */
static int32_t widest(const Candidate *candidates, int32_t first, int32_t count)
{
    int32_t most = 0, i = first;
    for (int lane = 0; lane < SHV_LANES && i < count && candidates[i].window == candidates[first].window; lane++) {
        if (candidates[i].count > most) most = candidates[i].count;
        i += candidates[i].count;
    }
    return most;
}

/* What the domain had under the old order, at any of its edges. */
static void carry(ShvSmoothedEdges *to, int32_t domain, const ShvSmoothedEdges *from, int32_t edge)
{
    if (from->domain_count == 0) return;
    const int32_t old = from->edge_domain[edge];
    memcpy(to->stress + 8 * (int64_t)domain, from->stress + 8 * (int64_t)old, 8 * sizeof *to->stress);
    to->stress_zz[domain] = from->stress_zz[old];
    for (int c = 0; c < 9; c++) *shv_domain_offset(to, domain, c) = *shv_domain_offset(from, old, c);
    if (shv_domain_has_offset(to, domain)) to->group_offset[domain / SHV_LANES] = 1;
}

static ShvStatus make_domains(ShvSolid *solid, ShvSmoothedEdges *fresh, const Candidate *candidates, int32_t count,
                              ShvError *error)
{
    int32_t window = -1, domain;
    for (int32_t first = 0; first < count; first += candidates[first].count) {
        const Candidate *own = &candidates[first];
        const bool next = own->window != window, full = next || fresh->last_lanes == SHV_LANES;
        while (window < own->window) fresh->window_group[++window] = fresh->group_count;
        SHV_TRY(shv_smoothing_add_domain(solid, fresh, own->count, full ? widest(candidates, first, count) : 0, next,
                                         (int16_t)own->material, &domain, error));
        for (int32_t i = 0; i < own->count; i++) shv_smoothing_set_edge(fresh, domain, i, own[i].edge);
        shv_smoothing_close_domain(solid, fresh, domain, own->count);
        carry(fresh, domain, &solid->smoothing, own->edge);
    }
    while (window < fresh->window_count) fresh->window_group[++window] = fresh->group_count;
    fresh->settled_groups = fresh->group_count;
    return SHV_OK;
}

/* Padding lanes compute as the last element does. */
static void fill_padding(ShvSmoothedEdges *smoothing, const ShvState *state)
{
    const int32_t last = smoothing->block_count - 1;
    int32_t *edges = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)last;
    for (int lane = 1; lane < SHV_LANES; lane++)
        if (smoothing->blocks[last] * SHV_LANES + lane >= state->element_count)
            memcpy(edges + (ptrdiff_t)SHV_TET_EDGES * lane, edges + (ptrdiff_t)SHV_TET_EDGES * (lane - 1),
                   SHV_TET_EDGES * sizeof *edges);
}

/* With which window the last group of a block is found. */
static int32_t block_window(const ShvSmoothedEdges *smoothing, int32_t block)
{
    const int32_t *domains = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)block;
    int32_t last = 0, window = block / smoothing->window_blocks;
    for (int i = 0; i < SHV_TET_EDGES * SHV_LANES; i++)
        if (domains[i] / SHV_LANES > last) last = domains[i] / SHV_LANES;
    while (window < smoothing->window_count && smoothing->window_group[window + 1] <= last) window++;
    return window;
}

static void order_blocks(ShvSmoothedEdges *smoothing)
{
    const int32_t windows = smoothing->window_count;
    int32_t *end = smoothing->window_ready + 1, total = 0;
    for (int32_t block = 0; block < smoothing->block_count; block++) {
        const int32_t window = block_window(smoothing, block);
        smoothing->block_late[block] = window == windows;
        if (window == windows)
            smoothing->late_blocks[smoothing->late_count++] = block;
        else
            end[window]++;
    }
    /* `end` holds numbers, then where each window begins, and filling moves that to its end */
    for (int32_t window = 0; window < windows; window++) {
        const int32_t own = end[window];
        end[window] = total;
        total += own;
    }
    for (int32_t block = 0; block < smoothing->block_count; block++)
        if (!smoothing->block_late[block]) smoothing->ready_blocks[end[block_window(smoothing, block)]++] = block;
}

static ShvStatus fill_layout(ShvSolid *solid, const ShvState *state, ShvSmoothedEdges *fresh, Candidate *candidates,
                             ShvError *error)
{
    ShvMemory *memory = solid->memory;
    const size_t blocks = (size_t)fresh->block_count, windows = (size_t)fresh->window_count + 1, size = sizeof(int32_t);
    fresh->edge_domain = shv_allocate(memory, SHV_PART_STATE, SHV_TET_EDGES * SHV_LANES * blocks, size);
    fresh->window_group = shv_allocate(memory, SHV_PART_STATE, windows, size);
    fresh->window_ready = shv_allocate(memory, SHV_PART_STATE, windows, size);
    fresh->ready_blocks = shv_allocate(memory, SHV_PART_STATE, blocks, size);
    fresh->late_blocks = shv_allocate(memory, SHV_PART_STATE, blocks, size);
    fresh->block_late = shv_allocate(memory, SHV_PART_STATE, blocks, 1);
    if (!fresh->edge_domain || !fresh->window_group || !fresh->window_ready || !fresh->ready_blocks ||
        !fresh->late_blocks || !fresh->block_late || !candidates)
        return shv_fail_memory(error, "smoothed elements", SHV_TET_EDGES * SHV_LANES * blocks * sizeof *candidates);
    SHV_TRY(make_domains(solid, fresh, candidates, list_candidates(solid, state, candidates), error));
    fill_padding(fresh, state);
    order_blocks(fresh);
    return SHV_OK;
}

/* All tets round an edge are needed where one is. */
static void follow_domain(const ShvSmoothedEdges *smoothing, int32_t domain)
{
    const int32_t count = shv_domain_edge_count(smoothing, domain);
    uint8_t highest = SHV_ACTIVE_NOT, *group = &smoothing->group_active[domain / SHV_LANES];
    for (int32_t i = 0; i < count; i++) {
        const uint8_t own = smoothing->lane_active[*shv_domain_member(smoothing, domain, i)];
        if (own > highest) highest = own;
    }
    if (highest > *group) *group = highest;
    for (int32_t i = 0; i < count; i++) {
        uint8_t *block = &smoothing->block_active[*shv_domain_member(smoothing, domain, i) / SHV_LANES];
        if (highest > *block) *block = highest;
    }
}

static void follow_lanes(const ShvSmoothedEdges *smoothing)
{
    memset(smoothing->block_active, SHV_ACTIVE_NOT, (size_t)smoothing->block_count);
    memset(smoothing->group_active, SHV_ACTIVE_NOT, (size_t)smoothing->group_count);
    for (int32_t domain = 0; domain < SHV_LANES * smoothing->group_count; domain++) follow_domain(smoothing, domain);
}

ShvStatus shv_smoothing_lay_out(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    const ShvSmoothedEdges *old = &solid->smoothing;
    ShvSmoothedEdges fresh = {.block_count = old->block_count,
                              .blocks = old->blocks,
                              .batch_block = old->batch_block,
                              .lane_active = old->lane_active,
                              .block_active = old->block_active,
                              .gradient = old->gradient,
                              .gradient_zz = old->gradient_zz,
                              .mean = old->mean,
                              .region_count = old->region_count,
                              .window_count = old->window_count,
                              .window_blocks = old->window_blocks};
    const size_t edges = SHV_TET_EDGES * SHV_LANES * (size_t)old->block_count;
    Candidate *candidates = shv_allocate(solid->memory, SHV_PART_STATE, edges, sizeof *candidates);
    const ShvStatus status = fill_layout(solid, state, &fresh, candidates, error);
    shv_release(candidates);
    release_groups(status == SHV_OK ? old : &fresh);
    if (status != SHV_OK) return status;
    solid->smoothing = fresh;
    follow_lanes(&fresh);
    return SHV_OK;
}

/* ---- creation ---- */

static int32_t list_blocks(ShvSolid *solid)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const ShvModel *model = solid->model;
    for (int32_t batch = 0; batch < solid->batch_count; batch++) {
        bool any = false;
        for (int32_t e = batch * SHV_LANES; e < (batch + 1) * SHV_LANES && e < model->mesh.element_count; e++)
            any = any || shv_model_material(model, e)->smoothed;
        smoothing->batch_block[batch] = any ? smoothing->block_count : -1;
        if (any) smoothing->blocks[smoothing->block_count++] = batch;
    }
    return smoothing->block_count;
}

/* A few windows for each thread at least. */
static void choose_windows(ShvSmoothedEdges *smoothing, int32_t threads)
{
    const int32_t wanted = smoothing->block_count / (4 * threads);
    smoothing->region_count = threads;
    smoothing->window_blocks = wanted < 1 ? 1 : wanted < LARGEST_WINDOW ? wanted : LARGEST_WINDOW;
    smoothing->window_count = (smoothing->block_count + smoothing->window_blocks - 1) / smoothing->window_blocks;
}

static ShvStatus create(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const size_t size = sizeof *smoothing->blocks;
    smoothing->batch_block = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, size);
    smoothing->blocks = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, size);
    smoothing->block_active = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, 1);
    if (!smoothing->batch_block || !smoothing->blocks || !smoothing->block_active)
        return shv_fail_memory(error, "smoothed elements", 9 * (size_t)solid->batch_count);
    if (list_blocks(solid) == 0) return SHV_OK;
    const size_t lanes = SHV_LANES * ((size_t)smoothing->block_count + 1);
    smoothing->gradient = shv_allocate(solid->memory, SHV_PART_STATE, 8 * lanes, sizeof *smoothing->gradient);
    smoothing->gradient_zz = shv_allocate(solid->memory, SHV_PART_STATE, lanes, sizeof *smoothing->gradient_zz);
    smoothing->mean = shv_allocate(solid->memory, SHV_PART_STATE, 9 * lanes, sizeof *smoothing->mean);
    smoothing->lane_active = shv_allocate(solid->memory, SHV_PART_STATE, lanes, 1);
    if (!smoothing->gradient || !smoothing->gradient_zz || !smoothing->mean || !smoothing->lane_active)
        return shv_fail_memory(error, "smoothed elements", (18 * sizeof *smoothing->gradient + 1) * lanes);
    choose_windows(smoothing, solid->model->threads);
    SHV_TRY(shv_smoothing_lay_out(solid, state, error));
    shv_solid_follow_active(solid, NULL, NULL);
    return SHV_OK;
}

void shv_solid_follow_active(const ShvSolid *solid, const int32_t *element_fragment, const uint8_t *awake)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    if (smoothing->block_count == 0) return;
    for (int32_t lane = 0; lane < SHV_LANES * smoothing->block_count; lane++) {
        const int32_t batch = smoothing->blocks[lane / SHV_LANES], element = batch * SHV_LANES + lane % SHV_LANES;
        const bool is_awake =
            element < solid->model->mesh.element_count && (!awake || awake[element_fragment[element]]);
        smoothing->lane_active[lane] = !solid->batch_active[batch] ? SHV_ACTIVE_NOT
                                       : is_awake                  ? SHV_ACTIVE_AWAKE
                                                                   : SHV_ACTIVE_BATCH;
    }
    follow_lanes(smoothing);
}

ShvStatus shv_smoothing_create(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    const ShvModel *model = solid->model;
    for (int32_t i = 0; i < model->material_count; i++)
        if (model->materials[i].smoothed) return create(solid, state, error);
    return SHV_OK;
}
