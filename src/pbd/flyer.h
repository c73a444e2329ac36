/* One fragment in flight under the PBD backend. */
#ifndef SHV_PBD_FLYER_H
#define SHV_PBD_FLYER_H

#include "pbd/damping.h"
#include "pbd/relax.h"
#include "rigid/backend.h"

typedef struct ShvFlyer {
    int32_t fragment;
    double time;                      /* s: of its nodes */
    bool moves;                       /* in the step at work: it is not at its end yet */
    ShvVec3 seen_velocity, seen_spin; /* written to the record: events of the time line change them */
    uint8_t *touched;                 /* per obstacle: in the last step */
    int32_t *fastest;                 /* per obstacle: touch of this step that closes fastest, −1: none */
    /* the step at work */
    ShvRigidField field; /* at its start, after damping */
    ShvQuat turn;        /* of the rigid motion within it; identity unless exact_rotation */
    ShvVec3 spin;        /* angular velocity after it */
} ShvFlyer;

/* Marks obstacles that the fragment touches where it is. On failure *flyer is NULL. */
ShvStatus shv_flyer_create(ShvFlyer **flyer, const ShvRigidWorld *world, int32_t fragment, ShvError *error);
void shv_flyer_destroy(ShvFlyer *flyer);

/* Takes over changed velocities of the record, damps, and predicts. Returns the energy taken by damping through `taken`. */
ShvStatus shv_flyer_predict(ShvFlyer *flyer, const ShvRigidWorld *world, const ShvPbdDefinition *pbd, ShvRelax *relax,
                            const ShvRelaxStep *step, double *taken, ShvError *error);
/* Velocities after the free turn of the step, without gravity. */
void shv_flyer_turn(const ShvFlyer *flyer, const ShvRigidWorld *world);
/* Fits the record to the nodes. */
void shv_flyer_write(ShvFlyer *flyer, const ShvRigidWorld *world);
/* After a step: which obstacles the fragment touches; `fastest` names those of a projection. */
void shv_flyer_note_touches(ShvFlyer *flyer, const ShvRigidWorld *world, const ShvRelax *relax);

#endif
