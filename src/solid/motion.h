/* Central difference in half-step form, over a list of awake nodes:
   v(n+1/2) = v(n−1/2) + ½(dt₋ + dt₊) a(n),  u(n+1) = u(n) + dt₊ v(n+1/2). With dt₋ = 0 it starts from v(0). */
#ifndef SHV_SOLID_MOTION_H
#define SHV_SOLID_MOTION_H

#include "model/ledger.h"
#include "model/state.h"

/* Zeroes the force of the listed nodes (nodes = NULL: all). */
void shv_motion_clear_force(ShvState *state, const int32_t *nodes, int32_t count, int32_t threads);
/* v += (kick × (force/mass + gravity)) for the listed nodes, kick = ½(dt₋ + dt₊). */
void shv_motion_kick(ShvState *state, const int32_t *nodes, int32_t count, double kick, const double gravity[3],
                     int32_t threads);
/* u += dt v. */
void shv_motion_drift(ShvState *state, const int32_t *nodes, int32_t count, double step, int32_t threads);
/* Σ over listed nodes in list order (fixed blocks: the same for any number of threads). */
double shv_motion_power(const ShvState *state, const double *force, const int32_t *nodes, int32_t count,
                        int32_t threads);

#endif
