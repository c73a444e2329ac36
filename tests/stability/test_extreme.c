#include "stability/extreme.h"

static void no_case_misses(void **state)
{
    (void)state;
    run_extreme(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_case_misses)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
