/* Shapes of fragments and obstacles as Bullet's worlds take them: about the centre of mass, in principal axes. */
#ifndef SHV_RIGID_BULLET_SHAPE_H
#define SHV_RIGID_BULLET_SHAPE_H

#include "bullet_bridge/rigid_world.h"
#include "convex/convex_pieces.h"
#include "fragment/free_rotation.h"
#include "shape/obstacle.h"

/* Stays where it is: the shape points into it. */
typedef struct ShvBodyShape {
    ShvBulletShape shape;
    int32_t hull_begin[2]; /* of a single hull */
    double *vertices;
} ShvBodyShape;

/* On failure nothing is owned. */
ShvStatus shv_body_shape_of_pieces(ShvBodyShape *body, const ShvConvexPieces *pieces, const ShvMat3 *axes, bool dust,
                                   ShvError *error);
/* A free mesh is its hull, one that is moved by nobody or by a script its triangles. */
ShvStatus shv_body_shape_of_obstacle(ShvBodyShape *body, const ShvObstacle *obstacle, const ShvMat3 *axes,
                                     ShvMemory *memory, ShvError *error);
void shv_body_shape_release(ShvBodyShape *body);

#endif
