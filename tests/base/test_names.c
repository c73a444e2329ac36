#include "check.h"

#include "base/names.h"

static const char *const keys[] = {"density",   "youngs_modulus", "poissons_ratio", "fracture_energy",
                                   "threshold", "safety",         "edge",           "size"};
static const size_t key_count = sizeof keys / sizeof *keys;

static const char *nearest(const char *word)
{
    return shv_nearest_name(word, keys, key_count);
}

static void slips_of_the_fingers_are_understood(void **state)
{
    (void)state;
    assert_string_equal(nearest("densty"), "density");   /* left out */
    assert_string_equal(nearest("dennsity"), "density"); /* doubled */
    assert_string_equal(nearest("dencity"), "density");  /* replaced */
    assert_string_equal(nearest("desnity"), "density");  /* swapped */
    assert_string_equal(nearest("Density"), "density");  /* capital */
    assert_string_equal(nearest("young_modulus"), "youngs_modulus");
    assert_string_equal(nearest("egde"), "edge"); /* one swap: two replacements would be beyond the limit of one */
    assert_string_equal(nearest("density"), "density");
}

static void beginnings_are_understood(void **state)
{
    (void)state;
    assert_string_equal(nearest("young"), "youngs_modulus");
    assert_string_equal(nearest("POISSON"), "poissons_ratio");
    assert_null(nearest("p"));
}

static void far_words_get_no_suggestion(void **state)
{
    (void)state;
    assert_null(nearest("gravity"));
    assert_null(nearest("x"));
    assert_null(nearest(""));
    assert_null(nearest("a_word_far_longer_than_any_key_of_any_scene_that_anybody_would_ever_write_down"));
    assert_null(shv_nearest_name("density", NULL, 0));
}

static void the_nearest_wins_and_the_first_of_equals(void **state)
{
    (void)state;
    static const char *const two[] = {"abcdxx", "abcdex", "abcdey"};
    assert_string_equal(shv_nearest_name("abcdef", two, 3), "abcdex");
    static const char *const mixed[] = {"a_candidate_that_is_longer_than_what_the_table_of_distances_can_hold", "name"};
    assert_string_equal(shv_nearest_name("nmae", mixed, 2), "name");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slips_of_the_fingers_are_understood),
        cmocka_unit_test(beginnings_are_understood),
        cmocka_unit_test(far_words_get_no_suggestion),
        cmocka_unit_test(the_nearest_wins_and_the_first_of_equals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
