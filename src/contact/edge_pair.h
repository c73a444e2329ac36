/* An edge against an edge of another surface, where no node of either need be near.

   Both are convex; their contact normal n is across both, and counts only where it is in the normal cone of the one and −n in that
   of the other (the arcs of both on the Gauss map cross): then the edges are what of the two wedges of facets comes closest
   along n. The gap is the distance of the edges along n. The answer is that of a point of the first edge over the facet of
   the second (facet_pair.h). */
#ifndef SHV_CONTACT_EDGE_PAIR_H
#define SHV_CONTACT_EDGE_PAIR_H

#include "contact/facet_pair.h"

/* Facets on both sides of an edge of the list, which is from corner `edge` of the first to the next. */
typedef struct ShvEdge {
    int32_t element, face, fragment; /* of the first facet */
    int32_t edge;
    int32_t corners[3];          /* its nodes */
    ShvVec3 places[3], opposite; /* m: of these; of the node of the second facet that is not on the edge */
} ShvEdge;

/* Whether the two may meet in a step, or overlap. Fills `pair` but for its slots. Otherwise *distance receives how far they
   at least have to go for that, m. `reach`: m, how far any two can come closer in the step. */
bool shv_edge_pair_detect(const ShvSurfaceBodies *bodies, const ShvEdge *own, const ShvEdge *other, double step,
                          double reach, ShvFacetPair *pair, double *distance);

#endif
