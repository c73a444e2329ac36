/* Colours chunks of batches so that two chunks of one colour share no node. */
#ifndef SHV_SOLID_COLOUR_H
#define SHV_SOLID_COLOUR_H

#include "solid/solid.h"

/* Fills chunk_count, chunk_batches, colour_count, colour_start, chunk_order and chunk_colour; needs batch_count. On failure what was
   made stays in `solid`, for its release. */
ShvStatus shv_solid_colour(ShvSolid *solid, const ShvState *state, ShvError *error);

#endif
