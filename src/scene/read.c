#include "scene/read.h"

#include <math.h>
#include <string.h>

#include "base/file.h"

enum { LONGEST_EXPECTATION = 400 };

static void read_value(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *base);

static void report_expected(ShvReader *reader, const ShvKey *key, const ShvNode *node)
{
    char expected[LONGEST_EXPECTATION];
    shv_key_describe(key, expected, sizeof expected);
    if (node->kind == SHV_NODE_LIST)
        shv_error(reader->diagnostics, node->place, "%s is a list of %d; expected %s", key->name, (int)node->count,
                  expected);
    else if (node->kind == SHV_NODE_MAPPING)
        shv_error(reader->diagnostics, node->place, "%s is a mapping; expected %s", key->name, expected);
    else if (node->null)
        shv_error(reader->diagnostics, node->place, "%s has no value; expected %s", key->name, expected);
    else
        shv_error(reader->diagnostics, node->place, "%s is %s; expected %s", key->name, shv_quoted(node->text).text,
                  expected);
}

static bool is_given_scalar(ShvReader *reader, const ShvKey *key, const ShvNode *node)
{
    if (node->kind == SHV_NODE_SCALAR && !node->null) return true;
    report_expected(reader, key, node);
    return false;
}

static bool is_allowed(const ShvKey *key, double value)
{
    if (isinf(value) && value > 0.0) return (key->flags & SHV_KEY_INFINITE) != 0;
    return isfinite(value) && shv_range_holds(key->range, value);
}

/* One number of a key, alone or in a vector. */
static bool read_number(ShvReader *reader, const ShvKey *key, const ShvNode *node, double *number)
{
    if (!is_given_scalar(reader, key, node)) return false;
    double value = 0.0;
    const char *unit = NULL;
    const ShvQuantityFault fault = shv_quantity_read(node->text, key->dimension, &value, &unit);
    if (fault == SHV_QUANTITY_WRONG_UNIT) {
        char units[120];
        shv_dimension_units(key->dimension, units, sizeof units);
        if (units[0])
            shv_error(reader->diagnostics, node->place, "%s has unit %s, which is no unit of %s; use one of %s",
                      key->name, shv_quoted(unit).text, shv_dimension_name(key->dimension), units);
        else
            shv_error(reader->diagnostics, node->place, "%s has unit %s; it is a plain number without a unit",
                      key->name, shv_quoted(unit).text);
        return false;
    }
    if (fault != SHV_QUANTITY_FINE || !is_allowed(key, value)) {
        report_expected(reader, key, node);
        return false;
    }
    *number = value;
    return true;
}

static void read_double(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    double value;
    if (read_number(reader, key, node, &value)) memcpy(target, &value, sizeof value);
}

/* Unsigned numbers beyond the signed range are the seeds of other programs: all 64 bits are taken. */
static bool parse_uint64(const char *text, uint64_t *value)
{
    *value = 0;
    if (!*text) return false;
    for (; *text; text++) {
        const unsigned digit = (unsigned)(*text - '0');
        if (*text < '0' || *text > '9' || *value > (UINT64_MAX - digit) / 10u) return false;
        *value = *value * 10u + digit;
    }
    return true;
}

static void read_uint64(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    uint64_t value;
    if (!is_given_scalar(reader, key, node)) return;
    if (parse_uint64(node->text, &value))
        memcpy(target, &value, sizeof value);
    else
        report_expected(reader, key, node);
}

static void read_integer(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    int64_t value = 0;
    if (!is_given_scalar(reader, key, node)) return;
    const bool parsed = shv_parse_int64(node->text, strlen(node->text), &value, NULL) == SHV_OK;
    const int32_t narrow = (int32_t)(value > INT32_MAX || value < INT32_MIN ? 0 : value);
    const bool fits = key->type == SHV_KEY_INT64 || narrow == value;
    if (!parsed || !fits || !shv_range_holds(key->range, (double)value))
        report_expected(reader, key, node);
    else if (key->type == SHV_KEY_INT64)
        memcpy(target, &value, sizeof value);
    else
        memcpy(target, &narrow, sizeof narrow);
}

static void read_boolean(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    if (!is_given_scalar(reader, key, node)) return;
    const bool value = strcmp(node->text, "true") == 0;
    if (value || strcmp(node->text, "false") == 0)
        memcpy(target, &value, sizeof value);
    else
        report_expected(reader, key, node);
}

static void read_text(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    if (!is_given_scalar(reader, key, node)) return;
    if (!node->text[0]) {
        report_expected(reader, key, node);
        return;
    }
    const char *text = shv_pool_text(reader->texts, node->text, strlen(node->text));
    memcpy(target, &text, sizeof text);
}

