/* Disjoint sets of integers: root[i] leads towards the lowest member of i's set, which leads to itself. */
#ifndef SHV_FRAGMENT_DISJOINT_SETS_H
#define SHV_FRAGMENT_DISJOINT_SETS_H

#include <stdint.h>

static inline int32_t shv_set_root(int32_t *root, int32_t member)
{
    while (root[member] != member) {
        root[member] = root[root[member]];
        member = root[member];
    }
    return member;
}

static inline void shv_set_join(int32_t *root, int32_t a, int32_t b)
{
    a = shv_set_root(root, a);
    b = shv_set_root(root, b);
    if (a < b) root[b] = a;
    if (b < a) root[a] = b;
}

#endif
