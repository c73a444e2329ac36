/* A node, or a point of an edge, against a facet of another surface: where they stand, and impulses between them that keep
   momentum and angular momentum.

   The point x projects to c = Σ wᵢ tᵢ in the plane of the facet's nodes tᵢ, x = c + h m, m the facet's normal. An impulse J on
   the point is answered by −wᵢ J + h (∇wᵢ·J) m on the facet's nodes: the weights sum to one, which keeps momentum, and since
   Σ tᵢ ∇wᵢᵀ is the projection on the plane, the second term is the couple −h m × J, which keeps angular momentum about
   any point for an impulse that does not pass through the plane at c. The velocity that does work with J follows by
   transposition, so that an impulse against it takes energy. All this for any J: a node meets the facet along m, and an edge
   meets an edge of the facet along the contact normal of both (edge_pair.h). */
#ifndef SHV_CONTACT_FACET_PAIR_H
#define SHV_CONTACT_FACET_PAIR_H

#include "contact/surface_list.h"
#include "shape/feature.h"

/* Plane of a facet, and barycentric coordinates in it. */
typedef struct ShvFacetPlane {
    ShvVec3 corners[3], normal;
    ShvVec3 gradients[3]; /* of the weights, 1/m */
} ShvFacetPlane;

/* A point of one surface and what it may meet within a step: a node and a facet; a point of an edge and the facet whose edge it
   crosses; or an obstacle and a node, or a point of a facet that meets a feature of the obstacle. */
typedef struct ShvFacetPair {
    int32_t nodes[3], node_count; /* of the point: a node, the ends of an edge or the corners of a facet */
    double shares[3];             /* of the nodes in the point */
    int32_t element, face;        /* element −1 − obstacle where it is one, and fragments[1] likewise */
    int32_t edge;                 /* of an edge: that of the facet which it meets, from corner `edge` to the next */
    int32_t feature;      /* of an obstacle, that a facet meets: then `face` is that facet, element × 4 + face */
    int32_t fragments[2]; /* of the point, of the facet */
    int32_t corners[3];   /* nodes of the facet */
    double step;          /* s: up to the next time that it is looked at */
    double gap;           /* m, along the contact normal; negative: inside; infinite: its way misses */
    double height;        /* m, of the point over the facet's plane: the gap, but for an edge */
    ShvVec3 point;        /* the node's position, m; of an obstacle: on its surface */
    ShvVec3 normal;       /* of the contact, towards the point: the facet's, but for an edge */
    ShvVec3 facet_normal; /* outward */
    ShvVec3 centre;       /* of the facet, m */
    double weights[3];
    ShvVec3 gradients[3];     /* of the weights, 1/m */
    ShvVec3 relative;         /* velocity of the point against the other side before any response, m/s */
    double inverse_mass;      /* 1/kg, along the normal */
    double slip_inverse_mass; /* 1/kg, the largest across it */
    double normal_impulse;    /* N·s on the point along the normal, ≥ 0 */
    ShvVec3 friction;         /* N·s on the point, across the normal */
    double friction_bound;    /* N·s */
    double obstacle_work[2];  /* J on a free obstacle, with its velocity before and after each impulse */
    int32_t slots[6];         /* in ShvSurfaceList, of the nodes and the corners; or SHV_SLOT_RIGID, SHV_SLOT_NONE */
    int32_t visit;            /* of its last solve in the sweeps */
    bool excluded;            /* another facet stands for it */
    bool deforming;           /* no coupled body has part in it */
} ShvFacetPair;

/* Of a coupled body or free obstacle, whose motion all its points share; of nothing, or of what is not moved. */
enum { SHV_SLOT_RIGID = -1, SHV_SLOT_NONE = -2 };

/* A pair worth looking at: a node and a facet or an obstacle; or an edge and an edge of a facet, or a facet and a feature of an
   obstacle. Places are those in ShvSurfaceList. */
