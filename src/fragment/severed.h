/* What comes off a fragment when nodes of it are split or bonds in it fail. */
#ifndef SHV_FRAGMENT_SEVERED_H
#define SHV_FRAGMENT_SEVERED_H

#include "fragment/fragment.h"

/* Parts that have come off the rest, which is one more. */
typedef struct ShvSevered {
    int32_t count;
    int32_t copies;     /* of the fragment's nodes: how many have been made */
    int32_t node_count; /* of all these parts; the nodes are the first of ShvFragments.label, in no order */
} ShvSevered;

/* Searches from both sides of all that has changed; all else of the fragment hangs together.
   fragments->found then holds for each node of it its part, from 1 on, and 0 for the rest: shv_severed_clear puts it back.
   On failure there is nothing to clear. The fragments' scratch arrays must have room for all nodes. */
ShvStatus shv_severed_find(ShvFragments *fragments, const ShvState *state, int32_t fragment,
                           const ShvConnectivityChange *change, ShvSevered *severed, ShvError *error);
void shv_severed_clear(ShvFragments *fragments, const ShvSevered *severed);

#endif
