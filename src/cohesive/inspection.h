/* One check of the criterion: the stress it asks for, and the disks of facets that it chooses. */
#ifndef SHV_COHESIVE_INSPECTION_H
#define SHV_COHESIVE_INSPECTION_H

#include "cohesive/cohesive.h"

typedef struct ShvInspection {
    ShvCohesive *cohesive;
    const ShvState *state;
    const double *stress;
    ShvStressSource source;
    int32_t asked; /* batches wanted so far */
} ShvInspection;

/* The stress of the batch of an element will be needed. */
void shv_inspection_want(ShvInspection *inspection, int32_t element);
/* Has all of what is wanted put where the check finds it. */
void shv_inspection_get(ShvInspection *inspection);

/* Value from which on facets count in a check: the threshold; with the force criterion less, since a disk whose intact facets are
   all below it may have others, inserted before from elsewhere, that are above. */
double shv_inspection_level(const ShvCohesive *cohesive);

/* The force criterion: nodes of watched facets that reach the level are looked at; of those that part, the one with the largest ratio first, ties by number, and none that shares a tet with
   one before it, since its forces will be others. As shv_cohesive_candidates; raises `largest` to what surfaces bear. */
void shv_inspection_find_disks(ShvInspection *inspection, int32_t *candidates, double *overstress, int32_t *count,
                               double *largest);

/* By value, the largest first, ties by number. */
void shv_sort_descending(int32_t *numbers, double *values, int32_t count);

#endif
