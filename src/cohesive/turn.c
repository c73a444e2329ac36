#include "cohesive/turn.h"

/* The middles of faces that stand half a turn against each other fall together, and nothing that acts on them makes a couple:
   a triangle that has shrunk to this share of the facet's area is left out. */
static const double smallest_share = 0.25;

/* Relative to the middle of corner 0, so that no digits are lost far from the origin. */
void shv_turn_begin(ShvFacetTurn *turn, const ShvCohesiveSides *sides, double area, const ShvState *state)
{
    const ShvVec3 start = shv_scale(shv_turn_twice_middle(turn, 0, state->displacement), 0.5);
    const ShvVec3 side =
        shv_sub(shv_madd(sides->arm[0], 0.5, shv_turn_twice_middle(turn, 1, state->displacement)), start);
    const ShvVec3 other =
        shv_sub(shv_madd(sides->arm[1], 0.5, shv_turn_twice_middle(turn, 2, state->displacement)), start);
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
    if (turn->answers) turn->answer = shv_turn_invert(turn, shv_scale(change, 0.5));
    turn->couple = sum;
}
