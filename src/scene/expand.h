/* `library: NAME` of materials, put into the tree before it is read. */
#ifndef SHV_SCENE_EXPAND_H
#define SHV_SCENE_EXPAND_H

#include "scene/tree.h"

/* The tree in which every material that names one of the library has the library's value for each key it does not give itself.
   Unknown names are reported. NULL when memory is out. */
ShvNode *shv_expand_materials(ShvPool *pool, ShvDiagnostics *diagnostics, ShvNode *root);

#endif
