#include "contact/node_grid.h"

#include "contact/candidates.h"

/* A key has 19 bits an axis and 5 for the level. */
enum { AXIS_BITS = 19, TOP_LEVEL = 31 };
static const double most_cubes = 262144.0;

void shv_node_grid_release(ShvNodeGrid *grid)
{
    shv_release(grid->keys);
    shv_release(grid->items);
    shv_release(grid->next);
    shv_release(grid->heads);
    shv_release(grid->found);
    *grid = (ShvNodeGrid){0};
}

void shv_node_grid_scale(ShvNodeGrid *grid, ShvBox region, double smallest)
{
    grid->origin = region.low;
    grid->size = fmax(smallest, shv_box_size(&region) / most_cubes);
    if (!(grid->size > 0.0)) grid->size = 1.0; /* one point */
}

int shv_node_grid_level(const ShvNodeGrid *grid, double size)
{
    int level = 0;
    for (double cube = grid->size; cube < size && level < TOP_LEVEL; cube *= 2.0) level++;
    return level;
}

static ShvStatus reserve(ShvNodeGrid *grid, int64_t entries, ShvError *error)
{
    if (entries > INT32_MAX / 4) return shv_fail_memory(error, "contact of surfaces", (size_t)entries * 16);
    const size_t count = (size_t)entries;
    if (grid->capacity < entries) {
        uint64_t *keys = shv_reallocate(grid->memory, SHV_PART_CONTACT, grid->keys, count, sizeof *keys);
        if (!keys) return shv_fail_memory(error, "contact of surfaces", count * sizeof *keys);
        grid->keys = keys;
        int32_t *items = shv_reallocate(grid->memory, SHV_PART_CONTACT, grid->items, count, sizeof *items);
        if (!items) return shv_fail_memory(error, "contact of surfaces", count * sizeof *items);
        grid->items = items;
        int32_t *next = shv_reallocate(grid->memory, SHV_PART_CONTACT, grid->next, count, sizeof *next);
        if (!next) return shv_fail_memory(error, "contact of surfaces", count * sizeof *next);
        grid->next = next;
        grid->capacity = (int32_t)entries;
    }
    for (grid->head_bits = 6; ((int64_t)1 << grid->head_bits) < entries;) grid->head_bits++;
    const int32_t heads = (int32_t)1 << grid->head_bits;
    if (grid->head_capacity < heads) {
        int32_t *grown = shv_reallocate(grid->memory, SHV_PART_CONTACT, grid->heads, (size_t)heads, sizeof *grown);
        if (!grown) return shv_fail_memory(error, "contact of surfaces", (size_t)heads * sizeof *grown);
        grid->heads = grown;
        grid->head_capacity = heads;
    }
    return SHV_OK;
}

ShvStatus shv_node_grid_start(ShvNodeGrid *grid, ShvBox region, double smallest, uint32_t levels, int32_t nodes,
                              ShvError *error)
{
    int used = 0;
    for (uint32_t bits = levels; bits; bits &= bits - 1) used++;
    SHV_TRY(reserve(grid, (int64_t)used * nodes, error));
    shv_node_grid_scale(grid, region, smallest);
    grid->levels = levels;
    grid->count = 0;
    for (int32_t k = 0; k < (int32_t)1 << grid->head_bits; k++) grid->heads[k] = -1;
    return SHV_OK;
}

/* What lies outside the region, or nowhere, counts to its rim. */
static uint64_t cell(double x, double origin, double size)
{
    const double at = floor((x - origin) / size) + 1.0, last = (double)((1 << AXIS_BITS) - 1);
    return at > 0.0 ? (uint64_t)(at < last ? at : last) : 0;
}

static uint64_t key_of(int level, uint64_t x, uint64_t y, uint64_t z)
{
    return ((((uint64_t)level << AXIS_BITS | x) << AXIS_BITS | y) << AXIS_BITS) | z;
}

/* Fibonacci hashing: the high bits of a product with 2⁶⁴ / golden ratio. */
static uint64_t hash_of(const ShvNodeGrid *grid, uint64_t key)
{
    const uint64_t mixed = (key ^ (key >> 31)) * UINT64_C(0x9E3779B97F4A7C15);
    return mixed >> (64 - grid->head_bits);
}

void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, ShvVec3 position)
{
    double size = grid->size;
    for (int level = 0; grid->levels >> level; level++, size *= 2.0) {
        if (!(grid->levels >> level & 1u)) continue;
        const uint64_t key = key_of(level, cell(position.x, grid->origin.x, size),
                                    cell(position.y, grid->origin.y, size), cell(position.z, grid->origin.z, size));
        const uint64_t hash = hash_of(grid, key);
        grid->keys[grid->count] = key;
        grid->items[grid->count] = item;
        grid->next[grid->count] = grid->heads[hash];
        grid->heads[hash] = grid->count++;
        if (level == TOP_LEVEL) break;
    }
}

/* The level in use that fits best: the lowest at or above its own, or the highest. */
static int level_for(const ShvNodeGrid *grid, double size)
{
    int highest = 0;
    const int own = shv_node_grid_level(grid, size);
    for (int level = 0; level <= TOP_LEVEL; level++) {
        if (!(grid->levels >> level & 1u)) continue;
        highest = level;
        if (level >= own) break;
    }
    return highest;
}

static ShvStatus collect(ShvNodeGrid *grid, uint64_t key, ShvError *error)
{
    for (int32_t k = grid->heads[hash_of(grid, key)]; k >= 0; k = grid->next[k]) {
        if (grid->keys[k] != key) continue;
        void *block = grid->found;
        SHV_TRY(shv_candidates_grow(grid->memory, &block, &grid->found_capacity, grid->found_count, sizeof(int32_t),
                                    error));
        grid->found = block;
        grid->found[grid->found_count++] = grid->items[k];
    }
    return SHV_OK;
}

ShvStatus shv_node_grid_find(ShvNodeGrid *grid, ShvBox box, ShvError *error)
{
    grid->found_count = 0;
    const int level = level_for(grid, shv_box_size(&box));
    double size = grid->size;
    for (int k = 0; k < level; k++) size *= 2.0;
    const ShvVec3 o = grid->origin;
    const uint64_t low[3] = {cell(box.low.x, o.x, size), cell(box.low.y, o.y, size), cell(box.low.z, o.z, size)};
    const uint64_t high[3] = {cell(box.high.x, o.x, size), cell(box.high.y, o.y, size), cell(box.high.z, o.z, size)};
    for (uint64_t x = low[0]; x <= high[0]; x++)
        for (uint64_t y = low[1]; y <= high[1]; y++)
            for (uint64_t z = low[2]; z <= high[2]; z++) SHV_TRY(collect(grid, key_of(level, x, y, z), error));
    return SHV_OK;
}
