/* What the analytic backend keeps of a fragment in flight, beside the fragment's record. */
#ifndef SHV_RIGID_FLIGHT_BODY_H
#define SHV_RIGID_FLIGHT_BODY_H

#include "rigid/backend.h"
#include "rigid/time_of_impact.h"

typedef struct ShvFlightBody {
    int32_t fragment;
    double time; /* s: of its record */
    ShvFreeRotation rotation;
    ShvVec3 angular_momentum; /* kg m²/s about the centre, world: the state of rotation */
    ShvQuat seen_orientation; /* what angular_momentum was derived from or written to: */
    ShvVec3 seen_spin;        /* events of the time line change the record */
    double *offsets;          /* of `arms` */
    ShvFacetShape *facets;    /* of `arms` */
    ShvArms arms;
    double slop;                 /* m: a smaller gap is a touch */
    uint8_t *touched, *touching; /* per obstacle: in the last step, in this one */
    int32_t still;               /* steps in a row without noticeable motion on supports that do not move */
    bool resting;                /* motionless until something changes */
    ShvVec3 resting_gravity;
} ShvFlightBody;

/* On failure *body is NULL. */
ShvStatus shv_flight_body_create(ShvFlightBody **body, const ShvRigidWorld *world, int32_t fragment, ShvError *error);
void shv_flight_body_destroy(ShvFlightBody *body);

/* Takes over a rotation that somebody wrote into the record since the last step. */
void shv_flight_body_read(ShvFlightBody *body, const ShvFragment *fragment);
/* Writes the angular velocity that belongs to the momentum and the record's orientation. */
void shv_flight_body_write(ShvFlightBody *body, ShvFragment *fragment);

#endif
