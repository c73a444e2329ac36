/* Suites: what cases say, and what becomes of them. */
#include "stability/scene.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

static char folder[] = "/tmp/shiver-suite-XXXXXX";

static void put(const char *name, const char *text)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void drop(const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(remove(path), 0);
}

static int enter(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int leave(void **state)
{
    (void)state;
    return rmdir(folder);
}

/* A cube falls freely for a tenth of a second: z = −g t²/2. */
#define FALL                                                                                                           \
    "shiver: 1\nduration: 0.1\nmaterials: {stuff: {density: 1000, youngs_modulus: 1 GPa, poissons_ratio: 0.2, "        \
    "breakable: false}}\nobjects: {cube: {material: stuff, mesh: {box: {size: [1, 1, 1], edge: 1}}}}\n"

static ShvSuite *run(const ShvSuiteOptions *options)
{
    ShvSuite *suite = NULL;
    ShvError error = {.message = ""};
    check_ok(shv_suite_run(&suite, folder, options, &error), error);
    return suite;
}

/* Every kind of expectation, held and missed. */
static void expectations_are_judged(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        ShvSuiteVerdict verdict;
    } cases[] = {
        {"#! expect: finishes\n", SHV_SUITE_PASS},
        {"#! expect: told\n", SHV_SUITE_PASS},
        {"#! expect: refused anything\n", SHV_SUITE_MISS},
        {"#! expect: stops anything\n", SHV_SUITE_MISS},
        {"#! set: duration=-1\n#! expect: refused duration\n", SHV_SUITE_PASS},
        {"#! set: duration=-1\n#! expect: refused another thing\n", SHV_SUITE_MISS},
        {"#! set: duration=-1\n#! expect: finishes\n", SHV_SUITE_MISS},
        {"#! set: duration=-1\n#! expect: steps = 0\n", SHV_SUITE_MISS},
        {"#! set: fracture.time_step=0.05\n#! expect: refused stable step\n", SHV_SUITE_PASS},
        {"#! expect: z = -0.04905 within 1e-9\n", SHV_SUITE_PASS},
        {"#! expect: z = -0.04905 within 1e-9 absolute\n", SHV_SUITE_PASS},
        {"#! expect: z = -0.04904 within 1e-9\n", SHV_SUITE_MISS},
        {"#! expect: z = -0.04904 within 0.001\n", SHV_SUITE_PASS},
        {"#! set: gravity=[0, 0, -19.62]; duration=0.1\n#! expect: z = 2 of b.yaml within 1e-9\n", SHV_SUITE_PASS},
        {"#! expect: z = 2 of b.yaml within 1e-9\n", SHV_SUITE_MISS},
        {"#! expect: z < -0.049\n#! expect: z > -0.0491\n#! expect: z <= 0\n#! expect: z >= -1\n", SHV_SUITE_PASS},
        {"#! expect: z < -0.05\n", SHV_SUITE_MISS},
        {"#! expect: first_wake > 0\n", SHV_SUITE_MISS}, /* not a number */
        {"#! expect: hash = first\n", SHV_SUITE_PASS},
        {"#! set: duration=0.2\n#! expect: hash = first\n", SHV_SUITE_MISS},
        {"#! expect: z < -0.05\n#! explained: it has not had the time\n", SHV_SUITE_EXPLAINED},
        {"#! expect: finishes\n#! explained: needs none\n", SHV_SUITE_PASS},
    };
    enum { COUNT = sizeof cases / sizeof cases[0] };
    char text[8192] = "";
    size_t length = 0;
    for (int i = 0; i < COUNT; i++)
        length +=
            (size_t)snprintf(text + length, sizeof text - length, "#! case %d: title %d\n%s", i, i, cases[i].text);
    snprintf(text + length, sizeof text - length, "%s", FALL);
    put("a.yaml", text);
    put("b.yaml", FALL);
    put("notes.txt", "not a scene");
    ShvSuite *suite = run(NULL);
    assert_int_equal(shv_suite_count(suite), COUNT);
    for (int i = 0; i < COUNT; i++) {
        const ShvSuiteRow *row = shv_suite_row(suite, i);
        if (row->verdict != cases[i].verdict)
            fail_msg("%s gave %s: %s", cases[i].text, shv_suite_verdict_name(row->verdict), row->found);
        assert_string_equal(row->file, "a.yaml");
        assert_int_equal(atoi(row->number), i);
        assert_true(strlen(row->found) > 0);
    }
    assert_int_equal(shv_suite_verdicts(suite, SHV_SUITE_EXPLAINED), 1);
    shv_suite_destroy(suite);
    drop("a.yaml");
    drop("b.yaml");
    drop("notes.txt");
}

