#include "scene/expand.h"

#include <string.h>

#include "base/names.h"
#include "base/text.h"
#include "scene/schema.h"
#include "shiver/library.h"

enum { LARGEST_LIBRARY = 64 };

static ShvNode *scalar(ShvPool *pool, ShvPlace place, const char *text)
{
    ShvNode *node = shv_tree_node(pool, SHV_NODE_SCALAR, place);
    if (node) node->text = shv_pool_text(pool, text, strlen(text));
    return node && node->text ? node : NULL;
}

/* Stands where `library` stands, so that messages about it lead there. */
static bool add(ShvPool *pool, ShvNode *mapping, ShvPlace place, const char *key, const char *value)
{
    if (shv_tree_find(mapping, key)) return true;
    ShvNode *name = scalar(pool, place, key), *node = scalar(pool, place, value);
    return name && node && shv_tree_append(pool, mapping, name, node);
}

/* Scatter is a mapping of its own. */
static const char scatter[] = "weibull";

/* The scene's own mapping, to be completed, or a new one; NULL when memory is out. */
static ShvNode *scatter_of(ShvPool *pool, ShvNode *material, ShvPlace place)
{
    ShvEntry *entry = shv_tree_find(material, scatter);
    if (entry) return entry->value = shv_tree_copy(pool, entry->value);
    ShvNode *name = scalar(pool, place, scatter), *mapping = shv_tree_node(pool, SHV_NODE_MAPPING, place);
    return name && mapping && shv_tree_append(pool, material, name, mapping) ? mapping : NULL;
}

/* Flaws belong to a volume or to a surface. */
static bool has_size(const ShvNode *mapping)
{
    return shv_tree_find(mapping, "volume") || shv_tree_find(mapping, "area");
}

static bool add_number(ShvPool *pool, ShvNode *material, ShvPlace place, const char *key, const char *value)
{
    const size_t length = sizeof scatter - 1;
    if (strncmp(key, scatter, length) != 0) return add(pool, material, place, key, value);
    ShvNode *mapping = scatter_of(pool, material, place);
    if (!mapping) return false;
    key += length + 1;
    const bool given = mapping->kind != SHV_NODE_MAPPING || (strcmp(key, "modulus") != 0 && has_size(mapping));
    return given || add(pool, mapping, place, key, value);
}

static void report_unknown(ShvDiagnostics *diagnostics, const ShvNode *node)
{
    const char *names[LARGEST_LIBRARY] = {NULL};
    char all[512] = "";
    int32_t count = 0;
    for (; count < shv_library_count() && count < LARGEST_LIBRARY; count++) {
        names[count] = shv_library_get(count)->name;
        shv_append(all, sizeof all, count == 0 ? "%s" : ", %s", names[count]);
    }
    const char *nearest = shv_nearest_name(node->text, names, (size_t)count);
    if (nearest)
        shv_error(diagnostics, node->place, "the library has no material %s; did you mean '%s'?",
                  shv_quoted(node->text).text, nearest);
    else
        shv_error(diagnostics, node->place, "the library has no material %s; it has %s (`shiver materials`)",
                  shv_quoted(node->text).text, all);
}

/* NULL when memory is out. */
static ShvNode *expanded(ShvPool *pool, ShvDiagnostics *diagnostics, ShvNode *material)
{
    const ShvEntry *entry = shv_tree_find(material, "library");
    if (!entry || entry->value->kind != SHV_NODE_SCALAR || entry->value->null) return material;
    const ShvLibraryMaterial *found = shv_library_find(entry->value->text);
    if (!found) {
        report_unknown(diagnostics, entry->value);
        found = shv_library_get(0); /* the scene is refused; no error is to follow from this one */
    }
    ShvNode *copy = shv_tree_copy(pool, material);
    if (!copy) return NULL;
    const ShvPlace place = entry->value->place;
    for (const ShvLibraryNumber *number = found->numbers; number->key; number++) {
        char text[40];
        shv_format(text, sizeof text, "%.17g", number->value);
        if (!add_number(pool, copy, place, number->key, text)) return NULL;
    }
    const ShvChoice *words =
        shv_table_find(shv_table_find(&shv_scene_table, "materials")->table, "unresolved")->choices;
    if (!add(pool, copy, place, "unresolved", shv_choice_name(words, found->unresolved))) return NULL;
    return found->breakable || add(pool, copy, place, "breakable", "false") ? copy : NULL;
}

ShvNode *shv_expand_materials(ShvPool *pool, ShvDiagnostics *diagnostics, ShvNode *root)
{
    const ShvEntry *entry = shv_tree_find(root, "materials");
    if (!entry || entry->value->kind != SHV_NODE_MAPPING) return root;
    ShvNode *copy = shv_tree_copy(pool, root), *materials = shv_tree_copy(pool, entry->value);
    if (!copy || !materials) return NULL;
    for (ShvEntry *material = materials->first; material; material = material->next) {
        material->value = expanded(pool, diagnostics, material->value);
        if (!material->value) return NULL;
    }
    shv_tree_find(copy, "materials")->value = materials;
    return copy;
}
