/* Where a fragment is: a grid over its box that knows of each cell's centre in which cluster of tets it lies. Looking a
   point up costs the same however many tets there are. */
#ifndef SHV_CONVEX_OCCUPANCY_H
#define SHV_CONVEX_OCCUPANCY_H

#include "convex/hull_clusters.h"

typedef struct ShvOccupancy {
    double low[3], cell; /* m */
    double inverse;      /* 1 / cell */
    int32_t size[3];     /* cells along x, y, z */
    uint8_t *cells;      /* z runs fastest: cluster + 1, 0 outside; with SHV_CELL_COVERED once in some hull */
} ShvOccupancy;

enum { SHV_CELL_EMPTY = 0, SHV_CELL_COVERED = 128 };

/* Cells of a fifth of the mean edge, larger where the box is so empty that they would outnumber the tets too far. */
ShvStatus shv_occupancy_make(ShvOccupancy *occupancy, ShvMemory *memory, const ShvFragmentTets *tets,
                             const ShvHullClusters *clusters, ShvError *error);
void shv_occupancy_release(ShvOccupancy *occupancy);

/* Marks the cells whose centres lie in a convex body as covered. */
void shv_occupancy_cover(ShvOccupancy *occupancy, const ShvPlanes *planes);
/* Volumes by count of cells, m³: of covered cells that no tet holds, of cells in tets that are not covered, of tets. */
void shv_occupancy_measure(const ShvOccupancy *occupancy, double *outside, double *missing, double *inside);

/* The cell value at a point; SHV_CELL_EMPTY beyond the grid. */
static inline uint8_t shv_occupancy_at(const ShvOccupancy *occupancy, ShvVec3 x)
{
    const double i = (x.x - occupancy->low[0]) * occupancy->inverse, j = (x.y - occupancy->low[1]) * occupancy->inverse,
                 k = (x.z - occupancy->low[2]) * occupancy->inverse;
    if (!(i >= 0.0 && j >= 0.0 && k >= 0.0 && i < occupancy->size[0] && j < occupancy->size[1] &&
          k < occupancy->size[2]))
        return SHV_CELL_EMPTY;
    return occupancy->cells[((int64_t)i * occupancy->size[1] + (int64_t)j) * occupancy->size[2] + (int64_t)k];
}

#endif
