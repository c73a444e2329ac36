#include "shape/bounding_tree.h"
#include "shape/obstacle.h"

static ShvVec3 to_local(const ShvObstacle *obstacle, ShvVec3 point)
{
    return shv_rotate(shv_quat_conjugate(obstacle->orientation), shv_sub(point, obstacle->position));
}

static ShvVec3 to_world(const ShvObstacle *obstacle, ShvVec3 point)
{
    return shv_add(shv_rotate(obstacle->orientation, point), obstacle->position);
}

/* ---- closest point, in local axes ---- */

static ShvSurfacePoint closest_of_plane(const ShvObstacle *obstacle, ShvVec3 point)
{
    const double gap = shv_dot(obstacle->normal, point) - obstacle->offset;
    return (ShvSurfacePoint){gap, obstacle->normal, shv_madd(point, -gap, obstacle->normal)};
}

static ShvSurfacePoint closest_of_sphere(const ShvObstacle *obstacle, ShvVec3 point)
{
    const ShvVec3 away = shv_sub(point, obstacle->position);
    const double distance = shv_norm(away);
    const ShvVec3 normal = distance > 0.0 ? shv_scale(away, 1.0 / distance) : shv_vec3(0.0, 0.0, 1.0);
    return (ShvSurfacePoint){distance - obstacle->radius, normal,
                             shv_madd(obstacle->position, obstacle->radius, normal)};
}

/* Inside: the nearest face (of equals the lowest axis); outside: the clamped point. */
static ShvSurfacePoint closest_of_box(ShvVec3 half_edges, ShvVec3 local)
{
    double q[3], half[3], closest[3], beyond[3], normal[3] = {0.0, 0.0, 0.0};
    shv_store3(q, local);
    shv_store3(half, half_edges);
    int face = 0;
    double squared = 0.0;
    for (int k = 0; k < 3; k++) {
        closest[k] = fmax(-half[k], fmin(half[k], q[k]));
        beyond[k] = q[k] - closest[k];
        squared += beyond[k] * beyond[k];
        if (fabs(q[k]) - half[k] > fabs(q[face]) - half[face]) face = k;
    }
    if (squared > 0.0) {
        const double distance = sqrt(squared);
        return (ShvSurfacePoint){distance, shv_scale(shv_load3(beyond), 1.0 / distance), shv_load3(closest)};
    }
    normal[face] = q[face] < 0.0 ? -1.0 : 1.0;
    closest[face] = normal[face] * half[face];
    return (ShvSurfacePoint){fabs(q[face]) - half[face], shv_load3(normal), shv_load3(closest)};
}

ShvSurfacePoint shv_obstacle_closest(const ShvObstacle *obstacle, ShvVec3 point, double limit)
{
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return closest_of_plane(obstacle, point);
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return closest_of_sphere(obstacle, point);
    const ShvVec3 away = shv_sub(point, obstacle->position);
    const double reach = obstacle->bounding_radius + limit, squared = shv_dot(away, away);
    if (squared > reach * reach)
        return (ShvSurfacePoint){sqrt(squared) - obstacle->bounding_radius, shv_vec3(0.0, 0.0, 1.0), point};
    const ShvVec3 local = to_local(obstacle, point);
    ShvSurfacePoint found;
    if (obstacle->shape == SHV_OBSTACLE_BOX) {
        found = closest_of_box(obstacle->half, local);
    } else {
        const ShvTreePoint at = shv_bounding_tree_closest(obstacle->tree, local, limit);
        found = (ShvSurfacePoint){at.gap, at.normal, at.point};
    }
    found.normal = shv_rotate(obstacle->orientation, found.normal);
    found.point = to_world(obstacle, found.point);
    return found;
}

/* A point so far below a face is as far from the surface, unless another face is nearer. */
bool shv_obstacle_is_sharp(const ShvObstacle *obstacle, const ShvSurfacePoint *at)
{
    const double depth = 1e-3 * obstacle->bounding_radius,
                 straight = 0.99; /* cosine: 8 degrees between faces are none */
    if (obstacle->shape != SHV_OBSTACLE_BOX && obstacle->shape != SHV_OBSTACLE_MESH) return false;
    return shv_obstacle_closest(obstacle, shv_madd(at->point, -depth, at->normal), 0.0).gap > -straight * depth;
}

