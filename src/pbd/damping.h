/* Damping towards rigid motion (Müller et al. 2007, section 3.5; Table 6.1 of the chapter with the sign of line 4 put
   right: I = +Σ m r̃ r̃ᵀ). Conserves momentum and angular momentum for every k. */
#ifndef SHV_PBD_DAMPING_H
#define SHV_PBD_DAMPING_H

#include "model/state.h"

/* Rigid motion with the momentum and angular momentum of a component's nodes, at positions reference + displacement. */
typedef struct ShvRigidField {
    double mass;
    ShvVec3 centre, velocity;
    ShvVec3 angular_momentum, angular_velocity; /* about the centre; no rotation about an axis through all nodes */
    ShvMat3 inertia;                            /* about the centre, world axes */
} ShvRigidField;
ShvRigidField shv_rigid_field(const ShvState *state, const int32_t *nodes, int32_t count);

/* Damps the velocities of one component's nodes: v += k (v_cm + ω × r − v), k = `damping` in 0…1. Degenerate components
   (one node, collinear or coincident nodes) have no rotation about the axes without inertia. Returns the kinetic energy
   taken, J ≥ 0. `field` (may be NULL) receives the motion that stays. */
double shv_damp_velocities(ShvState *state, const int32_t *nodes, int32_t count, double damping, ShvRigidField *field);

#endif
