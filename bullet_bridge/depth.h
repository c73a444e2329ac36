/* Distance, or depth and direction of penetration, of two convex bodies (tets, hulls, spheres, convex obstacles).
   Distance by GJK, depth by an expanding polytope, both with
   a bound that holds whether or not they have converged. */
#ifndef BULLET_BRIDGE_DEPTH_H
#define BULLET_BRIDGE_DEPTH_H

#include <stdint.h>

#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The hull of points grown by a radius (a sphere is one point and its radius). At most 1e5 times as large as its partner, or digits are lost. */
typedef struct ShvConvex {
    const double *points; /* 3 a point, body axes, m */
    int32_t count;
    double radius;      /* m, ≥ 0 */
    double position[3]; /* m */
    double rotation[9]; /* row major, body → world axes; a rotation */
} ShvConvex;

typedef struct ShvConvexGap {
    double gap;       /* m: distance; negative: depth, the shortest way by which the second gets clear */
    double normal[3]; /* unit, from the first to the second: moving the second along it opens the gap */
    double first[3],
        second[3]; /* closest points of the surfaces, or the deepest (second − first = gap × normal), world */
} ShvConvexGap;

/* The gap of two bodies, to about 1e-12 of their size. `gap` is never above the true one: the planes through `first` and
   `second` across `normal` bound the bodies. Faces that coincide have gap 0 (within round-off) and their own normal; where
   no direction is better than another (a corner in a corner, equal centres), some deepest one is chosen, the same
   whenever the same is asked. Fails on numbers that are not finite, an empty body or lack of memory. */
ShvStatus shv_convex_gap(const ShvConvex *first, const ShvConvex *second, ShvConvexGap *gap, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
