/* Which nodes may meet which obstacle in a step. */
#ifndef SHV_CONTACT_CANDIDATES_H
#define SHV_CONTACT_CANDIDATES_H

#include "contact/node_contact.h"

/* A node and an obstacle that may meet within a step: the tangent plane that the node must not pass. */
typedef struct ShvNodePair {
    int32_t node, obstacle;
    double gap; /* m, to the plane */
    ShvVec3 point, normal;
    ShvVec3 relative; /* velocity against the obstacle before any response, m/s */
    double speed;     /* sum of its components: unlike the Euclidean norm it does not vanish before the velocity does */
    double normal_impulse;
    ShvVec3 friction, before; /* as in ShvNodeTouch */
} ShvNodePair;

/* Rebuilds the candidates when they may no longer hold. Between rebuilds a step costs no look at the nodes, except that
   their speeds are read every 16 steps; twice that speed is allowed for, and half the skin is kept for what the nodes
   gain unseen. */
ShvStatus shv_candidates_refresh(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, double gravity, ShvError *error);

/* Room for one more element. */
ShvStatus shv_candidates_grow(ShvMemory *memory, void **block, int32_t *capacity, int32_t count, size_t size,
                              ShvError *error);

/* Largest speed of any point of an obstacle, m/s. */
double shv_candidates_obstacle_speed(const ShvObstacle *obstacle);

#endif
