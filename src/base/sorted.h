/* Whole numbers in increasing order. */
#ifndef SHV_BASE_SORTED_H
#define SHV_BASE_SORTED_H

#include <stdbool.h>
#include <stdint.h>

/* Place of the first that is not below `bound`; `count` where all are. */
static inline int32_t shv_sorted_place(const int32_t *numbers, int32_t count, int32_t bound)
{
    int32_t low = 0, high = count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (numbers[middle] < bound)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static inline bool shv_sorted_contains(const int32_t *numbers, int32_t count, int32_t number)
{
    const int32_t place = shv_sorted_place(numbers, count, number);
    return place < count && numbers[place] == number;
}

#endif
