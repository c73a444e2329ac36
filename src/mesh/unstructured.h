/* Unstructured tets of a body: nothing in them has a direction, so that nothing steers cracks. Points without order
   (scatter.h), a Delaunay tetrahedralisation (delaunay.h), relaxed: each point goes to the mean of the tets round it, and they
   are made anew, a few times; then the worst are bettered (improve.h). Made for a seed, the same bits on every machine. */
#ifndef SHV_MESH_UNSTRUCTURED_H
#define SHV_MESH_UNSTRUCTURED_H

#include "mesh/mesh.h"
#include "mesh/outline.h"

ShvStatus shv_mesh_unstructured(ShvMesh *mesh, ShvMemory *memory, const ShvOutline *outline, double edge, uint64_t seed,
                                ShvError *error);
/* A plate along the plane z = 0, too thin for disorder through it: an unstructured triangulation, prisms on it, and in each a node
   from which tets go to all its sides. Cracks can go straight through, and no plane of facets leads along it. */
ShvStatus shv_mesh_plate(ShvMesh *mesh, ShvMemory *memory, const double size[3], double edge, uint64_t seed,
                         ShvError *error);

#endif
