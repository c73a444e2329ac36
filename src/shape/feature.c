#include "shape/feature.h"

#include <stdlib.h>

#include "mesh/edge_table.h"
#include "shape/segment.h"
#include "shape/triangle.h"

/* ---- making ---- */

/* Of two faces that are within a ten-thousandth of a right angle of being one, the edge is none. */
static const double flat_fold = 1e-4;

static ShvVec3 face_normal(const ShvSurface *surface, int32_t triangle)
{
    const int32_t *nodes = surface->triangles + 3 * (int64_t)triangle;
    const ShvVec3 a = shv_surface_position(surface, nodes[0]);
    return shv_unit(shv_cross(shv_sub(shv_surface_position(surface, nodes[1]), a),
                              shv_sub(shv_surface_position(surface, nodes[2]), a)));
}

/* The edge that a half-edge is the first half of; false where it is the second, flat or concave. */
static bool make_edge(const ShvSurface *surface, const ShvEdgeTable *table, int32_t half_edge, ShvFeature *feature)
{
    const int32_t start = shv_half_edge_start(surface->triangles, half_edge);
    const int32_t end = shv_half_edge_end(surface->triangles, half_edge);
    const int32_t twin = shv_edge_table_find(table, end, start);
    if (start > end || twin < 0) return false;
    const ShvVec3 a = shv_surface_position(surface, start), b = shv_surface_position(surface, end);
    const ShvVec3 own = face_normal(surface, half_edge / 3), other = face_normal(surface, twin / 3);
    const double size = shv_norm(shv_sub(b, a));
    /* Own face to the left of the edge: the other one falls away from it where the edge is convex. */
    const double fold = shv_dot(shv_cross(own, other), shv_sub(b, a)) / size;
    *feature = (ShvFeature){{a, b}, shv_add(own, other), size};
    return fold > flat_fold;
}

static void add_vertices(ShvObstacle *obstacle, const ShvSurface *surface, const double *sizes)
{
    for (int32_t node = 0; node < surface->node_count; node++) {
        if (!(sizes[node] > 0.0)) continue;
        const ShvVec3 at = shv_surface_position(surface, node);
        obstacle->features[obstacle->feature_count++] = (ShvFeature){{at, at}, shv_vec3(0.0, 0.0, 0.0), sizes[node]};
    }
}

static double low_end(const ShvFeature *feature)
{
    return fmin(feature->ends[0].x, feature->ends[1].x);
}

/* By all their numbers, so that the order does not depend on who sorts. */
static int by_low_end(const void *a, const void *b)
{
    const ShvFeature *first = a, *second = b;
    const double x[7] = {low_end(first),   first->ends[0].x, first->ends[0].y, first->ends[0].z,
                         first->ends[1].x, first->ends[1].y, first->ends[1].z};
    const double y[7] = {low_end(second),   second->ends[0].x, second->ends[0].y, second->ends[0].z,
                         second->ends[1].x, second->ends[1].y, second->ends[1].z};
    for (int k = 0; k < 7; k++)
        if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
    return 0;
}

/* `sizes`: room for one number a node, zero. */
static void gather(ShvObstacle *obstacle, const ShvSurface *surface, const ShvEdgeTable *table, double *sizes)
{
    for (int32_t h = 0; h < 3 * surface->triangle_count; h++) {
        ShvFeature *feature = &obstacle->features[obstacle->feature_count];
        if (!make_edge(surface, table, h, feature)) continue;
        obstacle->feature_count++;
        obstacle->feature_reach = fmax(obstacle->feature_reach, fabs(feature->ends[0].x - feature->ends[1].x));
        const int32_t nodes[2] = {shv_half_edge_start(surface->triangles, h), shv_half_edge_end(surface->triangles, h)};
        for (int k = 0; k < 2; k++)
            sizes[nodes[k]] = sizes[nodes[k]] > 0.0 ? fmin(sizes[nodes[k]], feature->size) : feature->size;
    }
    add_vertices(obstacle, surface, sizes);
    qsort(obstacle->features, (size_t)obstacle->feature_count, sizeof *obstacle->features, by_low_end);
}

