#include "solid/domain.h"
#include "solid/kernel.h"

static int32_t chunk_end(const ShvSolid *solid, int32_t chunk)
{
    const int32_t end = (chunk + 1) * solid->chunk_batches;
    return end < solid->batch_count ? end : solid->batch_count;
}

/* One chunk, its batches in order. */
static void add_chunk(const ShvSolid *solid, ShvState *state, int32_t chunk)
{
    const int32_t end = chunk_end(solid, chunk);
    for (int32_t batch = chunk * solid->chunk_batches; batch < end; batch++)
        if (solid->batch_active[batch]) shv_batch_add_force(solid, state, batch);
}

void shv_solid_add_internal_force(const ShvSolid *solid, ShvState *state)
{
    shv_solid_smooth(solid, state);
#pragma omp parallel num_threads(solid->model->threads) if (solid->model->threads > 1)
    for (int32_t colour = 0; colour < solid->colour_count; colour++) {
        /* The end of this loop waits for all threads: colours run one after another. */
#pragma omp for schedule(static)
        for (int32_t i = solid->colour_start[colour]; i < solid->colour_start[colour + 1]; i++)
            add_chunk(solid, state, solid->chunk_order[i]);
    }
}

/* ---- and faces ---- */

typedef struct Faces {
    const double *weight;
    double floor;
    uint32_t *bits;
} Faces;

static bool search_chunk(const ShvSolid *solid, ShvState *state, int32_t chunk, const Faces *faces)
{
    const int32_t end = chunk_end(solid, chunk);
    bool inverted = false;
    for (int32_t batch = chunk * solid->chunk_batches; batch < end; batch++)
        if (solid->batch_active[batch] &&
            shv_batch_add_force_and_find_faces(solid, state, batch, faces->weight, faces->floor, faces->bits))
            inverted = true;
    return inverted;
}

bool shv_solid_add_internal_force_and_find_faces(const ShvSolid *solid, ShvState *state, const double *weight,
                                                 double floor, uint32_t *faces)
{
    const Faces found = {weight, floor, faces};
    int inverted = 0;
#pragma omp parallel num_threads(solid->model->threads) if (solid->model->threads > 1) reduction(| : inverted)
    for (int32_t colour = 0; colour < solid->colour_count; colour++) {
#pragma omp for schedule(static)
        for (int32_t i = solid->colour_start[colour]; i < solid->colour_start[colour + 1]; i++)
            inverted |= search_chunk(solid, state, solid->chunk_order[i], &found);
    }
    return inverted != 0;
}

/* ---- single nodes ---- */

static int32_t colour_of(const ShvSolid *solid, int32_t corner)
{
    return solid->chunk_colour[corner / (4 * SHV_LANES) / solid->chunk_batches];
}

/* Whether the force on one corner of a node is added before that on another: by colour, then in order. */
static bool comes_before(const ShvSolid *solid, int32_t a, int32_t b)
{
    const int32_t first = colour_of(solid, a), second = colour_of(solid, b);
    return first != second ? first < second : a < b;
}

/* The corner whose turn is next after `last` (−1: the first); −1 when there is none. Few corners meet at a node. */
static int32_t next_corner(const ShvSolid *solid, const int32_t *corners, int32_t count, int32_t last)
{
    int32_t next = -1;
    for (int32_t i = 0; i < count; i++) {
        if (last >= 0 && !comes_before(solid, last, corners[i])) continue;
        if (next < 0 || comes_before(solid, corners[i], next)) next = corners[i];
    }
    return next;
}

static ShvVec3 corner_force(const ShvSolid *solid, const ShvState *state, int32_t corner)
{
    _Alignas(64) double force[4][3][SHV_LANES];
    ShvWide h[3][3], p[3][3];
    const int32_t element = corner / 4, batch = element / SHV_LANES, lane = element % SHV_LANES;
    shv_batch_displacement_gradient(solid, state, batch, h);
    shv_batch_stress(solid, batch, h, p);
    shv_batch_corner_forces(solid, batch, p, force);
    return shv_vec3(force[corner % 4][0][lane], force[corner % 4][1][lane], force[corner % 4][2][lane]);
}

static void put_force(const ShvSolid *solid, ShvState *state, int32_t node)
{
    const int32_t *corners = state->corners + state->corner_start[node], count = state->corner_count[node];
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int32_t corner = next_corner(solid, corners, count, -1); corner >= 0;
         corner = next_corner(solid, corners, count, corner))
        sum = shv_add(sum, corner_force(solid, state, corner));
    shv_store3(state->force + 3 * (int64_t)node, sum);
}

static void put_forces(const ShvSolid *solid, ShvState *state, const int32_t *nodes, int32_t count)
{
    const int32_t threads = solid->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int32_t k = 0; k < count; k++) put_force(solid, state, nodes[k]);
}

/* Nodes of the tets in domains that have been split. */
static void mark_near_splits(const ShvSmoothedEdges *smoothing, const ShvState *state, uint8_t *marks)
{
    for (int32_t i = 0; i < smoothing->split_count; i++) {
        const int32_t domain = smoothing->split[i], edges = shv_domain_edge_count(smoothing, domain);
        for (int32_t m = 0; m < edges; m++) {
            const int32_t edge = SHV_TET_EDGES * *shv_domain_member(smoothing, domain, m);
            for (int corner = 0; corner < 4; corner++)
                marks[shv_state_node(state, shv_edge_element(smoothing, edge), corner)] = 1;
        }
    }
}

static void put_forces_near_splits(const ShvSolid *solid, ShvState *state, const int32_t *nodes, int32_t count,
                                   uint8_t *marks, int32_t *near)
{
    int32_t found = 0;
    for (int32_t i = 0; i < count; i++) marks[nodes[i]] = 1;
    mark_near_splits(&solid->smoothing, state, marks);
    for (int32_t node = 0; node < state->node_count; node++)
        if (marks[node]) near[found++] = node;
    shv_smoothing_find_split(solid);
    put_forces(solid, state, near, found);
}

ShvStatus shv_solid_put_internal_force(const ShvSolid *solid, ShvState *state, const int32_t *nodes, int32_t count,
                                       ShvError *error)
{
    if (solid->smoothing.split_count == 0) {
        put_forces(solid, state, nodes, count);
        return SHV_OK;
    }
    const size_t all = (size_t)state->node_count;
    uint8_t *marks = shv_allocate(solid->memory, SHV_PART_STATE, all, sizeof *marks);
    int32_t *near = shv_allocate(solid->memory, SHV_PART_STATE, all, sizeof *near);
    if (marks && near) put_forces_near_splits(solid, state, nodes, count, marks, near);
    const ShvStatus status = marks && near ? SHV_OK : shv_fail_memory(error, "the nodes of an insertion", 5 * all);
    shv_release(marks);
    shv_release(near);
    return status;
}
