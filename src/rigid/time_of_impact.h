/* When, within a step, a node of a moving fragment first meets a moving obstacle. */
#ifndef SHV_RIGID_TIME_OF_IMPACT_H
#define SHV_RIGID_TIME_OF_IMPACT_H

#include <stdbool.h>

#include "rigid/free_rotation.h"
#include "shape/obstacle.h"

/* Rigid motion from a moment on: constant acceleration of the centre, free rotation about it. */
typedef struct ShvFlight {
    ShvVec3 position, velocity, acceleration;
    ShvQuat orientation;
    ShvVec3 angular_momentum;
    const ShvFreeRotation *rotation;
    double fastest; /* bound of |ω|, rad/s */
} ShvFlight;

/* Nodes of the fragment's surface, 3 doubles a node from its centre in reference axes, none farther than `radius`. */
typedef struct ShvArms {
    const double *offsets;
    int32_t count;
    double radius;
} ShvArms;

ShvVec3 shv_flight_position(const ShvFlight *flight, double time);
ShvQuat shv_flight_orientation(const ShvFlight *flight, double time);
/* The obstacle a time later (or earlier), moving on with its present velocities. */
ShvObstacle shv_obstacle_later(const ShvObstacle *obstacle, double time);

/* Earliest time in [0, *time] at which some node closes with the obstacle, by conservative advancement: a node outside
   `slop` closes when its gap falls to ¾ slop or less; one that starts within slop, when it has gone ¼ slop deeper than
   its start (than 0, when it started outside). When there is one, *time becomes it and the answer is true. `obstacle` is
   that of the flight's start. */
bool shv_time_of_impact(const ShvFlight *flight, const ShvArms *arms, const ShvObstacle *obstacle, double slop,
                        double *time);

#endif
