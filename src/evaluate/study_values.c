#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "evaluate/study_plan.h"
#include "scene/read.h"

/* ---- a node as text ---- */

/* Words and numbers, which YAML reads as they are. */
static bool is_plain(const char *text)
{
    static const char *const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 ._+-/";
    return *text != '\0' && strspn(text, letters) == strlen(text) && *text != ' ' && text[strlen(text) - 1] != ' ' &&
           strcmp(text, "-") != 0 && strncmp(text, "- ", 2) != 0 && strncmp(text, "---", 3) != 0;
}

static void put_scalar(FILE *stream, const ShvNode *node)
{
    if (node->null || is_plain(node->text)) {
        shv_print(stream, "%s", node->null ? "null" : node->text);
        return;
    }
    shv_print(stream, "'");
    for (const char *c = node->text; *c; c++) shv_print(stream, *c == '\'' ? "''" : "%c", *c == '\n' ? ' ' : *c);
    shv_print(stream, "'");
}

static void put_node(FILE *stream, const ShvNode *node)
{
    const bool list = node->kind == SHV_NODE_LIST;
    if (node->kind == SHV_NODE_SCALAR) {
        put_scalar(stream, node);
        return;
    }
    shv_print(stream, list ? "[" : "{");
    for (const ShvEntry *entry = node->first; entry; entry = entry->next) {
        if (entry != node->first) shv_print(stream, ", ");
        if (entry->key) put_scalar(stream, entry->key);
        if (entry->key) shv_print(stream, ": ");
        put_node(stream, entry->value);
    }
    shv_print(stream, list ? "]" : "}");
}

const char *shv_study_text_of(ShvPool *pool, const ShvNode *node)
{
    char *text = NULL;
    size_t length = 0;
    FILE *stream = open_memstream(&text, &length);
    if (stream) put_node(stream, node);
    pool->failed |= !stream || fclose(stream) != 0;
    const char *copy = pool->failed ? NULL : shv_pool_text(pool, text, length);
    free(text);
    return copy;
}

/* ---- values ---- */

/* The ends are exact. */
static double between(double from, double to, int32_t count, int32_t index, bool geometric)
{
    if (index == 0) return from;
    if (index == count - 1) return to;
    const double part = (double)index / (count - 1);
    return geometric ? from * pow(to / from, part) : from + part * (to - from);
}

typedef struct RangeItem {
    ShvItemHead head;
    double from, to;
    int32_t count;
    const char *unit;
} RangeItem;

static const ShvRange counts = {2.0, 1000.0, false, false};
static const ShvKey range_keys[] = {
    {"from", SHV_KEY_NUMBER, .flags = SHV_KEY_REQUIRED, .offset = offsetof(RangeItem, from)},
    {"to", SHV_KEY_NUMBER, .flags = SHV_KEY_REQUIRED, .offset = offsetof(RangeItem, to)},
    {"count", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &counts, .offset = offsetof(RangeItem, count)},
    {"unit", SHV_KEY_TEXT, .offset = offsetof(RangeItem, unit)}};
static void start_range(void *item)
{
    *(RangeItem *)item = (RangeItem){.unit = ""};
}
static const ShvTable range_table = {.name = "a range",
                                     .keys = range_keys,
                                     .key_count = sizeof range_keys / sizeof *range_keys,
                                     .size = sizeof(RangeItem),
                                     .start = start_range};

static int32_t range(ShvPool *pool, ShvDiagnostics *diagnostics, const ShvEntry *entry, const char ***values)
{
    const bool geometric = strcmp(entry->key->text, "geometric") == 0;
    ShvReader reader = {pool, pool, diagnostics, NULL};
    RangeItem item;
    shv_read_document(&reader, &range_table, entry->value, &item);
    if (!item.head.good) return 0;
    if (geometric && !(item.from > 0.0 && item.to > 0.0)) {
        shv_error(diagnostics, entry->key->place, "'from' and 'to' of a geometric range must be above 0");
        return 0;
    }
    *values = shv_pool_take(pool, (size_t)item.count, sizeof **values);
    for (int32_t i = 0; i < item.count && *values; i++) {
        char text[96];
        shv_format(text, sizeof text, "%.9g%s%.30s", between(item.from, item.to, item.count, i, geometric),
                   item.unit[0] ? " " : "", item.unit);
        (*values)[i] = shv_pool_text(pool, text, strlen(text));
    }
    return *values ? item.count : 0;
}

int32_t shv_study_values(ShvPool *pool, ShvDiagnostics *diagnostics, const ShvNode *node, const char ***values)
{
    if (node->kind == SHV_NODE_MAPPING && node->count == 1 &&
        (strcmp(node->first->key->text, "linear") == 0 || strcmp(node->first->key->text, "geometric") == 0))
        return range(pool, diagnostics, node->first, values);
    const bool list = node->kind == SHV_NODE_LIST;
    const int32_t count = list ? node->count : 1;
    if (count == 0) {
        shv_error(diagnostics, node->place, "the list of values is empty");
        return 0;
    }
    *values = shv_pool_take(pool, (size_t)count, sizeof **values);
    if (!*values) return 0;
    int32_t i = 0;
    if (!list) (*values)[i++] = shv_study_text_of(pool, node);
    for (const ShvEntry *entry = node->first; list && entry; entry = entry->next)
        (*values)[i++] = shv_study_text_of(pool, entry->value);
    return count;
}
