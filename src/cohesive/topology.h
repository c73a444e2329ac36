/* Splitting nodes: a node belongs to one group of elements joined across intact facets that contain it. */
#ifndef SHV_COHESIVE_TOPOLOGY_H
#define SHV_COHESIVE_TOPOLOGY_H

#include "cohesive/cohesive.h"

/* Place of an element among the corners of a node, which increase; −1 when it has none there. */
int32_t shv_topology_find(const int32_t *corners, int32_t count, int32_t element);
/* Labels the corners of a node by group (cohesive->corner_label, in corner order; groups by their lowest corner);
   returns the number of groups. */
int32_t shv_topology_groups(ShvCohesive *cohesive, const ShvState *state, int32_t node);
/* Gives every further group its own copy of the node. Room for the copies must be there. */
void shv_topology_split(ShvCohesive *cohesive, ShvState *state, int32_t node);

#endif
