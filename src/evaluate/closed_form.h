/* The motion that a scene's `reference` names, from the scene's own numbers. */
#ifndef SHV_EVALUATE_CLOSED_FORM_H
#define SHV_EVALUATE_CLOSED_FORM_H

#include "evaluate/body.h"
#include "evaluate/free_top.h"

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

/* Of one body, from its state at time 0. SHV_BAD_INPUT, with what to change, where the scene is not one of the law's: no
   contact at the start, motion out of the line, events. `mesh` is that of the simulation. */
ShvStatus shv_closed_form(ShvClosedForm *form, const ShvSceneDefinition *scene, const ShvMeshView *mesh,
                          const ShvBody *body, const ShvBodyState *start, ShvError *error);
/* State at `time`, not before that of the last call. */
ShvBodyState shv_closed_form_at(ShvClosedForm *form, double time);

#endif
