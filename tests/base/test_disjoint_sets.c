#include "base/disjoint_sets.h"

#include "check.h"

/* Whatever the order of the pairs, the least number of a set is its root. */
static void the_least_leads_in_any_order(void **unused)
{
    (void)unused;
    static const int32_t pairs[][2] = {{5, 6}, {1, 4}, {4, 6}, {2, 7}};
    static const int32_t roots[] = {0, 1, 2, 3, 1, 1, 1, 2};
    for (int first = 0; first < 4; first++) {
        int32_t parent[8];
        for (int32_t i = 0; i < 8; i++) parent[i] = i;
        for (int k = 0; k < 4; k++)
            shv_set_join(parent, pairs[(first + k) % 4][k % 2], pairs[(first + k) % 4][1 - k % 2]);
        for (int32_t i = 0; i < 8; i++) assert_int_equal(shv_set_root(parent, i), roots[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_least_leads_in_any_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
