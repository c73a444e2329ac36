/* Nodes in a hashed grid of cubes of several sizes, one a level, each twice the one below: a box looks among cubes about
   as large as the facet it surrounds, so that facets of any size cost the same. Nodes are told apart by their pace, each of which
   has a grid of its own. */
#ifndef SHV_CONTACT_NODE_GRID_H
#define SHV_CONTACT_NODE_GRID_H

#include "base/memory.h"
#include "contact/box.h"

typedef struct ShvGridEntry {
    uint64_t key; /* pace, level and cube */
    ShvVec3 position;
    int32_t item;
} ShvGridEntry;

typedef struct ShvNodeGrid {
    ShvMemory *memory;
    ShvVec3 origin;
    double size;           /* of cubes of level 0, m */
    uint32_t levels;       /* bits: those in use */
    uint32_t paces;        /* bits: those with nodes */
    ShvGridEntry *entries; /* as they came */
    ShvGridEntry *sorted;  /* by hash */
    int32_t count, capacity;
    int32_t *starts; /* per hash: first of its entries in `sorted` */
    int32_t start_bits, start_capacity;
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
void shv_node_grid_add(ShvNodeGrid *grid, int32_t item, int pace, ShvVec3 position);
/* After the last node. */
void shv_node_grid_finish(ShvNodeGrid *grid);
/* Items of a pace in a box, into `found`, each once; `facet_size` chooses the level. */
ShvStatus shv_node_grid_find(ShvNodeGrid *grid, int pace, double facet_size, ShvBox box, ShvError *error);

#endif
