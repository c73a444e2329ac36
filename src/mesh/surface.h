/* Closed triangle surfaces, read from OBJ, STL (ASCII, binary) and PLY (ASCII, binary). */
#ifndef SHV_MESH_SURFACE_H
#define SHV_MESH_SURFACE_H

#include "mesh/mesh.h"

typedef struct ShvSurface {
    ShvMemory *memory;
    ShvPart part; /* its blocks are counted under */
    int32_t node_count, triangle_count;
    double *positions;  /* 3 × node_count */
    int32_t *triangles; /* 3 × triangle_count, counter-clockwise from outside */
} ShvSurface;

/* Reads by the file's extension (any case); polygons are split into fans; vertices of equal coordinates are merged;
   triangles that collapse by it (they close no hole) and vertices of no triangle are dropped; normals, texture
   coordinates, colours and groups are ignored; coordinates are multiplied by `scale`. Blocks are counted under `part`.
   Errors name the file and its line, or in a binary file the byte. On failure `surface` is zeroed and owns nothing. */
ShvStatus shv_surface_read(ShvSurface *surface, ShvMemory *memory, ShvPart part, const char *path, double scale,
                           ShvError *error);
void shv_surface_release(ShvSurface *surface);
/* Refuses a surface with an edge that is not shared by exactly two triangles of opposite direction, degenerate
   triangles, or negative enclosed volume (then all triangles are flipped instead, once); names the triangle by its
   index and corners. */
ShvStatus shv_surface_require_closed(ShvSurface *surface, const char *what, ShvError *error);
/* Splits the longest edge at its middle, over and over, until there are at least `triangles` (at most one more): of two
   equally long edges the one that is older goes first, so the result depends on the surface alone. The surface must be
   closed; its shape does not change. On failure it is as it was. */
ShvStatus shv_surface_refine(ShvSurface *surface, int64_t triangles, ShvError *error);
/* Enclosed volume, centre and inertia at unit density, by the divergence theorem. */
ShvMassProperties shv_surface_mass(const ShvSurface *surface);

static inline ShvVec3 shv_surface_position(const ShvSurface *surface, int32_t node)
{
    return shv_load3(surface->positions + 3 * (int64_t)node);
}

#endif
