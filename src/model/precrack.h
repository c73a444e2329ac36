/* Cracks that are there from the start: slits in the reference mesh, whose lips have nodes of their own. */
#ifndef SHV_MODEL_PRECRACK_H
#define SHV_MODEL_PRECRACK_H

#include "mesh/mesh.h"
#include "shiver/definition.h"

/* Parts the placed mesh of an object along its cracks. SHV_BAD_INPUT for a crack that meets no facet between two tets. */
ShvStatus shv_precrack_open(ShvMesh *mesh, const ShvObjectDefinition *object, ShvError *error);

#endif
