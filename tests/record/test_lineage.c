/* Which piece goes on as which, where masses and tets are chosen. */
#include "check.h"

#include "record/record.h"

enum { MOST = 16 };

static void extend(const ShvFragmentView *fragments, int32_t known, int32_t count, const int32_t *owner,
                   int32_t elements, int32_t *lines)
{
    int32_t first[MOST], heir[MOST];
    const ShvLineage lineage = {lines, first, heir};
    shv_lineage_extend(&lineage, fragments, known, count, owner, elements);
}

static void test_largest_goes_on(void **state)
{
    (void)state;
    const ShvFragmentView fragments[] = {{.parent = -1, .mass = 6}, {.parent = -1, .mass = 5}, {.parent = 0, .mass = 1},
                                         {.parent = 0, .mass = 3},  {.parent = 0, .mass = 2},  {.parent = 3, .mass = 2},
                                         {.parent = 3, .mass = 1}};
    const int32_t owner[] = {2, 5, 4, 6, 1};
    int32_t lines[MOST];
    extend(fragments, 0, 2, (const int32_t[]){0, 0, 0, 0, 1}, 5, lines);
    assert_true(lines[0] == 0 && lines[1] == 1);
    /* Two splits between two frames: the piece that died within goes on in its child. */
    extend(fragments, 2, 7, owner, 5, lines);
    const int32_t wanted[] = {0, 1, 2, 0, 4, 0, 6};
    assert_memory_equal(lines, wanted, sizeof wanted);
}

static void test_of_equals_the_lowest_tet(void **state)
{
    (void)state;
    const ShvFragmentView fragments[] = {{.parent = -1, .mass = 3},
                                         {.parent = 0, .mass = 1.0 + 1e-12},
                                         {.parent = 0, .mass = 1},
                                         {.parent = 0, .mass = 1}};
    int32_t lines[MOST];
    extend(fragments, 0, 1, (const int32_t[]){0, 0, 0}, 3, lines);
    extend(fragments, 1, 4, (const int32_t[]){3, 1, 2}, 3, lines);
    assert_true(lines[1] == 1 && lines[2] == 2 && lines[3] == 0);
    extend(fragments, 1, 4, (const int32_t[]){2, 3, 1}, 3, lines);
    assert_true(lines[1] == 1 && lines[2] == 0 && lines[3] == 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_largest_goes_on),
                                       cmocka_unit_test(test_of_equals_the_lowest_tet)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
