/* Disjoint sets of numbers as a forest (union-find with path halving): `parent` of each, its own number at a root. */
#ifndef SHV_BASE_DISJOINT_SETS_H
#define SHV_BASE_DISJOINT_SETS_H

#include <stdint.h>

/* The root of a number's set: its least member. */
static inline int32_t shv_set_root(int32_t *parent, int32_t number)
{
    while (parent[number] != number) number = parent[number] = parent[parent[number]];
    return number;
}

/* The lower root leads, so that the outcome does not depend on the order. */
static inline void shv_set_join(int32_t *parent, int32_t first, int32_t second)
{
    const int32_t a = shv_set_root(parent, first), b = shv_set_root(parent, second);
    parent[a > b ? a : b] = a > b ? b : a;
}

#endif
