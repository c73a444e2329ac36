/* A tree of boxes over the triangles of a closed surface: closest point with sign, and first crossing of a segment. */
#ifndef SHV_SHAPE_BOUNDING_TREE_H
#define SHV_SHAPE_BOUNDING_TREE_H

#include <stdbool.h>

#include "mesh/surface.h"

typedef struct ShvBoundingTree ShvBoundingTree;

/* The surface must be closed and must outlive the tree. NULL when memory is out. */
ShvBoundingTree *shv_bounding_tree_create(ShvMemory *memory, const ShvSurface *surface);
void shv_bounding_tree_release(ShvBoundingTree *tree);

typedef struct ShvTreePoint {
    double gap; /* signed distance, m; negative inside */
    ShvVec3 point, normal;
    int32_t triangle; /* −1: nothing nearer than the limit */
} ShvTreePoint;
/* Closest point. The sign comes from the pseudonormal of the feature (face, edge: sum of two, vertex: weighted by angle)
   that is closest, which is right for any closed surface (J. A. Bærentzen and H. Aanæs, Signed distance computation using
   the angle weighted pseudonormal, IEEE Trans. Vis. Comput. Graph. 11 (2005)). Points outside the bounding box of the
   surface give up beyond `limit` and return gap = limit. */
ShvTreePoint shv_bounding_tree_closest(const ShvBoundingTree *tree, ShvVec3 point, double limit);

/* First triangle that the segment crosses against its normal: fraction of the way, and normal. */
bool shv_bounding_tree_sweep(const ShvBoundingTree *tree, ShvVec3 from, ShvVec3 to, double *fraction, ShvVec3 *normal);

#endif
