/* One fragment in flight under the PBD backend. */
#ifndef SHV_PBD_PBD_BODY_H
#define SHV_PBD_PBD_BODY_H

#include "pbd/damping.h"
#include "pbd/relax.h"
#include "rigid/backend.h"

typedef struct ShvPbdBody {
    int32_t fragment;
    double time;      /* s: of its nodes */
    bool moves;       /* in the step at work: it is not at its end yet */
    uint8_t *touched; /* per obstacle: in the last step */
    int32_t *fastest; /* per obstacle: touch of this step that closes fastest, −1: none */
    /* the step at work */
    ShvRigidField field; /* at its start, after damping */
    ShvQuat rotation;    /* of the rigid motion within it; identity unless exact_rotation */
    ShvVec3 spin;        /* angular velocity after it */
} ShvPbdBody;

/* Marks obstacles that the fragment touches where it is. On failure *body is NULL. */
ShvStatus shv_pbd_body_create(ShvPbdBody **body, const ShvRigidWorld *world, int32_t fragment, ShvError *error);
void shv_pbd_body_destroy(ShvPbdBody *body);

/* Damps, and predicts. Returns the energy taken by damping through `taken`. */
ShvStatus shv_pbd_body_predict(ShvPbdBody *body, const ShvRigidWorld *world, const ShvPbdDefinition *pbd,
                               ShvRelax *relax, const ShvRelaxStep *step, double *taken, ShvError *error);
/* Velocities after the free turn of the step, without gravity. */
void shv_pbd_body_rotate(const ShvPbdBody *body, const ShvRigidWorld *world);
/* Fits the record to the nodes. */
void shv_pbd_body_write(ShvPbdBody *body, const ShvRigidWorld *world);
/* After a step: which obstacles the fragment touches; `fastest` names those of a projection. */
void shv_pbd_body_note_contacts(ShvPbdBody *body, const ShvRigidWorld *world, const ShvRelax *relax);

#endif
