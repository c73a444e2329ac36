/* One fragment's step: from event to event, each either an impact or the end of the step. */
#ifndef SHV_RIGID_FLIGHT_STEP_H
#define SHV_RIGID_FLIGHT_STEP_H

#include "rigid/flight_body.h"
#include "rigid/touch.h"

typedef struct ShvFlightStep {
    const ShvRigidWorld *world;
    ShvFlightBody *body;
    ShvFragment *fragment;
    double time, step; /* s: at the step's start; its length */
    double now;        /* s since its start */
    ShvVec3 gravity;
    ShvWakeJudge judge; /* NULL: nothing wakes */
    void *judge_data;
    ShvTouch *touches;   /* room for SHV_TOUCHES_AN_OBSTACLE an obstacle and once more, and one a surface node */
    ShvObstacle *others; /* obstacles at `now` */
    ShvTouchWork work;   /* J, answered so far */
    bool held;           /* the last part of the step was on supports */
} ShvFlightStep;

/* Marks the obstacles that the fragment touches as known, so that they are not fresh. */
void shv_flight_step_greet(ShvFlightStep *step);
/* Moves the fragment to the end of the step, or to the contact that wakes it: then the answer is true and `contact`
   is it. The body has read the record (shv_flight_body_read). */
bool shv_flight_step_run(ShvFlightStep *step, ShvRigidContact *contact);

#endif
