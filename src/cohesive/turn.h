/* How a cohesive facet turns, so that impulses between its faces keep angular momentum.

   The nodes of a pair stand apart by the opening Δ: an impulse −J on the first and J on the second makes the couple Δ × J. It
   is answered by impulses on the middles of the facet's three pairs, half on either node, that make the opposite couple and
   no sum: τ × rᵢ with τ = (Σ |r|² − r rᵀ)⁻¹ (J × Δ) and rᵢ the middles' arms from their mean, the least of all answers. The
   velocity that does work with J follows by transposition: it is the rate of opening seen by one who turns as the middles do,
   Δ' − ω × Δ. That is also what a law of components in the facet's frame needs, whose normal turns with the middles: its
   energy does not depend on how the facet stands, so that no work is done in a turn and its forces make no couple. (Ortiz and
   Pandolfi, 1999, call what follows from the turn of the normal the geometric terms.) */
#ifndef SHV_COHESIVE_TURN_H
#define SHV_COHESIVE_TURN_H

#include "cohesive/cohesive.h"

/* Of a facet whose nodes are known: where it stands and turns now. One whose middles have shrunk to a quarter of its area does
   not turn: its couples stay unanswered. */
void shv_turn_begin(ShvFacetTurn *turn, const ShvCohesiveSides *sides, double area, const ShvState *state);
/* ω at the present velocities, rad/s. */
ShvVec3 shv_turn_rate(const ShvFacetTurn *turn, const ShvState *state);
/* Finds the answer to what is new of the sum of the couples of three pulls, N m. */
void shv_turn_answer(ShvFacetTurn *turn, const ShvVec3 couple[3]);
/* Gives the middles the mean couple `couple`, N m, for `kick` seconds; its forces go to state->force as well. */
void shv_turn_strike(const ShvFacetTurn *turn, ShvState *state, ShvVec3 couple, double kick);
/* Change of the rate of opening of a corner, seen by one who turns with the facet, along a unit vector per impulse along it,
   1/kg. */
double shv_turn_response(const ShvFacetTurn *turn, const ShvState *state, int corner, ShvVec3 opening,
                         ShvVec3 direction);

#endif
