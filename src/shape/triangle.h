/* The point of a triangle that is closest to another point. */
#ifndef SHV_SHAPE_TRIANGLE_H
#define SHV_SHAPE_TRIANGLE_H

#include "base/vector.h"

/* What of a triangle the point is on: corners 0-2, edges 3-5 (from corner k − 3 to the next), its face. */
enum { SHV_TRIANGLE_EDGES = 3, SHV_TRIANGLE_FACE = 6 };

typedef struct ShvTrianglePoint {
    ShvVec3 point;
    double weights[3]; /* of the corners */
    int feature;
} ShvTrianglePoint;

ShvTrianglePoint shv_triangle_closest(ShvVec3 point, const ShvVec3 corners[3]);

#endif
