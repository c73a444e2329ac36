/* The tets of one fragment on their own, in its shape at the start or, where it rests deformed, in that. */
#ifndef SHV_CONVEX_FRAGMENT_TETS_H
#define SHV_CONVEX_FRAGMENT_TETS_H

#include "fragment/fragment.h"

typedef struct ShvFragmentTets {
    int32_t node_count, tet_count;
    double *positions; /* 3 a node: from the fragment's reference centre, m */
    int32_t *tets;     /* 4 nodes each */
    double *centroids; /* 3 a tet, m */
    double *volumes;   /* m³ */
    double volume;     /* their sum */
    double edge;       /* m: of regular tets as large as the mean */
} ShvFragmentTets;

/* Uses the node labels of `fragments` as scratch. On failure `tets` is zeroed and owns nothing. */
ShvStatus shv_fragment_tets_make(ShvFragmentTets *tets, const ShvFragments *fragments, const ShvState *state,
                                 int32_t fragment, ShvError *error);
/* The same of tets that come from elsewhere: room for so many, and, once positions and tets are filled in, the rest. */
ShvStatus shv_fragment_tets_allocate(ShvFragmentTets *tets, int32_t node_count, int32_t tet_count, ShvMemory *memory,
                                     ShvError *error);
void shv_fragment_tets_measure(ShvFragmentTets *tets);
void shv_fragment_tets_release(ShvFragmentTets *tets);
/* Positions of the four nodes of a tet. */
void shv_fragment_tet_corners(const ShvFragmentTets *tets, int32_t tet, ShvVec3 corners[4]);

#endif
