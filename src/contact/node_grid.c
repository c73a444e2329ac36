#include "contact/node_grid.h"

#include "contact/candidates.h"

/* A key has 18 bits an axis, and the speed class above them. */
enum { AXIS_BITS = 18 };
static const double most_cubes = 131072.0;

void shv_node_grid_release(ShvNodeGrid *grid)
{
    shv_release(grid->entries);
    shv_release(grid->sorted);
    shv_release(grid->starts);
    shv_release(grid->found);
    *grid = (ShvNodeGrid){0};
}

static ShvStatus reserve_starts(ShvNodeGrid *grid, int64_t entries, ShvError *error)
{
    for (grid->start_bits = 6; ((int64_t)1 << grid->start_bits) < entries;) grid->start_bits++;
    const size_t starts = ((size_t)1 << grid->start_bits) + 1;
    if ((size_t)grid->start_capacity >= starts) return SHV_OK;
    SHV_RESIZE(grid->memory, SHV_PART_CONTACT, grid->starts, starts, "contact of surfaces",
               starts * sizeof *grid->starts, error);
    grid->start_capacity = (int32_t)starts;
    return SHV_OK;
}

static ShvStatus reserve(ShvNodeGrid *grid, int64_t entries, ShvError *error)
{
    const size_t count = (size_t)(entries + entries / 4), bytes = count * sizeof(ShvGridEntry);
    if (entries > INT32_MAX / 4) return shv_fail_memory(error, "contact of surfaces", bytes);
    SHV_TRY(reserve_starts(grid, entries, error));
    if (grid->capacity >= entries) return SHV_OK;
    SHV_RESIZE(grid->memory, SHV_PART_CONTACT, grid->entries, count, "contact of surfaces", bytes, error);
    SHV_RESIZE(grid->memory, SHV_PART_CONTACT, grid->sorted, count, "contact of surfaces", bytes, error);
    grid->capacity = (int32_t)count;
    return SHV_OK;
}

ShvStatus shv_node_grid_start(ShvNodeGrid *grid, ShvBox region, const double size[SHV_GRID_SPEED_CLASSES],
                              int32_t points, ShvError *error)
{
    grid->count = 0;
    grid->origin = region.low;
    for (int speed_class = 0; speed_class < SHV_GRID_SPEED_CLASSES; speed_class++) {
        grid->size[speed_class] = fmax(size[speed_class], shv_box_size(&region) / most_cubes);
        grid->points[speed_class] = 0;
    }
    return reserve(grid, points, error);
}

/* What lies outside the region, or nowhere, counts to its rim. */
static uint64_t cell(double x, double origin, double size)
{
    const double at = floor((x - origin) / size) + 1.0, last = (double)((1 << AXIS_BITS) - 1);
    return at > 0.0 ? (uint64_t)(at < last ? at : last) : 0;
}

static uint64_t key_of(int speed_class, uint64_t x, uint64_t y, uint64_t z)
{
    return ((((uint64_t)speed_class << AXIS_BITS | x) << AXIS_BITS | y) << AXIS_BITS) | z;
}

/* Fibonacci hashing: the high bits of a product with 2⁶⁴ / golden ratio. */
static uint64_t hash_of(const ShvNodeGrid *grid, uint64_t key)
{
    const uint64_t mixed = (key ^ (key >> 31)) * UINT64_C(0x9E3779B97F4A7C15);
    return mixed >> (64 - grid->start_bits);
}

void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, int speed_class, ShvVec3 position)
{
    const ShvVec3 o = grid->origin;
    const double size = grid->size[speed_class];
    const uint64_t x = cell(position.x, o.x, size), y = cell(position.y, o.y, size), z = cell(position.z, o.z, size);
    grid->points[speed_class]++;
    grid->entries[grid->count++] =
        (ShvGridEntry){.key = key_of(speed_class, x, y, z), .position = position, .item = item};
}

/* Counting sort: entries of a cube stay in the order in which they came. */
void shv_node_grid_finish(ShvNodeGrid *grid)
{
    const int32_t buckets = (int32_t)1 << grid->start_bits;
    for (int32_t k = 0; k <= buckets; k++) grid->starts[k] = 0;
    for (int32_t k = 0; k < grid->count; k++) grid->starts[hash_of(grid, grid->entries[k].key)]++;
    for (int32_t k = 1; k <= buckets; k++) grid->starts[k] += grid->starts[k - 1];
    for (int32_t k = grid->count - 1; k >= 0; k--)
        grid->sorted[--grid->starts[hash_of(grid, grid->entries[k].key)]] = grid->entries[k];
}

static ShvStatus take(ShvNodeGrid *grid, int32_t item, ShvError *error)
{
    if (grid->found_count == grid->found_capacity) {
        void *block = grid->found;
        SHV_TRY(shv_candidates_grow(grid->memory, &block, &grid->found_capacity, grid->found_count, sizeof(int32_t),
                                    error));
        grid->found = block;
    }
    grid->found[grid->found_count++] = item;
    return SHV_OK;
}

static ShvStatus take_from_cube(ShvNodeGrid *grid, uint64_t key, const ShvBox *box, ShvError *error)
{
    const uint64_t hash = hash_of(grid, key);
    const int32_t end = grid->starts[hash + 1];
    for (int32_t k = grid->starts[hash]; k < end; k++)
        if (grid->sorted[k].key == key && shv_box_holds(box, grid->sorted[k].position))
            SHV_TRY(take(grid, grid->sorted[k].item, error));
    return SHV_OK;
}

/* A box of more cubes than there are points. */
static ShvStatus take_from_all(ShvNodeGrid *grid, int speed_class, const ShvBox *box, ShvError *error)
{
    for (int32_t k = 0; k < grid->count; k++)
        if (grid->entries[k].key >> (3 * AXIS_BITS) == (uint64_t)speed_class &&
            shv_box_holds(box, grid->entries[k].position))
            SHV_TRY(take(grid, grid->entries[k].item, error));
    return SHV_OK;
}

ShvStatus shv_node_grid_find(ShvNodeGrid *grid, int speed_class, ShvBox box, ShvError *error)
{
    grid->found_count = 0;
    if (grid->points[speed_class] == 0) return SHV_OK;
    const double size = grid->size[speed_class];
    const ShvVec3 o = grid->origin;
    const uint64_t low[3] = {cell(box.low.x, o.x, size), cell(box.low.y, o.y, size), cell(box.low.z, o.z, size)};
    const uint64_t high[3] = {cell(box.high.x, o.x, size), cell(box.high.y, o.y, size), cell(box.high.z, o.z, size)};
    double cubes = 1.0;
    for (int k = 0; k < 3; k++) cubes *= (double)(high[k] - low[k]) + 1.0;
    if (cubes > grid->count) return take_from_all(grid, speed_class, &box, error);
    for (uint64_t x = low[0]; x <= high[0]; x++)
        for (uint64_t y = low[1]; y <= high[1]; y++)
            for (uint64_t z = low[2]; z <= high[2]; z++)
                SHV_TRY(take_from_cube(grid, key_of(speed_class, x, y, z), &box, error));
    return SHV_OK;
}
