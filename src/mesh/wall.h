/* Walls: where a body is about as thin as the edges of its tets.

   Linear tets cannot bend. A wall of them shears in the place of bending, and is too stiff: by about 1 + 1.3 (L/t)², L the edges of its
   surface and t its thickness; with smoothed edges (solid/smoothing.h) by 1 + 0.055 (L/t)⁴ (docs/walls.md has what was measured). Under a
   blow it then stores more energy than it should before it breaks, and breaks late. */
#ifndef SHV_MESH_WALL_H
#define SHV_MESH_WALL_H

#include <stdbool.h>

#include "mesh/adjacency.h"

typedef struct ShvWall {
    double share;     /* of the surface, that is of walls thinner than three of its edges */
    double thickness; /* m, their mean by area, as the mean of their edges; 0 without any */
    double edge;      /* m: of equilateral triangles as large as their faces */
} ShvWall;

/* Of the elements `begin` to `end`; `adjacency` is of the whole mesh. */
ShvWall shv_mesh_wall(const ShvMesh *mesh, const ShvAdjacency *adjacency, int32_t begin, int32_t end);
/* Stiffness of such a wall in bending over what it should be; 1 without one. */
double shv_wall_stiffness(const ShvWall *wall, bool smoothed);

#endif
