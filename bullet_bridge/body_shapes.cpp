#include "bullet_bridge/body_shapes.hpp"

#include <algorithm>
#include <cmath>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>

namespace shiver
{
static btVector3 vertex_of(const ShvBulletShape &given, int32_t vertex, btScalar unit)
{
    const double *p = given.vertices + 3 * size_t(vertex);
    return btVector3(p[0], p[1], p[2]) / unit;
}

static void add_hull(BodyShapes *shapes, const ShvBulletShape &given, int32_t part, btScalar unit, btScalar margin)
{
    std::vector<btVector3> points;
    for (int32_t i = given.hull_begin[part]; i < given.hull_begin[part + 1]; i++)
        points.push_back(vertex_of(given, i, unit));
    ShvConvex convex;
    if (points.size() < 4 || !convex.make_hull(points)) return; // a sliver without volume meets nothing
    auto hull = std::make_unique<btConvexHullShape>();
    for (const btVector3 &point : convex.vertices) hull->addPoint(point, false);
    hull->recalcLocalAabb();
    hull->setMargin(margin);
    shapes->hulls.push_back(std::move(hull));
    shapes->parts.push_back(std::move(convex));
}

static ShvStatus make_hulls(BodyShapes *shapes, const ShvBulletShape &given, btScalar unit, btScalar margin,
                            ShvError *error)
{
    for (int32_t part = 0; part < given.hull_count; part++) add_hull(shapes, given, part, unit, margin);
    if (shapes->hulls.empty())
        return shv_fail(error, SHV_BAD_INPUT, "it is flat: no convex hull of it has a volume; mend the mesh there");
    shapes->shape = shapes->hulls.front().get();
    if (shapes->hulls.size() == 1) return SHV_OK;
    auto compound = std::make_unique<btCompoundShape>();
    for (const auto &hull : shapes->hulls) compound->addChildShape(btTransform::getIdentity(), hull.get());
    shapes->compound = std::move(compound);
    shapes->shape = shapes->compound.get();
    return SHV_OK;
}

static ShvStatus make_triangles(BodyShapes *shapes, const ShvBulletShape &given, btScalar unit, ShvError *error)
{
    shapes->triangles = std::make_unique<btTriangleMesh>();
    for (int32_t t = 0; t < given.triangle_count; t++) {
        btVector3 corner[3];
        for (int k = 0; k < 3; k++) corner[k] = vertex_of(given, given.triangles[3 * t + k], unit);
        ShvConvex part;
        if (!part.make_triangle(corner[0], corner[1], corner[2])) continue;
        shapes->triangles->addTriangle(corner[0], corner[1], corner[2]);
        shapes->parts.push_back(std::move(part));
    }
    if (shapes->parts.empty()) return shv_fail(error, SHV_BAD_INPUT, "its surface has no area; mend the mesh");
    shapes->surface = std::make_unique<btBvhTriangleMeshShape>(shapes->triangles.get(), true);
    shapes->shape = shapes->surface.get();
    return SHV_OK;
}

static ShvStatus make_vertices(BodyShapes *shapes, const ShvBulletShape &given, btScalar unit, btScalar margin,
                               ShvError *error)
{
    const bool hulls = given.kind == SHV_BULLET_HULLS;
    const int32_t count = hulls ? given.hull_begin[given.hull_count] : given.vertex_count;
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (count == 0 || !std::all_of(given.vertices, given.vertices + 3 * size_t(count), is_finite))
        return shv_fail(error, SHV_BAD_INPUT, "it has no vertices, or some whose coordinates are not finite");
    for (int32_t i = 0; i < count; i++) shapes->radius = btMax(shapes->radius, vertex_of(given, i, unit).length());
    return hulls ? make_hulls(shapes, given, unit, margin, error) : make_triangles(shapes, given, unit, error);
}

ShvStatus make_shapes(BodyShapes *shapes, const ShvBulletShape &given, btScalar unit, btScalar margin, ShvError *error)
{
    switch (given.kind) {
    case SHV_BULLET_PLANE:
        shapes->radius = BT_LARGE_FLOAT;
        shapes->surface = std::make_unique<btStaticPlaneShape>(
            btVector3(given.normal[0], given.normal[1], given.normal[2]), given.offset / unit);
        break;
    case SHV_BULLET_SPHERE:
        if (!(given.radius > 0)) return shv_fail(error, SHV_BAD_INPUT, "its radius is %g m", given.radius);
        shapes->radius = given.radius / unit;
        shapes->surface = std::make_unique<btSphereShape>(shapes->radius);
        break;
    case SHV_BULLET_HULLS:
    case SHV_BULLET_TRIANGLES:
        return make_vertices(shapes, given, unit, margin, error);
    }
    shapes->shape = shapes->surface.get();
    return SHV_OK;
}
} // namespace shiver
