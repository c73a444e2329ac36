/* Whether a ShvSelection chooses a point of the placed mesh. */
#ifndef SHV_MODEL_SELECTION_H
#define SHV_MODEL_SELECTION_H

#include <stdbool.h>

#include "base/vector.h"
#include "shiver/definition.h"

/* How far outside a point lies, along the axis on which it does so most, m; 0: it is chosen. */
double shv_selection_distance(const ShvSelection *selection, ShvVec3 point);
bool shv_selection_contains(const ShvSelection *selection, ShvVec3 point);

#endif
