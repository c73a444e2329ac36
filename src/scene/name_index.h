/* Names that a scene's keys refer to, sorted; tells duplicates and finds what a wrong name may mean. */
#ifndef SHV_SCENE_NAME_INDEX_H
#define SHV_SCENE_NAME_INDEX_H

#include "scene/tree.h"

typedef struct ShvNameEntry {
    const char *name;
    const ShvNode *key; /* where it is given */
    int group, order;   /* which list of the scene it is in, and the order of the scene */
    bool usable;        /* may be referred to where usable ones alone may */
} ShvNameEntry;

typedef struct ShvNameIndex {
    ShvNameEntry *entries;
    int32_t count;
} ShvNameIndex;

/* Room for `capacity` names; entries is NULL when memory is out. */
ShvNameIndex shv_name_index_create(ShvPool *pool, size_t capacity);
void shv_name_index_add(ShvNameIndex *index, const char *name, const ShvNode *key, int group, bool usable);
/* Sorts; names can then be found. Reports a name that stands for two things, except for one key given twice in one
   mapping, which is reported where the tree is read. */
void shv_name_index_finish(ShvNameIndex *index, ShvDiagnostics *diagnostics, const char *what);
const ShvNameEntry *shv_name_index_find(const ShvNameIndex *index, const char *name);
enum { SHV_ANY_GROUP = -1 };

/* "key 'name' …": reports a name that is not there, with the nearest one of a group or some of them; of any group, of the usable ones. */
void shv_name_index_report_unknown(const ShvNameIndex *index, ShvDiagnostics *diagnostics, ShvPlace place,
                                   const char *key, const char *name, const char *what, int group);

#endif
