/* Meshes from a definition: generators and readers behind one door. */
#ifndef SHV_MESH_GENERATE_H
#define SHV_MESH_GENERATE_H

#include "mesh/mesh.h"
#include "shiver/definition.h"

/* Makes or reads, validates and renumbers the mesh of a definition. `folder` is what relative file names start from
   (NULL: the working directory). Errors name the file and, in a text file, the line. */
ShvStatus shv_mesh_generate(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *folder,
                            ShvError *error);

/* Generators, one a kind; each gives a positively oriented mesh and does not renumber. */
ShvStatus shv_mesh_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_hollow_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_cylinder(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_notched_beam(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
/* Readers; `path` is already resolved. */
ShvStatus shv_mesh_read_gmsh(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error);
ShvStatus shv_mesh_read_tetgen(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error);
ShvStatus shv_mesh_shell(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                         ShvError *error);
/* Shifts nodes at random (jitter.c); nodes of the boundary move only within their own flat surface. */
ShvStatus shv_mesh_jitter(ShvMesh *mesh, double amount, uint64_t seed, ShvError *error);

#endif
