/* How deep two bodies stand in each other at the start: an object, and another or an obstacle, by their true surfaces. */
#ifndef SHV_SIM_OVERLAP_MEASURE_H
#define SHV_SIM_OVERLAP_MEASURE_H

#include "contact/box.h"
#include "coupling/hybrid.h"
#include "shape/bounding_tree.h"

/* An object where it stands at the start; nodes are numbered from its first. */
typedef struct ShvStartBody {
    const ShvModel *model;
    const ShvObject *object;
    ShvBox box;
    ShvVec3 centre;     /* of the box */
    double size;        /* m: half the box's diagonal */
    double radius;      /* m: about the centre */
    ShvSurface surface; /* its boundary; positions are the mesh's. No triangles until someone needs them */
    ShvBoundingTree *tree;
} ShvStartBody;

/* An obstacle where it stands at the start. */
typedef struct ShvStartObstacle {
    const ShvObstacle *obstacle;
    ShvBox box; /* infinite for a plane */
} ShvStartObstacle;

/* The deepest point found. */
typedef struct ShvDepth {
    double depth; /* m; 0: none lies inside */
    ShvVec3 point;
    ShvVec3 direction; /* of unit length: the shortest way on which the first body, there, leaves the second */
} ShvDepth;

/* Box, centre and size; the surface stays empty. */
void shv_start_body(ShvStartBody *body, const ShvModel *model, int32_t object);
void shv_start_obstacle(ShvStartObstacle *place, const ShvObstacle *obstacle);

/* No point of the one lies deeper in the other than this, by boxes and spheres around them; not above 0: they are apart. */
double shv_bound_of_objects(const ShvStartBody *first, const ShvStartBody *second);
double shv_bound_of_obstacle(const ShvStartBody *body, const ShvStartObstacle *place);

/* With the first body moved by `shift`. Surfaces and trees must be there, but for a plane. Tried are corners and middles of
   triangles of both, and edges that pass through at the middle of what is inside; where these find nothing below
   `allowance`, as for two bodies in one place, also centroids of tets. */
ShvDepth shv_depth_of_objects(const ShvStartBody *first, const ShvStartBody *second, ShvVec3 shift, double allowance);
ShvDepth shv_depth_in_obstacle(const ShvStartBody *body, const ShvStartObstacle *place, ShvVec3 shift,
                               double allowance);

/* How far the first body must go along a direction of unit length to be beyond all of the second, m. */
double shv_depth_along_object(const ShvStartBody *first, const ShvStartBody *second, ShvVec3 direction);
double shv_depth_along_obstacle(const ShvStartBody *body, const ShvStartObstacle *place, ShvVec3 direction,
                                double depth);

#endif
