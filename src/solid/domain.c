#include "solid/domain.h"

#include <stdlib.h>
#include <string.h>

/* ---- creation ---- */

/* An edge of a tet on its way to a domain. */
typedef struct Candidate {
    int32_t nodes[2]; /* the lower first; of an element that is not smoothed {−1, element} */
    int32_t material, edge;
    int32_t first, count; /* edge of its domain, and how many it has */
} Candidate;

/* So many edges of tets lie near enough for their domains to be in any order: then those of as many tets follow one another, and a
   processor guesses right when sums over them end. */
enum { NEAR_EDGES = 4096 };

static int by_domain(const void *a, const void *b)
{
    const Candidate *x = a, *y = b;
    for (int i = 0; i < 2; i++)
        if (x->nodes[i] != y->nodes[i]) return x->nodes[i] < y->nodes[i] ? -1 : 1;
    if (x->material != y->material) return x->material < y->material ? -1 : 1;
    return (x->edge > y->edge) - (x->edge < y->edge);
}

/* Domains nearly in the order of their tets, so that what is read together lies together. */
static int by_place(const void *a, const void *b)
{
    const Candidate *x = a, *y = b;
    const int32_t place = x->first / NEAR_EDGES, other = y->first / NEAR_EDGES;
    if (place != other) return place < other ? -1 : 1;
    if (x->count != y->count) return x->count < y->count ? -1 : 1;
    if (x->first != y->first) return x->first < y->first ? -1 : 1;
    return (x->edge > y->edge) - (x->edge < y->edge);
}

static bool same_domain(const Candidate *a, const Candidate *b)
{
    return a->nodes[0] == b->nodes[0] && a->nodes[1] == b->nodes[1] && a->material == b->material;
}

static bool is_smoothed(const ShvModel *model, int32_t element)
{
    return shv_model_material(model, element)->smoothed;
}

static void nodes_of_edge(const ShvState *state, int32_t element, int k, int32_t nodes[2])
{
    const int32_t a = shv_state_node(state, element, shv_tet_edges[k][0]);
    const int32_t b = shv_state_node(state, element, shv_tet_edges[k][1]);
    nodes[0] = a < b ? a : b;
    nodes[1] = a < b ? b : a;
}

static int32_t list_blocks(ShvSolid *solid)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const ShvModel *model = solid->model;
    for (int32_t batch = 0; batch < solid->batch_count; batch++) {
        bool any = false;
        for (int32_t e = batch * SHV_LANES; e < (batch + 1) * SHV_LANES && e < model->mesh.element_count; e++)
            any = any || is_smoothed(model, e);
        smoothing->batch_block[batch] = any ? smoothing->block_count : -1;
        if (any) smoothing->blocks[smoothing->block_count++] = batch;
    }
    return smoothing->block_count;
}

/* Room for so many domains in all that each has for itself. */
static ShvStatus reserve(ShvSolid *solid, int32_t count, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    ShvMemory *memory = solid->memory;
    if (count <= smoothing->domain_capacity) return SHV_OK;
    static const char what[] = "smoothed edges";
    const size_t size = (size_t)count, bytes = 200 * size;
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->first_member, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->member_count, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->inverse_volume, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->stress, 8 * size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->stress_zz, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->energy, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->offset, 9 * size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->active, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->has_offset, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->material, size, what, bytes, error);
    SHV_RESIZE(memory, SHV_PART_STATE, smoothing->split, size, what, bytes, error);
    smoothing->domain_capacity = count;
    return SHV_OK;
}

/* `first`, `count`: of its members. */
static void set_domain(ShvSolid *solid, int32_t domain, int32_t first, int32_t count)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    double volume = 0.0;
    smoothing->first_member[domain] = first;
    smoothing->member_count[domain] = count;
    for (int32_t i = first; i < first + count; i++) {
        smoothing->edge_domain[smoothing->members[i]] = domain;
        volume += solid->volumes[shv_edge_element(smoothing, smoothing->members[i])];
    }
    smoothing->inverse_volume[domain] = 1.0 / volume;
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
        if (is_smoothed(solid->model, element)) nodes_of_edge(state, element, edge % SHV_TET_EDGES, candidate->nodes);
    }
    qsort(candidates, (size_t)count, sizeof *candidates, by_domain);
    for (int32_t first = 0, end; first < count; first = end) {
        for (end = first; end < count && same_domain(&candidates[first], &candidates[end]); end++)
            candidates[end].first = candidates[first].edge;
        for (int32_t i = first; i < end; i++) candidates[i].count = end - first;
    }
    qsort(candidates, (size_t)count, sizeof *candidates, by_place);
    return count;
}

static ShvStatus make_domains(ShvSolid *solid, const Candidate *candidates, int32_t count, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    int32_t domains = 0;
    for (int32_t i = 0; i < count; i++) {
        smoothing->members[i] = candidates[i].edge;
        domains += i == 0 || candidates[i - 1].first != candidates[i].first;
    }
    SHV_TRY(reserve(solid, domains, error));
    for (int32_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && candidates[first].first == candidates[end].first;) end++;
        const int32_t domain = smoothing->domain_count++;
        smoothing->material[domain] = (int16_t)candidates[first].material;
        set_domain(solid, domain, first, end - first);
    }
    return SHV_OK;
}

