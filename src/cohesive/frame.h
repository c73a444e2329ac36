/* Where a cohesive facet stands: its pairs of nodes, and the plane midway between its faces. */
#ifndef SHV_COHESIVE_FRAME_H
#define SHV_COHESIVE_FRAME_H

#include "cohesive/cohesive.h"

typedef struct ShvCohesiveFrame {
    int32_t first[3], second[3]; /* nodes of corner i on both faces */
    ShvVec3 normal;              /* from the first face to the second */
} ShvCohesiveFrame;

/* Finds its sides anew, after nodes of it were split. */
void shv_cohesive_find_sides(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet);
ShvCohesiveFrame shv_cohesive_frame(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet);
/* second − first, m */
ShvVec3 shv_cohesive_opening(const ShvState *state, int32_t first, int32_t second);
static inline ShvOpening shv_cohesive_components(ShvVec3 opening, ShvVec3 normal)
{
    const double n = shv_dot(opening, normal);
    return (ShvOpening){n, shv_norm(shv_madd(opening, -n, normal))};
}
/* Area vector of the reference face of a facet's first element: normal × area, towards the second element. */
ShvVec3 shv_cohesive_reference_area(const ShvModel *model, int32_t facet);

#endif
