/* A fragment in rigid flight that deforming ones may touch: it goes through the same steps, its nodes follow one rigid
   motion, and an impulse changes that motion. Velocities stand at half steps like those of nodes. */
#ifndef SHV_CONTACT_COUPLED_BODY_H
#define SHV_CONTACT_COUPLED_BODY_H

#include <stdint.h>

#include "base/vector.h"

typedef struct ShvCoupledBody {
    double mass;                        /* kg; infinite, with a zero inverse inertia: nothing moves it */
    ShvMat3 inverse_inertia;            /* 1/(kg m²), about the centre of mass, world axes, at time n */
    ShvVec3 reference_centre;           /* centre of mass at reference positions, m */
    ShvVec3 position;                   /* centre of mass at time n, m */
    ShvQuat orientation;                /* reference axes → world, at time n */
    double radius;                      /* farthest node from the centre, m */
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
    int64_t alone; /* 1: it meets obstacles, and no other body; wide, so that no padding goes to checkpoints */
} ShvCoupledBody;

static inline ShvVec3 shv_coupled_body_point(const ShvCoupledBody *coupled_body, ShvVec3 reference)
{
    const ShvVec3 arm = shv_sub(reference, coupled_body->reference_centre);
    return shv_add(coupled_body->position, shv_rotate(coupled_body->orientation, arm));
}

static inline ShvVec3 shv_coupled_body_velocity(const ShvCoupledBody *coupled_body, ShvVec3 point)
{
    return shv_velocity_at(coupled_body->velocity, coupled_body->angular_velocity,
                           shv_sub(point, coupled_body->position));
}

/* Change of velocity of a point along a unit vector per impulse along it, 1/kg. */
static inline double shv_coupled_body_inverse_mass(const ShvCoupledBody *coupled_body, ShvVec3 point, ShvVec3 direction)
{
    const ShvVec3 torque = shv_cross(shv_sub(point, coupled_body->position), direction);
    return 1.0 / coupled_body->mass + shv_dot(torque, shv_apply(&coupled_body->inverse_inertia, torque));
}

/* N·s at a point. */
static inline void shv_coupled_body_impulse(ShvCoupledBody *coupled_body, ShvVec3 point, ShvVec3 impulse)
{
    const ShvVec3 torque = shv_cross(shv_sub(point, coupled_body->position), impulse);
    coupled_body->velocity = shv_madd(coupled_body->velocity, 1.0 / coupled_body->mass, impulse);
    coupled_body->angular_velocity =
        shv_add(coupled_body->angular_velocity, shv_apply(&coupled_body->inverse_inertia, torque));
}

#endif
