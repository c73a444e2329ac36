/* Tets within a closed surface or a CAD file, made by gmsh in a process of its own. */
#ifndef SHV_MESH_FILL_H
#define SHV_MESH_FILL_H

#include <signal.h>

#include "base/temporary.h"
#include "mesh/mesh.h"
#include "shiver/definition.h"

/* Refuses what is neither a surface (STL, OBJ, PLY) nor CAD (STEP, IGES, BREP), nor, with `script`, a script of gmsh, which may
   run any command. */
ShvStatus shv_fill_check(const char *path, bool script, ShvError *error);
/* Writes `output` (MSH 4.1) with tets of about the edge length, in the units of the input. A surface must be closed. gmsh works in
   `place` and ends with this process. `interrupted` (may be NULL): a signal that sets it ends gmsh. SHV_UNSUPPORTED where there is no gmsh;
   of what goes wrong in gmsh the message repeats its first line. */
ShvStatus shv_fill_file(const char *input, double edge, const ShvTemporary *place, const char *output,
                        const volatile sig_atomic_t *interrupted, ShvError *error);
/* The same from a definition (file, edge, scale) into memory; coordinates are those of the file. */
ShvStatus shv_mesh_fill(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                        ShvError *error);

#endif
