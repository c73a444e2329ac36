/* Unstructured tets of a body: nothing in them has a direction, so that nothing steers cracks. Points without order
   (scatter.h), a Delaunay tetrahedralisation (delaunay.h), relaxed: each point goes to the mean of the tets round it, and they
   are made anew, a few times; then the worst are bettered (improve.h). Made for a seed, the same bits on every machine. */
#ifndef SHV_MESH_UNSTRUCTURED_H
#define SHV_MESH_UNSTRUCTURED_H

#include "mesh/mesh.h"
#include "mesh/outline.h"

/* `stretch`: along each axis, by how much lengths count more than they are: a flat body is filled in the shape in which its
   tets are not flat; not for turned bodies. */
ShvStatus shv_mesh_unstructured(ShvMesh *mesh, ShvMemory *memory, const ShvOutline *outline, ShvVec3 stretch,
                                double edge, uint64_t seed, ShvError *error);

#endif