static ShvStatus find_features(ShvObstacle *obstacle, ShvMemory *memory, const ShvSurface *surface, ShvError *error)
{
    const int32_t half_edges = 3 * surface->triangle_count;
    const size_t most = (size_t)half_edges / 2 + (size_t)surface->node_count + 1;
    obstacle->features = shv_allocate(memory, SHV_PART_SHAPE, most, sizeof *obstacle->features);
    double *sizes = shv_allocate(memory, SHV_PART_SHAPE, (size_t)surface->node_count, sizeof *sizes);
    ShvEdgeTable table = {0};
    ShvStatus status = obstacle->features && sizes
                           ? SHV_OK
                           : shv_fail_memory(error, "the edges of an obstacle", most * sizeof *obstacle->features);
    if (status == SHV_OK) status = shv_edge_table_create(&table, memory, surface->triangles, half_edges, error);
    for (int32_t h = 0; status == SHV_OK && h < half_edges; h++) shv_edge_table_insert(&table, h);
    if (status == SHV_OK) gather(obstacle, surface, &table, sizes);
    shv_edge_table_release(&table);
    shv_release(sizes);
    return status;
}

/* The diagonals of a box's faces are flat, and no edges. */
static ShvStatus find_surface_features(ShvObstacle *obstacle, ShvMemory *memory, ShvError *error)
{
    double corners[24];
    const ShvSurface surface = shv_obstacle_surface(obstacle, corners);
    return find_features(obstacle, memory, &surface, error);
}

ShvStatus shv_features_create(ShvObstacle *obstacle, ShvMemory *memory, ShvError *error)
{
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        return SHV_OK;
    case SHV_OBSTACLE_SPHERE:
        obstacle->features = shv_allocate(memory, SHV_PART_SHAPE, 1, sizeof *obstacle->features);
        if (!obstacle->features) return shv_fail_memory(error, "an obstacle", sizeof *obstacle->features);
        obstacle->features[0].size = obstacle->radius;
        obstacle->feature_count = 1;
        return SHV_OK;
    case SHV_OBSTACLE_BOX:
    case SHV_OBSTACLE_MESH:
        break;
    }
    return find_surface_features(obstacle, memory, error);
}

/* ---- what is near ---- */

static ShvVec3 world_of(const ShvObstacle *obstacle, ShvVec3 local)
{
    return shv_add(obstacle->position, shv_rotate(obstacle->orientation, local));
}

static ShvVec3 local_of(const ShvObstacle *obstacle, ShvVec3 point)
{
    return shv_rotate(shv_quat_conjugate(obstacle->orientation), shv_sub(point, obstacle->position));
}

