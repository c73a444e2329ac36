/* What one key cannot show: references between the parts of a scene, and values that must fit each other. */
#ifndef SHV_SCENE_CHECK_H
#define SHV_SCENE_CHECK_H

#include "scene/assemble.h"

/* Reports faults of a scene whose keys have been read. Values of an item are compared only when all of them are good, so
   that one fault is not reported twice. `folder` is what relative file names start from. */
void shv_check_scene(const ShvSceneItem *scene, const ShvAssembly *assembly, const char *folder, ShvPool *work,
                     ShvDiagnostics *diagnostics);

#endif
