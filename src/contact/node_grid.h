/* Nodes in a hashed grid of cubes of several sizes, one a level, each twice the one below: a box looks among cubes about half
   as large as itself, so that boxes of any size cost the same. Nodes are told apart by their speed class, each of which has a grid of
   its own. */
#ifndef SHV_CONTACT_NODE_GRID_H
#define SHV_CONTACT_NODE_GRID_H

#include "base/memory.h"
#include "contact/box.h"

enum { SHV_GRID_SPEED_CLASSES = 8 };

typedef struct ShvGridEntry {
    uint64_t key; /* speed class, level and cube */
    ShvVec3 position;
    int32_t item;
} ShvGridEntry;

typedef struct ShvNodeGrid {
    ShvMemory *memory;
    ShvVec3 origin;
    double size;                             /* of cubes of level 0, m */
    uint32_t levels[SHV_GRID_SPEED_CLASSES]; /* bits: those in use; none where there are no nodes */
    ShvGridEntry *entries;                   /* as they came */
    ShvGridEntry *sorted;                    /* by hash */
    int32_t count, capacity;
    int32_t *starts; /* per hash: first of its entries in `sorted` */
    int32_t start_bits, start_capacity;
    int32_t *found;
    int32_t found_count, found_capacity;
} ShvNodeGrid;

void shv_node_grid_release(ShvNodeGrid *grid);
/* Sets the size of cubes in a region, so that levels can be asked for; `smallest`: of the cubes. */
void shv_node_grid_scale(ShvNodeGrid *grid, ShvBox region, double smallest);
/* Level of cubes at least so large. */
int shv_node_grid_level(const ShvNodeGrid *grid, double size);
/* Empties the grid for numbers of nodes of each speed class on some levels; after shv_node_grid_scale. */
ShvStatus shv_node_grid_start(ShvNodeGrid *grid, const uint32_t levels[SHV_GRID_SPEED_CLASSES],
                              const int32_t nodes[SHV_GRID_SPEED_CLASSES], ShvError *error);
void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, int speed_class, ShvVec3 position);
/* After the last node. */
void shv_node_grid_finish(ShvNodeGrid *grid);
/* Items of a speed class in a box, into `found`, each once; `size`: of cubes to look among. */
ShvStatus shv_node_grid_find(ShvNodeGrid *grid, int speed_class, double size, ShvBox box, ShvError *error);

#endif
