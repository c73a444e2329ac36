/* Room of the arrays of ShvCohesive. On failure every array is at least as long as its capacity says. */
#ifndef SHV_COHESIVE_STORAGE_H
#define SHV_COHESIVE_STORAGE_H

#include "cohesive/cohesive.h"

ShvStatus shv_cohesive_reserve_facets(ShvCohesive *cohesive, int32_t more, ShvError *error);
ShvStatus shv_cohesive_reserve_nodes(ShvCohesive *cohesive, int32_t nodes, ShvError *error);
/* criterion.c: a watched facet has been inserted, its elements' weights may fall. */
void shv_cohesive_weigh(const ShvCohesive *cohesive, int32_t facet);

#endif
