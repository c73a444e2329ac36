/* The points of two segments that are closest to each other. */
#ifndef SHV_SHAPE_SEGMENT_H
#define SHV_SHAPE_SEGMENT_H

#include <math.h>
#include <stdbool.h>

#include "base/vector.h"

/* Share of an edge next to its ends, where its nodes meet faces. What touches by rounding, or a step deep, would there face edges
   it has nothing to do with: a node that lies on a box brings its steep edges to those of the box, sideways. */
#define SHV_SEGMENT_RIM 1e-3

typedef struct ShvSegmentPoints {
    double shares[2]; /* along each */
    ShvVec3 between;  /* from the point of the first to that of the second */
    bool inside;      /* neither is in the rim of its segment, nor are they parallel */
} ShvSegmentPoints;

/* Cut to what lies on a segment. */
static inline double shv_segment_share(double share)
{
    return fmin(1.0, fmax(0.0, share));
}

/* Of two segments from `a` along `u` and from `b` along `v`. */
ShvSegmentPoints shv_segments_closest(ShvVec3 a, ShvVec3 u, ShvVec3 b, ShvVec3 v);

#endif
