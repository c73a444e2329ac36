#include <math.h>

#include "cohesive/solve.h"

/* While nodes go ways of w, the opening Δ of a pair changes by 2 w at most, and the normal by w Σ 1/height of the triangle of
   middles, whose linear functions have gradients of 1/height: the gap Δ·n changes by w (2 + |Δ| Σ 1/height). Heights and |Δ| change
   as well: w is held to a twentieth of 1/Σ, and what is left is made up for by 2.5 and 2 in place of 2 and 1.
   Σ 1/height = perimeter/(2 area) ≤ 2 Σ |arm|/(2 area) ≤ 2 √(tilt/spread). */
double shv_cohesive_way_apart(const ShvFacetRotation *rotation, const ShvFacetGaps *gaps)
{
    double least = (double)INFINITY, widest = 0.0;
    if (!rotation->rotates) return -1.0;
    for (int i = 0; i < 3; i++) {
        least =
            shv_smaller(least, shv_dot(gaps->opening[i], rotation->normal)); /* zero at a corner that is not split */
        widest = shv_larger(widest, shv_dot(gaps->opening[i], gaps->opening[i]));
    }
    if (!(least > 0.0)) return -1.0;
    widest = sqrt(widest);
    const double inverse_heights = 2.0 * sqrt(rotation->tilt / rotation->spread);
    const double meeting = least / (2.5 + 2.0 * widest * inverse_heights);
    const double separating = 0.5 * (0.5 * sqrt(rotation->area * SHV_SQUARE_OF_EDGE) - widest);
    return shv_smaller(shv_smaller(meeting, separating), 0.05 / inverse_heights);
}

double shv_cohesive_spread_of_speeds(const ShvFacetRotation *rotation, const ShvState *state)
{
    const ShvVec3 start = shv_load3(state->velocity + 3 * (int64_t)rotation->first[0]);
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        const ShvVec3 first = shv_sub(shv_load3(state->velocity + 3 * (int64_t)rotation->first[i]), start);
        const ShvVec3 second = shv_sub(shv_load3(state->velocity + 3 * (int64_t)rotation->second[i]), start);
        square = shv_larger(square, shv_larger(shv_dot(first, first), shv_dot(second, second)));
    }
    return sqrt(square);
}