static void read_choice(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    if (!is_given_scalar(reader, key, node)) return;
    for (const ShvChoice *choice = key->choices; choice->name; choice++) {
        if (strcmp(choice->name, node->text) != 0) continue;
        memcpy(target, &choice->value, sizeof choice->value);
        return;
    }
    report_expected(reader, key, node);
}

static void read_vector(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    double vector[3] = {0.0, 0.0, 0.0};
    if (node->kind != SHV_NODE_LIST || node->count != 3) {
        report_expected(reader, key, node);
        return;
    }
    ShvKey component = *key;
    component.type = SHV_KEY_NUMBER;
    component.flags = 0;
    bool good = true;
    int i = 0;
    for (const ShvEntry *entry = node->first; entry; entry = entry->next)
        good = read_number(reader, &component, entry->value, &vector[i++]) && good;
    if (good && key->flags & SHV_KEY_DIRECTION && vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0) {
        shv_error(reader->diagnostics, node->place, "%s is zero, which is no direction; give one such as [0, 0, 1]",
                  key->name);
        good = false;
    }
    if (good) memcpy(target, vector, sizeof vector);
}

static void read_axes(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    bool axes[3] = {false, false, false};
    bool good = node->kind == SHV_NODE_LIST && node->count > 0;
    for (const ShvEntry *entry = good ? node->first : NULL; entry && good; entry = entry->next) {
        const char *text = entry->value->kind == SHV_NODE_SCALAR ? entry->value->text : "";
        good = text[0] >= 'x' && text[0] <= 'z' && text[1] == '\0' && !axes[text[0] - 'x'];
        if (good)
            axes[text[0] - 'x'] = true;
        else
            report_expected(reader, key, entry->value);
    }
    if (good)
        memcpy(target, axes, sizeof axes);
    else if (node->kind != SHV_NODE_LIST || node->count == 0)
        report_expected(reader, key, node);
}

/* ---- mappings ----------------------------------------------------------------------------------------- */

static void report_missing(ShvReader *reader, const ShvTable *table, const ShvNode *node, uint64_t seen)
{
    char missing[LONGEST_EXPECTATION] = "";
    size_t used = 0;
    for (int i = 0; i < table->key_count; i++) {
        const ShvKey *key = &table->keys[i];
        if (seen >> i & 1u || !(key->flags & SHV_KEY_REQUIRED)) continue;
        const size_t length = strlen(key->name);
        if (used + length + 3 > sizeof missing) break;
        if (used > 0) memcpy(missing + used, ", ", 3);
        used += used > 0 ? 2 : 0;
        memcpy(missing + used, key->name, length + 1);
        used += length;
    }
    if (used > 0)
        shv_error(reader->diagnostics, node->place, "%s lacks what it must have: %s",
                  shv_table_label(table, reader->item).text, missing);
}

/* One of the keys that exclude each other: the first counts. */
static void take_variant(ShvReader *reader, const ShvTable *table, const ShvKey *key, const ShvNode *key_node,
                         char *base, const ShvKey **taken)
{
    char variants[LONGEST_EXPECTATION];
    shv_table_list(table, true, variants, sizeof variants);
    if (*taken) {
        shv_error(reader->diagnostics, key_node->place, "%s stands beside %s; %s takes exactly one of %s", key->name,
                  (*taken)->name, shv_table_label(table, reader->item).text, variants);
        return;
    }
    *taken = key;
    memcpy(base + table->variant_offset, &key->variant, sizeof key->variant);
}

static void read_mapping(ShvReader *reader, const ShvTable *table, const ShvNode *node, char *base)
{
    uint64_t seen = 0;
    const ShvKey *variant = NULL;
    for (const ShvEntry *entry = node->first; entry; entry = entry->next) {
        const ShvKey *key = shv_table_find(table, entry->key->text);
        if (!key) {
            shv_table_report_unknown(table, reader->item, reader->diagnostics, entry->key->place, entry->key->text);
            continue;
        }
        const uint64_t bit = (uint64_t)1 << (key - table->keys);
        if (seen & bit) continue; /* reported where the tree was read */
        seen |= bit;
        const ShvKey *before = variant;
        if (key->flags & SHV_KEY_VARIANT) take_variant(reader, table, key, entry->key, base, &variant);
        if (!(key->flags & SHV_KEY_VARIANT) || !before) read_value(reader, key, entry->value, base);
    }
    report_missing(reader, table, node, seen);
    if (table->variants && !variant) {
        char variants[LONGEST_EXPECTATION];
        shv_table_list(table, true, variants, sizeof variants);
        shv_error(reader->diagnostics, node->place, "%s has none of %s; give exactly one",
                  shv_table_label(table, reader->item).text, variants);
    }
}

