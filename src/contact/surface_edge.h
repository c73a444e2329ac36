/* Edges of the listed surfaces: which facets lie on both sides of each, and which are sharp. Half-edge 3 f + k of a list runs from
   corner k of its facet f to the next corner; an edge that is sharp is named by that of its half-edges whose facet has the
   higher place, since this one may have come later. */
#ifndef SHV_CONTACT_SURFACE_EDGE_H
#define SHV_CONTACT_SURFACE_EDGE_H

#include "contact/edge_pair.h"

/* Degrees between the normals of two facets from which a convex edge between them meets other edges. */
#define SHV_SHARP_EDGE 5.0

/* Finds the facets across the edges of one that has been listed, on the other side of the body: cracks that have not separated do not
   bound it. For models with adjacency. */
void shv_surface_edges_link(ShvSurfaceList *list, int32_t place);
/* Of all facets, for models without. */
ShvStatus shv_surface_edges_link_all(ShvSurfaceList *list, ShvError *error);
/* Marks the sharp edges that a facet names, as they are now. */
void shv_surface_edges_mark(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t place);
/* An edge as it is now; false for one that is none any more. */
bool shv_surface_edge(const ShvSurfaceList *list, const ShvSurfaceBodies *bodies, int32_t half_edge, ShvEdge *edge);

#endif
