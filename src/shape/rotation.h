/* Free rotation of a rigid body. */
#ifndef SHV_SHAPE_ROTATION_H
#define SHV_SHAPE_ROTATION_H

#include "base/vector.h"

/* Turns a body without torque for `step`. `moments` and `axes` (principal → body): its principal inertia; `orientation`:
   body → world; `angular_velocity`: world. Symmetric composition of rotations about the principal axes (a Lie-Poisson
   splitting: second order, reversible): the world's angular momentum is kept to round-off, the energy error is bounded
   and of second order. Turns of more than 1/32 rad are divided, at most 4096 times. */
void shv_rotate_free(ShvVec3 moments, ShvQuat axes, ShvQuat *orientation, ShvVec3 *angular_velocity, double step);

/* Rotation vector (|angle| ≤ π) of the shortest turn from one orientation to another: to = exp(vector) from. */
ShvVec3 shv_rotation_between(ShvQuat from, ShvQuat to);

#endif