static void read_item(ShvReader *reader, const ShvKey *key, const ShvEntry *entry, char *item)
{
    const int32_t errors = shv_diagnostics_errors(reader->diagnostics);
    const ShvNode *node = entry->value;
    ShvItemHead *head = (ShvItemHead *)(void *)item;
    shv_table_start(key->table, item);
    const char *outer = reader->item;
    if (entry->key) reader->item = entry->key->text;
    head->node = node;
    head->key = entry->key ? entry->key : node;
    if (entry->key) {
        head->name = shv_pool_text(reader->texts, entry->key->text, strlen(entry->key->text));
        if (!shv_is_name(entry->key->text))
            shv_error(reader->diagnostics, entry->key->place,
                      "%s is no name; use letters, digits, '_' and '-', at most 63 of them",
                      shv_quoted(entry->key->text).text);
    }
    if (node->kind == SHV_NODE_MAPPING) {
        read_mapping(reader, key->table, node, item);
    } else {
        char known[LONGEST_EXPECTATION];
        shv_table_list(key->table, false, known, sizeof known);
        shv_error(reader->diagnostics, node->place, "%s is %s; expected a mapping with keys %s",
                  shv_table_label(key->table, reader->item).text,
                  node->kind == SHV_NODE_SCALAR && node->null ? "empty" : shv_node_kind_name(node->kind), known);
    }
    head->good = shv_diagnostics_errors(reader->diagnostics) == errors;
    reader->item = outer;
}

static void read_items(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *target)
{
    if (node->kind != (key->type == SHV_KEY_LIST ? SHV_NODE_LIST : SHV_NODE_MAPPING)) {
        report_expected(reader, key, node);
        return;
    }
    ShvItems items = {shv_pool_take(reader->work, (size_t)node->count, key->table->size), 0};
    if (!items.data) return;
    for (const ShvEntry *entry = node->first; entry; entry = entry->next)
        read_item(reader, key, entry, (char *)items.data + (size_t)items.count++ * key->table->size);
    memcpy(target, &items, sizeof items);
}

static void read_value(ShvReader *reader, const ShvKey *key, const ShvNode *node, char *base)
{
    char *target = base + key->offset;
    if (key->flags & SHV_KEY_AUTOMATIC && node->kind == SHV_NODE_SCALAR && strcmp(node->text, "auto") == 0) return;
    switch (key->type) {
    case SHV_KEY_NUMBER:
        read_double(reader, key, node, target);
        break;
    case SHV_KEY_INT32:
    case SHV_KEY_INT64:
        read_integer(reader, key, node, target);
        break;
    case SHV_KEY_UINT64:
        read_uint64(reader, key, node, target);
        break;
    case SHV_KEY_BOOLEAN:
        read_boolean(reader, key, node, target);
        break;
    case SHV_KEY_TEXT:
        read_text(reader, key, node, target);
        break;
    case SHV_KEY_CHOICE:
        read_choice(reader, key, node, target);
        break;
    case SHV_KEY_VECTOR:
        read_vector(reader, key, node, target);
        break;
    case SHV_KEY_AXES:
        read_axes(reader, key, node, target);
        break;
    case SHV_KEY_NODE:
        memcpy(target, &node, sizeof node);
        break;
    case SHV_KEY_NAMED:
    case SHV_KEY_LIST:
        read_items(reader, key, node, target);
        break;
    case SHV_KEY_MAPPING:
        if (node->kind == SHV_NODE_MAPPING)
            read_mapping(reader, key->table, node, target);
        else
            report_expected(reader, key, node);
        break;
    }
}

void shv_read_document(ShvReader *reader, const ShvTable *table, const ShvNode *root, void *item)
{
    const int32_t errors = shv_diagnostics_errors(reader->diagnostics);
    ShvItemHead *head = item;
    shv_table_start(table, item);
    *head = (ShvItemHead){NULL, root, root, false};
    if (root->kind == SHV_NODE_MAPPING)
        read_mapping(reader, table, root, item);
    else
        shv_error(reader->diagnostics, root->place, "%s is %s; expected a mapping that begins with '%s: 1'",
                  table->name, shv_node_kind_name(root->kind), table->keys[0].name);
    head->good = shv_diagnostics_errors(reader->diagnostics) == errors;
}

void shv_read_scene(ShvReader *reader, const ShvNode *root, ShvSceneItem *scene)
{
    shv_read_document(reader, &shv_scene_table, root, scene);
}
