#include "bullet_bridge/convex_overlap.h"

#include <ccd/ccd.h>

// Of a body's own lengths: so much smaller it is looked at, so that neighbours do not overlap. libccd takes what is nearer than
// 1.5e-8 for overlapping, wherefore lengths are those of the first body.
static const double drawn_in = 1e-6;

namespace
{
struct Hull {
    const double *points;
    int32_t count;
    ccd_vec3_t middle; // from the origin of the first body
    double origin[3];  // of that, m
    double scale;      // 1/m
};

ccd_vec3_t place_of(const Hull &hull, int32_t point)
{
    const double *p = hull.points + 3 * static_cast<int64_t>(point);
    ccd_vec3_t place;
    ccdVec3Set(&place, (p[0] - hull.origin[0]) * hull.scale, (p[1] - hull.origin[1]) * hull.scale,
               (p[2] - hull.origin[2]) * hull.scale);
    return place;
}

Hull hull_of(const double *points, int32_t count, const double *origin, double scale)
{
    Hull hull = {points, count, {}, {origin[0], origin[1], origin[2]}, scale};
    ccdVec3Set(&hull.middle, 0.0, 0.0, 0.0);
    for (int32_t i = 0; i < count; i++) {
        const ccd_vec3_t place = place_of(hull, i);
        ccdVec3Add(&hull.middle, &place);
    }
    ccdVec3Scale(&hull.middle, 1.0 / count);
    return hull;
}

extern "C" {
static void farthest(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Hull &hull = *static_cast<const Hull *>(object);
    *point = place_of(hull, 0);
    for (int32_t i = 1; i < hull.count; i++) {
        const ccd_vec3_t candidate = place_of(hull, i);
        if (ccdVec3Dot(&candidate, direction) > ccdVec3Dot(point, direction)) *point = candidate;
    }
    ccd_vec3_t inwards = hull.middle;
    ccdVec3Sub(&inwards, point);
    ccdVec3Scale(&inwards, drawn_in);
    ccdVec3Add(point, &inwards);
}
}
} // namespace

bool shv_convex_overlap(const double *first, int32_t first_count, const double *second, int32_t second_count)
{
    double size = 0.0;
    for (int32_t i = 1; i < first_count; i++)
        for (int k = 0; k < 3; k++) {
            const double along = first[3 * static_cast<int64_t>(i) + k] - first[k];
            size = along > size ? along : -along > size ? -along : size;
        }
    const double scale = size > 0.0 ? 1.0 / size : 1.0;
    const Hull one = hull_of(first, first_count, first, scale), other = hull_of(second, second_count, first, scale);
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = farthest;
    ccd.max_iterations = 200;
    return ccdGJKIntersect(&one, &other, &ccd) != 0;
}
