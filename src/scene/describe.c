/* What keys and tables say about themselves in messages. */
#include <string.h>

#include "base/names.h"
#include "base/text.h"
#include "scene/schema.h"

enum { LARGEST_KEYS = 64 };

const ShvKey *shv_table_find(const ShvTable *table, const char *name)
{
    for (int i = 0; i < table->key_count; i++)
        if (strcmp(table->keys[i].name, name) == 0) return &table->keys[i];
    return NULL;
}

void shv_table_start(const ShvTable *table, void *item)
{
    memset(item, 0, table->size);
    if (table->start) table->start(item);
}

const char *shv_choice_name(const ShvChoice *choices, int value)
{
    for (; choices->name; choices++)
        if (choices->value == value) return choices->name;
    return "";
}

void shv_range_describe(const ShvRange *range, char *buffer, size_t size)
{
    buffer[0] = '\0';
    if (!range) return;
    if (range->low == range->high) {
        shv_format(buffer, size, "exactly %.15g", range->low);
        return;
    }
    shv_append(buffer, size, "%s %.15g", range->low_open ? "greater than" : "at least", range->low);
    if (range->high <= 1e300)
        shv_append(buffer, size, " and %s %.15g", range->high_open ? "less than" : "at most", range->high);
}

bool shv_range_holds(const ShvRange *range, double value)
{
    if (!range) return value == value;
    const bool above = range->low_open ? value > range->low : value >= range->low;
    const bool below = range->high_open ? value < range->high : value <= range->high;
    return above && below;
}

/* Joins with commas and a last "or". */
static void join(char *buffer, size_t size, const char *name, int index, int count)
{
    shv_append(buffer, size, "%s%s", index == 0 ? "" : index + 1 < count ? ", " : " or ", name);
}

static void describe_number(const ShvKey *key, const char *one, char *buffer, size_t size)
{
    const char *unit = shv_dimension_unit(key->dimension, 0);
    const char *name = shv_dimension_name(key->dimension);
    const bool vowel = strchr("aeio", name[0]) != NULL;
    shv_append(buffer, size, one, vowel ? "an" : "a", name);
    if (unit) shv_append(buffer, size, " in %s", unit);
    char others[120];
    shv_dimension_units(key->dimension, others, sizeof others);
    const char *second = strchr(others, ',');
    if (second) shv_append(buffer, size, " (or %s)", second + 2);
}

static void describe_choices(const ShvChoice *choices, char *buffer, size_t size)
{
    int count = 0;
    while (choices[count].name) count++;
    for (int i = 0; i < count; i++) join(buffer, size, choices[i].name, i, count);
}

static void describe_type(const ShvKey *key, char *buffer, size_t size)
{
    switch (key->type) {
    case SHV_KEY_NUMBER:
        describe_number(key, "%s %s", buffer, size);
        break;
    case SHV_KEY_INT32:
    case SHV_KEY_INT64:
        shv_append(buffer, size, "a whole number");
        break;
    case SHV_KEY_UINT64:
        shv_append(buffer, size, "a whole number, at least 0");
        break;
    case SHV_KEY_BOOLEAN:
        shv_append(buffer, size, "true or false");
        break;
    case SHV_KEY_TEXT:
        shv_append(buffer, size, key->flags & SHV_KEY_FILE ? "the name of a file" : "a text");
        break;
    case SHV_KEY_CHOICE:
        describe_choices(key->choices, buffer, size);
        break;
    case SHV_KEY_VECTOR:
        describe_number(key, "a list [x, y, z], each %s %s", buffer, size);
        break;
    case SHV_KEY_AXES:
        shv_append(buffer, size, "a list of some of x, y, z");
        break;
    case SHV_KEY_MAPPING:
        shv_append(buffer, size, "a mapping with keys ");
        break;
    case SHV_KEY_NAMED:
        shv_append(buffer, size, "a mapping of names to mappings with keys ");
        break;
    case SHV_KEY_LIST:
    case SHV_KEY_NODE:
        shv_append(buffer, size, "a list of mappings with keys ");
        break;
    }
    if (key->table) shv_table_list(key->table, false, buffer + strlen(buffer), size - strlen(buffer));
}

void shv_key_describe(const ShvKey *key, char *buffer, size_t size)
{
    buffer[0] = '\0';
    describe_type(key, buffer, size);
    char range[100];
    shv_range_describe(key->range, range, sizeof range);
    if (range[0]) shv_append(buffer, size, ", %s", range);
    if (key->flags & SHV_KEY_DIRECTION) shv_append(buffer, size, ", not zero");
    if (key->flags & SHV_KEY_INFINITE) shv_append(buffer, size, ", or .inf");
    if (key->flags & SHV_KEY_AUTOMATIC) shv_append(buffer, size, ", or auto");
}

void shv_table_list(const ShvTable *table, bool variants_alone, char *buffer, size_t size)
{
    int count = 0, index = 0;
    buffer[0] = '\0';
    for (int i = 0; i < table->key_count; i++)
        if (!variants_alone || table->keys[i].flags & SHV_KEY_VARIANT) count++;
    for (int i = 0; i < table->key_count; i++)
        if (!variants_alone || table->keys[i].flags & SHV_KEY_VARIANT)
            join(buffer, size, table->keys[i].name, index++, count);
}

bool shv_is_name(const char *text)
{
    static const char allowed[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
    const size_t length = strlen(text);
    return length > 0 && length <= 63 && strspn(text, allowed) == length;
}

ShvLabel shv_table_label(const ShvTable *table, const char *item)
{
    static const char mark[] = "<name>";
    ShvLabel label;
    const char *at = item ? strstr(table->name, mark) : NULL;
    if (at)
        shv_format(label.text, sizeof label.text, "%.*s%.63s%s", (int)(at - table->name), table->name,
                   shv_is_name(item) ? item : mark, at + sizeof mark - 1);
    else
        shv_format(label.text, sizeof label.text, "%s", table->name);
    return label;
}

void shv_table_report_unknown(const ShvTable *table, const char *item, ShvDiagnostics *diagnostics, ShvPlace place,
                              const char *word)
{
    const char *names[LARGEST_KEYS] = {NULL};
    for (int i = 0; i < table->key_count; i++) names[i] = table->keys[i].name;
    const char *nearest = shv_nearest_name(word, names, (size_t)table->key_count);
    const ShvLabel label = shv_table_label(table, item);
    char known[400];
    shv_table_list(table, false, known, sizeof known);
    if (nearest)
        shv_error(diagnostics, place, "unknown key %s in %s; did you mean '%s'?", shv_quoted(word).text, label.text,
                  nearest);
    else
        shv_error(diagnostics, place, "unknown key %s in %s; known are %s", shv_quoted(word).text, label.text, known);
}
