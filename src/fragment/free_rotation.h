/* Free rotation of a rigid body with any inertia, by power series of Euler's equations: the angular momentum is the
   state and stays what it is, only the orientation moves. */
#ifndef SHV_FRAGMENT_FREE_ROTATION_H
#define SHV_FRAGMENT_FREE_ROTATION_H

#include "base/vector.h"

typedef struct ShvFreeRotation {
    ShvMat3 axes;      /* principal axes in columns, in reference axes */
    double moment[3];  /* kg m², ascending; 0 where degenerate */
    double inverse[3]; /* 1/moment; 0 where degenerate: no rotation about that axis */
    double rate[3];    /* (I_j − I_k)/I_i of Euler's equations */
    double growth;     /* largest |rate|, at least 1: 1/(growth |ω|) bounds the series' radius of convergence */
} ShvFreeRotation;

/* Principal axes and moments of an inertia about the centre of mass, in reference axes. Moments below 1e-13 of the
   largest count as zero. */
ShvFreeRotation shv_free_rotation_make(const ShvMat3 *inertia);

/* Angular velocity and momentum (world) from each other, at an orientation (reference axes → world). */
ShvVec3 shv_free_rotation_velocity(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum);
ShvVec3 shv_free_rotation_momentum(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_velocity);
/* Kinetic energy of rotation, J. */
double shv_free_rotation_energy(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum);
/* Upper bound of |ω| for all times, rad/s. */
double shv_free_rotation_fastest(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum);
/* Inverse inertia in world axes (pseudo-inverse when degenerate). */
ShvMat3 shv_free_rotation_world_inverse(const ShvFreeRotation *rotation, ShvQuat orientation);

/* The orientation after `step` seconds; truncation is below round-off for any step, in substeps of at most a quarter
   radian. The cost grows with |ω| × step: callers refuse motion that turns more than SHV_LARGEST_ROTATION in one step. */
#define SHV_LARGEST_ROTATION 1e5 /* rad */
ShvQuat shv_free_rotation_advance(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum,
                                  double step);

#endif
