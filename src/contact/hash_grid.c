#include "contact/hash_grid.h"

/* A key has 18 bits an axis, and the speed class above them. */
enum { AXIS_BITS = 18, NOT_IN_GRID = -2 };
static const double most_cubes = 131072.0;

void shv_hash_grid_release(ShvHashGrid *grid)
{
    shv_release(grid->entries);
    shv_release(grid->first);
    shv_release(grid->found);
    *grid = (ShvHashGrid){0};
}

ShvStatus shv_hash_grid_start(ShvHashGrid *grid, ShvBox region, const double size[SHV_GRID_SPEED_CLASSES],
                              int32_t points, ShvError *error)
{
    grid->count = 0;
    grid->origin = region.low;
    for (int speed_class = 0; speed_class < SHV_GRID_SPEED_CLASSES; speed_class++) {
        grid->size[speed_class] = fmax(size[speed_class], shv_box_size(&region) / most_cubes);
        grid->points[speed_class] = 0;
    }
    for (grid->first_bits = 6; ((int64_t)1 << grid->first_bits) < points;) grid->first_bits++;
    const int64_t hashes = (int64_t)1 << grid->first_bits;
    SHV_RESERVE(grid->memory, SHV_PART_CONTACT, grid->first, grid->first_capacity, hashes, "contact", error);
    for (int64_t k = 0; k < hashes; k++) grid->first[k] = -1;
    return SHV_OK;
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
static int32_t *first_of(const ShvHashGrid *grid, uint64_t key)
{
    const uint64_t mixed = (key ^ (key >> 31)) * UINT64_C(0x9E3779B97F4A7C15);
    return &grid->first[mixed >> (64 - grid->first_bits)];
}

static void take_out(ShvHashGrid *grid, int32_t item)
{
    int32_t *link = first_of(grid, grid->entries[item].key);
    while (*link != item) link = &grid->entries[*link].next;
    *link = grid->entries[item].next;
    grid->points[grid->entries[item].key >> (3 * AXIS_BITS)]--;
}

ShvStatus shv_hash_grid_put(ShvHashGrid *grid, int32_t item, int speed_class, ShvVec3 position, ShvError *error)
{
    for (; grid->count <= item; grid->count++) {
        SHV_GROW(grid->memory, SHV_PART_CONTACT, grid->entries, grid->capacity, grid->count, "contact", error);
        grid->entries[grid->count].next = NOT_IN_GRID;
    }
    if (grid->entries[item].next != NOT_IN_GRID) take_out(grid, item);
    const ShvVec3 o = grid->origin;
    const double size = grid->size[speed_class];
    const uint64_t key =
        key_of(speed_class, cell(position.x, o.x, size), cell(position.y, o.y, size), cell(position.z, o.z, size));
    int32_t *first = first_of(grid, key);
    grid->entries[item] = (ShvGridEntry){.key = key, .position = position, .next = *first};
    *first = item;
    grid->points[speed_class]++;
    return SHV_OK;
}

static ShvStatus take(ShvHashGrid *grid, int32_t item, ShvError *error)
{
    SHV_GROW(grid->memory, SHV_PART_CONTACT, grid->found, grid->found_capacity, grid->found_count, "contact", error);
    grid->found[grid->found_count++] = item;
    return SHV_OK;
}

static ShvStatus take_from_cube(ShvHashGrid *grid, uint64_t key, const ShvBox *box, ShvError *error)
{
    for (int32_t k = *first_of(grid, key); k >= 0; k = grid->entries[k].next)
        if (grid->entries[k].key == key && shv_box_holds(box, grid->entries[k].position)) SHV_TRY(take(grid, k, error));
    return SHV_OK;
}

/* A box of more cubes than there are points. */
static ShvStatus take_from_all(ShvHashGrid *grid, int speed_class, const ShvBox *box, ShvError *error)
{
    for (int32_t k = 0; k < grid->count; k++) {
        const ShvGridEntry *entry = &grid->entries[k];
        if (entry->next != NOT_IN_GRID && entry->key >> (3 * AXIS_BITS) == (uint64_t)speed_class &&
            shv_box_holds(box, entry->position))
            SHV_TRY(take(grid, k, error));
    }
    return SHV_OK;
}

ShvStatus shv_hash_grid_find(ShvHashGrid *grid, int speed_class, ShvBox box, ShvError *error)
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
