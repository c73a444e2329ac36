#include "check.h"

#include "evaluate/formula.h"

/* A wave of period 1 about 3, sampled 64 times a period over four of them, its fifth sample lost; and a ramp on another clock. */
enum { SAMPLES = 257, RAMP = 3 };
static double wave_times[SAMPLES], wave[SAMPLES];
static const double ramp_times[RAMP] = {0.0, 1.0, 2.0}, ramp[RAMP] = {-1.0, 1.0, -1.0};

static bool find(void *data, const char *name, ShvFormulaValue *value)
{
    (void)data;
    if (strcmp(name, "wave") == 0)
        *value = (ShvFormulaValue){.series = true, .times = wave_times, .values = wave, .count = SAMPLES};
    else if (strcmp(name, "ramp") == 0)
        *value = (ShvFormulaValue){.series = true, .times = ramp_times, .values = ramp, .count = RAMP};
    else if (strcmp(name, "steel.size.x") == 0)
        *value = (ShvFormulaValue){.number = 7.0};
    else
        return false;
    return true;
}

static ShvStatus evaluate(const char *text, double *number, ShvError *error)
{
    ShvPool pool = {.memory = NULL};
    const ShvFormulaNames names = {.find = find, .pool = &pool};
    const ShvStatus status = shv_formula_number(text, &names, number, error);
    shv_pool_release(&pool);
    return status;
}

static double number_of(const char *text)
{
    double number = 0.0;
    ShvError error = {SHV_OK, ""};
    check_ok(evaluate(text, &number, &error), error);
    return number;
}

static void test_arithmetic(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } cases[] = {{"1 + 2 * 3", 7.0},
                 {"(1 + 2) * 3", 9.0},
                 {"2 ^ 3 ^ 2", 512.0},
                 {"-2 ^ 2", -4.0},
                 {"2 ^ -1", 0.5},
                 {"7 - 2 - 1", 4.0},
                 {"8 / 4 / 2", 1.0},
                 {" - - 3", 3.0},
                 {"1e-3 * 2.5e3", 2.5},
                 {"steel.size.x / 2", 3.5},
                 {"sqrt(abs(-16))", 4.0},
                 {"max(2, 3) - min(2, 3)", 1.0},
                 {"asinh(sinh(0.7))", 0.7},
                 {"tan(atan(0.7))", 0.7},
                 {"log(exp(2)) + cos(0) + sin(0) + tan(0) + cosh(0)", 4.0},
                 {"4 * pi", 12.566370614359172}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_near(number_of(cases[i].text), cases[i].value, 1e-15);
}

static void test_measures(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value, tolerance;
    } cases[] = {{"max(wave)", 5.0, 1e-12},
                 {"min(wave, 0, 0.5)", 3.0, 1e-12},
                 {"mean(wave, 1, 2 - 1/128)", 3.0, 1e-12},
                 {"rms(wave - 3) ^ 2", 2.0, 0.01},
                 {"integral(wave, 2, 3)", 3.0, 1e-12},
                 {"frequency(wave, 3)", 1.0, 1e-12},
                 {"frequency(2 * wave)", 1.0, 1e-2},
                 {"first(wave)", 3.0, 0.0},
                 {"last(wave)", 3.0, 1e-12},
                 {"at(wave, 4/64)", 3.0 + 2.0 * 0.5 * (0.2902846772544623 + 0.4713967368259976), 1e-12},
                 {"at(ramp, 0.25)", -0.5, 1e-15},
                 {"arrival(ramp, 0)", 0.5, 1e-15},
                 {"departure(ramp, 0)", 1.5, 1e-15},
                 {"duration(ramp, 0)", 1.0, 1e-15},
                 {"duration(-ramp, 0.5)", 0.5 * 3.0, 1e-15},
                 {"slope(ramp, 0, 1)", 2.0, 1e-15},
                 {"max(abs(ramp) * ramp / 2)", 0.5, 0.0},
                 {"max(ramp, -1, 0.5)", -1.0, 0.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_near(number_of(cases[i].text), cases[i].value, cases[i].tolerance);
    static const char *const nothing[] = {"at(ramp, 3)",      "arrival(ramp, 7)",   "departure(ramp, -7)",
                                          "mean(ramp, 5, 6)", "frequency(ramp, 0)", "slope(ramp, 0, 0.5)",
                                          "max(ramp, 5, 6)"};
    for (size_t i = 0; i < sizeof nothing / sizeof *nothing; i++) assert_true(isnan(number_of(nothing[i])));
}

static void test_faults(void **state)
{
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {{"", "character 1: something is missing at the end"},
                 {"1 +", "something is missing at the end"},
                 {"1 2", "character 3: expected an operator or the end"},
                 {"(1", "expected ')'"},
                 {"* 2", "expected a number, a name or '('"},
                 {"max(1, 2", "expected ',' or ')'"},
                 {"glass", "'glass' is unknown"},
                 {"cube(3)", "there is no function 'cube'"},
                 {"wave", "gives a series; take a number of it"},
                 {"max(wave + ramp)", "different times"},
                 {"mean(3)", "needs a series as its first argument"},
                 {"mean(wave, 1)", "the number of arguments is wrong"},
                 {"at(wave, ramp)", "only the first argument can be a series"},
                 {"at(wave, 1, 2, 3)", "too many arguments"},
                 {"sqrt(1, 2)", "takes one argument"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double number;
        ShvError error = {SHV_OK, ""};
        check_fails(evaluate(cases[i].text, &number, &error), SHV_BAD_INPUT, error, cases[i].part);
    }
}

/* Whatever leads further down: it ends with a message long before the stack does. */
static void test_depth(void **state)
{
    (void)state;
    static const char *const ways[] = {"(", "2^", "2^-", "sqrt(", "1+(", "-("};
    enum { TIMES = 30000 };
    static char deep[TIMES * 8];
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        char *end = deep;
        for (int k = 0; k < TIMES; k++) end += sprintf(end, "%s", ways[i]);
        strcpy(end, "1");
        double number;
        ShvError error = {SHV_OK, ""};
        check_fails(evaluate(deep, &number, &error), SHV_BAD_INPUT, error, "within each other");
    }
    double number;
    ShvError error = {SHV_OK, ""};
    char *end = deep;
    for (int k = 0; k < TIMES; k++) end += sprintf(end, "-+1%s", k + 1 < TIMES ? "+" : "");
    check_ok(evaluate(deep, &number, &error), error);
    assert_true(number == -TIMES); /* signs and sums go on as long as they like */
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_arithmetic), cmocka_unit_test(test_measures),
                                       cmocka_unit_test(test_faults), cmocka_unit_test(test_depth)};
    for (int i = 0; i < SAMPLES; i++) {
        wave_times[i] = i / 64.0;
        wave[i] = i == 4 ? (double)NAN : 3.0 + 2.0 * sin(2.0 * 3.14159265358979323846 * wave_times[i]);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