typedef struct ShvSurfaceCandidate {
    int32_t node;           /* alone, the edge's start or a corner of the facet: of the state, */
    int32_t slot;           /* and its place */
    int32_t facet;          /* −1 − obstacle where it is one; */
    int32_t element;        /* its tet, */
    int32_t corners[3];     /* and its nodes, of the state */
    int32_t own_facet;      /* whose edge it is, or which meets the feature; −1: a node alone */
    int32_t feature;        /* of the obstacle (shape/feature.h) */
    int32_t rebuild_number; /* in which it was found: a later one of a side of it makes it void */
    int8_t own_edge, edge;  /* of own_facet and of the facet */
    uint8_t copies;         /* bits: ends of both edges, own + 2 × other, that are copies of one node of the mesh */
    int8_t
        duplicate_corner; /* of the facet's tet: a copy of the node's origin; −1: none, or they meet across the facet */
} ShvSurfaceCandidate;

/* False for a facet without area. */
bool shv_facet_plane_make(const ShvVec3 corners[3], ShvFacetPlane *plane);
/* How far a point is from the facet or from what is behind it, m. */
double shv_facet_plane_distance(const ShvFacetPlane *plane, ShvVec3 x);

/* A facet of a fragment as obstacles meet it. */
ShvFacetShape shv_surface_facet_shape(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                                      const ShvSurfaceFacet *facet);

/* Whether the tets at a node (at an edge, where `end` is its other node) are behind the plane through it that a push asks for, a unit
   vector, but for `before`, a share of their edges. */
bool shv_surface_is_behind(const ShvSurfaceBodies *bodies, int32_t fragment, int32_t node, int32_t end, ShvVec3 push,
                           double before);
/* Whether a push can come to a node from outside: its tets are behind the push, or a facet at the node faces it, as both walls of a
   groove do that fits a ridge. Next to an edge of the other side the way out that seems shortest may be along a face that
   glides over that edge, which has nothing to do with it. */
bool shv_surface_admits(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, const ShvSurfaceNode *node,
                        ShvVec3 push);

/* Whether the two may meet in a step: the node stands before or behind the facet (or will), no deeper than half the facet's tet
   reaches. Fills `pair`. Otherwise *distance receives how far they at least have to go for that, m. `reach`: m, how far
   any two can come closer in the step. */
bool shv_facet_pair_detect(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                           const ShvSurfaceCandidate *candidate, double step, double reach, ShvFacetPair *pair,
                           double *distance);
/* The same of an obstacle (obstacle_pair.c); returns the number of points. */
enum { SHV_MOST_POINTS = 3 };
int shv_obstacle_pair_detect(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                             const ShvSurfaceCandidate *candidate, double step, double reach,
                             ShvFacetPair pairs[SHV_MOST_POINTS], double *distance);
/* What was deflected may run into an obstacle that its way missed, or into another face of a mesh: whether a node's does now, with
   the plane of where. */
bool shv_obstacle_pair_crosses(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvFacetPair *crossing);
/* Sets where pair->point stands over a facet. */
void shv_facet_pair_stand(ShvFacetPair *pair, const ShvFacetPlane *plane);
/* What follows from place and velocities; no impulses so far. */
void shv_facet_pair_weigh(ShvFacetPair *pair, const ShvSurfaceBodies *bodies);
/* Velocity of the point against the facet, that which does work with an impulse on the point. */
ShvVec3 shv_facet_pair_velocity(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies);
/* The answer of a facet's node to an impulse on the pair's point, N·s. */
static inline ShvVec3 shv_facet_pair_share(const ShvFacetPair *pair, int corner, ShvVec3 impulse)
{
    return shv_madd(shv_scale(impulse, -pair->weights[corner]),
                    pair->height * shv_dot(pair->gradients[corner], impulse), pair->facet_normal);
}
/* An impulse on the pair's point and the answer on the other side. */
void shv_facet_pair_strike(ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvVec3 impulse);

#endif
