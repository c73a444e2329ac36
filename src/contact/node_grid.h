/* Nodes in a hashed grid of cubes of several sizes, one a level, each twice the one below: a box looks among cubes about
   as large as itself, so that facets of any size cost the same. */
#ifndef SHV_CONTACT_NODE_GRID_H
#define SHV_CONTACT_NODE_GRID_H

#include "base/memory.h"
#include "contact/box.h"

typedef struct ShvNodeGrid {
    ShvMemory *memory;
    ShvVec3 origin;
    double size;     /* of cubes of level 0, m */
    uint32_t levels; /* bits: those in use */
    uint64_t *keys;  /* per entry: level and cube */
    int32_t *items, *next;
    int32_t count, capacity;
    int32_t *heads; /* per hash: last entry, −1: none */
    int32_t head_bits, head_capacity;
    int32_t *found;
    int32_t found_count, found_capacity;
} ShvNodeGrid;

void shv_node_grid_release(ShvNodeGrid *grid);
/* Empties the grid for `nodes` nodes in a region; `smallest`: size of the smallest boxes that will be asked for. */
ShvStatus shv_node_grid_start(ShvNodeGrid *grid, ShvBox region, double smallest, uint32_t levels, int32_t nodes,
                              ShvError *error);
/* Level of a box of some size; needs the size of the grid's cubes. */
int shv_node_grid_level(const ShvNodeGrid *grid, double size);
/* Sets the size of cubes only, so that levels can be asked for before the start. */
void shv_node_grid_scale(ShvNodeGrid *grid, ShvBox region, double smallest);
void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, ShvVec3 position);
/* Items in the cubes that a box meets, into `found`: a superset of those in the box, each once. */
ShvStatus shv_node_grid_find(ShvNodeGrid *grid, ShvBox box, ShvError *error);

#endif
