/* The pairs of a step, out of its candidates. */
#ifndef SHV_CONTACT_NARROW_PHASE_H
#define SHV_CONTACT_NARROW_PHASE_H

#include "contact/edge_pair.h"

typedef struct ShvPairKey {
    int32_t node, end, element, face, edge, feature, draft;
} ShvPairKey;

typedef struct ShvNarrowPhase {
    ShvFacetPair *drafts; /* the pairs as they are found */
    ShvPairKey *keys;     /* in order */
    int32_t count, capacity;
} ShvNarrowPhase;

typedef struct ShvSurfaceContact ShvSurfaceContact;

void shv_narrow_phase_release(ShvNarrowPhase *narrow);
/* Finds the pairs that may meet within `step` from now: contact->narrow.keys, in the order of their numbers, whatever the
   candidates were. Between coupled bodies it looks once in contact->detection_interval steps, that far ahead. */
ShvStatus shv_narrow_phase(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error);

#endif
