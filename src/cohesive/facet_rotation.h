/* How a cohesive facet turns, so that impulses between its faces keep angular momentum.

   The nodes of a pair stand apart by the opening Δ: an impulse −J on the first and J on the second makes the couple Δ × J. It
   is answered by impulses on the middles of the facet's three pairs, half on either node, that make the opposite couple and
   no sum: τ × rᵢ with τ = (Σ |r|² − r rᵀ)⁻¹ (J × Δ) and rᵢ the middles' arms from their mean, the least of all answers. The
   velocity that does work with J follows by transposition: it is the rate of opening seen by one who turns as the middles do,
   Δ' − ω × Δ. That is also what a law of components in the facet's frame needs, whose normal turns with the middles: its
   energy does not depend on how the facet stands, so that no work is done in a turn and its forces make no couple. (Ortiz and
   Pandolfi, 1999, call what follows from the turn of the normal the geometric terms.) */
#ifndef SHV_COHESIVE_FACET_ROTATION_H
#define SHV_COHESIVE_FACET_ROTATION_H

#include "cohesive/cohesive.h"

/* Of a facet whose nodes are known: where it stands and turns now. One whose middles have shrunk to a quarter of its area does
   not turn: its couples stay unanswered. */
void shv_facet_rotation_begin(ShvFacetRotation *rotation, const ShvState *state);
/* Finds the answer to what is new of the sum of the couples of three pulls, N m. */
void shv_facet_rotation_answer(ShvFacetRotation *rotation, const ShvVec3 couple[3]);

/* What follows stands in the innermost loop of closing faces. */

/* (Σ |r|² − r rᵀ)⁻¹ v */
static inline ShvVec3 shv_facet_rotation_invert(const ShvFacetRotation *rotation, ShvVec3 v)
{
    const double *m = rotation->inverse;
    return shv_vec3(m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
                    m[2] * v.x + m[4] * v.y + m[5] * v.z);
}

static inline ShvVec3 shv_facet_rotation_twice_middle(const ShvFacetRotation *rotation, int corner,
                                                      const double *values)
{
    return shv_add(shv_load3(values + 3 * (int64_t)rotation->first[corner]),
                   shv_load3(values + 3 * (int64_t)rotation->second[corner]));
}

/* ω at the present velocities, rad/s. As the arms have no sum, velocities relative to those of corner 0 do. */
static inline ShvVec3 shv_facet_rotation_rate(const ShvFacetRotation *rotation, const ShvState *state)
{
    if (!rotation->rotates) return shv_vec3(0.0, 0.0, 0.0);
    const ShvVec3 start = shv_facet_rotation_twice_middle(rotation, 0, state->velocity);
    const ShvVec3 side = shv_sub(shv_facet_rotation_twice_middle(rotation, 1, state->velocity), start);
    const ShvVec3 other = shv_sub(shv_facet_rotation_twice_middle(rotation, 2, state->velocity), start);
    const ShvVec3 sum = shv_add(shv_cross(rotation->arm[1], side), shv_cross(rotation->arm[2], other));
    return shv_facet_rotation_invert(rotation, shv_scale(sum, 0.5));
}

static inline void shv_facet_rotation_push(ShvState *state, int32_t node, ShvVec3 force, double kick)
{
    shv_add_to3(state->velocity + 3 * (int64_t)node, shv_scale(force, kick / state->mass[node]));
    shv_add_to3(state->force + 3 * (int64_t)node, force);
}

/* Gives the middles the mean couple `couple`, N m, for `kick` seconds; its forces go to state->force as well. */
static inline void shv_facet_rotation_strike(const ShvFacetRotation *rotation, ShvState *state, ShvVec3 couple,
                                             double kick)
{
    if (!rotation->rotates) return;
    const ShvVec3 answer = shv_facet_rotation_invert(rotation, shv_scale(couple, 0.5));
    for (int i = 0; i < 3; i++) {
        const ShvVec3 half = shv_cross(answer, rotation->arm[i]);
        shv_facet_rotation_push(state, rotation->first[i], half, kick);
        shv_facet_rotation_push(state, rotation->second[i], half, kick);
    }
}

static inline double shv_facet_rotation_yield(const ShvState *state, int32_t node, ShvVec3 share)
{
    return shv_dot(share, share) / state->mass[node];
}

/* Change of the rate of opening of a corner, seen by one who turns with the facet, along a unit vector per impulse along it,
   1/kg. */
static inline double shv_turn_response(const ShvFacetRotation *rotation, const ShvState *state, int corner,
                                       ShvVec3 opening, ShvVec3 direction)
{
    ShvVec3 answer = {0.0, 0.0, 0.0};
    if (rotation->rotates) answer = shv_facet_rotation_invert(rotation, shv_scale(shv_cross(direction, opening), 0.5));
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const ShvVec3 half = shv_cross(answer, rotation->arm[i]);
        const ShvVec3 own = i == corner ? direction : shv_vec3(0.0, 0.0, 0.0);
        if (rotation->first[i] == rotation->second[i]) {
            sum += shv_facet_rotation_yield(state, rotation->first[i], shv_scale(half, 2.0));
            continue;
        }
        sum += shv_facet_rotation_yield(state, rotation->first[i], shv_sub(half, own));
        sum += shv_facet_rotation_yield(state, rotation->second[i], shv_add(half, own));
    }
    return sum;
}

#endif
