/* The reference mesh: linear tetrahedra, constant once made. */
#ifndef SHV_MESH_MESH_H
#define SHV_MESH_MESH_H

#include <stdint.h>

#include "base/memory.h"
#include "base/vector.h"

/* A part of a mesh that its file names: a physical volume of gmsh. */
typedef struct ShvMeshGroup {
    int32_t tag;
    char name[128]; /* gmsh's own limit, with the zero */
} ShvMeshGroup;

typedef struct ShvMesh {
    ShvMemory *memory;
    int32_t node_count, element_count;
    double *positions;       /* 3 × node_count, m */
    int32_t *elements;       /* 4 × element_count; (x1−x0, x2−x0, x3−x0) right handed: positive volume */
    int32_t *element_groups; /* element_count: tags, 0 where there is none; NULL: in the whole mesh */
    ShvMeshGroup *groups;    /* those with a name */
    int32_t group_count;
} ShvMesh;

/* Most elements and most nodes of a mesh: facet and corner numbers (4 × element + corner) and small multiples of them
   stay within int32_t. */
#define SHV_MESH_LARGEST (INT32_MAX / 16)

/* Face k of a tet lies opposite its corner k; its three corners run counter-clockwise seen from outside. */
extern const uint8_t shv_face_corners[4][3];

/* An empty mesh with zeroed arrays. On failure `mesh` is zeroed and owns nothing. */
ShvStatus shv_mesh_allocate(ShvMesh *mesh, ShvMemory *memory, int64_t node_count, int64_t element_count,
                            ShvError *error);
void shv_mesh_release(ShvMesh *mesh);
/* Room for the groups of its elements, all 0. */
ShvStatus shv_mesh_add_groups(ShvMesh *mesh, ShvError *error);
/* The tag of a group by its name or, where none has it, by its number; 0: there is no such group. */
int32_t shv_mesh_find_group(const ShvMesh *mesh, const char *name);

static inline ShvVec3 shv_mesh_position(const ShvMesh *mesh, int32_t node)
{
    return shv_load3(mesh->positions + 3 * (int64_t)node);
}
double shv_mesh_element_volume(const ShvMesh *mesh, int32_t element);

/* Refuses, and names the first offending element: node indices out of range, repeated corners, non-finite coordinates,
   zero volume (below 1e-15 of the cube of the longest edge), inverted elements, duplicate elements, facets shared by
   more than two elements, elements that overlap (same side of a shared facet), nodes that no element uses. Repeated
   coordinates are allowed: the lips of a notch. `what` names the mesh in messages. */
ShvStatus shv_mesh_validate(const ShvMesh *mesh, const char *what, ShvError *error);

/* Renumbers elements (space-filling curve) and nodes (first use) for locality, in place. The order depends on the mesh
   alone. Optional maps receive new → old (element_count, node_count entries). */
ShvStatus shv_mesh_renumber(ShvMesh *mesh, int32_t *old_elements, int32_t *old_nodes, ShvError *error);

typedef struct ShvMeshQuality {
    int32_t node_count, element_count;
    double volume;                                 /* m³ */
    double shortest_edge, mean_edge, longest_edge; /* m; the mean runs over the six edges of every element */
    double smallest_altitude;                      /* m, and its element */
    int32_t smallest_altitude_element;
    double worst_aspect, mean_aspect; /* 3 × inradius / circumradius: 1 regular, 0 flat */
    int32_t worst_element;
    double smallest_dihedral, largest_dihedral; /* degrees */
} ShvMeshQuality;
ShvMeshQuality shv_mesh_quality(const ShvMesh *mesh);

/* Mass properties of the solid tets (not of the lumped nodes) at unit density. */
typedef struct ShvMassProperties {
    double mass;     /* = volume × density */
    ShvVec3 centre;  /* centre of mass */
    ShvMat3 inertia; /* about the centre */
} ShvMassProperties;
ShvMassProperties shv_mesh_mass(const ShvMesh *mesh);

#endif