/* Padding lanes compute as the last element does. */
static void fill_padding(ShvSolid *solid, const ShvState *state)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t last = smoothing->block_count - 1;
    int32_t *edges = smoothing->edge_domain + SHV_TET_EDGES * SHV_LANES * (int64_t)last;
    for (int lane = 1; lane < SHV_LANES; lane++)
        if (smoothing->blocks[last] * SHV_LANES + lane >= state->element_count)
            memcpy(edges + (ptrdiff_t)SHV_TET_EDGES * lane, edges + (ptrdiff_t)SHV_TET_EDGES * (lane - 1),
                   SHV_TET_EDGES * sizeof *edges);
}

static ShvStatus create(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const size_t lanes = SHV_LANES * (size_t)solid->batch_count, size = sizeof *smoothing->members;
    smoothing->batch_block = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, size);
    smoothing->blocks = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, size);
    smoothing->block_active = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->batch_count, 1);
    if (!smoothing->batch_block || !smoothing->blocks || !smoothing->block_active)
        return shv_fail_memory(error, "smoothed elements", 9 * (size_t)solid->batch_count);
    if (list_blocks(solid) == 0) return SHV_OK;
    const size_t smoothed = SHV_LANES * (size_t)smoothing->block_count, edges = SHV_TET_EDGES * smoothed;
    smoothing->gradient = shv_allocate(solid->memory, SHV_PART_STATE, 8 * smoothed, sizeof *smoothing->gradient);
    smoothing->gradient_zz = shv_allocate(solid->memory, SHV_PART_STATE, smoothed, sizeof *smoothing->gradient_zz);
    smoothing->members = shv_allocate(solid->memory, SHV_PART_STATE, edges, size);
    smoothing->edge_domain = shv_allocate(solid->memory, SHV_PART_STATE, edges, size);
    Candidate *candidates = shv_allocate(solid->memory, SHV_PART_STATE, edges, sizeof *candidates);
    ShvStatus status = SHV_OK;
    if (!smoothing->gradient || !smoothing->gradient_zz || !smoothing->members || !smoothing->edge_domain ||
        !candidates)
        status = shv_fail_memory(error, "smoothed elements", edges * sizeof *candidates + 200 * lanes);
    if (status == SHV_OK) status = make_domains(solid, candidates, list_candidates(solid, state, candidates), error);
    if (status == SHV_OK) fill_padding(solid, state);
    if (status == SHV_OK) shv_solid_follow_active(solid);
    shv_release(candidates);
    return status;
}

/* A batch may hold tets of bodies that rest beside others that do not; of those, too, all tets round an edge are needed. */
void shv_solid_follow_active(const ShvSolid *solid)
{
    const ShvSmoothedEdges *smoothing = &solid->smoothing;
    if (smoothing->block_count > 0) memset(smoothing->block_active, 0, (size_t)smoothing->block_count);
    for (int32_t domain = 0; domain < smoothing->domain_count; domain++) {
        const int32_t *members = smoothing->members + smoothing->first_member[domain];
        const int32_t count = smoothing->member_count[domain];
        bool any = false;
        for (int32_t i = 0; i < count && !any; i++)
            any = solid->batch_active[smoothing->blocks[members[i] / (SHV_TET_EDGES * SHV_LANES)]];
        smoothing->active[domain] = any;
        for (int32_t i = 0; i < count && any; i++)
            smoothing->block_active[members[i] / (SHV_TET_EDGES * SHV_LANES)] = 1;
    }
}

ShvStatus shv_smoothing_create(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    const ShvModel *model = solid->model;
    for (int32_t i = 0; i < model->material_count; i++)
        if (model->materials[i].smoothed) return create(solid, state, error);
    return SHV_OK;
}

void shv_smoothing_release(ShvSmoothedEdges *smoothing)
{
    shv_release(smoothing->blocks);
    shv_release(smoothing->block_active);
    shv_release(smoothing->batch_block);
    shv_release(smoothing->edge_domain);
    shv_release(smoothing->gradient);
    shv_release(smoothing->gradient_zz);
    shv_release(smoothing->members);
    shv_release(smoothing->first_member);
    shv_release(smoothing->member_count);
    shv_release(smoothing->inverse_volume);
    shv_release(smoothing->stress);
    shv_release(smoothing->stress_zz);
    shv_release(smoothing->energy);
    shv_release(smoothing->offset);
    shv_release(smoothing->active);
    shv_release(smoothing->has_offset);
    shv_release(smoothing->material);
    shv_release(smoothing->split);
    *smoothing = (ShvSmoothedEdges){0};
}

/* ---- splitting ---- */

