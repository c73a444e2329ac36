/* Unstructured tets of a body: nothing in them has a direction, so that nothing steers cracks. Points without order
   (scatter.h), a Delaunay tetrahedralisation (delaunay.h), relaxed: each point goes to the mean of the tets round it, and they
   are made anew, a few times; then the worst are bettered (improve.h). Made for a seed, the same bits on every machine. */
#ifndef SHV_MESH_UNSTRUCTURED_H
#define SHV_MESH_UNSTRUCTURED_H

#include "mesh/mesh.h"
#include "mesh/outline.h"

ShvStatus shv_mesh_unstructured(ShvMesh *mesh, ShvMemory *memory, const ShvOutline *outline, double edge, uint64_t seed,
                                ShvError *error);
/* A plate in the plane z = 0, too thin for disorder: an unstructured triangulation of its rectangle, and two layers of
   prisms of three tets each on it. Cracks can go straight through it, and the nodes between the layers lie at any height, so
   that none can run along the middle. */
ShvStatus shv_mesh_plate(ShvMesh *mesh, ShvMemory *memory, const double size[3], double edge, uint64_t seed,
                         ShvError *error);

#endif
