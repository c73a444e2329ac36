/* Bodies between obstacles that leave them no room: no rigid motion can answer such contacts, and what a solver makes of them is
   bounded but means nothing. So what can break wakes before obstacles that move have closed on it, and stays awake as long as they do.
   What is rigid there all the same is told as events, one for each of the two obstacles. */
#include "coupling/hybrid.h"

/* Shares of the radius: room that is missing between two obstacles before it counts, beyond what round hulls, rough faces and
   solvers leave; and by which a body must have got free before it can be squeezed anew. */
static const double missing_of_radius = 0.01, free_of_radius = 0.005;
/* Share of the radius within which a node is on an obstacle: on which side of it is rounding. */
static const double touching_of_radius = 1e-9;

enum { MOST_NEAR = 16 };

/* An obstacle near a body, and how deep the body is in it. */
typedef struct Side {
    int32_t obstacle;
    ShvVec3 normal;
    double gap;
} Side;

/* Of what flies that of the rigid shape, also where an engine keeps nodes, which it may press together. */
static ShvVec3 position_of(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvMat3 *turned, int32_t node)
{
    if (fragment->mode == SHV_MODE_FRACTURE) return shv_state_position(&hybrid->state, node);
    const ShvVec3 reference = shv_load3(hybrid->state.reference + 3 * (int64_t)node);
    return shv_add(fragment->position, shv_apply(turned, shv_sub(reference, fragment->reference_centre)));
}

/* How far the fragment's box reaches against a direction from its centre, m. */
static double reach_against(const ShvFragment *fragment, const ShvMat3 *turned, ShvVec3 direction)
{
    const ShvVec3 d = shv_apply_transposed(turned, direction), low = fragment->low, high = fragment->high;
    return -(d.x * (d.x > 0.0 ? low.x : high.x) + d.y * (d.y > 0.0 ? low.y : high.y) +
             d.z * (d.z > 0.0 ? low.z : high.z));
}

/* Obstacles that hold their place and that the box of a rigid fragment, larger by the slack, reaches into: far fewer than are near. */
static int32_t list_sides(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvMat3 *turned, double slack,
                          Side *sides)
{
    int32_t count = 0;
    for (int32_t i = 0; i < hybrid->obstacles.count && count < MOST_NEAR; i++) {
        const ShvObstacle *obstacle = &hybrid->obstacles.items[i];
        if (obstacle->motion == SHV_OBSTACLE_FREE) continue;
        const ShvSurfacePoint at = shv_obstacle_closest(obstacle, fragment->position, fragment->radius + slack);
        if (at.gap >= fragment->radius + slack || at.gap > reach_against(fragment, turned, at.normal) + slack) continue;
        sides[count++] = (Side){i, at.normal, at.gap};
    }
    return count;
}

static bool some_face_each_other(const Side *sides, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++)
            if (shv_normals_face(sides[i].normal, sides[k].normal)) return true;
    return false;
}

/* Where the fragment's nodes are deepest in an obstacle, or nearest to it within the slack. */
static Side deepest_in(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvMat3 *turned, int32_t obstacle,
                       double slack)
{
    Side side = {.obstacle = obstacle, .gap = HUGE_VAL};
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const ShvSurfacePoint at = shv_obstacle_closest(&hybrid->obstacles.items[obstacle],
                                                        position_of(hybrid, fragment, turned, node), slack);
        if (at.gap < side.gap) side = (Side){obstacle, at.normal, at.gap};
    }
    return side;
}

/* Room that two sides lack, m; negative: they leave some, or do not face each other. */
static double missing_between(const Side *a, const Side *b, double slack)
{
    const bool both = a->gap <= slack && b->gap <= slack && shv_normals_face(a->normal, b->normal);
    return both ? -(a->gap + b->gap) : -HUGE_VAL;
}

typedef struct Squeeze {
    double missing; /* m */
    int32_t obstacles[2];
} Squeeze;

static void find_among(const Side *sides, int32_t count, double slack, Squeeze *squeeze)
{
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++) {
            const double missing = missing_between(&sides[i], &sides[k], slack);
            if (missing > squeeze->missing) *squeeze = (Squeeze){missing, {sides[i].obstacle, sides[k].obstacle}};
        }
}

