#include "cohesive/turn.h"

static ShvVec3 twice_middle(const ShvFacetTurn *turn, int corner, const double *values)
{
    return shv_add(shv_load3(values + 3 * (int64_t)turn->first[corner]),
                   shv_load3(values + 3 * (int64_t)turn->second[corner]));
}

/* (Σ |r|² − r rᵀ)⁻¹ of three arms in one plane with no sum. In the plane Σ |r|² − Σ r rᵀ is the adjugate of Σ r rᵀ, whose
   determinant is a third of the square of twice the area. */
static ShvVec3 invert(const ShvFacetTurn *turn, ShvVec3 v)
{
    ShvVec3 sum = shv_scale(turn->normal, turn->spread * shv_dot(turn->normal, v));
    for (int i = 0; i < 3; i++) sum = shv_madd(sum, turn->tilt * shv_dot(turn->arm[i], v), turn->arm[i]);
    return sum;
}

ShvVec3 shv_turn_rate(const ShvFacetTurn *turn, const ShvState *state)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    if (!turn->turns) return sum;
    for (int i = 0; i < 3; i++) sum = shv_add(sum, shv_cross(turn->arm[i], twice_middle(turn, i, state->velocity)));
    return invert(turn, shv_scale(sum, 0.5));
}

/* The middles of faces that stand half a turn against each other fall together, and nothing that acts on them makes a couple:
   a triangle that has shrunk to this share of the facet's area is left out. */
static const double smallest_share = 0.25;

/* Relative to the middle of corner 0, so that no digits are lost far from the origin. */
void shv_turn_begin(ShvFacetTurn *turn, const ShvCohesiveSides *sides, double area, const ShvState *state)
{
    const ShvVec3 start = shv_scale(twice_middle(turn, 0, state->displacement), 0.5);
    const ShvVec3 side = shv_sub(shv_madd(sides->arm[0], 0.5, twice_middle(turn, 1, state->displacement)), start);
    const ShvVec3 other = shv_sub(shv_madd(sides->arm[1], 0.5, twice_middle(turn, 2, state->displacement)), start);
    const ShvVec3 twice_area = shv_cross(side, other), mean = shv_scale(shv_add(side, other), 1.0 / 3.0);
    turn->normal = shv_unit(twice_area);
    turn->arm[0] = shv_scale(mean, -1.0);
    turn->arm[1] = shv_sub(side, mean);
    turn->arm[2] = shv_sub(other, mean);
    const double square = shv_dot(twice_area, twice_area);
    turn->turns = square > 4.0 * smallest_share * smallest_share * area * area;
    turn->tilt = 3.0 / square;
    turn->spread = 0.0;
    for (int i = 0; i < 3; i++) turn->spread += shv_dot(turn->arm[i], turn->arm[i]);
    turn->spread = 1.0 / turn->spread;
    turn->couple = shv_vec3(0.0, 0.0, 0.0);
    turn->rate = shv_turn_rate(turn, state);
}

void shv_turn_answer(ShvFacetTurn *turn, const ShvVec3 couple[3])
{
    const ShvVec3 sum = shv_add(couple[0], shv_add(couple[1], couple[2])), change = shv_sub(sum, turn->couple);
    turn->answers = turn->turns && (change.x != 0.0 || change.y != 0.0 || change.z != 0.0);
    if (turn->answers) turn->answer = invert(turn, shv_scale(change, 0.5));
    turn->couple = sum;
}

static void push(ShvState *state, int32_t node, ShvVec3 force, double kick)
{
    shv_add_to3(state->velocity + 3 * (int64_t)node, shv_scale(force, kick / state->mass[node]));
    shv_add_to3(state->force + 3 * (int64_t)node, force);
}

void shv_turn_strike(const ShvFacetTurn *turn, ShvState *state, ShvVec3 couple, double kick)
{
    if (!turn->turns) return;
    const ShvVec3 answer = invert(turn, shv_scale(couple, 0.5));
    for (int i = 0; i < 3; i++) {
        const ShvVec3 half = shv_cross(answer, turn->arm[i]);
        push(state, turn->first[i], half, kick);
        push(state, turn->second[i], half, kick);
    }
}

static double yield(const ShvState *state, int32_t node, ShvVec3 share)
{
    return shv_dot(share, share) / state->mass[node];
}

double shv_turn_response(const ShvFacetTurn *turn, const ShvState *state, int corner, ShvVec3 opening,
                         ShvVec3 direction)
{
    ShvVec3 answer = {0.0, 0.0, 0.0};
    if (turn->turns) answer = invert(turn, shv_scale(shv_cross(direction, opening), 0.5));
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const ShvVec3 half = shv_cross(answer, turn->arm[i]);
        const ShvVec3 own = i == corner ? direction : shv_vec3(0.0, 0.0, 0.0);
        if (turn->first[i] == turn->second[i]) {
            sum += yield(state, turn->first[i], shv_scale(half, 2.0));
            continue;
        }
        sum += yield(state, turn->first[i], shv_sub(half, own));
        sum += yield(state, turn->second[i], shv_add(half, own));
    }
    return sum;
}
