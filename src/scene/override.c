#include "scene/override.h"

#include <string.h>

#include "base/file.h"
#include "base/names.h"

enum { LARGEST_CANDIDATES = 500 };

typedef struct Walk {
    ShvPool *pool;
    ShvDiagnostics *diagnostics;
    ShvPlace place;
    ShvNode *value;
    char *rest;       /* what is left of the path */
    const char *item; /* name of the item that the way leads through, NULL for none */
} Walk;

/* What the node that has been reached may hold. */
typedef struct Holder {
    ShvKeyType type; /* MAPPING, NAMED, LIST, VECTOR or AXES */
    const ShvTable *table;
    const char *name;
} Holder;

static ShvNode *set_below(Walk *walk, Holder holder, const ShvNode *node);

/* Cuts the first part off the rest of the path; NULL at its end. */
static const char *next_part(Walk *walk)
{
    if (!walk->rest) return NULL;
    char *part = walk->rest;
    char *dot = strchr(part, '.');
    walk->rest = dot ? dot + 1 : NULL;
    if (dot) *dot = '\0';
    return part;
}

/* The new value of an entry: the value of the override at the end of the path, else what setting below gives. */
static ShvNode *new_value(Walk *walk, const ShvKey *key, Holder below, const ShvNode *old)
{
    if (!walk->rest) return walk->value;
    if (below.type < SHV_KEY_VECTOR) {
        shv_error(walk->diagnostics, walk->place, "'%s' is a value; it has no key '%.60s' below it", key->name,
                  walk->rest);
        return NULL;
    }
    return set_below(walk, below, old);
}

/* A copy of the mapping in which `part` has another value. */
static ShvNode *with_entry(Walk *walk, const ShvNode *mapping, const char *part, ShvNode *value)
{
    ShvNode *copy = shv_tree_copy(walk->pool, mapping);
    if (!copy) return NULL;
    ShvEntry *entry = shv_tree_find(copy, part);
    if (entry) {
        entry->value = value;
        return copy;
    }
    ShvNode *key = shv_tree_node(walk->pool, SHV_NODE_SCALAR, walk->place);
    if (!key) return NULL;
    key->text = shv_pool_text(walk->pool, part, strlen(part));
    return key->text && shv_tree_append(walk->pool, copy, key, value) ? copy : NULL;
}

static ShvNode *set_key(Walk *walk, Holder holder, const ShvNode *mapping, const char *part)
{
    const ShvKey *key = shv_table_find(holder.table, part);
    if (!key) {
        shv_table_report_unknown(holder.table, walk->item, walk->diagnostics, walk->place, part);
        return NULL;
    }
    const ShvEntry *entry = shv_tree_find(mapping, part);
    ShvNode *value = new_value(walk, key, (Holder){key->type, key->table, key->name}, entry ? entry->value : NULL);
    return value ? with_entry(walk, mapping, part, value) : NULL;
}

static void report_unknown_name(Walk *walk, Holder holder, const ShvNode *mapping, const char *part)
{
    const char *names[LARGEST_CANDIDATES] = {NULL};
    size_t count = 0;
    for (const ShvEntry *entry = mapping->first; entry && count < LARGEST_CANDIDATES; entry = entry->next)
        names[count++] = entry->key->text;
    const char *nearest = shv_nearest_name(part, names, count);
    if (nearest)
        shv_error(walk->diagnostics, walk->place, "%s has no %s; did you mean %s?", holder.name, shv_quoted(part).text,
                  shv_quoted(nearest).text);
    else
        shv_error(walk->diagnostics, walk->place, "%s has no %s; add it as a whole: --set %s.%.63s={...}", holder.name,
                  shv_quoted(part).text, holder.name, part);
}

static ShvNode *set_name(Walk *walk, Holder holder, const ShvNode *mapping, const char *part)
{
    const ShvEntry *entry = shv_tree_find(mapping, part);
    if (!entry && walk->rest) {
        report_unknown_name(walk, holder, mapping, part);
        return NULL;
    }
    const Holder item = {SHV_KEY_MAPPING, holder.table, part};
    walk->item = part;
    ShvNode *value = walk->rest ? set_below(walk, item, entry->value) : walk->value;
    return value ? with_entry(walk, mapping, part, value) : NULL;
}

static ShvNode *set_element(Walk *walk, Holder holder, const ShvNode *list, const char *part)
{
    int64_t index = -1;
    const bool parsed = shv_parse_int64(part, strlen(part), &index, NULL) == SHV_OK;
    if (!parsed || index < 0 || index >= list->count) {
        shv_error(walk->diagnostics, walk->place, "%s is no element of %s, which has %d, counted from 0",
                  shv_quoted(part).text, holder.name, (int)list->count);
        return NULL;
    }
    const Holder item = {SHV_KEY_MAPPING, holder.table, holder.name};
    if (walk->rest && !holder.table) {
        shv_error(walk->diagnostics, walk->place, "an element of %s is a value; it has no key '%.60s' below it",
                  holder.name, walk->rest);
        return NULL;
    }
    ShvNode *value = walk->rest ? set_below(walk, item, shv_tree_at(list, index)->value) : walk->value;
    ShvNode *copy = value ? shv_tree_copy(walk->pool, list) : NULL;
    if (copy) shv_tree_at(copy, index)->value = value;
    return copy;
}

/* `node` (NULL: not there yet) with the value set somewhere below it. */
static ShvNode *set_below(Walk *walk, Holder holder, const ShvNode *node)
{
    const bool is_mapping = holder.type == SHV_KEY_MAPPING || holder.type == SHV_KEY_NAMED;
    const ShvNodeKind kind = is_mapping ? SHV_NODE_MAPPING : SHV_NODE_LIST;
    const ShvNode *held = node ? node : shv_tree_node(walk->pool, kind, walk->place);
    if (!held) return NULL;
    if (held->kind != kind) {
        shv_error(walk->diagnostics, walk->place, "'%s' is %s in the scene, so nothing below it can be set",
                  holder.name, shv_node_kind_name(held->kind));
        return NULL;
    }
    const char *part = next_part(walk);
    if (!is_mapping) return set_element(walk, holder, held, part);
    return holder.type == SHV_KEY_NAMED ? set_name(walk, holder, held, part) : set_key(walk, holder, held, part);
}

ShvNode *shv_override_apply(ShvPool *pool, ShvDiagnostics *diagnostics, ShvNode *root, const char *override,
                            int32_t index)
{
    const ShvPlace place = {1, 1, index + 1};
    const char *equals = strchr(override, '=');
    if (!equals || equals == override) {
        shv_error(diagnostics, place, "%s is no assignment; expected a.b.c=value", shv_quoted(override).text);
        return root;
    }
    char *path = shv_pool_text(pool, override, (size_t)(equals - override));
    ShvNode *value = shv_tree_read(pool, diagnostics, equals + 1, strlen(equals + 1), place.origin);
    if (!path || !value) return root;
    if (value->kind == SHV_NODE_SCALAR && !value->text) {
        value->text = "";
        value->null = true;
    }
    Walk walk = {pool, diagnostics, place, value, path, NULL};
    ShvNode *changed = set_below(&walk, (Holder){SHV_KEY_MAPPING, &shv_scene_table, "the scene"}, root);
    return changed ? changed : root;
}
