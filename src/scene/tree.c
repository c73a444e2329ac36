#include "scene/tree.h"

#include <string.h>

ShvNode *shv_tree_node(ShvPool *pool, ShvNodeKind kind, ShvPlace place)
{
    ShvNode *node = shv_pool_take(pool, 1, sizeof *node);
    if (!node) return NULL;
    node->kind = kind;
    node->place = place;
    node->weight = 1;
    return node;
}

bool shv_tree_append(ShvPool *pool, ShvNode *parent, ShvNode *key, ShvNode *value)
{
    ShvEntry *entry = shv_pool_take(pool, 1, sizeof *entry);
    if (!entry) return false;
    entry->key = key;
    entry->value = value;
    if (parent->last)
        parent->last->next = entry;
    else
        parent->first = entry;
    parent->last = entry;
    parent->count++;
    parent->weight += value->weight;
    return true;
}

ShvNode *shv_tree_copy(ShvPool *pool, const ShvNode *node)
{
    ShvNode *copy = shv_tree_node(pool, node->kind, node->place);
    if (!copy) return NULL;
    copy->null = node->null;
    copy->text = node->text;
    for (const ShvEntry *entry = node->first; entry; entry = entry->next)
        if (!shv_tree_append(pool, copy, entry->key, entry->value)) return NULL;
    return copy;
}

ShvEntry *shv_tree_find(const ShvNode *mapping, const char *key)
{
    if (mapping->kind != SHV_NODE_MAPPING) return NULL;
    for (ShvEntry *entry = mapping->first; entry; entry = entry->next)
        if (strcmp(entry->key->text, key) == 0) return entry;
    return NULL;
}

ShvEntry *shv_tree_at(const ShvNode *list, int64_t index)
{
    if (list->kind != SHV_NODE_LIST || index < 0 || index >= list->count) return NULL;
    ShvEntry *entry = list->first;
    for (int64_t i = 0; i < index; i++) entry = entry->next;
    return entry;
}

const char *shv_node_kind_name(ShvNodeKind kind)
{
    static const char *const names[] = {"a value", "a list", "a mapping"};
    return names[kind];
}
