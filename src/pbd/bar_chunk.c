#include "pbd/bar_chunk.h"

#include <string.h>

#include "pbd/bar_kernel.h"

/* Colours of items kept as bits at the nodes. An item that meets all of them gets a batch of its own. */
enum { ALONE = 63 };

/* ---- items ---- */

static int32_t add_tets(ShvBars *bars, const ShvState *state, int32_t origin, int32_t count)
{
    for (int32_t i = bars->corner_start[origin]; i < bars->corner_start[origin + 1]; i++) {
        const int32_t element = bars->corner_list[i] / 4;
        bool lowest = bars->awake[element] != 0;
        for (int32_t corner = 0; corner < 4; corner++) lowest &= shv_bar_origin(bars, element, corner) >= origin;
        if (!lowest) continue;
        for (int32_t corner = 0; corner < 4; corner++)
            bars->items[4 * count + corner] = shv_state_node(state, element, corner);
        count++;
    }
    return count;
}

/* `seen` remembers the last edge to a node; where copies of the origin take turns, the list itself is searched. */
static bool is_new_edge(ShvBars *bars, int32_t from, int32_t to, int32_t first, int32_t count)
{
    if (bars->seen[to] == from) return false;
    bars->seen[to] = from;
    for (int32_t i = first; i < count; i++)
        if (bars->items[2 * i] == from && bars->items[2 * i + 1] == to) return false;
    return true;
}

static int32_t add_edges(ShvBars *bars, const ShvState *state, int32_t origin, int32_t count)
{
    const int32_t first = count;
    for (int32_t i = bars->corner_start[origin]; i < bars->corner_start[origin + 1]; i++) {
        const int32_t element = bars->corner_list[i] / 4, corner = bars->corner_list[i] % 4;
        if (!bars->awake[element]) continue;
        const int32_t from = shv_state_node(state, element, corner);
        for (int32_t other = 0; other < 4; other++) {
            if (shv_bar_origin(bars, element, other) <= origin) continue;
            const int32_t to = shv_state_node(state, element, other);
            if (!is_new_edge(bars, from, to, first, count)) continue;
            bars->items[2 * count] = from;
            bars->items[2 * count + 1] = to;
            count++;
        }
    }
    return count;
}

static int32_t collect(ShvBars *bars, const ShvState *state, int32_t chunk)
{
    int32_t count = 0;
    const int32_t end = shv_bar_chunk_end(bars, chunk);
    for (int32_t origin = chunk * SHV_BAR_CHUNK_NODES; origin < end; origin++)
        count =
            bars->form == SHV_BARS_EDGE ? add_edges(bars, state, origin, count) : add_tets(bars, state, origin, count);
    for (int32_t i = 0; i < bars->corners * count; i++) bars->seen[bars->items[i]] = -1;
    return count;
}

/* ---- colours and batches ---- */

/* Gives every item the lowest colour its nodes have not met; counts items per colour. */
static void colour_items(ShvBars *bars, int32_t count, int32_t *colour_count)
{
    const int32_t corners = bars->corners;
    for (int32_t item = 0; item < count; item++) {
        const int32_t *nodes = bars->items + corners * item;
        uint64_t taken = 0;
        for (int32_t c = 0; c < corners; c++) taken |= bars->met[nodes[c]];
        int32_t colour = 0;
        while (colour < ALONE && ((taken >> colour) & 1)) colour++;
        if (colour < ALONE)
            for (int32_t c = 0; c < corners; c++) bars->met[nodes[c]] |= UINT64_C(1) << colour;
        bars->item_colour[item] = (uint8_t)colour;
        colour_count[colour]++;
    }
    for (int32_t i = 0; i < corners * count; i++) bars->met[bars->items[i]] = 0;
}

/* First batch of each colour within the chunk; answers the number of all. */
static int32_t place_colours(const int32_t *colour_count, int32_t *colour_batch)
{
    int32_t batches = 0;
    for (int32_t colour = 0; colour <= ALONE; colour++) {
        colour_batch[colour] = batches;
        batches += colour == ALONE ? colour_count[colour] : (colour_count[colour] + SHV_LANES - 1) / SHV_LANES;
    }
    return batches;
}

static ShvStatus reserve_batches(ShvBars *bars, int64_t wanted, ShvError *error)
{
    if (wanted <= bars->batch_capacity) return SHV_OK;
    int64_t capacity = wanted + wanted / 4 + 16;
    if (capacity > INT32_MAX) capacity = INT32_MAX;
    const size_t ends = (size_t)bars->corners * SHV_LANES, rests = (size_t)bars->edges * SHV_LANES;
    int32_t *grown_ends =
        shv_reallocate(bars->memory, SHV_PART_BARS, bars->ends, (size_t)capacity * ends, sizeof *grown_ends);
    if (grown_ends) bars->ends = grown_ends;
    double *grown_rest =
        shv_reallocate(bars->memory, SHV_PART_BARS, bars->rest, (size_t)capacity * rests, sizeof *grown_rest);
    if (grown_rest) bars->rest = grown_rest;
    if (!grown_ends || !grown_rest || wanted > INT32_MAX)
        return shv_fail_memory(error, "bars", (size_t)capacity * (ends * sizeof(int32_t) + rests * sizeof(double)));
    bars->batch_capacity = (int32_t)capacity;
    return SHV_OK;
}

/* A chunk that outgrew its place moves to the end, with some room to grow on. */
static ShvStatus make_room(ShvBars *bars, ShvBarChunk *chunk, int32_t batches, ShvError *error)
{
    if (batches > chunk->room) {
        const int32_t room = chunk->room == 0 ? batches : batches + batches / 4 + 1;
        SHV_TRY(reserve_batches(bars, (int64_t)bars->batch_end + room, error));
        bars->batch_held += room - chunk->room;
        chunk->first = bars->batch_end;
        chunk->room = room;
        bars->batch_end += room;
    }
    chunk->count = batches;
    return SHV_OK;
}

