/* A fragment in rigid flight that deforming ones may touch: it goes through the same steps, its nodes follow one rigid
   motion, and an impulse changes that motion. Velocities stand at half steps like those of nodes. */
#ifndef SHV_CONTACT_COMPANION_H
#define SHV_CONTACT_COMPANION_H

#include <stdint.h>

#include "base/vector.h"

typedef struct ShvCompanion {
    double mass;                        /* kg; infinite, with a zero inverse inertia: nothing moves it */
    ShvMat3 inverse_inertia;            /* 1/(kg m²), about the centre of mass, world axes, at time n */
    ShvVec3 reference_centre;           /* centre of mass at reference positions, m */
    ShvVec3 position;                   /* centre of mass at time n, m */
    ShvQuat orientation;                /* reference axes → world, at time n */
    double radius;                      /* farthest node from the centre, m */
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
    int64_t alone; /* 1: it meets obstacles, and no other body; wide, so that no padding goes to checkpoints */
} ShvCompanion;

static inline ShvVec3 shv_companion_point(const ShvCompanion *companion, ShvVec3 reference)
{
    const ShvVec3 arm = shv_sub(reference, companion->reference_centre);
    return shv_add(companion->position, shv_rotate(companion->orientation, arm));
}

static inline ShvVec3 shv_companion_velocity(const ShvCompanion *companion, ShvVec3 point)
{
    const ShvVec3 arm = shv_sub(point, companion->position);
    return shv_add(companion->velocity, shv_cross(companion->angular_velocity, arm));
}

/* Change of velocity of a point along a unit vector per impulse along it, 1/kg. */
static inline double shv_companion_inverse_mass(const ShvCompanion *companion, ShvVec3 point, ShvVec3 direction)
{
    const ShvVec3 turn = shv_cross(shv_sub(point, companion->position), direction);
    return 1.0 / companion->mass + shv_dot(turn, shv_apply(&companion->inverse_inertia, turn));
}

/* N·s at a point. */
static inline void shv_companion_impulse(ShvCompanion *companion, ShvVec3 point, ShvVec3 impulse)
{
    const ShvVec3 turn = shv_cross(shv_sub(point, companion->position), impulse);
    companion->velocity = shv_madd(companion->velocity, 1.0 / companion->mass, impulse);
    companion->angular_velocity = shv_add(companion->angular_velocity, shv_apply(&companion->inverse_inertia, turn));
}

#endif
