/* Balls and thick spherical shells from the twenty tets between an icosahedron's faces and its centre.

   Every tet is cut by planes parallel to its four faces into small tets and octahedra; layer k of nodes is a sphere
   of 10 k² + 2 nodes (layer 0: the centre), so nodes become fewer inwards just as the spheres become smaller, and
   elements have one size everywhere. Octahedra are cut along the diagonal that leaves the best of four tets. A shell
   leaves out the inner layers. */
#ifndef SHV_MESH_SECTORS_H
#define SHV_MESH_SECTORS_H

#include <stdbool.h>

#include "mesh/mesh.h"

typedef struct ShvSectors {
    int32_t first, last; /* layers of nodes; first = 0 is a solid ball */
    double inner_radius, outer_radius;
} ShvSectors;

/* Mean edge over the distance between layers (measured; within 3 % from three layers on). */
#define SHV_SECTORS_EDGE 1.285

/* Elements, as a double: too many are refused by the caller before they are made. */
double shv_sectors_count(const ShvSectors *sectors);
ShvStatus shv_sectors_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvSectors *sectors, ShvError *error);

#endif
