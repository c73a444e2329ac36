/* Meshes from a definition: generators and readers behind one door. */
#ifndef SHV_MESH_GENERATE_H
#define SHV_MESH_GENERATE_H

#include "mesh/mesh.h"
#include "shiver/definition.h"

/* Makes or reads, validates and renumbers the mesh of a definition. `folder` is what relative file names start from
   (NULL: the working directory). Errors name the file and, in a text file, the line. */
ShvStatus shv_mesh_generate(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *folder,
                            ShvError *error);

/* Generators, one a kind; each gives a positively oriented mesh and does not renumber. Bodies are centred on the origin.
   Bad parameters are SHV_BAD_INPUT with the value; an edge may be at most twice the thinnest part of the body (side,
   wall, hole radius), and a mesh has at most SHV_MESH_LARGEST elements. The mean edge is within 15 % of `edge`.
   - Box: body-centred lattice (lattice.h), or no order (unstructured.h). Ball, hollow ball: icosahedral layers, surface nodes on the spheres
     (sectors.h). Cylinder: layers of prisms (cylinder.c).
   - Notched beam: body-centred lattice whose cells are halved until edges at the notch are at most 1.2 notch_edge; the
     edge asked for grows by 0.3 of the distance from the notch. The notch is a slit of no width: its two lips have nodes
     of their own at the same places, the nodes of its front (z = tip) are common to both sides. */
ShvStatus shv_mesh_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_hollow_ball(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_cylinder(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
ShvStatus shv_mesh_notched_beam(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
/* Unstructured (unstructured.h). Refuses profiles that are no outline, and edges that do not fit into its walls. */
ShvStatus shv_mesh_turned(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error);
/* Readers; `path` is already resolved, coordinates stay as they are in the file. Errors name the file and its line (a
   binary file: the byte) and a tet by its tag in the file: cut off, malformed and non-finite entries, wrong counts,
   unknown or repeated nodes, tets that are flat or inverted. On failure `mesh` is zeroed and owns nothing. */
/* MSH 2.2 as text, 4.1 as text or in binary of this machine's byte order. Tets (type 4) are kept; points, lines,
   triangles and quadrangles are skipped, and so are nodes that no tet uses (those of surfaces bounding no tet); other
   volumes and curved elements are refused, since dropping them would leave holes. */
ShvStatus shv_mesh_read_gmsh(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error);
/* `path`.node and `path`.ele, where an extension .node or .ele of `path` itself does not count; numbered from 0 or 1;
   attributes, markers and comments are ignored, nodes that no tet uses dropped. */
ShvStatus shv_mesh_read_tetgen(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error);
/* Reads a closed surface (surface.h), scales it, refines it to `refine_to` triangles when that is more than it has, and
   extrudes it inwards along its vertex normals (weighted by angle) by `thickness` in `layers` equal layers of prisms,
   three tets each: (layers + 1) × vertices nodes, 3 × layers × triangles tets. Node v of layer k (0: the surface) is
   k × vertices + v. Where there is no room the depth is smaller, see shv_shell_find_depths. */
ShvStatus shv_mesh_shell(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                         ShvError *error);
/* Shifts nodes at random (jitter.c); nodes of the boundary move only within their own flat surface. */
ShvStatus shv_mesh_jitter(ShvMesh *mesh, double amount, uint64_t seed, ShvError *error);

#endif
