/* Second opinions for the tests, by FCL and libccd. Nothing that is shipped links them: decisions.md says why.
   Bodies are hulls of points: a radius or a support function is refused. */
#ifndef BULLET_BRIDGE_ORACLE_H
#define BULLET_BRIDGE_ORACLE_H

#include <stdbool.h>
#include <stdint.h>

#include "bullet_bridge/depth.h"
#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* FCL's GJK: distance in m, or `apart` is false. Above the true one by at most 1e-9 of it; closer than 1e-9 m counts as
   touching. */
ShvStatus shv_oracle_distance(const ShvConvex *first, const ShvConvex *second, bool *apart, double *distance,
                              ShvError *error);
/* FCL's conservative advancement while the second body makes the way `move` (m) at constant speed and does not turn:
   the share of the way at which they touch, if *found. */
ShvStatus shv_oracle_impact(const ShvConvex *first, const ShvConvex *second, const double move[3], bool *found,
                            double *share, ShvError *error);
/* FCL's dynamic AABB tree: arguments and answer as shv_impact_candidates, finite boxes only. */
ShvStatus shv_oracle_pairs(const double *boxes, int32_t box_count, int32_t *pairs, int64_t capacity, int64_t *count,
                           ShvError *error);

/* libccd's GJK: whether the bodies meet. */
ShvStatus shv_oracle_overlap(const ShvConvex *first, const ShvConvex *second, bool *overlap, ShvError *error);
/* libccd's MPR: a way (m) by which the second gets clear of the first so that they just touch, not always the shortest.
   *overlap is false when there is none. */
ShvStatus shv_oracle_way_out(const ShvConvex *first, const ShvConvex *second, bool *overlap, double way[3],
                             ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
