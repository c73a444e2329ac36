#include "cohesive/turn.h"

static bool is_split(const ShvCohesivePoint *point)
{
    return point->first != point->second;
}

static ShvVec3 middle(const ShvCohesivePoint *point, const double *values)
{
    const ShvVec3 first = shv_load3(values + 3 * (int64_t)point->first);
    if (!is_split(point)) return first;
    return shv_scale(shv_add(first, shv_load3(values + 3 * (int64_t)point->second)), 0.5);
}

/* Relative to the reference position of corner 0, so that no digits are lost far from the origin. */
static void find_arms(ShvFacetTurn *turn, const ShvCohesivePoint points[3], const ShvState *state)
{
    const ShvVec3 start = shv_load3(state->reference + 3 * (int64_t)points[0].first);
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; i++) {
        const ShvVec3 place = shv_sub(shv_load3(state->reference + 3 * (int64_t)points[i].first), start);
        turn->arm[i] = shv_add(place, middle(&points[i], state->displacement));
        sum = shv_add(sum, turn->arm[i]);
    }
    for (int i = 0; i < 3; i++) turn->arm[i] = shv_madd(turn->arm[i], -1.0 / 3.0, sum);
}

static ShvMat3 inertia_of(const ShvVec3 arm[3])
{
    ShvMat3 inertia = {{{0.0}}};
    for (int i = 0; i < 3; i++) {
        const double r[3] = {arm[i].x, arm[i].y, arm[i].z}, square = shv_dot(arm[i], arm[i]);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) inertia.m[a][b] += (a == b ? square : 0.0) - r[a] * r[b];
    }
    return inertia;
}

/* The middles of faces that stand half a turn against each other fall together, and nothing that acts on them makes a couple:
   a triangle that has shrunk to this share of the facet's area is left out. */
static const double smallest_share = 0.25;

static bool has_shrunk(const ShvFacetTurn *turn, const ShvCohesivePoint points[3])
{
    const ShvVec3 side = shv_sub(turn->arm[1], turn->arm[0]), other = shv_sub(turn->arm[2], turn->arm[0]);
    const double area = 3.0 * points[0].weight; /* three points share the facet's */
    return !(0.5 * shv_norm(shv_cross(side, other)) > smallest_share * area);
}

void shv_turn_begin(ShvFacetTurn *turn, const ShvCohesivePoint points[3], const ShvState *state)
{
    *turn = (ShvFacetTurn){.turns = is_split(&points[0]) || is_split(&points[1]) || is_split(&points[2])};
    if (!turn->turns) return;
    find_arms(turn, points, state);
    const ShvMat3 inertia = inertia_of(turn->arm);
    turn->turns = !has_shrunk(turn, points) && shv_invert(&inertia, &turn->inverse) != 0;
}

ShvVec3 shv_turn_rate(const ShvFacetTurn *turn, const ShvCohesivePoint points[3], const ShvState *state)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    if (!turn->turns) return sum;
    for (int i = 0; i < 3; i++) sum = shv_add(sum, shv_cross(turn->arm[i], middle(&points[i], state->velocity)));
    return shv_apply(&turn->inverse, sum);
}

static void push(ShvState *state, int32_t node, ShvVec3 force, double kick)
{
    shv_add_to3(state->velocity + 3 * (int64_t)node, shv_scale(force, kick / state->mass[node]));
    shv_add_to3(state->force + 3 * (int64_t)node, force);
}

void shv_turn_strike(const ShvFacetTurn *turn, const ShvCohesivePoint points[3], ShvState *state, ShvVec3 couple,
                     double kick)
{
    if (!turn->turns) return;
    const ShvVec3 answer = shv_apply(&turn->inverse, couple);
    for (int i = 0; i < 3; i++) {
        const ShvVec3 force = shv_cross(answer, turn->arm[i]);
        const bool split = is_split(&points[i]);
        push(state, points[i].first, split ? shv_scale(force, 0.5) : force, kick);
        if (split) push(state, points[i].second, shv_scale(force, 0.5), kick);
    }
}

static double yield(const ShvState *state, int32_t node, ShvVec3 share)
{
    return shv_dot(share, share) / state->mass[node];
}

double shv_turn_response(const ShvFacetTurn *turn, const ShvCohesivePoint points[3], const ShvState *state, int corner,
                         ShvVec3 direction)
{
    ShvVec3 answer = {0.0, 0.0, 0.0};
    if (turn->turns) answer = shv_apply(&turn->inverse, shv_cross(direction, points[corner].opening));
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const bool split = is_split(&points[i]);
        const ShvVec3 share = shv_scale(shv_cross(answer, turn->arm[i]), split ? 0.5 : 1.0);
        const ShvVec3 own = i == corner ? direction : shv_vec3(0.0, 0.0, 0.0);
        sum += yield(state, points[i].first, shv_sub(share, own));
        if (split) sum += yield(state, points[i].second, shv_add(share, own));
    }
    return sum;
}

void shv_turn_follow(const ShvFacetTurn *turn, ShvCohesivePoint points[3], const ShvState *state)
{
    const ShvVec3 rate = shv_turn_rate(turn, points, state);
    for (int i = 0; i < 3; i++)
        if (is_split(&points[i])) points[i].carried = shv_cross(rate, points[i].opening);
}
