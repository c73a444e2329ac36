#include "mesh/edge_table.h"

#include "base/random.h"

ShvStatus shv_edge_table_create(ShvEdgeTable *table, ShvMemory *memory, const int32_t *triangles, int64_t half_edges,
                                ShvError *error)
{
    /* At most half full: probe sequences stay short. */
    uint64_t size = 16;
    while (size < 2 * (uint64_t)half_edges) size *= 2;
    *table = (ShvEdgeTable){.triangles = triangles, .mask = size - 1};
    table->slots = shv_allocate(memory, SHV_PART_GENERAL, size, sizeof *table->slots);
    if (table->slots) return SHV_OK;
    *table = (ShvEdgeTable){0};
    return shv_fail_memory(error, "the edges of a surface", size * sizeof(int32_t));
}

void shv_edge_table_release(ShvEdgeTable *table)
{
    shv_release(table->slots);
    *table = (ShvEdgeTable){0};
}

/* The slot that holds the directed edge, or the free one where it belongs. */
static uint64_t slot_of(const ShvEdgeTable *table, int32_t from, int32_t to)
{
    uint64_t slot = shv_random_bits((uint64_t)(uint32_t)from, (uint64_t)(uint32_t)to) & table->mask;
    while (table->slots[slot]) {
        const int32_t there = table->slots[slot] - 1;
        if (shv_half_edge_start(table->triangles, there) == from && shv_half_edge_end(table->triangles, there) == to)
            return slot;
        slot = (slot + 1) & table->mask;
    }
    return slot;
}

int32_t shv_edge_table_insert(ShvEdgeTable *table, int32_t half_edge)
{
    const uint64_t slot = slot_of(table, shv_half_edge_start(table->triangles, half_edge),
                                  shv_half_edge_end(table->triangles, half_edge));
    const int32_t there = table->slots[slot] - 1;
    if (there < 0) table->slots[slot] = half_edge + 1;
    return there;
}

int32_t shv_edge_table_find(const ShvEdgeTable *table, int32_t from, int32_t to)
{
    return table->slots[slot_of(table, from, to)] - 1;
}
