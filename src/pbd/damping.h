/* Damping towards rigid motion (Müller et al. 2007, section 3.5; Table 6.1 of the chapter with the sign of line 4 put
   right: I = +Σ m r̃ r̃ᵀ). Conserves momentum and angular momentum for every k. */
#ifndef SHV_PBD_DAMPING_H
#define SHV_PBD_DAMPING_H

#include "base/vector.h"
#include "model/state.h"

/* Damps the velocities of one component's nodes: v += k (v_cm + ω × r − v), positions reference + displacement. Degenerate
   components (one node, collinear) by pseudo-inverse. Returns the kinetic energy taken, J ≥ 0. */
double shv_damp_velocities(ShvState *state, const int32_t *nodes, int32_t count, double damping);

/* Rigid motion of a component's nodes: v_cm, ω, centre. */
void shv_damping_motion(const ShvState *state, const int32_t *nodes, int32_t count, ShvVec3 *centre, ShvVec3 *velocity,
                        ShvVec3 *angular_velocity);

#endif
