/* Which piece goes on as which. */
#include "record/record.h"

/* Masses are sums over nodes in some order: shares of the mass below which two are equal. */
static const double EQUAL_MASSES = 1e-9;

/* The lowest tet of each new fragment, also of one that has split again: elements come in increasing order. */
static void find_first_elements(int32_t *first, const ShvFragmentView *fragments, int32_t known, int32_t count,
                                const int32_t *owner, int32_t element_count)
{
    for (int32_t i = known; i < count; i++) first[i] = INT32_MAX;
    for (int32_t e = 0; e < element_count; e++)
        for (int32_t f = owner[e]; f >= known && first[f] == INT32_MAX; f = fragments[f].parent) first[f] = e;
}

static bool goes_before(const ShvFragmentView *fragments, const int32_t *first, int32_t a, int32_t b)
{
    const double difference = fragments[a].mass - fragments[b].mass, equal = EQUAL_MASSES * fragments[b].mass;
    return difference > equal || (difference >= -equal && first[a] < first[b]);
}

void shv_lineage_extend(const ShvLineage *lines, const ShvFragmentView *fragments, int32_t known, int32_t count,
                        const int32_t *owner, int32_t element_count)
{
    int32_t *heir = lines->heir;
    find_first_elements(lines->first_element, fragments, known, count, owner, element_count);
    for (int32_t i = 0; i < count; i++) heir[i] = -1;
    for (int32_t i = known; i < count; i++) {
        const int32_t parent = fragments[i].parent;
        if (parent < 0) continue;
        if (heir[parent] < 0 || goes_before(fragments, lines->first_element, i, heir[parent])) heir[parent] = i;
    }
    for (int32_t i = known; i < count; i++) {
        const int32_t parent = fragments[i].parent;
        lines->lineage[i] = parent >= 0 && heir[parent] == i ? lines->lineage[parent] : i;
    }
}
