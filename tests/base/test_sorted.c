#include "base/sorted.h"

#include "check.h"

/* Lists of every length up to seven, asked for each of their numbers, for those between them and beyond both ends. */
static void found_as_by_counting(void **unused)
{
    (void)unused;
    static const int32_t numbers[] = {INT32_MIN, -3, 0, 1, 5, 8, INT32_MAX};
    static const int32_t asked[] = {INT32_MIN, -4, -3, -1, 0, 1, 2, 5, 7, 8, 9, INT32_MAX};
    for (int32_t count = 0; count <= 7; count++)
        for (int k = 0; k < 12; k++) {
            int32_t below = 0;
            bool contained = false;
            for (int32_t i = 0; i < count; i++) {
                below += numbers[i] < asked[k];
                contained = contained || numbers[i] == asked[k];
            }
            assert_int_equal(shv_sorted_place(numbers, count, asked[k]), below);
            assert_int_equal(shv_sorted_contains(numbers, count, asked[k]), contained);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(found_as_by_counting)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