static double rest_length(const ShvState *state, const int32_t *nodes, int edge)
{
    const ShvVec3 a = shv_load3(state->reference + 3 * (int64_t)nodes[shv_tet_edges[edge][0]]);
    const ShvVec3 b = shv_load3(state->reference + 3 * (int64_t)nodes[shv_tet_edges[edge][1]]);
    return shv_norm(shv_sub(a, b));
}

/* Puts an item into one lane, or, when it is the first of its batch, into all. */
static void store_item(ShvBars *bars, const ShvState *state, const int32_t *nodes, int64_t batch, int32_t lane)
{
    const int32_t last = lane == 0 ? SHV_LANES : lane + 1;
    for (int32_t corner = 0; corner < bars->corners; corner++)
        for (int32_t i = lane; i < last; i++)
            bars->ends[(batch * bars->corners + corner) * SHV_LANES + i] = nodes[corner];
    for (int edge = 0; edge < bars->edges; edge++) {
        const double rest = rest_length(state, nodes, edge);
        for (int32_t i = lane; i < last; i++) bars->rest[(batch * bars->edges + edge) * SHV_LANES + i] = rest;
    }
}

static void store_items(ShvBars *bars, const ShvState *state, int32_t first, int32_t count, const int32_t *colour_batch)
{
    int32_t filled[ALONE + 1] = {0};
    for (int32_t item = 0; item < count; item++) {
        const int32_t colour = bars->item_colour[item], place = filled[colour]++;
        const int32_t batch = first + colour_batch[colour] + (colour == ALONE ? place : place / SHV_LANES);
        store_item(bars, state, bars->items + bars->corners * item, batch, colour == ALONE ? 0 : place % SHV_LANES);
    }
}

ShvStatus shv_bar_chunk_make(ShvBars *bars, const ShvState *state, int32_t index, ShvError *error)
{
    int32_t colour_count[ALONE + 1] = {0}, colour_batch[ALONE + 1];
    ShvBarChunk *chunk = &bars->chunks[index];
    const int32_t count = collect(bars, state, index);
    colour_items(bars, count, colour_count);
    SHV_TRY(make_room(bars, chunk, place_colours(colour_count, colour_batch), error));
    store_items(bars, state, chunk->first, count, colour_batch);
    bars->bar_count += (int64_t)bars->edges * (count - chunk->items);
    chunk->items = count;
    return SHV_OK;
}

/* ---- colours of chunks ---- */

/* Colours of chunks kept as bits at the nodes. A chunk that meets all of them runs alone. */
enum { SHARED_COLOURS = 64 };

/* All nodes that items of the chunk may touch: its own, and those of higher number around them. */
static uint64_t visit_nodes(ShvBars *bars, int32_t chunk, uint64_t mark)
{
    uint64_t taken = 0;
    const int32_t end = shv_bar_chunk_end(bars, chunk);
    for (int32_t origin = chunk * SHV_BAR_CHUNK_NODES; origin < end; origin++)
        for (int32_t i = bars->corner_start[origin]; i < bars->corner_start[origin + 1]; i++)
            for (int32_t corner = 0; corner < 4; corner++) {
                const int32_t node = shv_bar_origin(bars, bars->corner_list[i] / 4, corner);
                if (node < origin) continue;
                taken |= bars->met[node];
                bars->met[node] |= mark;
            }
    return taken;
}

static int32_t colour_chunks(ShvBars *bars, int32_t *colours)
{
    int32_t shared = 0;
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++) {
        const uint64_t taken = visit_nodes(bars, chunk, 0);
        int32_t colour = 0;
        while (colour < SHARED_COLOURS && ((taken >> colour) & 1)) colour++;
        colours[chunk] = colour < SHARED_COLOURS ? colour : -1;
        if (colour == SHARED_COLOURS) continue;
        visit_nodes(bars, chunk, UINT64_C(1) << colour);
        if (colour >= shared) shared = colour + 1;
    }
    int32_t count = shared;
    for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++)
        if (colours[chunk] < 0) colours[chunk] = count++;
    memset(bars->met, 0, (size_t)bars->model->mesh.node_count * sizeof *bars->met);
    return count;
}

static void sort_chunks(ShvBars *bars, const int32_t *colours)
{
    int32_t place = 0;
    for (int32_t colour = 0; colour < bars->colour_count; colour++) {
        bars->colour_start[colour] = place;
        for (int32_t chunk = 0; chunk < bars->chunk_count; chunk++)
            if (colours[chunk] == colour) bars->chunk_order[place++] = chunk;
    }
    bars->colour_start[bars->colour_count] = place;
}

ShvStatus shv_bar_chunks_colour(ShvBars *bars, ShvError *error)
{
    const size_t chunks = (size_t)bars->chunk_count, size = sizeof(int32_t);
    int32_t *colours = shv_allocate(bars->memory, SHV_PART_BARS, chunks, size);
    if (!colours) return shv_fail_memory(error, "the colours of bars", chunks * size);
    bars->colour_count = colour_chunks(bars, colours);
    bars->colour_start = shv_allocate(bars->memory, SHV_PART_BARS, (size_t)bars->colour_count + 1, size);
    bars->chunk_order = shv_allocate(bars->memory, SHV_PART_BARS, chunks, size);
    const bool made = bars->colour_start && bars->chunk_order;
    if (made) sort_chunks(bars, colours);
    shv_release(colours);
    return made ? SHV_OK
                : shv_fail_memory(error, "the order of bars", (chunks + (size_t)bars->colour_count + 1) * size);
}
