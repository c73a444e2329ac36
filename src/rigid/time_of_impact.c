#include "rigid/time_of_impact.h"

ShvVec3 shv_flight_position(const ShvFlight *flight, double time)
{
    return shv_madd(shv_madd(flight->position, time, flight->velocity), 0.5 * time * time, flight->acceleration);
}

ShvQuat shv_flight_orientation(const ShvFlight *flight, double time)
{
    return shv_free_rotation_advance(flight->rotation, flight->orientation, flight->angular_momentum, time);
}

static bool is_zero(ShvVec3 a)
{
    return a.x == 0.0 && a.y == 0.0 && a.z == 0.0;
}

ShvObstacle shv_obstacle_later(const ShvObstacle *obstacle, double time)
{
    ShvObstacle later = *obstacle;
    if (!is_zero(obstacle->velocity)) later.position = shv_madd(obstacle->position, time, obstacle->velocity);
    if (!is_zero(obstacle->angular_velocity))
        later.orientation =
            shv_quat_multiply(shv_quat_exponential(shv_scale(obstacle->angular_velocity, time)), obstacle->orientation);
    return later;
}

/* What the search of one fragment against one obstacle shares. */
typedef struct Search {
    const ShvFlight *flight;
    const ShvObstacle *obstacle;
    bool moving;   /* obstacle */
    bool spinning; /* obstacle */
    bool convex;   /* gap(x + d) ≥ gap(x) + n·d wherever d leads */
    double slop;
    ShvMat3 start; /* orientation at time 0 */
} Search;

ShvFacetShape shv_facet_placed(const ShvFacetShape *facet, const ShvMat3 *turned, ShvVec3 position)
{
    ShvFacetShape placed = *facet;
    for (int k = 0; k < 3; k++) placed.corners[k] = shv_add(position, shv_apply(turned, facet->corners[k]));
    placed.apex = shv_add(position, shv_apply(turned, facet->apex));
    return placed;
}

/* A node on its way, or a facet that a feature of the obstacle may meet. */
typedef struct Traveller {
    ShvVec3 offset;             /* of the node */
    const ShvFacetShape *facet; /* NULL: a node */
    const ShvFeature *feature;
    double arm;       /* farthest from the fragment's centre, m */
    double threshold; /* gap that counts as closed, but for the tolerance */
} Traveller;

/* Bound of the relative speed of a point at most `arm` from the fragment's centre and now at `distance` from the obstacle's
   position, over `left` seconds: the farther they may get, the faster a spinning obstacle sweeps. */
static double fastest_approach(const Search *search, double arm, double distance, double left)
{
    const ShvFlight *flight = search->flight;
    const double point = shv_norm(flight->velocity) + shv_norm(flight->acceleration) * left + flight->fastest * arm;
    const double linear = point + shv_norm(search->obstacle->velocity);
    if (!search->spinning) return linear;
    return linear + shv_norm(search->obstacle->angular_velocity) * (distance + linear * left);
}

/* Time in which a point that closes at `speed`, and faster by at most `acceleration`, covers `gap` > 0. */
static double time_to_cover(double gap, double speed, double acceleration)
{
    const double root = sqrt(speed * speed + 2.0 * acceleration * gap);
    if (speed >= 0.0) return speed + root > 0.0 ? 2.0 * gap / (speed + root) : (double)INFINITY;
    return acceleration > 0.0 ? (root - speed) / acceleration : (double)INFINITY;
}

/* How long a node at `clearance` above its threshold surely stays above it; `normal` at the closest point. */
static double safe_time(const Search *search, const Traveller *node, double time, double clearance, ShvVec3 normal,
                        ShvQuat orientation)
{
    const ShvFlight *flight = search->flight;
    const ShvVec3 spin = shv_free_rotation_velocity(flight->rotation, orientation, flight->angular_momentum);
    const ShvVec3 velocity = shv_velocity_at(shv_madd(flight->velocity, time, flight->acceleration), spin,
                                             shv_rotate(orientation, node->offset));
    const ShvVec3 relative = shv_sub(velocity, search->obstacle->velocity);
    /* |d(ω × r)/dt| ≤ (|ω'| + |ω|²) r and |ω'| ≤ max |I_j − I_k|/I_i |ω|² by Euler's equations */
    const double acceleration = shv_norm(flight->acceleration) +
                                (1.0 + flight->rotation->growth) * flight->fastest * flight->fastest * node->arm;
    const double speed = search->convex ? -shv_dot(normal, relative) : shv_norm(relative);
    return time_to_cover(clearance, speed, acceleration);
}

