/* "a.b.c=value" onto a tree. */
#ifndef SHV_SCENE_OVERRIDE_H
#define SHV_SCENE_OVERRIDE_H

#include "scene/schema.h"

/* Puts override number `index` (its nodes get the origin index + 1) into a copy of the way to it: nodes that aliases
   share are not changed elsewhere. Mappings on the way are made where they are missing; names of items must be there.
   Returns the new root; faults are reported and leave the old one. */
ShvNode *shv_override_apply(ShvPool *pool, ShvDiagnostics *diagnostics, ShvNode *root, const char *override,
                            int32_t index);

#endif
