// Bodies' shapes as Bullet's: compounds of convex hulls, spheres, planes, triangle meshes.
#ifndef BULLET_BRIDGE_BODY_SHAPES_HPP
#define BULLET_BRIDGE_BODY_SHAPES_HPP

#include <memory>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>

#include "bullet_bridge/rigid_convex.hpp"
#include "bullet_bridge/rigid_world.h"

namespace shiver
{
struct BodyShapes {
    std::vector<ShvConvex> parts; // hulls that have a volume, triangles that have an area: numbered as in the shape
    std::vector<std::unique_ptr<btConvexHullShape>> hulls;
    std::unique_ptr<btTriangleMesh> triangles;
    std::unique_ptr<btCollisionShape> compound, surface; // where there is one
    btCollisionShape *shape = nullptr;                   // one of these
    btScalar radius = 0;                                 // about the origin; BT_LARGE_FLOAT of a plane
};

// `unit`: what is 1 inside, m; `margin`: round every hull, in units. Refuses what has no volume.
ShvStatus make_shapes(BodyShapes *shapes, const ShvBulletShape &given, btScalar unit, btScalar margin, ShvError *error);
} // namespace shiver

#endif
