/* What a cracked fragment still bears: the least residual force of a cut over that cut's area, and the least work to open one. */
#ifndef SHV_FRAGMENT_RESIDUAL_STRENGTH_H
#define SHV_FRAGMENT_RESIDUAL_STRENGTH_H

#include "fragment/fragment.h"

typedef struct ShvResidual {
    double strength; /* Pa; infinite where nothing can break */
    double
        energy; /* J: work of opening the minimum cut; infinite in a body without cracks and where nothing can break */
} ShvResidual;

/* The least of
   - the weakest intact facet, as for a body without cracks;
   - the cuts round parts that hang on by bonds alone: groups of tets that intact facets, and bonds above a share of their
     strength, hold together, for a few such shares;
   - plane sections across the three principal axes of inertia, each between two tets in the order of their centroids: where
     a crack has gone half through, half of the section's area bears nothing.
   Of a cut, Σ strength × area over Σ area of the facets that it crosses (of sections: of their projections). Failed facets
   bear nothing. An oblique or winding crack that intact tets bridge is seen only in part by a plane section. */
ShvStatus shv_fragment_residual_strength(ShvFragments *fragments, const ShvCohesive *cohesive, const ShvState *state,
                                         int32_t fragment, ShvResidual *residual, ShvError *error);

#endif
