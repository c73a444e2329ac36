/* A notched beam of bricks: planes across x, y and z cut it into bricks, and each brick into five tets, one of which
   takes its middle and one each of four corners. From brick to brick the four corners alternate, so that faces fit.
   Planes across y and z are equally spaced (z: below and above the tip); those across x grow thinner towards the notch.
   Such a mesh has fewer tets a node (5 inside) than a lattice (6 inside). */
#ifndef SHV_MESH_BRICKS_H
#define SHV_MESH_BRICKS_H

#include "mesh/mesh.h"
#include "shiver/definition.h"

/* Mean of the edges of the five tets of a cube, over its side: of 30 edges 12 are sides and 18 are diagonals. */
#define SHV_BRICK_EDGE 1.2485281374238570

/* A box of such bricks, all alike and about cubes, without a slit; not renumbered. */
ShvStatus shv_mesh_brick_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
/* The beam of a definition whose lengths have been checked; not renumbered. The nodes of the slit are those of
   shv_mesh_notched_beam: two lips, one front. */
ShvStatus shv_mesh_brick_beam(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);

#endif