/* Brings those of the members from `first` on that have the nodes of the first one to the front, in order; returns their end. */
static int32_t gather_first(const ShvSmoothedEdges *smoothing, const ShvState *state, int32_t first, int32_t end)
{
    int32_t nodes[2], own[2], kept = first, *members = smoothing->members;
    nodes_of_edge(state, shv_edge_element(smoothing, members[first]), members[first] % SHV_TET_EDGES, nodes);
    for (int32_t i = first; i < end; i++) {
        const int32_t edge = members[i];
        nodes_of_edge(state, shv_edge_element(smoothing, edge), edge % SHV_TET_EDGES, own);
        if (own[0] != nodes[0] || own[1] != nodes[1]) continue;
        memmove(members + kept + 1, members + kept, (size_t)(i - kept) * sizeof *members);
        members[kept++] = edge;
    }
    return kept;
}

static ShvMat3 deformation(const double gradient[9])
{
    ShvMat3 f;
    for (int c = 0; c < 9; c++) f.m[c / 3][c % 3] = gradient[c] + (c % 4 == 0 ? 1.0 : 0.0);
    return f;
}

/* G of a part: F (I + G) of the part as that of the whole, `gradient` less I. */
static void set_offset(ShvSmoothedEdges *smoothing, int32_t domain, const double whole[9])
{
    double own[9], change[9];
    double *offset = smoothing->offset + 9 * (int64_t)domain;
    ShvMat3 inverse;
    shv_domain_gradient(smoothing, domain, own);
    for (int c = 0; c < 9; c++) change[c] = whole[c] - own[c];
    const ShvMat3 f = deformation(own);
    smoothing->has_offset[domain] = false;
    memset(offset, 0, 9 * sizeof *offset);
    if (!shv_invert(&f, &inverse)) return;
    for (int c = 0; c < 9; c++) {
        for (int k = 0; k < 3; k++) offset[c] += inverse.m[c / 3][k] * change[3 * k + c % 3];
        smoothing->has_offset[domain] = smoothing->has_offset[domain] || offset[c] != 0.0;
    }
}

/* (I + H) (I + G) − I of a domain. */
static void find_whole(const ShvSmoothedEdges *smoothing, int32_t domain, double whole[9])
{
    double own[9];
    const double *offset = smoothing->offset + 9 * (int64_t)domain;
    shv_domain_gradient(smoothing, domain, own);
    for (int c = 0; c < 9; c++) {
        whole[c] = own[c] + offset[c];
        for (int k = 0; k < 3; k++) whole[c] += own[3 * (c / 3) + k] * offset[3 * k + c % 3];
    }
}

/* Of a domain whose nodes may have been split. */
static ShvStatus split_domain(ShvSolid *solid, const ShvState *state, int32_t domain, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    const int32_t first = smoothing->first_member[domain], end = first + smoothing->member_count[domain];
    int32_t stop = gather_first(smoothing, state, first, end);
    if (stop == end) return SHV_OK;
    double whole[9];
    find_whole(smoothing, domain, whole);
    if (smoothing->domain_count + (end - stop) > smoothing->domain_capacity)
        SHV_TRY(reserve(solid, smoothing->domain_capacity + smoothing->domain_capacity / 2 + (end - stop), error));
    for (int32_t part = domain, begin = first;; part = smoothing->domain_count++) {
        smoothing->material[part] = smoothing->material[domain];
        smoothing->active[part] = smoothing->active[domain];
        set_domain(solid, part, begin, stop - begin);
        set_offset(smoothing, part, whole);
        smoothing->split[smoothing->split_count++] = part;
        if (stop == end) return SHV_OK;
        begin = stop;
        stop = gather_first(smoothing, state, begin, end);
    }
}

ShvStatus shv_solid_split(ShvSolid *solid, const ShvState *state, const int32_t *nodes, int32_t count, ShvError *error)
{
    ShvSmoothedEdges *smoothing = &solid->smoothing;
    smoothing->split_count = 0;
    if (smoothing->block_count == 0) return SHV_OK;
    for (int32_t i = 0; i < count; i++)
        for (int32_t n = 0; n < state->corner_count[nodes[i]]; n++) {
            const int32_t corner = state->corners[state->corner_start[nodes[i]] + n], element = corner / 4;
            const int32_t block = smoothing->batch_block[element / SHV_LANES];
            if (block < 0) continue;
            const int32_t *domains =
                smoothing->edge_domain + SHV_TET_EDGES * (SHV_LANES * (int64_t)block + element % SHV_LANES);
            for (int k = 0; k < SHV_TET_EDGES; k++)
                if (shv_tet_edges[k][0] == corner % 4 || shv_tet_edges[k][1] == corner % 4)
                    SHV_TRY(split_domain(solid, state, domains[k], error));
        }
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
        for (int k = 0; k < SHV_TET_EDGES; k++) {
            smoothing->has_offset[domains[k]] = false;
            memset(smoothing->offset + 9 * (int64_t)domains[k], 0, 9 * sizeof *smoothing->offset);
        }
    }
}
