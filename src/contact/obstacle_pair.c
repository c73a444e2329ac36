/* Obstacles against nodes, and against facets where an obstacle is small or has edges of its own (shape/feature.h). */
#include "contact/facet_pair.h"

/* Times the reach: how far distances are measured, so that what is farther need not be looked at again soon. */
static const double look_ahead = 8.0;

/* `own`: what is there of the body, m. A rigid one moves as it does there; elsewhere it is the obstacle's motion that depends on
   the place. */
static void place_pair(ShvFacetPair *pair, const ShvSurfaceBodies *bodies, const ShvSurfacePoint *at, ShvVec3 own)
{
    pair->gap = pair->height = at->gap;
    pair->point = shv_bodies_coupled_body(bodies, pair->fragments[0]) ? own : at->point;
    pair->centre = at->point;
    pair->normal = pair->facet_normal = at->normal;
    shv_facet_pair_weigh(pair, bodies);
}

static bool sweep(const ShvObstacle *obstacle, ShvVec3 from, ShvVec3 path, ShvSurfacePoint *at)
{
    ShvCrossing crossing;
    if (!shv_obstacle_sweep(obstacle, from, shv_add(from, path), &crossing)) return false;
    *at = (ShvSurfacePoint){shv_dot(shv_sub(from, crossing.point), crossing.normal), crossing.normal, crossing.point};
    return true;
}

/* A node that would pass the tangent plane at its closest point may miss the obstacle or meet it elsewhere: its way decides, so
   that thin obstacles stop fast nodes and corners do not stop what passes by. What misses keeps no plane, but may be
   deflected into the obstacle yet. */
static void find_plane(ShvFacetPair *pair, const ShvSurfaceBodies *bodies, const ShvObstacle *obstacle, ShvVec3 x)
{
    const ShvVec3 path = shv_scale(pair->relative, pair->step);
    ShvSurfacePoint at = {(double)INFINITY, pair->normal, pair->point};
    if (obstacle->shape == SHV_OBSTACLE_PLANE || pair->gap <= 0.0) return;
    if (pair->gap + shv_dot(path, pair->normal) >= 0.0) return;
    sweep(obstacle, x, path, &at);
    place_pair(pair, bodies, &at, x);
}

/* Of the obstacle's radius: how far outside its surface a path begins, so that round-off does not put it inside. */
static const double outside_of_radius = 1e-12;

bool shv_obstacle_pair_crosses(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies, ShvFacetPair *crossing)
{
    if (pair->element >= 0 || pair->node_count > 1 || !pair->deforming) return false;
    const ShvObstacle *obstacle = shv_bodies_obstacle(bodies, pair->element);
    if (obstacle->shape != SHV_OBSTACLE_MESH && isfinite(pair->gap)) return false; /* convex, behind its one plane */
    const double rounding = outside_of_radius * obstacle->bounding_radius;
    const ShvVec3 from =
        shv_madd(shv_state_position(bodies->state, pair->nodes[0]), fmax(0.0, -pair->gap) + rounding, pair->normal);
    const ShvVec3 path = shv_scale(shv_facet_pair_velocity(pair, bodies), pair->step);
    ShvSurfacePoint at;
    if (!sweep(obstacle, from, path, &at)) return false;
    if (at.gap + shv_dot(path, at.normal) > -2.0 * rounding) return false;
    *crossing = *pair;
    place_pair(crossing, bodies, &at, from);
    return true;
}

/* Where a facet meets a feature on one of its edges. */
static bool is_edge_behind(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list, const ShvSurfaceFacet *facet,
                           const ShvFeaturePoint *point)
{
    const int edge = shv_feature_point_edge(point);
    if (edge < 0) return true;
    const int32_t start = list->nodes[facet->slots[edge]].node, end = list->nodes[facet->slots[(edge + 1) % 3]].node;
    return shv_surface_is_behind(bodies, facet->fragment, start, end, point->normal, SHV_BEFORE_EDGE);
}

/* The way of a step is a small share of a facet, so that the plane found is the one that counts. */
static int detect_facet(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                        const ShvSurfaceCandidate *candidate, double reach, ShvFacetPair pairs[SHV_MOST_POINTS],
                        double *distance)
{
    const ShvObstacle *obstacle = shv_bodies_obstacle(bodies, candidate->facet);
    const ShvFeature *feature = &obstacle->features[candidate->feature];
    const ShvSurfaceFacet *facet = &list->facets[candidate->own_facet];
    const ShvFacetShape shape = shv_surface_facet_shape(bodies, list, facet);
    ShvFeaturePoint points[SHV_MOST_POINTS];
    const int count = shv_feature_meet(obstacle, feature, &shape, reach, points);
    if (count == 0) {
        const double between = shv_feature_distance(obstacle, feature, &shape);
        if (between > reach) *distance = between;
    }
    int kept = 0;
    for (int i = 0; i < count; i++) {
        if (!is_edge_behind(bodies, list, facet, &points[i])) continue;
        const ShvSurfacePoint at = {points[i].gap, points[i].normal, points[i].point};
        ShvFacetPair *pair = &pairs[kept++];
        *pair = pairs[0];
        pair->node_count = 3;
        pair->face = 4 * facet->element + facet->face;
        pair->feature = candidate->feature;
        for (int k = 0; k < 3; k++) {
            pair->nodes[k] = list->nodes[facet->slots[k]].node;
            pair->shares[k] = points[i].weights[k];
        }
        place_pair(pair, bodies, &at, shv_madd(at.point, at.gap, at.normal));
    }
    return kept;
}

int shv_obstacle_pair_detect(const ShvSurfaceBodies *bodies, const ShvSurfaceList *list,
                             const ShvSurfaceCandidate *candidate, double step, double reach,
                             ShvFacetPair pairs[SHV_MOST_POINTS], double *distance)
{
    const ShvSurfaceNode *node = &list->nodes[candidate->slot];
    const ShvObstacle *obstacle = shv_bodies_obstacle(bodies, candidate->facet);
    pairs[0] = (ShvFacetPair){.nodes = {node->node},
                              .node_count = 1,
                              .shares = {1.0},
                              .element = candidate->facet,
                              .face = -1,
                              .fragments = {node->fragment, candidate->facet},
                              .corners = {-1, -1, -1},
                              .step = step};
    *distance = 0.0;
    if (candidate->own_facet >= 0) return detect_facet(bodies, list, candidate, reach, pairs, distance);
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    const ShvSurfacePoint at = shv_obstacle_closest(obstacle, x, look_ahead * reach);
    if (at.gap > reach) *distance = fmin(at.gap, look_ahead * reach);
    if (at.gap > reach) return 0;
    if (shv_obstacle_is_sharp(obstacle, &at) && !shv_surface_admits(bodies, list, node, at.normal)) return 0;
    place_pair(&pairs[0], bodies, &at, x);
    if (!shv_bodies_coupled_body(bodies, node->fragment)) find_plane(&pairs[0], bodies, obstacle, x);
    return 1;
}
