/* shiver stability, as text. */
#include "cli/json.h"
#include "cli/shell.h"

static const char scene[] =
    "shiver: 1\nduration: 1\nmaterials: {stuff: {density: 1000, youngs_modulus: 1 GPa, poissons_ratio: 0.24, "
    "breakable: false}}\nobjects: {bar: {material: stuff, mesh: {box: {size: [1, 1, 2], edge: 1}}}}\n";

static void test_table_and_files(void **state)
{
    (void)state;
    shell_write("bar.yaml", scene);
    shell_works("$shiver stability bar.yaml --k 1,0.5 --iterations 2 --at 1 --steps 300 --csv t.csv --svg t",
                "largest stable step");
    assert_non_null(strstr(output.out, "refused above"));
    assert_non_null(strstr(output.out, "how far off"));
    shell_works("wc -l <t.csv", "7"); /* head, and two points of each of three settings */
    shell_works("ls t_limit.svg t_stiffness.svg t_error.svg", "t_error.svg");
    shell_fails("$shiver stability bar.yaml --steps 300 --csv t.csv", 2, "t.csv");
    shell_works("$shiver stability bar.yaml --k 1 --iterations 1 --at 1 --steps 300 --csv t.csv --force --json",
                "\"rows\"");
    assert_true(json_valid(output.out));
}

static void test_bad_words(void **state)
{
    (void)state;
    shell_write("bar.yaml", scene);
    shell_fails("$shiver stability", 2, "needs a SCENE");
    shell_fails("$shiver stability bar.yaml --k 1,", 2, "--k");
    shell_fails("$shiver stability bar.yaml --k 2", 2, "stiffness");
    shell_fails("$shiver stability bar.yaml --iterations 1.5", 2, "whole");
    shell_fails("$shiver stability bar.yaml --steps 1", 2, "at least 100");
    shell_fails("$shiver stability nowhere.yaml", 2, "nowhere.yaml");
    shell_fails("$shiver stability --suite nowhere", 2, "cannot read 'nowhere'");
}

static void test_suite_of_a_folder(void **state)
{
    (void)state;
    static const char head[] = "verification: 1\ntitle: a\nscene: a.yaml\nsource: us\nshort: true\nruns:\n";
    char text[1024];
    shell_works("mkdir -p cases", "");
    shell_write("cases/a.yaml", scene);
    snprintf(text, sizeof text, "%s  one: {title: 'one | bar', expect: finishes}\n", head);
    shell_write("cases/a.case.yaml", text);
    shell_works("$shiver stability --suite cases", "finishes  one | bar");
    shell_works("$shiver stability --suite cases --markdown t.md && cat t.md", "| finishes | one \\| bar |");
    shell_works("$shiver stability --suite cases --json", "\"verdict\": \"pass\"");
    assert_true(json_valid(output.out));
    snprintf(text, sizeof text, "%s  one: {expect: run.steps > 1}\n  two: {full: true, expect: finishes}\n", head);
    shell_write("cases/a.case.yaml", text);
    shell_fails("$shiver stability --suite cases --quick", 1, "");
    assert_non_null(strstr(output.out, "run.steps > 1  one"));
    assert_null(strstr(output.out, "two"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table_and_files),
        cmocka_unit_test(test_bad_words),
        cmocka_unit_test(test_suite_of_a_folder),
    };
    return cmocka_run_group_tests(tests, shell_enter, shell_leave);
}
