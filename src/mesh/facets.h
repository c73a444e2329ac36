/* Which faces of which elements are the same facet: the common ground of validation, adjacency and the boundary. */
#ifndef SHV_MESH_FACETS_H
#define SHV_MESH_FACETS_H

#include "mesh/mesh.h"

typedef enum ShvFacetFault {
    SHV_FACET_SOUND,
    SHV_FACET_DUPLICATE_ELEMENT, /* `element` has the four nodes of `other` */
    SHV_FACET_CROWDED,           /* a face of `element` already belongs to two elements, one of them `other` */
    SHV_FACET_OVERLAP            /* `element` and `other` lie on the same side of a common face */
} ShvFacetFault;

typedef struct ShvFacetFinding {
    ShvFacetFault fault;
    int32_t element, other; /* other < element; the fault of lowest `element` */
    int32_t nodes[3];       /* of the face, increasing */
} ShvFacetFinding;

/* mates[4 e + k] = 4 e' + k' when face k of element e is face k' of e', or −1 on the boundary. Node indices must be in
   range and positive volumes are assumed. Caller releases *mates (counted as general scratch); it is NULL on failure.
   `finding` may be NULL for a mesh known to be valid. */
ShvStatus shv_facet_mates(const ShvMesh *mesh, int32_t **mates, ShvFacetFinding *finding, ShvError *error);

/* The faces, 4 e + k, that belong to one element alone, increasing. Counted under `part`; caller releases
   *faces, which is NULL on failure. */
ShvStatus shv_boundary_faces(const ShvMesh *mesh, ShvMemory *memory, ShvPart part, int32_t **faces, int32_t *count,
                             ShvError *error);

#endif
