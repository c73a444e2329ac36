/* Which nodes and facets may meet which obstacle in a step. */
#ifndef SHV_CONTACT_CANDIDATES_H
#define SHV_CONTACT_CANDIDATES_H

#include "contact/node_contact.h"
#include "shape/feature.h"

/* A node, or a point of a facet, and an obstacle that may meet within a step: the tangent plane that it must not pass. */
typedef struct ShvNodePair {
    int32_t nodes[3], node_count; /* 1 or 3 */
    double weights[3];            /* of the nodes: the point is Σ wᵢ xᵢ */
    int32_t obstacle;
    double gap; /* m, to the plane */
    ShvVec3 point, normal;
    ShvVec3 relative; /* velocity against the obstacle before any response, m/s */
    double speed;     /* sum of its components: unlike the Euclidean norm it does not vanish before the velocity does */
    double inverse_mass, slip_inverse_mass; /* 1/kg: along the normal; no less than any across it */
    double normal_impulse, friction_bound;  /* N·s */
    ShvVec3 friction;                       /* as in ShvNodeTouch */
    ShvVec3 before[3];                      /* of each node */
} ShvNodePair;

/* Rebuilds the candidates when they may no longer hold. Between rebuilds a step does not go through the nodes, except that
   their speeds are read every 16 steps; twice that speed is allowed for, and half the skin is kept for what the nodes
   gain unseen. */
ShvStatus shv_candidates_refresh(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, double gravity, ShvError *error);

/* The facet as it stands. */
ShvFacetShape shv_candidate_shape(const ShvFacetCandidate *candidate, const ShvState *state);

/* Largest speed of any point of an obstacle, m/s. */
double shv_candidates_obstacle_speed(const ShvObstacle *obstacle);

#endif
