/* Obstacles in a step of position based dynamics: relax.h's parts that concern them. */
#ifndef SHV_PBD_RESPONSE_H
#define SHV_PBD_RESPONSE_H

#include "pbd/relax.h"

/* Moves nodes that are inside an obstacle to its surface. */
ShvStatus shv_response_project(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count,
                               const ShvRelaxStep *step, ShvError *error);
/* Restitution and friction after the velocities have followed the projections; gives free obstacles their velocities. */
void shv_response_apply(ShvRelax *relax, ShvState *state, ShvObstacles *obstacles, const ShvRelaxStep *step);
/* Remembers who touched. */
void shv_response_finish(ShvRelax *relax, const int32_t *nodes, int32_t count);

#endif
