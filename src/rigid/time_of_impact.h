/* When, within a step, a node or a facet of a moving fragment first meets a moving obstacle. */
#ifndef SHV_RIGID_TIME_OF_IMPACT_H
#define SHV_RIGID_TIME_OF_IMPACT_H

#include <stdbool.h>

#include "fragment/free_rotation.h"
#include "shape/feature.h"

/* Rigid motion from a time on: constant acceleration of the centre, free rotation about it. */
typedef struct ShvFlight {
    ShvVec3 position, velocity, acceleration;
    ShvQuat orientation;
    ShvVec3 angular_momentum;
    const ShvFreeRotation *rotation;
    double fastest; /* bound of |ω|, rad/s */
} ShvFlight;

/* The fragment's surface from its centre in reference axes: nodes, 3 doubles each, none farther than `radius`, and its
   facets, of at most `facet_radius`; none where all obstacles are planes. */
typedef struct ShvArms {
    const double *offsets;
    int32_t count;
    double radius;
    const ShvFacetShape *facets;
    int32_t facet_count;
    double facet_radius;
} ShvArms;

ShvVec3 shv_flight_position(const ShvFlight *flight, double time);
ShvQuat shv_flight_orientation(const ShvFlight *flight, double time);
/* The obstacle a time later (or earlier), moving on with its present velocities. */
ShvObstacle shv_obstacle_later(const ShvObstacle *obstacle, double time);

/* A facet turned and moved with its fragment. */
ShvFacetShape shv_facet_placed(const ShvFacetShape *facet, const ShvMat3 *turned, ShvVec3 position);

/* Earliest time in [0, *time] at which some node, or facet and feature of the obstacle, closes with the obstacle, by conservative
   advancement: what is outside `slop` closes when its gap falls to ¾ slop or less; one that starts within slop, when it has gone ¼ slop deeper than
   its start (than 0, when it started outside). When there is one, *time becomes it and the answer is true. `obstacle` is
   that of the flight's start. */
bool shv_time_of_impact(const ShvFlight *flight, const ShvArms *arms, const ShvObstacle *obstacle, double slop,
                        double *time);

#endif
