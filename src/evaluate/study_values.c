#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/names.h"
#include "base/text.h"
#include "evaluate/study_plan.h"

/* ---- a node as text ---- */

typedef struct Line {
    char *text;
    size_t size, length;
} Line;

/* Counts what does not fit. */
static void put(Line *line, const char *text)
{
    for (; *text; text++, line->length++)
        if (line->length + 1 < line->size) line->text[line->length] = *text;
}

/* Words and numbers, which YAML reads as they are. */
static bool is_plain(const char *text)
{
    static const char *const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789 ._+-/";
    return *text != '\0' && strspn(text, letters) == strlen(text) && *text != ' ' && text[strlen(text) - 1] != ' ' &&
           strcmp(text, "-") != 0 && strncmp(text, "- ", 2) != 0 && strncmp(text, "---", 3) != 0;
}

static void put_scalar(Line *line, const ShvNode *node)
{
    char letter[2] = "";
    if (node->null || is_plain(node->text)) {
        put(line, node->null ? "null" : node->text);
        return;
    }
    put(line, "'");
    for (const char *c = node->text; *c; c++) {
        letter[0] = *c == '\n' ? ' ' : *c;
        put(line, *c == '\'' ? "''" : letter);
    }
    put(line, "'");
}

static void put_node(Line *line, const ShvNode *node)
{
    if (node->kind == SHV_NODE_SCALAR) {
        put_scalar(line, node);
        return;
    }
    put(line, node->kind == SHV_NODE_LIST ? "[" : "{");
    for (const ShvEntry *entry = node->first; entry; entry = entry->next) {
        if (entry != node->first) put(line, ", ");
        if (entry->key) {
            put_scalar(line, entry->key);
            put(line, ": ");
        }
        put_node(line, entry->value);
    }
    put(line, node->kind == SHV_NODE_LIST ? "]" : "}");
}

const char *shv_study_text_of(ShvPool *pool, const ShvNode *node)
{
    Line line = {NULL, 0, 0};
    put_node(&line, node);
    line = (Line){shv_pool_take(pool, line.length + 1, 1), line.length + 1, 0};
    if (line.text) put_node(&line, node);
    return line.text;
}

/* ---- checks ---- */

bool shv_study_check_keys(ShvDiagnostics *diagnostics, const ShvNode *node, const char *what, const char *const *names,
                          int32_t count)
{
    bool good = true;
    if (node->kind != SHV_NODE_MAPPING) {
        shv_error(diagnostics, node->place, "%s must be a mapping, not %s", what, shv_node_kind_name(node->kind));
        return false;
    }
    for (const ShvEntry *entry = node->first; entry; entry = entry->next) {
        bool known = false;
        for (int32_t i = 0; i < count && !known; i++) known = strcmp(entry->key->text, names[i]) == 0;
        if (known) continue;
        const char *near = shv_nearest_name(entry->key->text, names, (size_t)count);
        shv_error(diagnostics, entry->key->place, "unknown key %s in %s%s%s%s", shv_quoted(entry->key->text).text, what,
                  near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
        good = false;
    }
    return good;
}

bool shv_study_number(ShvDiagnostics *diagnostics, const ShvNode *node, const char *name, double low, double high,
                      bool whole, double *value)
{
    double number = 0.0;
    const bool read = node->kind == SHV_NODE_SCALAR && !node->null &&
                      shv_parse_double(node->text, strlen(node->text), false, &number, NULL) == SHV_OK;
    if (read && number >= low && number <= high && (!whole || number == floor(number))) {
        *value = number;
        return true;
    }
    shv_error(diagnostics, node->place, "'%s' must be a %s from %g to %g", name, whole ? "whole number" : "number", low,
              high);
    return false;
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

static int32_t range(ShvPool *pool, ShvDiagnostics *diagnostics, const ShvEntry *entry, const char ***values)
{
    static const char *const names[] = {"from", "to", "count", "unit"};
    const bool geometric = strcmp(entry->key->text, "geometric") == 0;
    double numbers[3];
    if (!shv_study_check_keys(diagnostics, entry->value, "a range", names, 4)) return 0;
    for (int i = 0; i < 3; i++) {
        const ShvEntry *found = shv_tree_find(entry->value, names[i]);
        if (!found) {
            shv_error(diagnostics, entry->key->place, "the range lacks '%s'", names[i]);
            return 0;
        }
        const double low = i == 2 ? 2.0 : geometric ? 1e-300 : -1e300;
        if (!shv_study_number(diagnostics, found->value, names[i], low, i == 2 ? 1000.0 : 1e300, i == 2, &numbers[i]))
            return 0;
    }
    const ShvEntry *unit = shv_tree_find(entry->value, "unit");
    const int32_t count = (int32_t)numbers[2];
    *values = shv_pool_take(pool, (size_t)count, sizeof **values);
    for (int32_t i = 0; i < count && *values; i++) {
        char text[96];
        shv_format(text, sizeof text, "%.9g%s%.30s", between(numbers[0], numbers[1], count, i, geometric),
                   unit ? " " : "", unit && unit->value->kind == SHV_NODE_SCALAR ? unit->value->text : "");
        (*values)[i] = shv_pool_text(pool, text, strlen(text));
    }
    return *values ? count : 0;
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
