/* The pairs of a step, out of its candidates. */
#ifndef SHV_CONTACT_NARROW_PHASE_H
#define SHV_CONTACT_NARROW_PHASE_H

#include "contact/edge_pair.h"

typedef struct ShvPairKey {
    int32_t node, end, element, face, edge, feature, draft;
} ShvPairKey;

/* A candidate that is due. */
typedef struct ShvDueCandidate {
    int32_t candidate;
    uint8_t kind; /* place in ShvSurfaceContact.candidates */
    bool near;    /* the two may meet */
} ShvDueCandidate;

typedef struct ShvNarrowPhase {
    ShvDueCandidate *due;
    int32_t due_count, due_capacity;
    int64_t pass;    /* of the present search */
    int32_t *nodes;  /* of this search: places in the list */
    int32_t *facets; /* likewise */
    int32_t node_count, node_capacity, facet_count, facet_capacity;
    ShvFacetPlane *planes; /* per facet of the list, when it was last looked at */
    ShvFacetPair *drafts;  /* pairs, and some that are none */
    ShvPairKey *keys;      /* those that are, in order */
    int32_t count, key_count, capacity;
} ShvNarrowPhase;

typedef struct ShvSurfaceContact ShvSurfaceContact;

void shv_narrow_phase_release(ShvNarrowPhase *narrow);
/* Finds the pairs that may meet within `step` from now: contact->narrow.keys, in the order of their numbers, whatever the
   candidates were. Between coupled bodies it looks once in contact->detection_interval steps, that far ahead. */
ShvStatus shv_narrow_phase(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error);

#endif