/* Where a rigid fragment is deepest in each obstacle near to it; none where no two of them face each other. */
static int32_t find_sides(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvMat3 *turned, double slack,
                          Side *sides)
{
    const int32_t count = list_sides(hybrid, fragment, turned, slack, sides);
    if (!some_face_each_other(sides, count)) return 0;
    for (int32_t i = 0; i < count; i++) sides[i] = deepest_in(hybrid, fragment, turned, sides[i].obstacle, slack);
    return count;
}

static void find_for_rigid(const ShvHybrid *hybrid, const ShvFragment *fragment, Squeeze *squeeze)
{
    const ShvMat3 turned = shv_quat_to_matrix(fragment->orientation);
    const double slack = free_of_radius * fragment->radius;
    Side sides[MOST_NEAR];
    find_among(sides, find_sides(hybrid, fragment, &turned, slack, sides), slack, squeeze);
}

/* What deforms may be pressed together as it will; obstacles that leave no room for a node do not. */
static void find_for_awake(const ShvHybrid *hybrid, const ShvFragment *fragment, Squeeze *squeeze)
{
    const double slack = touching_of_radius * fragment->radius;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const ShvVec3 x = shv_state_position(&hybrid->state, hybrid->fragments.nodes[fragment->node_begin + k]);
        Side sides[MOST_NEAR];
        int32_t count = 0;
        for (int32_t i = 0; i < hybrid->obstacles.count && count < MOST_NEAR; i++) {
            const ShvObstacle *obstacle = &hybrid->obstacles.items[i];
            if (obstacle->motion == SHV_OBSTACLE_FREE) continue;
            const ShvSurfacePoint at = shv_obstacle_closest(obstacle, x, 2.0 * slack);
            if (at.gap <= slack) sides[count++] = (Side){i, at.normal, at.gap};
        }
        if (count > 1) find_among(sides, count, slack, squeeze);
    }
}

/* ---- obstacles that close ---- */

/* How far the obstacle that moves most goes in a time, at the middle of a body, m. */
static double longest_way(const ShvHybrid *hybrid, const ShvFragment *fragment, double time)
{
    double fastest = 0.0;
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        if (hybrid->obstacles.items[i].motion == SHV_OBSTACLE_SCRIPTED)
            fastest = fmax(fastest, shv_norm(shv_obstacle_velocity(&hybrid->obstacles.items[i], fragment->position)));
    return fastest * time;
}

/* Whether two sides take more room from a body between them in a time than they leave it. A body may go along with both. */
static bool close_on(const ShvHybrid *hybrid, const ShvFragment *fragment, const Side *a, const Side *b, double slack,
                     double time)
{
    const double missing = missing_between(a, b, slack);
    if (!(missing > -HUGE_VAL)) return false;
    const ShvVec3 approach = shv_sub(shv_obstacle_velocity(&hybrid->obstacles.items[a->obstacle], fragment->position),
                                     shv_obstacle_velocity(&hybrid->obstacles.items[b->obstacle], fragment->position));
    const double way = time * shv_dot(approach, shv_unit(shv_sub(a->normal, b->normal)));
    return way > touching_of_radius * fragment->radius && missing + way > 0.0;
}

bool shv_hybrid_is_squeezed(const ShvHybrid *hybrid, const ShvFragment *fragment, double time)
{
    if (fragment->mode != SHV_MODE_FLIGHT || !isfinite(fragment->strength) || fragment->dust) return false;
    const double way = longest_way(hybrid, fragment, time);
    if (!(way > 0.0)) return false;
    const ShvMat3 turned = shv_quat_to_matrix(fragment->orientation);
    const double slack = way + free_of_radius * fragment->radius;
    Side sides[MOST_NEAR];
    const int32_t count = find_sides(hybrid, fragment, &turned, slack, sides);
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++)
            if (close_on(hybrid, fragment, &sides[i], &sides[k], slack, time)) return true;
    return false;
}

/* Of its own speed into a body, that with which an obstacle still closes on what does not give way. */
static const double closing_share = 0.1;

