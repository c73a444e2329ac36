/* What a ShvSelection chooses of an object's placed mesh. */
#ifndef SHV_CONDITIONS_CONDITION_SELECTION_H
#define SHV_CONDITIONS_CONDITION_SELECTION_H

#include <stdbool.h>

#include "conditions/imposed.h"
#include "model/selection.h"

/* Chosen nodes, increasing; the caller releases *nodes, which is NULL on failure. */
ShvStatus shv_selection_nodes(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                              int32_t **nodes, int32_t *count, ShvError *error);
/* Boundary facets whose three nodes are chosen, increasing (element, face), with traction × area / 3; likewise. */
ShvStatus shv_selection_facets(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                               ShvVec3 traction, ShvImposedFacet **facets, int32_t *count, ShvError *error);

#endif
