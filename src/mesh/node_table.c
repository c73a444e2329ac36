#include "mesh/node_table.h"

static ShvStatus allocate(ShvNodeTable *table, ShvMemory *memory, int64_t capacity, ShvError *error)
{
    *table = (ShvNodeTable){.memory = memory, .capacity = capacity};
    table->keys = shv_allocate(memory, SHV_PART_GENERAL, (size_t)capacity, sizeof *table->keys);
    table->nodes = shv_allocate(memory, SHV_PART_GENERAL, (size_t)capacity, sizeof *table->nodes);
    if (table->keys && table->nodes) return SHV_OK;
    shv_node_table_release(table);
    return shv_fail_memory(error, "the nodes of a mesh", (size_t)capacity * 12);
}

ShvStatus shv_node_table_create(ShvNodeTable *table, ShvMemory *memory, ShvError *error)
{
    enum { START = 1024 };
    SHV_TRY(allocate(table, memory, START, error));
    table->positions = shv_allocate(memory, SHV_PART_MESH, 3 * START / 2, sizeof *table->positions);
    if (table->positions) return SHV_OK;
    shv_node_table_release(table);
    return shv_fail_memory(error, "the nodes of a mesh", 3 * START / 2 * sizeof *table->positions);
}

void shv_node_table_release(ShvNodeTable *table)
{
    shv_release(table->positions);
    shv_release(table->keys);
    shv_release(table->nodes);
    *table = (ShvNodeTable){0};
}

/* Slot of a key, or the free one where it belongs. */
static int64_t slot_of(const ShvNodeTable *table, uint64_t key)
{
    const uint64_t mixed = key * UINT64_C(0x9e3779b97f4a7c15); /* Fibonacci hashing: 2^64 / golden ratio */
    int64_t slot = (int64_t)((mixed ^ mixed >> 32) & (uint64_t)(table->capacity - 1));
    while (table->nodes[slot] && table->keys[slot] != key) slot = (slot + 1) & (table->capacity - 1);
    return slot;
}

static ShvStatus grow(ShvNodeTable *table, ShvError *error)
{
    if (table->count >= SHV_MESH_LARGEST)
        return shv_fail(error, SHV_BAD_INPUT, "a mesh has more than %lld nodes; use longer edges",
                        (long long)SHV_MESH_LARGEST);
    ShvNodeTable larger;
    SHV_TRY(allocate(&larger, table->memory, 2 * table->capacity, error));
    const size_t length = 3 * (size_t)table->capacity;
    double *positions = shv_reallocate(table->memory, SHV_PART_MESH, table->positions, length, sizeof *positions);
    if (!positions) {
        shv_node_table_release(&larger);
        return shv_fail_memory(error, "the nodes of a mesh", length * sizeof *positions);
    }
    for (int64_t old = 0; old < table->capacity; old++) {
        if (!table->nodes[old]) continue;
        const int64_t slot = slot_of(&larger, table->keys[old]);
        larger.keys[slot] = table->keys[old];
        larger.nodes[slot] = table->nodes[old];
    }
    larger.positions = positions;
    larger.count = table->count;
    table->positions = NULL;
    shv_node_table_release(table);
    *table = larger;
    return SHV_OK;
}

ShvStatus shv_node_table_find(ShvNodeTable *table, uint64_t key, int32_t *node, bool *added, ShvError *error)
{
    int64_t slot = slot_of(table, key);
    *added = table->nodes[slot] == 0;
    if (*added) {
        if (2 * (int64_t)table->count >= table->capacity) {
            SHV_TRY(grow(table, error));
            slot = slot_of(table, key);
        }
        table->keys[slot] = key;
        table->nodes[slot] = ++table->count;
    }
    *node = table->nodes[slot] - 1;
    return SHV_OK;
}

ShvStatus shv_node_table_take(ShvNodeTable *table, ShvMesh *mesh, ShvError *error)
{
    const size_t length = 3 * (size_t)table->count;
    double *positions = shv_reallocate(table->memory, SHV_PART_MESH, table->positions, length, sizeof *positions);
    if (!positions) return shv_fail_memory(error, "the nodes of a mesh", length * sizeof *positions);
    table->positions = NULL;
    shv_release(mesh->positions);
    mesh->positions = positions;
    mesh->node_count = table->count;
    return SHV_OK;
}
