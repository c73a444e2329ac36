/* The reference of scene files, docs/scene.md, written from the tables that read them. */
#ifndef SHV_SCENE_REFERENCE_H
#define SHV_SCENE_REFERENCE_H

#include "base/memory.h"

/* The whole text, terminated. Defaults are those of the definitions. The caller releases *text. */
ShvStatus shv_scene_reference(ShvMemory *memory, char **text, ShvError *error);

#endif