enum { CAREFUL_EVALUATIONS = 100, MOST_EVALUATIONS = 300, BISECTIONS = 60 };

/* Where a node is at a time, and its gap. */
typedef struct Proximity {
    ShvQuat orientation; /* of the fragment */
    double approach;     /* bound of the relative speed from now to the limit */
    bool far;            /* too far to be met before the limit, or met elsewhere: by a node, or another feature */
    ShvSurfacePoint surface;
} Proximity;

/* The least gap where facet and feature face each other, else their distance. */
static double facet_gap(const Search *search, const Traveller *traveller, const ShvObstacle *obstacle,
                        const ShvFacetShape *facet, bool *elsewhere)
{
    ShvFeaturePoint points[3];
    const int count = shv_feature_meet(obstacle, traveller->feature, facet, 2.0 * search->slop, points);
    double gap = count > 0 ? points[0].gap : shv_feature_distance(obstacle, traveller->feature, facet);
    for (int k = 1; k < count; k++) gap = fmin(gap, points[k].gap);
    *elsewhere = count == 0 && gap <= search->slop;
    return gap;
}

static void measure_facet(const Search *search, const Traveller *traveller, double left, const ShvObstacle *obstacle,
                          const ShvMat3 *turned, ShvVec3 position, Proximity *proximity)
{
    const ShvFacetShape facet = shv_facet_placed(traveller->facet, turned, position);
    const double distance = search->spinning ? shv_norm(shv_sub(position, obstacle->position)) + traveller->arm : 0.0;
    bool elsewhere;
    proximity->approach = fastest_approach(search, traveller->arm, distance, left);
    proximity->surface.gap = facet_gap(search, traveller, obstacle, &facet, &elsewhere);
    proximity->far = elsewhere || proximity->surface.gap >= 2.0 * search->slop + proximity->approach * left;
}

static void measure_node(const Search *search, const Traveller *node, double left, const ShvObstacle *obstacle,
                         const ShvMat3 *turned, ShvVec3 position, Proximity *proximity)
{
    const ShvVec3 point = shv_add(position, shv_apply(turned, node->offset));
    const double distance = search->spinning ? shv_norm(shv_sub(point, obstacle->position)) : 0.0;
    proximity->approach = fastest_approach(search, node->arm, distance, left);
    const double far = 2.0 * search->slop + proximity->approach * left;
    proximity->surface = shv_obstacle_closest(obstacle, point, far);
    proximity->far = proximity->surface.gap >= far;
}

static Proximity measure(const Search *search, const Traveller *traveller, double time, double limit)
{
    const ShvFlight *flight = search->flight;
    Proximity proximity = {.orientation = flight->orientation};
    ShvMat3 turned = search->start;
    if (time > 0.0) {
        proximity.orientation = shv_flight_orientation(flight, time);
        turned = shv_quat_to_matrix(proximity.orientation);
    }
    ShvObstacle moved;
    const ShvObstacle *obstacle = search->obstacle;
    if (search->moving && time > 0.0) {
        moved = shv_obstacle_later(search->obstacle, time);
        obstacle = &moved;
    }
    (traveller->facet ? measure_facet : measure_node)(search, traveller, limit - time, obstacle, &turned,
                                                      shv_flight_position(flight, time), &proximity);
    return proximity;
}

/* Of the slop: how near its threshold a gap is at a time of impact (between ¼ and ¾ of the slop). */
static const double found_of_slop = 0.25;
/* Of the limit: the least stride after CAREFUL_EVALUATIONS. */
static const double forced_stride = 0.01;

/* Between a time at which the node is above its threshold and one at which it is below. */
static double bisect(const Search *search, const Traveller *node, double above, double below, double limit)
{
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (above + below);
        const Proximity proximity = measure(search, node, middle, limit);
        const double clearance = proximity.surface.gap - node->threshold;
        if (fabs(clearance) <= found_of_slop * search->slop) return middle;
        if (clearance > 0.0)
            above = middle;
        else
            below = middle;
    }
    return above;
}