/* Whether an obstacle that moves pushes a body which does not go along with it: something behind it holds. */
static bool is_pressed(const ShvHybrid *hybrid, const ShvFragment *fragment, double time)
{
    ShvFragment fitted = *fragment;
    shv_fragment_fit(&fitted, &hybrid->fragments, &hybrid->state);
    const double slack = longest_way(hybrid, &fitted, time) + free_of_radius * fitted.radius;
    const ShvMat3 turned = shv_quat_to_matrix(fitted.orientation);
    Side sides[MOST_NEAR];
    const int32_t count = list_sides(hybrid, &fitted, &turned, slack, sides);
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacle *obstacle = &hybrid->obstacles.items[sides[i].obstacle];
        if (obstacle->motion != SHV_OBSTACLE_SCRIPTED) continue;
        const Side side = deepest_in(hybrid, &fitted, &turned, sides[i].obstacle, slack);
        const double speed = shv_dot(shv_obstacle_velocity(obstacle, fitted.position), side.normal);
        if (side.gap > slack || !(speed > 0.0)) continue;
        if (speed - shv_dot(fitted.velocity, side.normal) > closing_share * speed) return true;
    }
    return false;
}

/* What is pressed presses what it meets. */
static void spread_pressure(ShvHybrid *hybrid)
{
    const ShvSurfaceContact *surface = &hybrid->coupling.surface;
    ShvFragment *items = hybrid->fragments.items;
    for (bool more = true; more;) {
        more = false;
        for (int32_t k = 0; k < surface->pair_count; k++) {
            if (surface->pairs[k].element < 0) continue;
            ShvFragment *pair[2] = {&items[surface->pairs[k].fragments[0]], &items[surface->pairs[k].fragments[1]]};
            const double last = fmax(pair[0]->last_pressed, pair[1]->last_pressed);
            more = more || pair[0]->last_pressed < last || pair[1]->last_pressed < last;
            pair[0]->last_pressed = pair[1]->last_pressed = last;
        }
    }
}

void shv_hybrid_find_pressed(ShvHybrid *hybrid)
{
    const double time = hybrid->scene->rigid.time_step;
    bool moves = false, any = false;
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        moves = moves || hybrid->obstacles.items[i].motion == SHV_OBSTACLE_SCRIPTED;
    for (int32_t i = 0; i < hybrid->fragments.count && moves; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FRACTURE || !is_pressed(hybrid, fragment, time)) continue;
        fragment->last_pressed = hybrid->state.time;
        any = true;
    }
    if (any) spread_pressure(hybrid);
}

ShvStatus shv_hybrid_wake_squeezed(ShvHybrid *hybrid, ShvError *error)
{
    const double interval = hybrid->interval_end - hybrid->state.time;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (shv_hybrid_is_squeezed(hybrid, fragment, interval)) SHV_TRY(shv_hybrid_wake_alone(hybrid, i, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* ---- events ---- */

static ShvStatus tell(ShvHybrid *hybrid, int32_t index, const Squeeze *squeeze, ShvError *error)
{
    for (int i = 0; i < 2; i++) {
        ShvEventView event = {.time = hybrid->state.time,
                              .kind = SHV_RUN_SQUEEZE,
                              .fragment = index,
                              .obstacle = squeeze->obstacles[i],
                              .value = squeeze->missing};
        SHV_TRY(shv_hybrid_log(hybrid, &event, error));
    }
    return SHV_OK;
}

ShvStatus shv_hybrid_find_squeeze(ShvHybrid *hybrid, ShvError *error)
{
    if (hybrid->obstacles.count < 2) return SHV_OK;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FLIGHT && fragment->mode != SHV_MODE_FRACTURE) continue;
        Squeeze squeeze = {.missing = 0.0};
        if (fragment->mode == SHV_MODE_FLIGHT)
            find_for_rigid(hybrid, fragment, &squeeze);
        else
            find_for_awake(hybrid, fragment, &squeeze);
        if (squeeze.missing < free_of_radius * fragment->radius) fragment->squeezed = false;
        if (fragment->squeezed || squeeze.missing < missing_of_radius * fragment->radius) continue;
        fragment->squeezed = true;
        SHV_TRY(tell(hybrid, i, &squeeze, error));
    }
    return SHV_OK;
}
