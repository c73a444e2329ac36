/* Convex hull of a few points: at most SHV_HULL_VERTICES of them become vertices, the ones that reach farthest first. */
#ifndef SHV_CONVEX_HULL_H
#define SHV_CONVEX_HULL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/vector.h"

enum { SHV_HULL_VERTICES = 64, SHV_HULL_FACES = 2 * SHV_HULL_VERTICES - 4 };

/* Dimension of the set of points, seen with a resolution of 2⁻²⁴ of its largest extent. */
typedef enum ShvHullRank { SHV_HULL_POINT, SHV_HULL_LINE, SHV_HULL_FLAT, SHV_HULL_SOLID } ShvHullRank;

typedef struct ShvHull {
    ShvHullRank rank;
    int32_t vertex_count, face_count;  /* 0 unless solid */
    int32_t points[SHV_HULL_VERTICES]; /* of each vertex: its index among the points */
    uint8_t faces[SHV_HULL_FACES][3];  /* vertices, counter-clockwise from outside; the hull is closed */
    double volume;                     /* m³ */
    bool reduced;                      /* some points were left outside to keep the number of vertices */
} ShvHull;

/* A hull with its own vertices. */
typedef struct ShvPolytope {
    ShvHull hull;
    double vertices[3 * SHV_HULL_VERTICES]; /* m */
} ShvPolytope;

/* Half-spaces normal · x ≤ offset of the faces, unit normals, 4 numbers each; those of slivers are left out. */
typedef struct ShvPlanes {
    int32_t count;
    double planes[SHV_HULL_FACES][4];
    double low[3], high[3]; /* box around the body, m */
} ShvPlanes;

/* Scratch that grows with the largest set of points so far. Zeroed but for `memory` to begin with. */
typedef struct ShvHullScratch {
    ShvMemory *memory;
    int32_t capacity;
    double *grid; /* 3 a point: whole numbers */
    int32_t *next;
} ShvHullScratch;

/* Hull of `count` ≥ 1 finite points, 3 numbers each, with at most `most` (4 … SHV_HULL_VERTICES) vertices. A pure function
   of the points and their order. Points that span no volume are no failure: `rank` tells. Fails only without memory. */
ShvStatus shv_hull_make(ShvHull *hull, ShvHullScratch *scratch, const double *points, int32_t count, int32_t most,
                        ShvError *error);
/* The same with copies of the vertices. `points` may be those of the polytope itself. */
ShvStatus shv_polytope_make(ShvPolytope *polytope, ShvHullScratch *scratch, const double *points, int32_t count,
                            ShvError *error);
void shv_polytope_planes(const ShvPolytope *polytope, ShvPlanes *planes);
/* Moves the vertices: centre + scale (x − centre). */
void shv_polytope_scale(ShvPolytope *polytope, ShvVec3 centre, double scale);
void shv_hull_scratch_release(ShvHullScratch *scratch);

#endif