static void long_and_slow_cases(void **state)
{
    (void)state;
    put("a.yaml", "#! case 1: quick\n#! expect: finishes\n#! case 2: not\n#! long\n#! expect: finishes\n" FALL);
    ShvSuiteOptions options = shv_suite_default();
    options.quick = true;
    ShvSuite *suite = run(&options);
    assert_int_equal(shv_suite_row(suite, 0)->verdict, SHV_SUITE_PASS);
    assert_int_equal(shv_suite_row(suite, 1)->verdict, SHV_SUITE_SKIPPED);
    shv_suite_destroy(suite);
    /* Free flight asks between its steps. */
    put("a.yaml", "#! case 1: slow\n#! set: rigid.time_step=1e-6\n#! expect: told\n" FALL);
    options.most_seconds = 0.0;
    suite = run(&options);
    assert_int_equal(shv_suite_row(suite, 0)->verdict, SHV_SUITE_MISS);
    assert_non_null(strstr(shv_suite_row(suite, 0)->found, "too long"));
    shv_suite_destroy(suite);
    drop("a.yaml");
}

/* This file covers itself. */
static void tests_are_looked_up(void **state)
{
    (void)state;
    put("covered.txt", "# a remark\n\n"
                       "1 | this | stability/test_suite | tests_are_looked_up\n"
                       "2 | not there | stability/test_suite | no_such_function\n"
                       "3 | no file | stability/test_nothing | tests_are_looked_up\n");
    ShvSuiteOptions options = shv_suite_default();
    options.tests = ".";
    ShvSuite *suite = run(&options);
    static const ShvSuiteVerdict verdicts[] = {SHV_SUITE_PASS, SHV_SUITE_MISS, SHV_SUITE_MISS};
    for (int32_t i = 0; i < 3; i++) assert_int_equal(shv_suite_row(suite, i)->verdict, verdicts[i]);
    assert_string_equal(shv_suite_row(suite, 0)->file, "ctest -R stability/test_suite");
    shv_suite_destroy(suite);
    drop("covered.txt");
}

static void what_is_not_understood_is_named(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"#! expect: finishes\n", "a.yaml:1: a `case` comes first"},
        {"#! case 1 no colon\n", "a.yaml:1: `case` needs"},
        {"#! case 1: a\n", "expects nothing"},
        {"#! case 1: a\n#! expects: finishes\n", "a.yaml:2: none of case"},
        {"#! case 1: a\n#! expect: nonsense < 1\n", "names no measure"},
        {"#! case 1: a\n#! expect: z is 1\n", "lacks one of"},
        {"#! case 1: a\n#! expect: z < much\n", "lacks a number"},
        {"#! case 1: a\n#! expect: z < 1 or so\n", "not understood"},
        {"#! case 1: a\n#! expect: z = 1 within\n", "after `within`"},
        {"#! case 1: a\n#! expect: z = 1 of nowhere.yaml\n", "nowhere.yaml"},
        {"#! case 1: a\n#! expect: hash = first\n", "no earlier case"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        ShvSuite *suite = NULL;
        ShvError error = {.message = ""};
        snprintf(text, sizeof text, "%s%s", cases[i][0], FALL);
        put("a.yaml", text);
        check_fails(shv_suite_run(&suite, folder, NULL, &error), SHV_BAD_INPUT, error, cases[i][1]);
        assert_null(suite);
    }
    drop("a.yaml");
    ShvSuite *suite = NULL;
    ShvError error = {.message = ""};
    check_fails(shv_suite_run(&suite, folder, NULL, &error), SHV_BAD_INPUT, error, "no scene");
    check_fails(shv_suite_run(&suite, "/nowhere/at/all", NULL, &error), SHV_FILE_ERROR, error, "no folder");
    put("covered.txt", "1 | too short\n");
    check_fails(shv_suite_run(&suite, folder, NULL, &error), SHV_BAD_INPUT, error, "covered.txt:1");
    drop("covered.txt");
}

static void running_out_of_memory_is_reported(void **state)
{
    (void)state;
    put("a.yaml", "#! case 1: a\n#! expect: finishes\n#! expect: z = 1 of a.yaml within 0.1\n" FALL);
    put("covered.txt", "1 | this | stability/test_suite | tests_are_looked_up\n");
    bool done = false;
    for (int64_t count = 0; !done; count++) {
        ShvMemory *memory = shv_memory_create();
        ShvSuiteOptions options = shv_suite_default();
        ShvSuite *suite = NULL;
        ShvError error = {.message = ""};
        options.memory = memory;
        options.tests = ".";
        shv_memory_fail_after(memory, count);
        const ShvStatus status = shv_suite_run(&suite, folder, &options, &error);
        done = status == SHV_OK && shv_memory_requests(memory) <= count;
        shv_suite_destroy(suite);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    drop("a.yaml");
    drop("covered.txt");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expectations_are_judged),
        cmocka_unit_test(long_and_slow_cases),
        cmocka_unit_test(tests_are_looked_up),
        cmocka_unit_test(what_is_not_understood_is_named),
        cmocka_unit_test(running_out_of_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
