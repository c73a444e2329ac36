#include <ccd/ccd.h>

#include <vector>

#include "bullet_bridge/oracle/guard.hpp"
#include "bullet_bridge/oracle/oracle.h"

namespace
{

// Points in world axes.
struct Hull {
    std::vector<ccd_vec3_t> points;
    ccd_vec3_t middle;
};

Hull hull_of(const ShvConvex *body)
{
    Hull hull;
    ccdVec3Set(&hull.middle, 0.0, 0.0, 0.0);
    const double *m = body->rotation;
    for (int32_t i = 0; i < body->count; i++) {
        const double *p = body->points + 3 * static_cast<int64_t>(i);
        ccd_vec3_t point;
        ccdVec3Set(&point, body->position[0] + m[0] * p[0] + m[1] * p[1] + m[2] * p[2],
                   body->position[1] + m[3] * p[0] + m[4] * p[1] + m[5] * p[2],
                   body->position[2] + m[6] * p[0] + m[7] * p[1] + m[8] * p[2]);
        hull.points.push_back(point);
        ccdVec3Add(&hull.middle, &point);
    }
    ccdVec3Scale(&hull.middle, 1.0 / body->count);
    return hull;
}

extern "C" {

static void farthest(const void *object, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Hull *hull = static_cast<const Hull *>(object);
    ccd_real_t most = 0.0;
    const ccd_vec3_t *best = nullptr;
    for (const ccd_vec3_t &candidate : hull->points) {
        const ccd_real_t along = ccdVec3Dot(&candidate, direction);
        if (best != nullptr && along <= most) continue;
        most = along;
        best = &candidate;
    }
    *point = *best;
}

static void middle(const void *object, ccd_vec3_t *point)
{
    *point = static_cast<const Hull *>(object)->middle;
}
}

ccd_t settings()
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = farthest;
    ccd.center1 = ccd.center2 = middle;
    ccd.max_iterations = 500;
    ccd.mpr_tolerance = 1e-10;
    return ccd;
}

} // namespace

ShvStatus shv_oracle_overlap(const ShvConvex *first, const ShvConvex *second, bool *overlap, ShvError *error)
{
    if (!shiver::is_hull(first) || !shiver::is_hull(second)) return shiver::refuse(error);
    return shiver::guarded(error, [&] {
        const Hull one = hull_of(first), other = hull_of(second);
        const ccd_t ccd = settings();
        *overlap = ccdGJKIntersect(&one, &other, &ccd) != 0;
        return SHV_OK;
    });
}

ShvStatus shv_oracle_separation(const ShvConvex *first, const ShvConvex *second, bool *overlap, double way[3],
                                ShvError *error)
{
    if (!shiver::is_hull(first) || !shiver::is_hull(second)) return shiver::refuse(error);
    return shiver::guarded(error, [&] {
        const Hull one = hull_of(first), other = hull_of(second);
        const ccd_t ccd = settings();
        ccd_real_t depth = 0.0;
        ccd_vec3_t direction, where;
        ccdVec3Set(&direction, 0.0, 0.0, 0.0);
        *overlap = ccdMPRPenetration(&one, &other, &ccd, &depth, &direction, &where) == 0;
        for (int i = 0; i < 3 && *overlap; i++) way[i] = depth * direction.v[i];
        return SHV_OK;
    });
}
