/* The motion that a scene's `reference` names, from the scene's own numbers. */
#ifndef SHV_EVALUATE_CLOSED_FORM_H
#define SHV_EVALUATE_CLOSED_FORM_H

#include "evaluate/trajectory.h"

/* free_top.c: torque-free rotation by power series of Euler's equations, exact to rounding. */
typedef struct ShvFreeTop {
    ShvQuat axes, pose;      /* principal axes → body axes; → world */
    double spin[3], rate[3]; /* ω in principal axes, rad/s; ω̇₁ = rate₁ ω₂ ω₃ and so on */
    double time;             /* s */
} ShvFreeTop;
/* `inertia` in body axes, about the centre of mass; `spin` in world axes. */
ShvFreeTop shv_free_top(const ShvMat3 *inertia, ShvQuat orientation, ShvVec3 spin);
/* Orientation and spin (world) at `time`, not before that of the last call. */
void shv_free_top_at(ShvFreeTop *top, double time, ShvQuat *orientation, ShvVec3 *spin);

/* ---- along a line: lengths m, times s, and angles as arcs (m): radius × angle ---- */

typedef struct ShvLineMotion {
    double position, velocity;
} ShvLineMotion;

/* Height above the ground (≥ 0 at the start) under gravity g > 0 towards it, at `time` after the start; an impact multiplies
   the velocity by −restitution. Impacts that accumulate (restitution < 1) end at rest on the ground. */
ShvLineMotion shv_law_bounce(double height, double velocity, double gravity, double restitution, double time);

typedef struct ShvRollMotion {
    ShvLineMotion centre, rim; /* rim: arc turned and its speed; forward rolling without slip has equal speeds */
} ShvRollMotion;
/* Along a slope: `pull` is the part of gravity along it, `friction` ≥ 0 the largest deceleration by Coulomb friction, m/s². A ball
   with moment of inertia `shape` × mass × radius² (solid: 2/5) starts with these speeds of centre and rim, slips until they agree,
   then rolls if friction bears it. With an infinite shape its rim stays as it is: it slides, and what has stopped stays while
   friction bears the pull. */
ShvRollMotion shv_law_roll(double velocity, double rim_speed, double pull, double friction, double shape, double time);

/* ---- the motion of a body ---- */

typedef struct ShvClosedForm {
    ShvReferenceLaw law;
    ShvBodyState start;
    ShvVec3 gravity;
    ShvFreeTop top;    /* flight */
    ShvVec3 direction; /* of the motion along a line: bounce, slide, roll */
    double height;     /* bounce: of the lowest point above the plane, m */
    double speed;      /* bounce, slide, roll: along `direction` at the start */
    double pull;       /* part of gravity along `direction`; bounce: against it */
    double friction;   /* slide, roll: largest deceleration, m/s² */
    double restitution;
    double radius, shape; /* roll: of the ball, and its moment of inertia over mass × radius² */
    ShvVec3 axis;         /* roll: it turns about this one when it moves along `direction` */
    double rim_speed;
} ShvClosedForm;

/* Of one body of the first frame. SHV_BAD_INPUT, with what to change, where the scene is not one of the law's: no contact at the
   start, motion out of the line, events. */
ShvStatus shv_closed_form(ShvClosedForm *form, const ShvSceneDefinition *scene, const ShvSimulation *simulation,
                          const ShvBody *body, int32_t index, ShvError *error);
/* State at `time`, not before that of the last call. */
ShvBodyState shv_closed_form_at(ShvClosedForm *form, double time);

#endif
