#include "evaluate/formula.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/text.h"

enum { LONGEST_NAME = 128, DEEPEST = 64 };

typedef struct Parser {
    const char *text, *at;
    const ShvFormulaNames *names;
    ShvError *error;
    int depth;
} Parser;

static ShvStatus parse_sum(Parser *parser, ShvFormulaValue *value);

static ShvStatus fail(Parser *parser, const char *what)
{
    return shv_fail(parser->error, SHV_BAD_INPUT, "formula '%.200s', character %d: %s", parser->text,
                    (int)(parser->at - parser->text) + 1, what);
}

static void skip_spaces(Parser *parser)
{
    while (isspace((unsigned char)*parser->at)) parser->at++;
}

static bool take(Parser *parser, char wanted)
{
    skip_spaces(parser);
    if (*parser->at != wanted) return false;
    parser->at++;
    return true;
}

/* ---- operations ---- */

static double combine(char operation, double a, double b)
{
    switch (operation) {
    case '+':
        return a + b;
    case '-':
        return a - b;
    case '*':
        return a * b;
    case '/':
        return a / b;
    default:
        return pow(a, b);
    }
}

static double entry(const ShvFormulaValue *value, int64_t i)
{
    return value->series ? value->values[i] : value->number;
}

static ShvStatus operate(Parser *parser, char operation, ShvFormulaValue *a, const ShvFormulaValue *b)
{
    if (!a->series && !b->series) {
        a->number = combine(operation, a->number, b->number);
        return SHV_OK;
    }
    if (a->series && b->series && a->times != b->times)
        return fail(parser, "the two series have different times; reduce one to a number first");
    const ShvFormulaValue clock = a->series ? *a : *b;
    double *values = shv_pool_take(parser->names->pool, (size_t)clock.count, sizeof *values);
    if (!values) return shv_fail_memory(parser->error, "a series", (size_t)clock.count * sizeof *values);
    for (int64_t i = 0; i < clock.count; i++) values[i] = combine(operation, entry(a, i), entry(b, i));
    *a = clock;
    a->values = values;
    return SHV_OK;
}

/* Part of a whole that may be nothing: 0 of nothing is 0. */
static double over(double part, double whole)
{
    return part == 0.0 ? 0.0 : whole != 0.0 ? part / whole : (double)NAN;
}

static double share(double value, double reference)
{
    return over(fabs(value - reference), fabs(reference));
}

static double nonzero(double value, double otherwise)
{
    return fabs(value) > 0.0 ? value : otherwise;
}

/* Of one number or of two. */
static const struct {
    const char *name;
    double (*of)(double);
    double (*of_two)(double, double);
} functions[] = {{"sqrt", sqrt, NULL}, {"abs", fabs, NULL},    {"exp", exp, NULL},     {"log", log, NULL},
                 {"sin", sin, NULL},   {"cos", cos, NULL},     {"tan", tan, NULL},     {"sinh", sinh, NULL},
                 {"cosh", cosh, NULL}, {"asinh", asinh, NULL}, {"atan", atan, NULL},   {"min", NULL, fmin},
                 {"max", NULL, fmax},  {"over", NULL, over},   {"share", NULL, share}, {"nonzero", NULL, nonzero}};

static ShvStatus apply(Parser *parser, double (*of)(double), ShvFormulaValue *value)
{
    if (!value->series) {
        value->number = of(value->number);
        return SHV_OK;
    }
    double *values = shv_pool_take(parser->names->pool, (size_t)value->count, sizeof *values);
    if (!values) return shv_fail_memory(parser->error, "a series", (size_t)value->count * sizeof *values);
    for (int64_t i = 0; i < value->count; i++) values[i] = of(value->values[i]);
    value->values = values;
    return SHV_OK;
}

/* ---- calls ---- */

static ShvStatus parse_arguments(Parser *parser, ShvFormulaValue *arguments, int *count)
{
    *count = 0;
    do {
        if (*count == SHV_MOST_ARGUMENTS) return fail(parser, "too many arguments");
        SHV_TRY(parse_sum(parser, &arguments[(*count)++]));
    } while (take(parser, ','));
    return take(parser, ')') ? SHV_OK : fail(parser, "expected ',' or ')'");
}

static ShvStatus measure(Parser *parser, const ShvReduction *found, const ShvFormulaValue *arguments, int count,
                         ShvFormulaValue *value)
{
    double numbers[SHV_MOST_ARGUMENTS];
    if (found->of_list ? arguments[0].series || !arguments[0].values : !arguments[0].series)
        return fail(parser, found->of_list ? "this function needs a list as its first argument, such as crack.opened"
                                           : "this function needs a series as its first argument");
    if (count < found->least || count > found->most || (found->most == 3 && count == 2))
        return fail(parser, "the number of arguments is wrong");
    for (int i = 1; i < count; i++) {
        if (arguments[i].series) return fail(parser, "only the first argument can be a series");
        numbers[i - 1] = arguments[i].number;
    }
    *value = (ShvFormulaValue){.number = shv_reduction_take(found, &arguments[0], numbers, count)};
    return SHV_OK;
}

/* min and max of two numbers are functions, of a series they reduce it. */
static ShvStatus parse_call(Parser *parser, const char *name, ShvFormulaValue *value)
{
    ShvFormulaValue arguments[SHV_MOST_ARGUMENTS];
    int count;
    SHV_TRY(parse_arguments(parser, arguments, &count));
    const bool two = count == 2 && !arguments[0].series && !arguments[1].series;
    const ShvReduction *reduction = shv_reduction_find(name);
    for (size_t i = 0; i < sizeof functions / sizeof functions[0]; i++) {
        if (strcmp(functions[i].name, name) != 0 || (functions[i].of_two && !two)) continue;
        *value = arguments[0];
        if (functions[i].of && count != 1) return fail(parser, "this function takes one argument");
        if (functions[i].of) return apply(parser, functions[i].of, value);
        value->number = functions[i].of_two(arguments[0].number, arguments[1].number);
        return SHV_OK;
    }
    if (reduction) return measure(parser, reduction, arguments, count, value);
    return shv_fail(parser->error, SHV_BAD_INPUT, "formula '%.200s': there is no function '%s'", parser->text, name);
}

