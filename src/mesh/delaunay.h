/* Delaunay tetrahedralisation of points on a grid, point by point (Bowyer, Watson), in whole numbers: exact, and the same
   on every machine. */
#ifndef SHV_MESH_DELAUNAY_H
#define SHV_MESH_DELAUNAY_H

#include <stdint.h>

#include "base/memory.h"

/* Coordinates are at least 0 and below this: products that say on which side of a sphere a point lies then fit four times
   64 bits. */
enum { SHV_DELAUNAY_GRID = 1 << 19 };

typedef struct ShvDelaunay {
    int32_t tet_count;
    int32_t *tets; /* 4 points each, of positive volume; they fill the convex hull */
} ShvDelaunay;

/* `points`: 3 coordinates each, no two alike, not all in one plane: else SHV_BAD_INPUT. On failure owns nothing. */
ShvStatus shv_delaunay_make(ShvDelaunay *delaunay, ShvMemory *memory, const int32_t *points, int32_t count,
                            ShvError *error);
void shv_delaunay_release(ShvDelaunay *delaunay);

#endif
