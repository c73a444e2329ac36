/* A YAML document as a tree that remembers where everything stands. An alias shares the node of its anchor. */
#ifndef SHV_SCENE_TREE_H
#define SHV_SCENE_TREE_H

#include "scene/diagnostics.h"

typedef enum ShvNodeKind { SHV_NODE_SCALAR, SHV_NODE_LIST, SHV_NODE_MAPPING } ShvNodeKind;

typedef struct ShvNode ShvNode;
typedef struct ShvEntry {
    ShvNode *key; /* a scalar; NULL in a list */
    ShvNode *value;
    struct ShvEntry *next;
} ShvEntry;

struct ShvNode {
    ShvNodeKind kind;
    bool null; /* a scalar that is absent, ~ or null */
    ShvPlace place;
    const char *text; /* scalar */
    ShvEntry *first, *last;
    int32_t count;
    int64_t weight; /* nodes in it, those of aliases as often as they are met */
};

/* The root of the one document in text[0 … length), or NULL after reporting why there is none. Faults that leave the
   tree usable (duplicate keys) are reported too; of duplicates all entries are kept. */
ShvNode *shv_tree_read(ShvPool *pool, ShvDiagnostics *diagnostics, const char *text, size_t length, int32_t origin);

/* New empty nodes and entries, NULL when memory is out. */
ShvNode *shv_tree_node(ShvPool *pool, ShvNodeKind kind, ShvPlace place);
bool shv_tree_append(ShvPool *pool, ShvNode *parent, ShvNode *key, ShvNode *value);
/* A copy whose entries may be changed; keys and values are shared. */
ShvNode *shv_tree_copy(ShvPool *pool, const ShvNode *node);

/* tree_text.c: a node as YAML of one line, of the pool. NULL when memory is out. */
const char *shv_tree_text(ShvPool *pool, const ShvNode *node);

/* First entry with that key, or entry number `index` of a list; NULL when there is none. */
ShvEntry *shv_tree_find(const ShvNode *mapping, const char *key);
ShvEntry *shv_tree_at(const ShvNode *list, int64_t index);
/* "a mapping", "a list", "a value": for messages. */
const char *shv_node_kind_name(ShvNodeKind kind);

#endif
