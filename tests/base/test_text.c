#include "check.h"

#include <locale.h>

#include "base/text.h"
#include "shiver/status.h"

/* Switches to an installed locale with a decimal comma; false when the system has none. */
static int use_decimal_comma(void)
{
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8", "de_DE", "fr_FR"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (setlocale(LC_ALL, names[i])) return 1;
    return 0;
}

static void numbers_have_a_point_in_every_locale(void **state)
{
    (void)state;
    if (!use_decimal_comma()) skip();
    char text[32];
    snprintf(text, sizeof text, "%.2f", 1.5);
    assert_string_equal(text, "1,50"); /* the locale does what the test is about */
    assert_int_equal(shv_format(text, sizeof text, "%.2f", 1.5), 4);
    assert_string_equal(text, "1.50");
    check_near(shv_text_to_double("2.25", NULL), 2.25, 0.0);
    ShvError error;
    shv_fail(&error, SHV_BAD_INPUT, "%.1f", 0.5);
    assert_string_equal(error.message, "0.5");
    snprintf(text, sizeof text, "%.2f", 1.5);
    assert_string_equal(text, "1,50"); /* the caller's locale is back */
    setlocale(LC_ALL, "C");
}

static void formatting_is_bounded(void **state)
{
    (void)state;
    char text[4] = "zzz";
    assert_int_equal(shv_format(text, sizeof text, "%d", 123456), 6);
    assert_string_equal(text, "123");
    assert_int_equal(shv_format(NULL, 0, "%s", "abc"), 3);
}

static void printing_writes_to_the_file(void **state)
{
    (void)state;
    FILE *file = tmpfile();
    assert_non_null(file);
    assert_int_equal(shv_print(file, "%g %s\n", 0.125, "m"), 8);
    rewind(file);
    char line[32];
    assert_non_null(fgets(line, sizeof line, file));
    assert_string_equal(line, "0.125 m\n");
    fclose(file);
}

static void conversion_tells_where_it_stopped(void **state)
{
    (void)state;
    const char text[] = "-1.25e2,7";
    char *end;
    check_near(shv_text_to_double(text, &end), -125.0, 0.0);
    assert_ptr_equal(end, text + 7);
}

static void what_does_not_fit_is_cut(void **state)
{
    (void)state;
    char text[8] = "ab";
    shv_append(text, sizeof text, "%d", 345);
    assert_string_equal(text, "ab345");
    shv_append(text, sizeof text, " %s", "cdef");
    assert_string_equal(text, "ab345 c");
    shv_append(text, sizeof text, "more");
    assert_string_equal(text, "ab345 c");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_have_a_point_in_every_locale),
        cmocka_unit_test(formatting_is_bounded),
        cmocka_unit_test(printing_writes_to_the_file),
        cmocka_unit_test(conversion_tells_where_it_stopped),
        cmocka_unit_test(what_does_not_fit_is_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
