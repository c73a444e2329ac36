/* Touching points of one fragment, and the impulses that answer them. */
#ifndef SHV_RIGID_TOUCH_H
#define SHV_RIGID_TOUCH_H

#include <stdbool.h>

#include "shape/obstacle.h"

enum {
    SHV_TOUCHES_AN_OBSTACLE = 8
}; /* at most; of more nodes those that close fastest and lie farthest apart are kept */

typedef struct ShvTouch {
    int32_t obstacle;       /* index */
    ShvObstacle *other;     /* that obstacle at the time of the touch: takes the opposite impulses */
    ShvVec3 point, normal;  /* world; the normal points from the obstacle to the fragment */
    ShvVec3 arm;            /* from the fragment's centre to the point */
    ShvVec3 other_velocity; /* of the obstacle's point before the impulses */
    double gap;
    double mobility, tangent_mobility; /* change of relative velocity per unit impulse, 1/kg; set by the solution */
    double wanted;                     /* normal velocity that the impulses leave at least, m/s */
    double normal_impulse;             /* N s on the fragment, along the normal */
    ShvVec3 friction_impulse;
} ShvTouch;

typedef struct ShvRigidMotion {
    double inverse_mass;
    ShvMat3 inverse_inertia; /* world */
    ShvVec3 velocity, angular_velocity;
} ShvRigidMotion;

typedef struct ShvTouchWork {
    double normal, friction; /* J on the fragment and on free obstacles */
} ShvTouchWork;

ShvVec3 shv_touch_velocity(const ShvRigidMotion *motion, const ShvTouch *touch);
/* Normal velocity of the fragment against the obstacle: negative when closing. */
double shv_touch_normal_speed(const ShvRigidMotion *motion, const ShvTouch *touch);

/* Keeps SHV_TOUCHES_AN_OBSTACLE of the touches, all of one obstacle; returns how many are left. */
int32_t shv_touches_reduce(ShvTouch *touches, int32_t count, const ShvRigidMotion *motion);

/* Sequential impulses: every touch leaves with at least its wanted normal speed, pushes only, and rubs by Coulomb's law
   against the sliding that is left. Changes the motion and free obstacles (`other`). */
void shv_touches_solve(ShvTouch *touches, int32_t count, ShvRigidMotion *motion);

/* Work of a share of the impulses, acting while the motion goes on its way from `before` by that share towards `after`:
   impulse × mean velocity of the point. Share 1 is exactly the change of kinetic energy. */
ShvTouchWork shv_touches_work(const ShvTouch *touches, int32_t count, const ShvRigidMotion *before,
                              const ShvRigidMotion *after, double share);

#endif
