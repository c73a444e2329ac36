/* Items to definitions: plain arrays that live as long as the scene. */
#ifndef SHV_SCENE_ASSEMBLE_H
#define SHV_SCENE_ASSEMBLE_H

#include "scene/schema.h"

/* More objects than this do not fit the element-to-object table of a run. */
enum { SHV_SCENE_LARGEST_OBJECTS = 65535 };

typedef struct ShvAssembly {
    ShvSceneDefinition definition;
    ShvObjectDefinition *objects;         /* those of the definition */
    const ShvObjectItem **object_sources; /* the item that each object comes from; in the work pool */
} ShvAssembly;

/* Expands repeats, makes normals and axes unit vectors, gathers conditions. Arrays and new names go to `pool`. */
void shv_assemble(ShvAssembly *assembly, const ShvSceneItem *scene, ShvPool *pool, ShvPool *work,
                  ShvDiagnostics *diagnostics);

#endif