/* The first whose low end is at x or beyond. */
static int32_t first_from(const ShvObstacle *obstacle, double x)
{
    int32_t low = 0, high = obstacle->feature_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (low_end(&obstacle->features[middle]) < x)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static void find_range(const ShvObstacle *obstacle, ShvVec3 point, double reach, int32_t *first, int32_t *end)
{
    const double x = local_of(obstacle, point).x, far = reach + obstacle->radius;
    *first = first_from(obstacle, x - far - obstacle->feature_reach);
    *end = first_from(obstacle, x + far);
}

bool shv_feature_is_edge(const ShvFeature *feature)
{
    return feature->outward.x != 0.0 || feature->outward.y != 0.0 || feature->outward.z != 0.0;
}

bool shv_feature_is_near(const ShvObstacle *obstacle, const ShvFeature *feature, ShvVec3 point, double reach)
{
    const ShvVec3 way = shv_sub(feature->ends[1], feature->ends[0]);
    const ShvVec3 from = shv_sub(local_of(obstacle, point), feature->ends[0]);
    const double squared = shv_dot(way, way);
    const double share = squared > 0.0 ? shv_segment_share(shv_dot(from, way) / squared) : 0.0;
    return shv_norm(shv_madd(from, -share, way)) < reach + obstacle->radius;
}

bool shv_features_matter(const ShvObstacle *obstacle, double facet_radius, ShvVec3 point, double reach)
{
    const double edge = 1.7320508075688772 * facet_radius; /* of a regular facet */
    if (obstacle->radius > SHV_FEATURE_FLAT * edge) return false;
    int32_t first, end;
    find_range(obstacle, point, reach, &first, &end);
    for (int32_t k = first; k < end; k++)
        if (shv_feature_is_near(obstacle, &obstacle->features[k], point, reach)) return true;
    return false;
}

/* Of the tet's extent: a point so little beyond a face is on it. */
static const double face_margin = 1e-9;

double shv_facet_beyond_free_face(const ShvFacetShape *facet, ShvVec3 x)
{
    for (int k = 0; k < 3; k++) {
        if (!(facet->free >> k & 1)) continue;
        /* The face opposite corner k holds the apex and the other two. */
        const ShvVec3 a = facet->corners[(k + 1) % 3], b = facet->corners[(k + 2) % 3];
        const ShvVec3 out = shv_cross(shv_sub(facet->apex, a), shv_sub(b, a));
        const double side = shv_dot(out, shv_sub(x, a)), inner = shv_dot(out, shv_sub(facet->corners[k], a));
        if (side * inner < -face_margin * inner * inner) return fabs(side) / shv_norm(out);
    }
    return 0.0;
}

ShvVec3 shv_facet_centre(const ShvFacetShape *facet, double *radius)
{
    const ShvVec3 *x = facet->corners;
    const ShvVec3 centre = shv_scale(shv_add(shv_add(x[0], x[1]), x[2]), 1.0 / 3.0);
    *radius =
        fmax(shv_norm(shv_sub(x[0], centre)), fmax(shv_norm(shv_sub(x[1], centre)), shv_norm(shv_sub(x[2], centre))));
    return centre;
}

bool shv_features_about(const ShvObstacle *obstacle, const ShvFacetShape *facet, double margin, ShvFeatureRange *range)
{
    double radius;
    range->centre = shv_facet_centre(facet, &radius);
    range->reach = radius + margin;
    if (shv_obstacle_closest(obstacle, range->centre, range->reach).gap >= range->reach) return false;
    if (!shv_features_matter(obstacle, radius, range->centre, range->reach)) return false;
    find_range(obstacle, range->centre, range->reach, &range->first, &range->end);
    return true;
}

/* ---- contact points ---- */

/* Share of a facet next to its rim, where what touches by rounding would face features it has nothing to do with. */
static const double facet_rim = 1e-8;

/* Whether a direction is among the outward normals of the obstacle at a point of its surface: then the surface is as far
   behind a point a little way out. */
static bool looks_out(const ShvObstacle *obstacle, const ShvFeature *feature, ShvVec3 point, ShvVec3 normal)
{
    const double way = 0.01 * feature->size, straight = 0.9995; /* cosine: 2 degrees past them will do */
    return shv_obstacle_closest(obstacle, shv_madd(point, way, normal), 2.0 * way).gap >= straight * way;
}

static bool meet_sphere(const ShvObstacle *obstacle, const ShvFacetShape *facet, double limit, ShvFeaturePoint *found)
{
    const ShvTrianglePoint at = shv_triangle_closest(obstacle->position, facet->corners);
    const ShvVec3 away = shv_sub(at.point, obstacle->position);
    const double distance = shv_norm(away), gap = distance - obstacle->radius;
    /* The body is on the far side of its facet; a centre within the body is not the facet's to keep out. */
    if (at.feature < SHV_TRIANGLE_EDGES || !(gap < limit) || !(shv_dot(away, shv_sub(facet->apex, at.point)) > 0.0))
        return false;
    const ShvVec3 normal = shv_scale(away, 1.0 / distance);
    *found = (ShvFeaturePoint){gap,
                               shv_madd(obstacle->position, obstacle->radius, normal),
                               normal,
                               {at.weights[0], at.weights[1], at.weights[2]}};
    return true;
}

/* A vertex against the facet's inside, no deeper than half the facet's tet and not out of it again on another side. */
static bool meet_vertex(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet,
                        double limit, ShvFeaturePoint *found)
{
    const ShvVec3 point = world_of(obstacle, feature->ends[0]), *x = facet->corners;
    const ShvVec3 area = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
    ShvVec3 normal = shv_unit(area); /* into the body */
    if (shv_dot(normal, shv_sub(facet->apex, x[0])) < 0.0) normal = shv_scale(normal, -1.0);
    const double gap = shv_dot(normal, shv_sub(x[0], point));
    if (!(gap < limit) || gap < -0.5 * shv_dot(normal, shv_sub(facet->apex, x[0]))) return false;
    *found = (ShvFeaturePoint){gap, point, normal, {0.0, 0.0, 0.0}};
    const double whole = shv_dot(area, area);
    for (int k = 0; k < 3; k++) {
        const ShvVec3 from = shv_sub(x[(k + 1) % 3], point), to = shv_sub(x[(k + 2) % 3], point);
        found->weights[k] = shv_dot(area, shv_cross(from, to)) / whole;
        if (!(found->weights[k] >= facet_rim)) return false;
    }
    if (gap < 0.0 && shv_facet_beyond_free_face(facet, point) > 0.0) return false;
    return looks_out(obstacle, feature, point, normal);
}

/* One edge of the facet; its tet is to be on its far side, where a body that drapes over an edge has its next nodes lower. What a
   node of the edge has gone into, deeper than the edge, is its own to leave: one that rests on the obstacle is in it by rounding. */
static bool meet_edge(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet, int edge,
                      double limit, ShvFeaturePoint *found)
{
    const double lower = 0.5, deepest = 0.25; /* shares of the shorter edge */
    const int next = (edge + 1) % 3, third = (edge + 2) % 3;
    const ShvVec3 a = world_of(obstacle, feature->ends[0]), b = facet->corners[edge];
    const ShvVec3 u = shv_sub(world_of(obstacle, feature->ends[1]), a), v = shv_sub(facet->corners[next], b);
    const ShvSegmentPoints at = shv_segments_closest(a, u, b, v);
    if (!at.inside) return false;
    ShvVec3 normal = shv_unit(shv_cross(u, v));
    if (shv_dot(normal, shv_rotate(obstacle->orientation, feature->outward)) < 0.0) normal = shv_scale(normal, -1.0);
    const double gap = shv_dot(normal, at.between), size = fmin(shv_norm(u), shv_norm(v));
    if (!(gap < limit) || gap < -deepest * size) return false;
    if (shv_dot(normal, shv_sub(facet->corners[third], b)) < -lower * size ||
        shv_dot(normal, shv_sub(facet->apex, b)) < 0.0)
        return false;
    for (int k = 0; k < 2 && gap <= 0.0; k++)
        if (shv_obstacle_closest(obstacle, facet->corners[k == 0 ? edge : next], 0.0).gap <= gap) return false;
    *found = (ShvFeaturePoint){gap, shv_madd(a, at.shares[0], u), normal, {0.0, 0.0, 0.0}};
    found->weights[edge] = 1.0 - at.shares[1];
    found->weights[next] = at.shares[1];
    return looks_out(obstacle, feature, found->point, normal);
}

int shv_feature_meet(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet, double limit,
                     ShvFeaturePoint points[3])
{
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return meet_sphere(obstacle, facet, limit, points);
    if (!shv_feature_is_edge(feature)) return meet_vertex(obstacle, feature, facet, limit, points);
    int count = 0;
    for (int k = 0; k < 3; k++) count += meet_edge(obstacle, feature, facet, k, limit, &points[count]);
    return count;
}

int shv_feature_point_edge(const ShvFeaturePoint *point)
{
    for (int k = 0; k < 3; k++)
        if (point->weights[k] == 0.0) return (k + 1) % 3;
    return -1;
}

double shv_feature_distance(const ShvObstacle *obstacle, const ShvFeature *feature, const ShvFacetShape *facet)
{
    const ShvVec3 a = world_of(obstacle, feature->ends[0]);
    if (!shv_feature_is_edge(feature))
        return shv_norm(shv_sub(shv_triangle_closest(a, facet->corners).point, a)) - obstacle->radius;
    const ShvVec3 u = shv_sub(world_of(obstacle, feature->ends[1]), a);
    double least = (double)INFINITY;
    for (int k = 0; k < 3; k++) {
        const ShvVec3 b = facet->corners[k], v = shv_sub(facet->corners[(k + 1) % 3], b);
        least = fmin(least, shv_norm(shv_segments_closest(a, u, b, v).between));
    }
    return least;
}
