#include "solid/colour.h"

/* Chunks are large enough that few of their nodes are shared, and numerous enough to keep threads busy in every colour.
   Their size depends on the mesh alone. */
enum { LARGEST_CHUNK = 64, SMALLEST_CHUNK = 4, WANTED_CHUNKS = 256 };

/* Colours kept as bits at the nodes. A chunk that meets all of them, in a mesh without locality, runs alone. */
enum { SHARED_COLOURS = 64 };

static int32_t chunk_end(const ShvSolid *solid, int32_t chunk)
{
    const int64_t end = ((int64_t)chunk + 1) * solid->chunk_batches;
    return end < solid->batch_count ? (int32_t)end : solid->batch_count;
}

/* The lowest colour that no node of the chunk has met; −1: none is left. Marks it at the nodes. */
static int32_t colour_chunk(const ShvSolid *solid, const ShvState *state, int32_t chunk, uint64_t *met)
{
    const int64_t begin = (int64_t)chunk * solid->chunk_batches * (4 * SHV_LANES);
    const int64_t end = (int64_t)chunk_end(solid, chunk) * (4 * SHV_LANES);
    uint64_t taken = 0;
    for (int64_t i = begin; i < end; i++) taken |= met[state->connectivity[i]];
    if (taken == UINT64_MAX) return -1;
    int32_t colour = 0;
    while ((taken >> colour) & 1) colour++;
    for (int64_t i = begin; i < end; i++) met[state->connectivity[i]] |= UINT64_C(1) << colour;
    return colour;
}

/* Colours all chunks; those that run alone get colours of their own after the shared ones. */
static int32_t colour_chunks(const ShvSolid *solid, const ShvState *state, uint64_t *met, int32_t *colours)
{
    int32_t shared = 0;
    for (int32_t chunk = 0; chunk < solid->chunk_count; chunk++) {
        colours[chunk] = colour_chunk(solid, state, chunk, met);
        if (colours[chunk] >= shared) shared = colours[chunk] + 1;
    }
    int32_t count = shared;
    for (int32_t chunk = 0; chunk < solid->chunk_count; chunk++)
        if (colours[chunk] < 0) colours[chunk] = count++;
    return count;
}

/* Counting sort of the chunks by colour, in increasing order within one. */
static void order_chunks(ShvSolid *solid, const int32_t *colours)
{
    for (int32_t chunk = 0; chunk < solid->chunk_count; chunk++) solid->colour_start[colours[chunk] + 1]++;
    for (int32_t colour = 0; colour < solid->colour_count; colour++)
        solid->colour_start[colour + 1] += solid->colour_start[colour];
    for (int32_t chunk = solid->chunk_count - 1; chunk >= 0; chunk--)
        solid->chunk_order[--solid->colour_start[colours[chunk] + 1]] = chunk;
    /* Filling from the back has moved every end to its colour's start. */
    for (int32_t colour = 0; colour < solid->colour_count; colour++)
        solid->colour_start[colour] = solid->colour_start[colour + 1];
    solid->colour_start[solid->colour_count] = solid->chunk_count;
}

static ShvStatus fill(ShvSolid *solid, const ShvState *state, uint64_t *met, ShvError *error)
{
    const size_t chunks = (size_t)solid->chunk_count, size = sizeof *solid->chunk_colour;
    int32_t *colours = solid->chunk_colour;
    if (!met || !colours)
        return shv_fail_memory(error, "the colours of elements",
                               (size_t)state->node_count * sizeof *met + chunks * size);
    solid->colour_count = colour_chunks(solid, state, met, colours);
    solid->colour_start = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->colour_count + 1, size);
    solid->chunk_order = shv_allocate(solid->memory, SHV_PART_STATE, chunks, size);
    if (!solid->colour_start || !solid->chunk_order)
        return shv_fail_memory(error, "the order of elements", (chunks + (size_t)solid->colour_count + 1) * size);
    order_chunks(solid, colours);
    return SHV_OK;
}

ShvStatus shv_solid_colour(ShvSolid *solid, const ShvState *state, ShvError *error)
{
    int32_t batches = solid->batch_count / WANTED_CHUNKS;
    if (batches > LARGEST_CHUNK) batches = LARGEST_CHUNK;
    if (batches < SMALLEST_CHUNK) batches = SMALLEST_CHUNK;
    solid->chunk_batches = batches;
    solid->chunk_count = (solid->batch_count + batches - 1) / batches;
    uint64_t *met = shv_allocate(solid->memory, SHV_PART_STATE, (size_t)state->node_count, sizeof *met);
    solid->chunk_colour =
        shv_allocate(solid->memory, SHV_PART_STATE, (size_t)solid->chunk_count, sizeof *solid->chunk_colour);
    const ShvStatus status = fill(solid, state, met, error);
    shv_release(met);
    return status;
}
