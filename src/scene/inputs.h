/* What a run follows from beside its scene: the files that the scene names. */
#ifndef SHV_SCENE_INPUTS_H
#define SHV_SCENE_INPUTS_H

#include "base/memory.h"
#include "shiver/definition.h"

/* Goes on from *hash over the contents of all files of meshes and obstacles, relative ones from `folder`. Files that cannot be
   read make runs fail later, with their own message. */
ShvStatus shv_inputs_hash(ShvMemory *memory, const char *folder, const ShvSceneDefinition *scene, uint64_t *hash,
                          ShvError *error);

#endif
