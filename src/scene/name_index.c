#include "scene/name_index.h"

#include <stdlib.h>
#include <string.h>

#include "base/names.h"
#include "base/text.h"

ShvNameIndex shv_name_index_create(ShvPool *pool, size_t capacity)
{
    return (ShvNameIndex){shv_pool_take(pool, capacity, sizeof(ShvNameEntry)), 0};
}

void shv_name_index_add(ShvNameIndex *index, const char *name, const ShvNode *key, int group, bool usable)
{
    if (!index->entries || !name) return;
    index->entries[index->count] = (ShvNameEntry){name, key, group, index->count, usable};
    index->count++;
}

static int compare_entries(const void *first, const void *second)
{
    const ShvNameEntry *a = first, *b = second;
    const int order = strcmp(a->name, b->name);
    return order != 0 ? order : (a->order > b->order) - (a->order < b->order);
}

void shv_name_index_finish(ShvNameIndex *index, ShvDiagnostics *diagnostics, const char *what)
{
    if (index->count < 2) return;
    qsort(index->entries, (size_t)index->count, sizeof *index->entries, compare_entries);
    for (int32_t i = 1; i < index->count; i++) {
        const ShvNameEntry *before = &index->entries[i - 1], *entry = &index->entries[i];
        if (strcmp(before->name, entry->name) != 0) continue;
        if (before->group == entry->group && strcmp(before->key->text, entry->key->text) == 0) continue;
        shv_error(diagnostics, entry->key->place, "name %s stands for two %s, before at line %d; rename one",
                  shv_quoted(entry->name).text, what, (int)before->key->place.line);
    }
}

const ShvNameEntry *shv_name_index_find(const ShvNameIndex *index, const char *name)
{
    int32_t low = 0, high = index->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (strcmp(index->entries[middle].name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < index->count && strcmp(index->entries[low].name, name) == 0 ? &index->entries[low] : NULL;
}

void shv_name_index_report_unknown(const ShvNameIndex *index, ShvDiagnostics *diagnostics, ShvPlace place,
                                   const char *key, const char *name, const char *what, int group)
{
    enum { LARGEST_CANDIDATES = 500, SHOWN = 8 };
    const char *names[LARGEST_CANDIDATES] = {NULL};
    char shown[SHOWN * 70] = "none";
    size_t count = 0, used = 0;
    for (int32_t i = 0; i < index->count && count < LARGEST_CANDIDATES; i++) {
        const ShvNameEntry *entry = &index->entries[i];
        if (group == SHV_ANY_GROUP ? !entry->usable : entry->group != group) continue;
        names[count] = entry->name;
        if (count < SHOWN)
            used +=
                (size_t)shv_format(shown + used, sizeof shown - used, count == 0 ? "%.65s" : ", %.65s", names[count]);
        count++;
    }
    const char *nearest = shv_nearest_name(name, names, count);
    if (nearest)
        shv_error(diagnostics, place, "%s %s is no %s; did you mean '%.63s'?", key, shv_quoted(name).text, what,
                  nearest);
    else
        shv_error(diagnostics, place, "%s %s is no %s; there %s %s%s", key, shv_quoted(name).text, what,
                  count == 1 ? "is" : "are", shown, count > SHOWN ? ", ..." : "");
}
