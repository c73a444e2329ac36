/* Slips: what contacts moved nodes otherwise than by their velocities, and the work of forces along it. */
#ifndef SHV_PBD_SLIPS_H
#define SHV_PBD_SLIPS_H

#include "pbd/relax.h"

/* The time of the state: slips of the step before are set apart, and their nodes' forces marked as unknown (NaN), which the
   caller fills in for those that take part in this step. */
void shv_slips_begin(ShvRelax *relax, const ShvState *state);
/* After the projections, with the velocities of before, by which the prediction moved nodes; and after the response. Synchronous
   steps have no slips: their impulses carry the work (relax.c). On failure there are none. */
ShvStatus shv_slips_start(ShvRelax *relax, const ShvState *state, const ShvRelaxStep *step, ShvError *error);
void shv_slips_finish(ShvRelax *relax, const ShvState *state, const ShvRelaxStep *step);

#endif
