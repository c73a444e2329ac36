/* Bonded facets in PBD flight: the copies of a node on both sides of one are tied, so that what the law holds together flies and
   is damped as one body. A tie is a rigid bar between two copies, as long as they were apart when the body came to rest
   (micrometres, where a bond still holds); bars.h leaves out pairs that coincide in the reference. Worked through one after
   another, in the order of facets, after the bars of each sweep. */
#ifndef SHV_PBD_TIES_H
#define SHV_PBD_TIES_H

#include "fragment/fragment.h"

typedef struct ShvTie {
    int32_t ends[2];
    double length; /* m */
} ShvTie;

typedef struct ShvTies {
    ShvMemory *memory;
    ShvTie *items;
    int32_t count, capacity;
} ShvTies;

/* Those of fragments with a flag (per fragment index). On failure there are none. */
ShvStatus shv_ties_update(ShvTies *ties, const ShvFragments *fragments, const ShvState *state, const uint8_t *flags,
                          ShvError *error);
void shv_ties_release(ShvTies *ties);
/* One sweep, on the arrays of shv_bars_sweep. */
void shv_ties_sweep(const ShvTies *ties, double stiffness, const double *anchors, double *shifts);

#endif