/* ---- grammar ---- */

/* A function of a run, whose name is all that stands in the parentheses. */
static bool of_run(Parser *parser, const char *function, ShvFormulaValue *value)
{
    char name[LONGEST_NAME];
    const char *start = parser->at + strspn(parser->at, " ");
    size_t length = 0;
    while (isalnum((unsigned char)start[length]) || start[length] == '_') length++;
    if (!parser->names->call || length == 0 || length >= sizeof name || start[length] != ')') return false;
    memcpy(name, start, length);
    name[length] = '\0';
    if (!parser->names->call(parser->names->data, function, name, value)) return false;
    parser->at = start + length + 1;
    return true;
}

static ShvStatus parse_name(Parser *parser, ShvFormulaValue *value)
{
    char name[LONGEST_NAME];
    size_t length = 0;
    while (isalnum((unsigned char)*parser->at) || *parser->at == '_' || *parser->at == '.') {
        if (length + 1 == sizeof name) return fail(parser, "the name is too long");
        name[length++] = *parser->at++;
    }
    name[length] = '\0';
    if (take(parser, '(')) return of_run(parser, name, value) ? SHV_OK : parse_call(parser, name, value);
    if (strcmp(name, "pi") == 0) {
        *value = (ShvFormulaValue){.number = SHV_PI};
        return SHV_OK;
    }
    if (parser->names->find(parser->names->data, name, value)) return SHV_OK;
    return shv_fail(parser->error, SHV_BAD_INPUT, "formula '%.200s': '%s' is unknown", parser->text, name);
}

static ShvStatus parse_number(Parser *parser, ShvFormulaValue *value)
{
    char *end;
    *value = (ShvFormulaValue){.number = shv_text_to_double(parser->at, &end)};
    if (end == parser->at) return fail(parser, "expected a number");
    parser->at = end;
    return SHV_OK;
}

static ShvStatus parse_primary(Parser *parser, ShvFormulaValue *value)
{
    if (take(parser, '(')) {
        SHV_TRY(parse_sum(parser, value));
        return take(parser, ')') ? SHV_OK : fail(parser, "expected ')'");
    }
    const unsigned char c = (unsigned char)*parser->at;
    if (isdigit(c) || c == '.') return parse_number(parser, value);
    if (isalpha(c) || c == '_') return parse_name(parser, value);
    return fail(parser, c ? "expected a number, a name or '('" : "something is missing at the end");
}

static ShvStatus parse_sign(Parser *parser, ShvFormulaValue *value);

/* To the right, and stronger than a sign before it: −2^2 = −4. */
static ShvStatus parse_power(Parser *parser, ShvFormulaValue *value)
{
    SHV_TRY(parse_primary(parser, value));
    if (!take(parser, '^')) return SHV_OK;
    ShvFormulaValue exponent;
    SHV_TRY(parse_sign(parser, &exponent));
    return operate(parser, '^', value, &exponent);
}

/* Every way down leads through here, by parentheses, calls and exponents alike: the depth is counted here. */
static ShvStatus parse_sign(Parser *parser, ShvFormulaValue *value)
{
    if (++parser->depth > DEEPEST) return fail(parser, "too many parentheses or powers within each other");
    bool minus = false;
    while (true) {
        if (take(parser, '-'))
            minus = !minus;
        else if (!take(parser, '+'))
            break;
    }
    SHV_TRY(parse_power(parser, value));
    parser->depth--;
    const ShvFormulaValue less = {.number = -1.0};
    return minus ? operate(parser, '*', value, &less) : SHV_OK;
}

/* Sums of products, from the left: `signs` are the two operations of this level. */
static ShvStatus parse_terms(Parser *parser, const char *signs, ShvFormulaValue *value)
{
    const bool sum = signs[0] == '+';
    SHV_TRY(sum ? parse_terms(parser, "*/", value) : parse_sign(parser, value));
    while (true) {
        const char operation = take(parser, signs[0]) ? signs[0] : take(parser, signs[1]) ? signs[1] : '\0';
        if (!operation) return SHV_OK;
        ShvFormulaValue other;
        SHV_TRY(sum ? parse_terms(parser, "*/", &other) : parse_sign(parser, &other));
        SHV_TRY(operate(parser, operation, value, &other));
    }
}

static ShvStatus parse_sum(Parser *parser, ShvFormulaValue *value)
{
    return parse_terms(parser, "+-", value);
}

ShvStatus shv_formula_evaluate(const char *text, const ShvFormulaNames *names, ShvFormulaValue *value, ShvError *error)
{
    Parser parser = {text, text, names, error, 0};
    SHV_TRY(parse_sum(&parser, value));
    skip_spaces(&parser);
    return *parser.at ? fail(&parser, "expected an operator or the end") : SHV_OK;
}

ShvStatus shv_formula_number(const char *text, const ShvFormulaNames *names, double *number, ShvError *error)
{
    ShvFormulaValue value;
    SHV_TRY(shv_formula_evaluate(text, names, &value, error));
    if (value.series)
        return shv_fail(error, SHV_BAD_INPUT, "formula '%.200s' gives a series; take a number of it, such as max(…)",
                        text);
    *number = value.number;
    return SHV_OK;
}
