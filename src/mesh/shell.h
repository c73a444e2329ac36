/* A closed surface with the direction and depth in which every vertex is extruded inwards. */
#ifndef SHV_MESH_SHELL_H
#define SHV_MESH_SHELL_H

#include "mesh/surface.h"

typedef struct ShvShell {
    ShvSurface surface;
    double *normals; /* 3 a node, outwards, unit */
    double *depths;  /* a node, m: from the surface to the innermost layer, along −normal */
    int32_t layers;
} ShvShell;

/* Corners 0, 1, 2 of a prism are a triangle's on the outside of a layer, sorted by node; 3, 4, 5 those below. The
   staircase of tets cuts the wall over nodes p < q along outer p – inner q, whatever triangle it is seen from, so that
   neighbours conform. Tet k has the upright edge k – k + 3. Table 0 is for triangles that sorting leaves
   counter-clockwise from outside, table 1 for those that it turns over. */
extern const uint8_t shv_prism_tets[2][3][4];
/* Sorts a triangle's corners by node and gives the table to use. */
int shv_shell_sort_corners(const int32_t *corners, int32_t sorted[3]);

/* Node's position at the outside of a layer (layers: the inside of the last one). */
static inline ShvVec3 shv_shell_point(const ShvShell *shell, int32_t node, int32_t layer)
{
    const double depth = shell->depths[node] * (double)layer / (double)shell->layers;
    return shv_madd(shv_surface_position(&shell->surface, node), -depth, shv_load3(shell->normals + 3 * (int64_t)node));
}
static inline const int32_t *shv_shell_corners(const ShvShell *shell, int32_t triangle)
{
    return shell->surface.triangles + 3 * (int64_t)triangle;
}

/* Finds the depths (shell_depth.c): `thickness` where there is room. Surface, normals and layers are there already;
   depths is allocated. A vertex that looks through the body at another wall nearer than thickness / 0.45 gets 0.45 of
   that distance, so that opposite walls do not meet. The corners of a prism that has a tet of less than a tenth of its
   share (area × depth / 3 / layers) lose 15 % of their depth until there is none; depth then changes by at most half
   of the length of an edge along it, which spreads the reduction. SHV_BAD_INPUT naming the triangle where less than a
   twentieth of `thickness` would be left. Walls that meet at an acute angle may still overlap by less than the depth
   of their vertices: rays from the vertices only see what is in front of them. */
ShvStatus shv_shell_find_depths(ShvShell *shell, double thickness, const char *what, ShvError *error);

/* Caps depths[v] at `share` of the distance from node v along −normal to the next wall (shell_room.c). Distances
   beyond `reach` need not be seen. */
ShvStatus shv_shell_cap_by_room(ShvShell *shell, double share, double reach, ShvError *error);

#endif
