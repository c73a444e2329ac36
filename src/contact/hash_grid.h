/* Points in a hashed grid of cubes, into which they are put one by one and in which they move. They are told apart by their speed
   class, each of which has cubes of its own size. */
#ifndef SHV_CONTACT_HASH_GRID_H
#define SHV_CONTACT_HASH_GRID_H

#include "base/memory.h"
#include "contact/box.h"

enum { SHV_GRID_SPEED_CLASSES = 8 };

typedef struct ShvGridEntry {
    uint64_t key; /* speed class and cube */
    ShvVec3 position;
    int32_t next; /* item with the same hash, −1: none; or −2: it is not in the grid */
} ShvGridEntry;

typedef struct ShvHashGrid {
    ShvMemory *memory;
    ShvVec3 origin;
    double size[SHV_GRID_SPEED_CLASSES];    /* of cubes, m */
    int32_t points[SHV_GRID_SPEED_CLASSES]; /* number of each */
    ShvGridEntry *entries;                  /* per item */
    int32_t count, capacity;
    int32_t *first; /* item per hash, −1: none */
    int32_t first_bits, first_capacity;
    int32_t *found;
    int32_t found_count, found_capacity;
} ShvHashGrid;

void shv_hash_grid_release(ShvHashGrid *grid);
/* Empties the grid for about so many points, most of them in a region; cubes have the sizes, m, or what the region's size makes of
   them. */
ShvStatus shv_hash_grid_start(ShvHashGrid *grid, ShvBox region, const double size[SHV_GRID_SPEED_CLASSES],
                              int32_t points, ShvError *error);
/* Puts an item in, or elsewhere. */
ShvStatus shv_hash_grid_put(ShvHashGrid *grid, int32_t item, int speed_class, ShvVec3 position, ShvError *error);
/* Items of a speed class in a box, into `found`, each once. */
ShvStatus shv_hash_grid_find(ShvHashGrid *grid, int speed_class, ShvBox box, ShvError *error);

#endif
