/* Obstacles: planes, spheres, boxes and closed triangle meshes, fixed, scripted or free. */
#ifndef SHV_SHAPE_OBSTACLE_H
#define SHV_SHAPE_OBSTACLE_H

#include "base/memory.h"
#include "base/vector.h"
#include "mesh/surface.h"
#include "shiver/definition.h"

typedef struct ShvBoundingTree ShvBoundingTree; /* of a triangle mesh; bounding_tree.h */

typedef struct ShvObstacle {
    const ShvObstacleDefinition *definition;
    ShvObstacleShape shape;
    ShvObstacleMotion motion;
    double friction, restitution;
    /* local shape */
    ShvVec3 normal;      /* plane: unit */
    double offset;
    double radius;
    ShvVec3 half;        /* box */
    ShvSurface surface;  /* mesh: about its centre of mass */
    ShvBoundingTree *tree;
    double bounding_radius; /* about the position; infinite for a plane */
    /* body */
    double mass;         /* kg; infinity unless free */
    ShvMat3 inertia;     /* about the position in local axes, free only */
    ShvVec3 position;    /* m; of a free body: its centre of mass */
    ShvQuat orientation;
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
} ShvObstacle;

typedef struct ShvObstacles {
    ShvMemory *memory;
    ShvObstacle *items;
    int32_t count;
} ShvObstacles;

ShvStatus shv_obstacles_create(ShvObstacles *obstacles, ShvMemory *memory, const ShvSceneDefinition *scene,
                               const char *folder, ShvError *error);
void shv_obstacles_release(ShvObstacles *obstacles);

/* Places scripted obstacles at a time and gives them the velocity of their keyframes' motion. */
void shv_obstacles_script(ShvObstacles *obstacles, double time);

/* Moves free obstacles by `step` under gravity and the impulses of the last moments, and answers their contacts with
   other obstacles (restitution: the larger of the pair's, friction: the geometric mean). Returns the work of those
   contacts, J. */
double shv_obstacles_advance(ShvObstacles *obstacles, double step, const double gravity[3]);

typedef struct ShvSurfacePoint {
    double gap;       /* signed distance to the surface, m; negative inside */
    ShvVec3 normal;   /* outward unit normal at the closest point, world */
    ShvVec3 point;    /* closest point of the surface, world */
} ShvSurfacePoint;
/* Exact signed distance; `limit`: beyond this gap any value ≥ limit may be returned (bounding tests first). */
ShvSurfacePoint shv_obstacle_closest(const ShvObstacle *obstacle, ShvVec3 point, double limit);
/* Velocity of the obstacle's material at a world point. */
ShvVec3 shv_obstacle_velocity(const ShvObstacle *obstacle, ShvVec3 point);
/* Change of velocity per unit impulse along `direction` at `point`, 1/kg (0 unless free). */
double shv_obstacle_inverse_mass(const ShvObstacle *obstacle, ShvVec3 point, ShvVec3 direction);
/* Applies an impulse at a point (no effect unless free). */
void shv_obstacle_impulse(ShvObstacle *obstacle, ShvVec3 point, ShvVec3 impulse);
/* Kinetic energy, momentum, angular momentum about the origin of a free obstacle (zero otherwise). */
double shv_obstacle_kinetic(const ShvObstacle *obstacle);

#endif
