/* The pairs of a step, out of its candidates. */
#ifndef SHV_CONTACT_SURFACE_DRAW_H
#define SHV_CONTACT_SURFACE_DRAW_H

#include "contact/facet_pair.h"

typedef struct ShvPairKey {
    int32_t node, element, face, feature, draft;
} ShvPairKey;

/* A candidate that is due. */
typedef struct ShvSurfaceLook {
    int32_t candidate;
    uint8_t kind; /* place in ShvSurfaceContact.candidates */
    bool near;    /* the two may meet */
} ShvSurfaceLook;

typedef struct ShvSurfaceDraw {
    ShvSurfaceLook *looks;
    int32_t look_count, look_capacity;
    int64_t turn;    /* of the present looks */
    int32_t *nodes;  /* of these looks: places in the list */
    int32_t *facets; /* likewise */
    int32_t node_count, node_capacity, facet_count, facet_capacity;
    ShvFacetPlane *planes; /* per facet of the list, when it was last looked at */
    ShvFacetPair *drafts;  /* pairs, and some that are none */
    ShvPairKey *keys;      /* those that are, in order */
    int32_t count, key_count, capacity;
} ShvSurfaceDraw;

typedef struct ShvSurfaceContact ShvSurfaceContact;

void shv_surface_draw_release(ShvSurfaceDraw *draw);
/* Finds the pairs that may meet within `step` from now: contact->draw.keys, in the order of their numbers, whatever the
   candidates were. Between companions it looks once in contact->beats steps, that far ahead. */
ShvStatus shv_surface_draw(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error);

#endif
