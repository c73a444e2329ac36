/* Bodies between obstacles that leave them no room: no motion can answer such contacts, and what a solver makes of them is bounded
   but means nothing. It is told as events, one for each of the two obstacles. */
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

/* Of the rigid shape, also where an engine keeps nodes, which it may press together. */
static ShvVec3 position_of(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvMat3 *turned, int32_t node)
{
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

static void find_for_rigid(const ShvHybrid *hybrid, const ShvFragment *fragment, Squeeze *squeeze)
{
    const ShvMat3 turned = shv_quat_to_matrix(fragment->orientation);
    const double slack = free_of_radius * fragment->radius;
    Side sides[MOST_NEAR];
    const int32_t count = list_sides(hybrid, fragment, &turned, slack, sides);
    if (!some_face_each_other(sides, count)) return;
    for (int32_t i = 0; i < count; i++) sides[i] = deepest_in(hybrid, fragment, &turned, sides[i].obstacle, slack);
    find_among(sides, count, slack, squeeze);
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
