/* A tree to items, by the tables of schema.h. */
#ifndef SHV_SCENE_READ_H
#define SHV_SCENE_READ_H

#include "scene/schema.h"

typedef struct ShvReader {
    ShvPool *work;  /* items: until the scene is made */
    ShvPool *texts; /* texts: as long as the scene */
    ShvDiagnostics *diagnostics;
    const char *item; /* name of the item that is being read, NULL for none */
} ShvReader;

/* Reads the top level into `scene`. All faults of keys and values are reported; what is faulty keeps its default. */
void shv_read_scene(ShvReader *reader, const ShvNode *root, ShvSceneItem *scene);
/* The same for a document of another kind; `item` is of the table and starts from its defaults. */
void shv_read_document(ShvReader *reader, const ShvTable *table, const ShvNode *root, void *item);

#endif
