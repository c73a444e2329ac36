/* Nodes against obstacles in fracture mode: unilateral, Coulomb friction, restitution 0. Acts on velocities after the
   kick: a node that would be inside at the end of the step gets the impulse that lets it just arrive (gap > 0) or stops
   it (gap ≤ 0); it is never pushed out, so contact takes energy or leaves it. Free obstacles take the opposite impulse. */
#ifndef SHV_CONTACT_NODE_CONTACT_H
#define SHV_CONTACT_NODE_CONTACT_H

#include "model/ledger.h"
#include "model/state.h"
#include "shape/obstacle.h"

typedef struct ShvNodeContact {
    ShvMemory *memory;
    /* surface nodes near each obstacle, rebuilt when motion since then exceeds the skin */
    int32_t *candidates; /* node indices, increasing, per obstacle one after another */
    int32_t *candidate_start; /* obstacle_count + 1 */
    int32_t capacity;
    double skin, moved; /* m */
    /* this step */
    int32_t touching;        /* nodes with an impulse this step */
    double normal_work, friction_work;           /* J on the nodes, impulse × mean of velocities before the kick and after */
    double obstacle_work;                        /* J on free obstacles */
    double largest_closing_speed;                /* m/s of new contacts */
    ShvVec3 impulse;                             /* N·s on the nodes, total */
} ShvNodeContact;

ShvStatus shv_node_contact_create(ShvNodeContact *contact, ShvMemory *memory, const ShvObstacles *obstacles, ShvError *error);
void shv_node_contact_release(ShvNodeContact *contact);
/* Forces a rebuild of the candidates (nodes were duplicated, fragments woke). */
void shv_node_contact_invalidate(ShvNodeContact *contact);
/* One step for the listed awake surface nodes. `before`: velocities before the kick are not stored; the work is booked
   from impulse, mass and velocities after: v₋ = v_free − kick × a is passed as `kick` and state->force. */
ShvStatus shv_node_contact_apply(ShvNodeContact *contact, ShvState *state, ShvObstacles *obstacles, const int32_t *nodes,
                                 int32_t count, double kick, double step, const double gravity[3], ShvError *error);

#endif
