#include "pbd/bars.h"

#include <string.h>

#include "pbd/bar_chunk.h"

/* ---- corners around reference nodes ---- */

static ShvStatus list_corners(ShvBars *bars, ShvError *error)
{
    const ShvMesh *mesh = &bars->model->mesh;
    const int64_t corners = 4 * (int64_t)mesh->element_count;
    const size_t nodes = (size_t)mesh->node_count, size = sizeof(int32_t);
    bars->own_start = shv_allocate(bars->memory, SHV_PART_BARS, nodes + 2, size);
    bars->own_list = shv_allocate(bars->memory, SHV_PART_BARS, (size_t)corners, size);
    if (!bars->own_start || !bars->own_list)
        return shv_fail_memory(error, "the corners of bars", ((size_t)corners + nodes + 2) * size);
    /* Counted two places up, so that filling turns each count into the start of the next node. */
    int32_t *start = bars->own_start;
    for (int64_t i = 0; i < corners; i++) start[mesh->elements[i] + 2]++;
    for (size_t i = 2; i < nodes + 2; i++) start[i] += start[i - 1];
    for (int64_t i = 0; i < corners; i++) bars->own_list[start[mesh->elements[i] + 1]++] = (int32_t)i;
    bars->corner_start = bars->own_start;
    bars->corner_list = bars->own_list;
    return SHV_OK;
}

static ShvStatus find_corners(ShvBars *bars, ShvError *error)
{
    if (!bars->model->can_break) return list_corners(bars, error);
    bars->corner_start = bars->model->adjacency.corner_start;
    bars->corner_list = bars->model->adjacency.corners;
    return SHV_OK;
}

/* ---- life ---- */

/* Most items of any chunk: one a corner, or three when each corner's edges all differ. */
static int64_t largest_chunk(const ShvBars *bars)
{
    int64_t largest = 0;
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++) {
        const int64_t corners = bars->corner_start[shv_bar_chunk_end(bars, chunk)] -
                                (int64_t)bars->corner_start[chunk * SHV_BAR_CHUNK_NODES];
        if (corners > largest) largest = corners;
    }
    return bars->form == SHV_BARS_EDGE ? 3 * largest : largest;
}

static ShvStatus reserve_nodes(ShvBars *bars, int32_t nodes, ShvError *error)
{
    if (nodes <= bars->node_room) return SHV_OK;
    int64_t room = (int64_t)nodes + nodes / 2;
    if (room > INT32_MAX) room = INT32_MAX;
    uint64_t *met = shv_reallocate(bars->memory, SHV_PART_BARS, bars->met, (size_t)room, sizeof *met);
    if (met) bars->met = met;
    int32_t *seen = shv_reallocate(bars->memory, SHV_PART_BARS, bars->seen, (size_t)room, sizeof *seen);
    if (seen) bars->seen = seen;
    if (!met || !seen) return shv_fail_memory(error, "the nodes of bars", (size_t)room * (sizeof *met + sizeof *seen));
    for (int64_t i = bars->node_room; i < room; i++) seen[i] = -1;
    bars->node_room = (int32_t)room;
    return SHV_OK;
}

static ShvStatus allocate(ShvBars *bars, ShvError *error)
{
    const ShvMesh *mesh = &bars->model->mesh;
    const size_t chunks = (size_t)bars->chunk_count, items = (size_t)largest_chunk(bars);
    bars->chunks = shv_allocate(bars->memory, SHV_PART_BARS, chunks, sizeof *bars->chunks);
    bars->dirty = shv_allocate(bars->memory, SHV_PART_BARS, chunks, 1);
    bars->awake = shv_allocate(bars->memory, SHV_PART_BARS, (size_t)mesh->element_count, 1);
    bars->items = shv_allocate(bars->memory, SHV_PART_BARS, (size_t)bars->corners * items, sizeof *bars->items);
    bars->item_colour = shv_allocate(bars->memory, SHV_PART_BARS, items, 1);
    if (!bars->chunks || !bars->dirty || !bars->awake || !bars->items || !bars->item_colour)
        return shv_fail_memory(error, "bars", (size_t)mesh->element_count + 20 * chunks + 17 * items);
    return reserve_nodes(bars, mesh->node_count, error);
}