/* Time of impact of one before `limit`, or infinity. After CAREFUL_EVALUATIONS (a node that slides along a curved
   surface) the strides are at least 1/100 of the limit: the sign of the gap still finds it inside anything thicker than it
   moves in that time, and bisection goes back. */
static double impact_of(const Search *search, Traveller *node, double limit)
{
    double time = 0.0, above = 0.0;
    for (int evaluation = 0; evaluation < MOST_EVALUATIONS; evaluation++) {
        const Proximity proximity = measure(search, node, time, limit);
        if (proximity.far) return (double)INFINITY;
        const double gap = proximity.surface.gap;
        if (evaluation == 0)
            node->threshold = gap <= search->slop ? fmin(gap, 0.0) - 0.5 * search->slop : 0.5 * search->slop;
        const double clearance = gap - node->threshold;
        if (clearance < -found_of_slop * search->slop) return bisect(search, node, above, time, limit);
        if (clearance <= found_of_slop * search->slop) return time;
        const double stride =
            search->spinning || node->facet
                ? clearance / proximity.approach
                : safe_time(search, node, time, clearance, proximity.surface.normal, proximity.orientation);
        const bool forced = evaluation >= CAREFUL_EVALUATIONS && stride < forced_stride * limit;
        if (time == limit || (!forced && !(time + stride < limit))) return (double)INFINITY;
        above = time;
        time = fmin(limit, time + (forced ? forced_stride * limit : stride));
    }
    return (double)INFINITY;
}

static bool try_nodes(const Search *search, const ShvArms *arms, double *time)
{
    bool found = false;
    for (int32_t i = 0; i < arms->count; i++) {
        Traveller node = {.offset = shv_load3(arms->offsets + 3 * (int64_t)i)};
        node.arm = shv_norm(node.offset);
        const double hit = impact_of(search, &node, *time);
        if (hit < *time) {
            *time = hit;
            found = true;
        }
    }
    return found;
}

static bool try_facet(const Search *search, const ShvFacetShape *facet, double travel, double *time)
{
    const ShvObstacle *obstacle = search->obstacle;
    const ShvFacetShape placed = shv_facet_placed(facet, &search->start, search->flight->position);
    ShvFeatureRange range;
    bool found = false;
    if (!shv_features_about(obstacle, &placed, travel, &range)) return false;
    for (int32_t k = range.first; k < range.end; k++) {
        if (!shv_feature_is_near(obstacle, &obstacle->features[k], range.centre, range.reach)) continue;
        Traveller traveller = {.facet = facet, .feature = &obstacle->features[k]};
        for (int c = 0; c < 3; c++) traveller.arm = fmax(traveller.arm, shv_norm(facet->corners[c]));
        const double hit = impact_of(search, &traveller, *time);
        if (!(hit < *time)) continue;
        *time = hit;
        found = true;
    }
    return found;
}

bool shv_time_of_impact(const ShvFlight *flight, const ShvArms *arms, const ShvObstacle *obstacle, double slop,
                        double *time)
{
    const bool round = obstacle->shape == SHV_OBSTACLE_SPHERE; /* spin does not change where its surface is */
    Search search = {.flight = flight,
                     .obstacle = obstacle,
                     .spinning = !round && !is_zero(obstacle->angular_velocity),
                     .convex = obstacle->shape != SHV_OBSTACLE_MESH,
                     .slop = slop};
    search.moving = search.spinning || !is_zero(obstacle->velocity);
    const double distance = search.spinning ? shv_norm(shv_sub(flight->position, obstacle->position)) : 0.0;
    const double travel = fastest_approach(&search, arms->radius, distance + arms->radius, *time) * *time + 2.0 * slop;
    const double far = arms->radius + travel;
    if (shv_obstacle_closest(obstacle, flight->position, far).gap >= far) return false;
    search.start = shv_quat_to_matrix(flight->orientation);
    bool found = try_nodes(&search, arms, time);
    if (arms->facet_count == 0 || !shv_features_matter(obstacle, arms->facet_radius, flight->position, far))
        return found;
    for (int32_t i = 0; i < arms->facet_count; i++)
        if (try_facet(&search, &arms->facets[i], travel, time)) found = true;
    return found;
}
