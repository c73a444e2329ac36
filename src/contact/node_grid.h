/* Points in a hashed grid of cubes. They are told apart by their speed class, each of which has cubes of its own size. */
#ifndef SHV_CONTACT_NODE_GRID_H
#define SHV_CONTACT_NODE_GRID_H

#include "base/memory.h"
#include "contact/box.h"

enum { SHV_GRID_SPEED_CLASSES = 8 };

typedef struct ShvGridEntry {
    uint64_t key; /* speed class and cube */
    ShvVec3 position;
    int32_t item;
} ShvGridEntry;

typedef struct ShvNodeGrid {
    ShvMemory *memory;
    ShvVec3 origin;
    double size[SHV_GRID_SPEED_CLASSES];    /* of cubes, m */
    int32_t points[SHV_GRID_SPEED_CLASSES]; /* number of each */
    ShvGridEntry *entries;               /* as they came */
    ShvGridEntry *sorted;                /* by hash */
    int32_t count, capacity;
    int32_t *starts; /* per hash: first of its entries in `sorted` */
    int32_t start_bits, start_capacity;
    int32_t *found;
    int32_t found_count, found_capacity;
} ShvNodeGrid;

void shv_node_grid_release(ShvNodeGrid *grid);
/* Empties the grid for so many points in a region; cubes have the sizes, m, or what the region's size makes of them. */
ShvStatus shv_node_grid_start(ShvNodeGrid *grid, ShvBox region, const double size[SHV_GRID_SPEED_CLASSES],
                              int32_t points, ShvError *error);
void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, int speed_class, ShvVec3 position);
/* After the last point. */
void shv_node_grid_finish(ShvNodeGrid *grid);
/* Items of a speed class in a box, into `found`, each once. */
ShvStatus shv_node_grid_find(ShvNodeGrid *grid, int speed_class, ShvBox box, ShvError *error);

#endif