ShvStatus shv_bars_create(ShvBars *bars, const ShvModel *model, ShvBarForm form, ShvError *error)
{
    const bool edge = form == SHV_BARS_EDGE;
    *bars = (ShvBars){.memory = model->memory,
                      .model = model,
                      .form = form,
                      .corners = edge ? 2 : 4,
                      .edges = edge ? 1 : 6,
                      .known_nodes = model->mesh.node_count,
                      .chunk_count = (model->mesh.node_count + SHV_BAR_CHUNK_NODES - 1) / SHV_BAR_CHUNK_NODES};
    ShvStatus status = find_corners(bars, error);
    if (status == SHV_OK) status = allocate(bars, error);
    if (status == SHV_OK) status = shv_bar_chunks_colour(bars, error);
    if (status != SHV_OK) shv_bars_release(bars);
    return status;
}

void shv_bars_release(ShvBars *bars)
{
    shv_release(bars->chunks);
    shv_release(bars->colour_start);
    shv_release(bars->chunk_order);
    shv_release(bars->ends);
    shv_release(bars->rest);
    shv_release(bars->awake);
    shv_release(bars->dirty);
    shv_release(bars->own_start);
    shv_release(bars->own_list);
    shv_release(bars->met);
    shv_release(bars->seen);
    shv_release(bars->items);
    shv_release(bars->item_colour);
    *bars = (ShvBars){0};
}

/* ---- update ---- */

/* Chunks of the element's corners up to a reference node. */
static void mark_element(ShvBars *bars, int32_t element, int32_t highest)
{
    for (int32_t corner = 0; corner < 4; corner++) {
        const int32_t origin = shv_bar_origin(bars, element, corner);
        if (origin <= highest) bars->dirty[origin / SHV_BAR_CHUNK_NODES] = 1;
    }
}

/* Edges and tets at the copies of a node have changed; they belong to it or to nodes of lower number around it. */
static void mark_duplicated(ShvBars *bars, const ShvState *state)
{
    for (int32_t node = bars->known_nodes; node < state->node_count; node++) {
        const int32_t origin = state->origin[node];
        for (int32_t i = bars->corner_start[origin]; i < bars->corner_start[origin + 1]; i++)
            mark_element(bars, bars->corner_list[i] / 4, origin);
    }
    bars->known_nodes = state->node_count;
}

static void mark_switched(ShvBars *bars, const ShvState *state, const uint8_t *flags)
{
    for (int32_t e = 0; e < state->element_count; e++) {
        const uint8_t awake = !flags || flags[state->element_fragment[e]];
        if (awake == bars->awake[e]) continue;
        bars->awake[e] = awake;
        mark_element(bars, e, INT32_MAX);
    }
}

/* When most of the room is gaps, all chunks move together again. */
static void close_gaps(ShvBars *bars)
{
    if (bars->batch_end / 2 <= bars->batch_held) return;
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++)
        bars->chunks[chunk] = (ShvBarChunk){.items = bars->chunks[chunk].items};
    memset(bars->dirty, 1, (size_t)bars->chunk_count);
    bars->batch_end = bars->batch_held = 0;
}

ShvStatus shv_bars_update(ShvBars *bars, const ShvState *state, const uint8_t *flags, ShvError *error)
{
    SHV_TRY(reserve_nodes(bars, state->node_count, error));
    mark_duplicated(bars, state);
    mark_switched(bars, state, flags);
    close_gaps(bars);
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++) {
        if (!bars->dirty[chunk]) continue;
        SHV_TRY(shv_bar_chunk_make(bars, state, chunk, error));
        bars->dirty[chunk] = 0;
    }
    return SHV_OK;
}
