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

/* A node on its way. */
typedef struct Traveller {
    ShvVec3 offset;
    double arm;       /* |offset| */
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
    const ShvVec3 velocity = shv_add(shv_madd(flight->velocity, time, flight->acceleration),
                                     shv_cross(spin, shv_rotate(orientation, node->offset)));
    const ShvVec3 relative = shv_sub(velocity, search->obstacle->velocity);
    /* |d(ω × r)/dt| ≤ (|ω'| + |ω|²) r and |ω'| ≤ max |I_j − I_k|/I_i |ω|² by Euler's equations */
    const double acceleration = shv_norm(flight->acceleration) +
                                (1.0 + flight->rotation->growth) * flight->fastest * flight->fastest * node->arm;
    const double speed = search->convex ? -shv_dot(normal, relative) : shv_norm(relative);
    return time_to_cover(clearance, speed, acceleration);
}

enum { CAREFUL_EVALUATIONS = 100, MOST_EVALUATIONS = 300, BISECTIONS = 60 };

/* Where a node is at a time, and its gap. */
typedef struct Sight {
    ShvQuat orientation; /* of the fragment */
    double approach;     /* bound of the relative speed from now to the limit */
    bool far;            /* too far to be met before the limit */
    ShvSurfacePoint surface;
} Sight;

static Sight look(const Search *search, const Traveller *node, double time, double limit)
{
    const ShvFlight *flight = search->flight;
    Sight sight = {.orientation = flight->orientation};
    ShvVec3 arm = shv_apply(&search->start, node->offset);
    if (time > 0.0) {
        sight.orientation = shv_flight_orientation(flight, time);
        arm = shv_rotate(sight.orientation, node->offset);
    }
    const ShvVec3 point = shv_add(shv_flight_position(flight, time), arm);
    ShvObstacle moved;
    const ShvObstacle *obstacle = search->obstacle;
    if (search->moving && time > 0.0) {
        moved = shv_obstacle_later(search->obstacle, time);
        obstacle = &moved;
    }
    const double distance = search->spinning ? shv_norm(shv_sub(point, obstacle->position)) : 0.0;
    sight.approach = fastest_approach(search, node->arm, distance, limit - time);
    const double far = 2.0 * search->slop + sight.approach * (limit - time);
    sight.surface = shv_obstacle_closest(obstacle, point, far);
    sight.far = sight.surface.gap >= far;
    return sight;
}

/* Between a time at which the node is above its threshold and one at which it is below. */
static double bisect(const Search *search, const Traveller *node, double above, double below, double limit)
{
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = 0.5 * (above + below);
        const Sight sight = look(search, node, middle, limit);
        const double clearance = sight.surface.gap - node->threshold;
        if (fabs(clearance) <= 0.25 * search->slop) return middle;
        if (clearance > 0.0)
            above = middle;
        else
            below = middle;
    }
    return above;
}

/* Time of impact of one node before `limit`, or infinity. After CAREFUL_EVALUATIONS (a node that slides along a curved
   surface) the strides are at least 1/100 of the limit: the sign of the gap still finds it inside anything thicker than it
   moves in that time, and bisection goes back. */
static double node_impact(const Search *search, Traveller *node, double limit)
{
    double time = 0.0, above = 0.0;
    for (int evaluation = 0; evaluation < MOST_EVALUATIONS; evaluation++) {
        const Sight sight = look(search, node, time, limit);
        if (sight.far) return (double)INFINITY;
        const double gap = sight.surface.gap;
        if (evaluation == 0)
            node->threshold = gap <= search->slop ? fmin(gap, 0.0) - 0.5 * search->slop : 0.5 * search->slop;
        const double clearance = gap - node->threshold;
        if (clearance < -0.25 * search->slop) return bisect(search, node, above, time, limit);
        if (clearance <= 0.25 * search->slop) return time;
        const double stride = search->spinning
                                  ? clearance / sight.approach
                                  : safe_time(search, node, time, clearance, sight.surface.normal, sight.orientation);
        const bool forced = evaluation >= CAREFUL_EVALUATIONS && stride < 0.01 * limit;
        if (time == limit || (!forced && !(time + stride < limit))) return (double)INFINITY;
        above = time;
        time = fmin(limit, time + (forced ? 0.01 * limit : stride));
    }
    return (double)INFINITY;
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
    const double travel = fastest_approach(&search, arms->radius, distance + arms->radius, *time) * *time;
    const double far = arms->radius + travel + 2.0 * slop;
    if (shv_obstacle_closest(obstacle, flight->position, far).gap >= far) return false;
    search.start = shv_quat_to_matrix(flight->orientation);
    bool found = false;
    for (int32_t i = 0; i < arms->count; i++) {
        Traveller node = {.offset = shv_load3(arms->offsets + 3 * (int64_t)i)};
        node.arm = shv_norm(node.offset);
        const double hit = node_impact(&search, &node, *time);
        if (hit < *time) {
            *time = hit;
            found = true;
        }
    }
    return found;
}
