/* Who touches whom in the reference mesh: facets between tets, and the corners that meet at a node. Built only where
   something can break. */
#ifndef SHV_MESH_ADJACENCY_H
#define SHV_MESH_ADJACENCY_H

#include "mesh/mesh.h"

typedef struct ShvAdjacency {
    int32_t facet_count;
    int32_t interior_count;  /* interior facets come first: 0 … interior_count − 1, in increasing order of
                                (first element, its face) */
    int32_t *facet_elements; /* 2 per facet: lower element first; [1] = −1 on the boundary */
    uint8_t *facet_faces;    /* 2 per facet: the face of each element */
    int32_t *element_facets; /* 4 per element: the facet opposite each corner */
    int32_t *corner_start;   /* node_count + 1 */
    int32_t *corners;        /* 4 × element_count: element × 4 + corner, increasing within a node */
} ShvAdjacency;

/* The mesh must be valid. On failure `adjacency` is zeroed and owns nothing. */
ShvStatus shv_adjacency_build(ShvAdjacency *adjacency, const ShvMesh *mesh, ShvError *error);
void shv_adjacency_release(ShvAdjacency *adjacency);

/* The corners that meet at each node, as in ShvAdjacency but for the last start. The mesh has an element at least. */
void shv_mesh_corners(const ShvMesh *mesh, int32_t *start, int32_t *corners);

/* Boundary triangles of the mesh, outward, 3 nodes each, in facet order; caller releases *triangles. */
ShvStatus shv_mesh_boundary(const ShvMesh *mesh, ShvPart part, int32_t **triangles, int32_t *count, ShvError *error);

#endif
