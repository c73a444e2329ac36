/* What the parts of the cohesive solve share: lists (lists.c), histories (force.c), impulses (pull.c), closing faces
   (closure.c). */
#ifndef SHV_COHESIVE_SOLVE_H
#define SHV_COHESIVE_SOLVE_H

#include <math.h>

#include "cohesive/cohesive.h"

/* Below this many, starting threads costs more than they save. */
enum { SHV_FEWEST_PARALLEL = 256 };

/* Of the edge of an equilateral triangle over its area: 4/√3. */
#define SHV_SQUARE_OF_EDGE 2.3094010767585034

static inline bool shv_cohesive_in_parallel(const ShvCohesive *cohesive, int32_t count)
{
    return cohesive->model->threads > 1 && count >= SHV_FEWEST_PARALLEL;
}

/* Makes the lists of a step anew: facets in order of the nodes they stem from, points cluster by cluster and pair by pair. */
void shv_cohesive_list(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);
/* The order in which faces of the facets in the lists are closed (closure.c). */
void shv_cohesive_order_closing(ShvCohesive *cohesive, const ShvState *state);
/* Counts become first places. */
void shv_cohesive_sum_up(int32_t *fill, int32_t count);
/* Pulls of the last step outlive the lists: the next step starts from them. */
void shv_cohesive_keep_pulls(ShvCohesive *cohesive);
/* Forgets the lists, and the step they belong to. */
void shv_cohesive_drop_lists(ShvCohesive *cohesive);
/* Takes facets that have separated off the list of live ones. */
void shv_cohesive_drop_separated(ShvCohesive *cohesive);

/* What the faces of a pair may give when they part, J. */
double shv_cohesive_releasable(const ShvCohesive *cohesive, const ShvState *state, const ShvFacetRotation *rotation,
                               int corner);

/* ---- faces that stand apart (apart.c) ----
   need not be looked at before their nodes have come far enough for them to meet, as neighbours beyond a skin. In debris most
   facets that have failed are. */

/* The way that each node of a facet has to go, seen from one of them, before its faces can meet, or are so far apart that they
   separate, m; negative where they meet. */
double shv_cohesive_way_apart(const ShvFacetRotation *rotation, const ShvFacetGaps *gaps);
/* Whether closing faces of a facet have been pushed in the step. */
static inline bool shv_cohesive_is_pushed(const ShvCohesive *cohesive, int32_t rotation)
{
    return cohesive->apart[cohesive->rotations[rotation].index] == -(double)INFINITY;
}
/* Largest speed of a facet's nodes, seen from its first one, m/s. */
double shv_cohesive_spread_of_speeds(const ShvFacetRotation *rotation, const ShvState *state);

/* Of opening, seen by one who turns with the facet. */
static inline ShvVec3 shv_cohesive_rate(const ShvCohesive *cohesive, const ShvState *state,
                                        const ShvCohesivePoint *point)
{
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                 shv_load3(state->velocity + 3 * (int64_t)point->first));
    return shv_sub(rate, shv_cross(cohesive->rotations[point->rotation].rate, point->opening));
}

#endif
