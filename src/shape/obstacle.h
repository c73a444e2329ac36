/* Obstacles: planes, spheres, boxes and closed triangle meshes, fixed, scripted or free. */
#ifndef SHV_SHAPE_OBSTACLE_H
#define SHV_SHAPE_OBSTACLE_H

#include <stdbool.h>

#include "base/memory.h"
#include "base/vector.h"
#include "mesh/surface.h"
#include "shiver/definition.h"

typedef struct ShvBoundingTree ShvBoundingTree; /* of a triangle mesh; bounding_tree.h */
typedef struct ShvFeature ShvFeature;           /* feature.h */

typedef struct ShvObstacle {
    const ShvObstacleDefinition *definition;
    const char *name; /* empty where a scene made in C gives none */
    ShvObstacleShape shape;
    ShvObstacleMotion motion;
    double friction, restitution;
    /* local shape */
    ShvVec3 normal; /* plane: unit */
    double offset;
    double radius;      /* sphere; else 0 */
    ShvVec3 half;       /* box */
    ShvSurface surface; /* mesh: about its centre of mass, in the axes of the file */
    ShvVec3 centre;     /* mesh: its centre of mass in the file's (scaled) coordinates: the file's origin is at
                            position − orientation · centre, which is where placement and keyframes put it */
    ShvBoundingTree *tree;
    double bounding_radius; /* about the position; infinite for a plane */
    ShvFeature *features;   /* what facets meet between their nodes, by the low ends of their x */
    int32_t feature_count;
    double feature_reach; /* m: longest way of one along x */
    /* body */
    double mass;               /* kg; infinity unless free */
    ShvMat3 inertia;           /* about the position in local axes, free only */
    ShvMat3 inverse_inertia;   /* zero unless free */
    ShvVec3 principal_moments; /* kg m², free only */
    ShvQuat principal_axes;    /* principal → local axes */
    ShvVec3 position;          /* m; the centre of mass */
    ShvQuat orientation;
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
} ShvObstacle;

typedef struct ShvObstacles {
    ShvMemory *memory;
    ShvObstacle *items;
    int32_t count;
    struct ShvBodyContact *contacts; /* room for those of one time between free and other obstacles (collide.h) */
    int32_t contact_capacity;
} ShvObstacles;

/* Refuses impossible definitions and unreadable or open surfaces; the message names the obstacle. Scripted obstacles
   stand at time 0. On failure `obstacles` is zeroed and owns nothing. */
ShvStatus shv_obstacles_create(ShvObstacles *obstacles, ShvMemory *memory, const ShvSceneDefinition *scene,
                               const char *folder, ShvError *error);
void shv_obstacles_release(ShvObstacles *obstacles);

/* Places scripted obstacles at a time and gives them the velocity of their keyframes' motion (at a keyframe: of the motion
   that begins there). */
void shv_obstacles_script(ShvObstacles *obstacles, double time);
/* The same, with the constant velocities that lead to the pose at time + step, whatever keyframes lie between. */
void shv_obstacles_script_step(ShvObstacles *obstacles, double time, double step);

/* Its triangles in local axes: those of a mesh, or of a box, whose corners are stored (8 × 3 numbers); none of a plane or sphere. */
ShvSurface shv_obstacle_surface(const ShvObstacle *obstacle, double corners[24]);

/* Moves free obstacles by `step` under gravity and answers their contacts with other obstacles (restitution: the larger
   of the pair's, friction: the geometric mean). Flight is exact (parabola) or keeps |L| to round-off and energy nearly
   (rotation.h). An impact splits the step at its time; contacts that close slower than 2 step |gravity| are held without
   restitution and do not sink. Corners and vertices are tried against surfaces, edges are not tried against edges.
   Scripted obstacles are carried along with their velocity until the next shv_obstacles_script. Returns the work of the
   contacts on free obstacles, J. */
double shv_obstacles_advance(ShvObstacles *obstacles, double step, const double gravity[3]);

typedef struct ShvSurfacePoint {
    double gap;     /* signed distance to the surface, m; negative inside */
    ShvVec3 normal; /* outward unit normal at the closest point, world */
    ShvVec3 point;  /* closest point of the surface, world */
} ShvSurfacePoint;
/* Exact signed distance; `limit` (≥ 0): beyond this gap any value ≥ limit may be returned, with a point and normal
   without meaning (bounding tests first). The gap of a box or mesh is negative at any depth. */
ShvSurfacePoint shv_obstacle_closest(const ShvObstacle *obstacle, ShvVec3 point, double limit);
/* Whether an edge or a corner of the obstacle is next to such a point (within 1e-3 of its radius), where the way to the nearest surface
   may be none that a body beside it can be pushed. */
bool shv_obstacle_is_sharp(const ShvObstacle *obstacle, const ShvSurfacePoint *at);
/* Whether two surfaces whose outward unit normals these are face each other: they are more than 120 degrees apart. */
static inline bool shv_normals_face(ShvVec3 a, ShvVec3 b)
{
    return shv_dot(a, b) < -0.5;
}

typedef struct ShvCrossing {
    double fraction;       /* of the way, 0…1 */
    ShvVec3 point, normal; /* on the surface, outward, world */
} ShvCrossing;
/* First crossing of the segment from → to into the obstacle where it stands; false when it stays outside or starts
   inside. What lies inside at the end and outside at the start has always crossed. */
bool shv_obstacle_sweep(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, ShvCrossing *crossing);

/* Velocity of the obstacle's material at a world point. */
ShvVec3 shv_obstacle_velocity(const ShvObstacle *obstacle, ShvVec3 point);
/* Change of velocity per unit impulse along `direction` at `point`, 1/kg (0 unless free). */
double shv_obstacle_inverse_mass(const ShvObstacle *obstacle, ShvVec3 point, ShvVec3 direction);
/* Applies an impulse at a point (no effect unless free). */
void shv_obstacle_impulse(ShvObstacle *obstacle, ShvVec3 point, ShvVec3 impulse);
/* Kinetic energy and angular momentum about the origin of a free obstacle (zero otherwise). */
double shv_obstacle_kinetic(const ShvObstacle *obstacle);
ShvVec3 shv_obstacle_angular_momentum(const ShvObstacle *obstacle);

#endif
