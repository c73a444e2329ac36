/* Whether a ShvSelection chooses a point of the placed mesh. */
#ifndef SHV_MODEL_SELECTION_H
#define SHV_MODEL_SELECTION_H

#include <stdbool.h>

#include "base/vector.h"
#include "shiver/definition.h"

bool shv_selection_contains(const ShvSelection *selection, ShvVec3 point);

#endif