/* ---- first crossing ---- */

static bool sweep_plane(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, ShvCrossing *crossing)
{
    const double start = closest_of_plane(obstacle, from).gap, end = closest_of_plane(obstacle, to).gap;
    if (start < 0.0 || end >= 0.0) return false;
    const double t = start / (start - end);
    *crossing = (ShvCrossing){t, shv_madd(from, t, shv_sub(to, from)), obstacle->normal};
    return true;
}

/* |a + t d|² = r², first root, in the form that does not cancel. */
static bool sweep_sphere(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, ShvCrossing *crossing)
{
    const ShvVec3 a = shv_sub(from, obstacle->position), d = shv_sub(to, from);
    const double dd = shv_dot(d, d), ad = shv_dot(a, d), radius = obstacle->radius;
    const double c = (shv_norm(a) - radius) * (shv_norm(a) + radius);
    const double discriminant = ad * ad - dd * c;
    if (c < 0.0 || ad >= 0.0 || discriminant < 0.0) return false;
    const double t = c / (-ad + sqrt(discriminant));
    if (!(t <= 1.0)) return false;
    const ShvVec3 normal = shv_unit(shv_madd(a, t, d));
    *crossing = (ShvCrossing){t, shv_madd(obstacle->position, radius, normal), normal};
    return true;
}

/* By slabs: the face entered last is the one crossed. */
static bool sweep_box(ShvVec3 half_edges, ShvVec3 from, ShvVec3 to, double *fraction, ShvVec3 *normal)
{
    double a[3], b[3], half[3], outward[3] = {0.0, 0.0, 0.0};
    shv_store3(a, from);
    shv_store3(b, to);
    shv_store3(half, half_edges);
    double enter = -1.0, leave = 1.0;
    int face = -1;
    for (int k = 0; k < 3; k++) {
        const double way = b[k] - a[k];
        if (way == 0.0) {
            if (fabs(a[k]) > half[k]) return false;
            continue;
        }
        const double side = way > 0.0 ? -half[k] : half[k];
        const double in = (side - a[k]) / way, out = (-side - a[k]) / way;
        if (in > enter) {
            enter = in;
            face = k;
        }
        leave = fmin(leave, out);
    }
    if (face < 0 || enter < 0.0 || enter > leave) return false;
    outward[face] = b[face] > a[face] ? -1.0 : 1.0;
    *fraction = enter;
    *normal = shv_load3(outward);
    return true;
}

static bool sweep_local(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, double *fraction, ShvVec3 *normal)
{
    if (obstacle->shape == SHV_OBSTACLE_BOX) return sweep_box(obstacle->half, from, to, fraction, normal);
    return shv_bounding_tree_sweep(obstacle->tree, from, to, fraction, normal);
}

bool shv_obstacle_sweep(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 to, ShvCrossing *crossing)
{
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return sweep_plane(obstacle, from, to, crossing);
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return sweep_sphere(obstacle, from, to, crossing);
    if (shv_obstacle_closest(obstacle, from, 0.0).gap < 0.0) return false;
    double fraction = 1.0;
    ShvVec3 normal;
    if (sweep_local(obstacle, to_local(obstacle, from), to_local(obstacle, to), &fraction, &normal)) {
        *crossing = (ShvCrossing){fraction, shv_madd(from, fraction, shv_sub(to, from)),
                                  shv_rotate(obstacle->orientation, normal)};
        return true;
    }
    /* Rounding at an edge may hide the crossing, never the penetration. */
    const ShvSurfacePoint end = shv_obstacle_closest(obstacle, to, 0.0);
    if (end.gap >= 0.0) return false;
    *crossing = (ShvCrossing){1.0, end.point, end.normal};
    return true;
}
