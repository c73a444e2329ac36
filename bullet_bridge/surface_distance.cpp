#include "bullet_bridge/surface_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include "bullet_bridge/guarded.hpp"

struct ShvDistanceSurface {
    fcl::BVHModel<fcl::kIOSd> tree;
};

namespace
{

// 1/m: FCL looks at triangles in micrometres, for some of its thresholds are lengths. Its trees of rectangle-swept spheres (RSS,
// OBBRSS) lose the nearest pair of one in a thousand small tets all the same, those of spheres and boxes (kIOS) none.
const double drawn_larger = 1e6;

fcl::Vector3d drawn(const double *point)
{
    return drawn_larger * fcl::Vector3d(point);
}

void store(double *numbers, const fcl::Vector3d &point)
{
    for (int i = 0; i < 3; i++) numbers[i] = point[i] / drawn_larger;
}

// FCL's other GJK, GST_INDEP, stalls (bullet_bridge/oracle/fcl_oracle.cpp); triangles against each other need none.
ShvStatus measure(const ShvDistanceSurface *first, const fcl::CollisionGeometryd *second, const fcl::Vector3d &place,
                  ShvSurfaceDistance *nearest)
{
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = place;
    fcl::DistanceRequestd request;
    request.enable_nearest_points = true;
    request.gjk_solver_type = fcl::GST_LIBCCD;
    fcl::DistanceResultd result;
    const double distance = fcl::distance(&first->tree, fcl::Transform3d::Identity(), second, pose, request, result);
    nearest->distance = distance > 0.0 ? distance / drawn_larger : 0.0;
    store(nearest->first, result.nearest_points[0]);
    store(nearest->second, result.nearest_points[1] + place); // FCL gives it from the sphere's centre
    return SHV_OK;
}

} // namespace

ShvStatus shv_distance_surface_create(ShvDistanceSurface **surface, const double *positions, const int32_t *triangles,
                                      int32_t triangle_count, ShvError *error)
{
    *surface = nullptr;
    return shiver::guarded(error, [&] {
        auto made = std::make_unique<ShvDistanceSurface>();
        made->tree.beginModel(triangle_count, 3 * triangle_count);
        for (int64_t i = 0; i < triangle_count; i++) {
            const double *corners[3];
            for (int k = 0; k < 3; k++) corners[k] = positions + 3 * static_cast<int64_t>(triangles[3 * i + k]);
            made->tree.addTriangle(drawn(corners[0]), drawn(corners[1]), drawn(corners[2]));
        }
        made->tree.endModel();
        *surface = made.release();
        return SHV_OK;
    });
}

void shv_distance_surface_destroy(ShvDistanceSurface *surface)
{
    delete surface;
}

ShvStatus shv_surface_distance(const ShvDistanceSurface *first, const ShvDistanceSurface *second,
                               ShvSurfaceDistance *nearest, ShvError *error)
{
    return shiver::guarded(error, [&] { return measure(first, &second->tree, fcl::Vector3d::Zero(), nearest); });
}

ShvStatus shv_surface_distance_to_sphere(const ShvDistanceSurface *surface, const double centre[3], double radius,
                                         ShvSurfaceDistance *nearest, ShvError *error)
{
    return shiver::guarded(error, [&] {
        const fcl::Sphered sphere(drawn_larger * radius);
        return measure(surface, &sphere, drawn(centre), nearest);
    });
}
