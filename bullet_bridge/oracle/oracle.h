/* Second opinions for the tests, by FCL and libccd: decisions.md says why nothing that is shipped asks them this.
   Bodies are hulls of points: a radius is refused. */
#ifndef BULLET_BRIDGE_ORACLE_H
#define BULLET_BRIDGE_ORACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "bullet_bridge/depth.h"
#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* FCL's GJK: distance in m, to 1e-9 of it, if *apart. Closer than 1e-6 of the bodies' size it may be wrong about `apart`. */
ShvStatus shv_oracle_distance(const ShvConvex *first, const ShvConvex *second, bool *apart, double *distance,
                              ShvError *error);
/* By FCL's distances: the share of the way `move` (m) that the second body has made, without turning, when they are within
   1e-9 m of each other, if *found. */
ShvStatus shv_oracle_impact(const ShvConvex *first, const ShvConvex *second, const double move[3], bool *found,
                            double *share, ShvError *error);
/* libccd's GJK: whether the bodies meet. Closer than √(its round-off), 1.5e-8 m, they do; flat ones that overlap by less than
   1e-5 of their size may not. */
ShvStatus shv_oracle_overlap(const ShvConvex *first, const ShvConvex *second, bool *overlap, ShvError *error);
/* libccd's MPR: a way (m) by which the second gets clear of the first so that they just touch, not always the shortest.
   *overlap is false when there is none. */
ShvStatus shv_oracle_separation(const ShvConvex *first, const ShvConvex *second, bool *overlap, double way[3],
                                ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
