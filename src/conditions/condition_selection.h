/* What a ShvSelection chooses of an object's placed mesh. */
#ifndef SHV_CONDITIONS_CONDITION_SELECTION_H
#define SHV_CONDITIONS_CONDITION_SELECTION_H

#include <stdbool.h>

#include "model/model.h"
#include "model/selection.h"

typedef struct ShvImposedFacet {
    int32_t element, face; /* face as in shv_face_corners */
    ShvVec3 share;         /* N on each of its three nodes at full value: traction × area at the start / 3 */
} ShvImposedFacet;

/* Chosen nodes, increasing; the caller releases *nodes, on failure too. None is bad input. */
ShvStatus shv_selection_nodes(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                              int32_t **nodes, int32_t *count, ShvError *error);
/* Boundary facets whose three nodes are chosen, increasing (element, face), with traction × area / 3; likewise. */
ShvStatus shv_selection_facets(const ShvSelection *selection, const ShvModel *model, const ShvObject *object,
                               ShvVec3 traction, ShvImposedFacet **facets, int32_t *count, ShvError *error);

#endif
