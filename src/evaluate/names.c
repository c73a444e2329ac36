#include "evaluate/names.h"

#include <string.h>

#include "evaluate/crack_surface.h"
#include "evaluate/figures.h"

enum { DEEPEST_FIGURE = 8 };

/* ---- functions of two runs ---- */

double shv_masses_distance(const double *a, int64_t a_count, const double *b, int64_t b_count)
{
    double a_mass = 0.0, b_mass = 0.0, largest = 0.0;
    if (a_count == 0 || b_count == 0) return a_count == b_count ? 0.0 : 1.0;
    for (int64_t i = 0; i < a_count; i++) a_mass += a[i];
    for (int64_t i = 0; i < b_count; i++) b_mass += b[i];
    /* Equal pieces of equal bodies differ by rounding. */
    const double rounding = 1.0 + 1e-9;
    for (int64_t i = 0, k = 0; i < a_count || k < b_count;) {
        const double m = fmin(i < a_count ? a[i] / a_mass : HUGE_VAL, k < b_count ? b[k] / b_mass : HUGE_VAL);
        while (i < a_count && a[i] / a_mass <= m * rounding) i++;
        while (k < b_count && b[k] / b_mass <= m * rounding) k++;
        largest = fmax(largest, fabs((double)i / (double)a_count - (double)k / (double)b_count));
    }
    return largest;
}

/* The failed facets of a run; of no mesh where nothing is known. */
static ShvCrackSurface crack_of(const ShvOutcome *outcome)
{
    const ShvOutcomeList *mesh = shv_outcome_find(outcome, "crack.mesh"),
                         *list = shv_outcome_find(outcome, "crack.facets");
    if (!mesh || mesh->count != 2 || !list) return (ShvCrackSurface){0, NULL, 0};
    return (ShvCrackSurface){(uint64_t)mesh->values[0] << 32 | (uint64_t)mesh->values[1], (const void *)list->values,
                             (int32_t)(list->count / SHV_FACET_NUMBERS)};
}

/* False: there is no such function. */
static bool compare_ends(const char *function, const ShvOutcome *a, const ShvOutcome *b, double *value)
{
    if (strcmp(function, "masses") == 0) {
        const ShvOutcomeList *x = shv_outcome_find(a, "pieces.mass"), *y = shv_outcome_find(b, "pieces.mass");
        *value = x && y ? shv_masses_distance(x->values, x->count, y->values, y->count) : (double)NAN;
        return true;
    }
    const ShvCrackSurface x = crack_of(a), y = crack_of(b);
    if (strcmp(function, "crack_overlap") == 0)
        *value = shv_crack_overlap(&x, &y);
    else if (strcmp(function, "crack_distance") == 0)
        *value = shv_crack_distance(&x, &y).largest;
    else if (strcmp(function, "crack_mean_distance") == 0)
        *value = shv_crack_distance(&x, &y).mean;
    else
        return false;
    return true;
}

static double trajectory_function(ShvNames *names, int index, const ShvOutcome *other)
{
    const ShvOutcome *run = names->run->outcome;
    if (names->followed != run || names->beside != other) {
        const ShvStatus status = shv_trajectory_errors(run, other, names->errors, &names->error);
        if (status != SHV_OK) names->status = status;
        names->followed = run;
        names->beside = other;
    }
    return names->errors[index];
}

static const ShvNamedRun *run_named(const ShvNames *names, const char *name, size_t length)
{
    const ShvNamedRun *run = names->run->before;
    while (run && (strlen(run->name) != length || strncmp(run->name, name, length) != 0)) run = run->before;
    return run;
}

static bool call(void *data, const char *function, const char *name, ShvFormulaValue *value)
{
    static const ShvNamedRun closed_form = {.name = "closed_form"};
    ShvNames *names = data;
    const ShvNamedRun *other = run_named(names, name, strlen(name));
    if (!other && strcmp(name, closed_form.name) == 0) other = &closed_form;
    if (!other) return false;
    *value = (ShvFormulaValue){.number = (double)NAN};
    const int index = shv_trajectory_measure_index(function);
    if (index >= 0) {
        value->number = trajectory_function(names, index, other->outcome);
        return true;
    }
    const ShvOutcome none = {.memory = NULL};
    return compare_ends(function, names->run->outcome, other->outcome ? other->outcome : &none, &value->number);
}

/* ---- names ---- */

static bool find(void *data, const char *name, ShvFormulaValue *value);

/* A figure that a run lacks the numbers for is not a number. */
static bool find_figure(ShvNames *names, const char *name, ShvFormulaValue *value)
{
    const char *formula = shv_figure_formula(name);
    ShvError ignored;
    if (!formula || names->depth >= DEEPEST_FIGURE) return false;
    const ShvFormulaNames own = shv_names(names);
    names->depth++;
    if (shv_formula_evaluate(formula, &own, value, &ignored) != SHV_OK)
        *value = (ShvFormulaValue){.number = (double)NAN};
    names->depth--;
    return true;
}

static bool find_list(const ShvOutcome *outcome, const char *name, ShvFormulaValue *value)
{
    const ShvOutcomeList *list = shv_outcome_find(outcome, name);
    if (!list) return false;
    static const double nothing = 0.0; /* an empty list is a list */
    const double *times = shv_outcome_times(outcome, list);
    *value = (ShvFormulaValue){.series = list->clock != SHV_CLOCK_NONE,
                               .number = list->count > 0 ? list->values[0] : (double)NAN,
                               .times = times,
                               .values = list->count > 0 ? list->values : &nothing,
                               .count = list->count};
    return true;
}

/* "runs.coarse.x": x of that run. */
static bool find_other(ShvNames *names, const char *name, ShvFormulaValue *value)
{
    if (strncmp(name, "runs.", 5) != 0) return false;
    name += 5;
    const size_t length = strcspn(name, ".");
    const ShvNamedRun *other = run_named(names, name, length), *own = names->run;
    if (!other || name[length] != '.') return false;
    if (!other->outcome) {
        *value = (ShvFormulaValue){.number = (double)NAN};
        return true;
    }
    names->run = other;
    const bool found = find(names, name + length + 1, value);
    names->run = own;
    return found;
}

static bool find(void *data, const char *name, ShvFormulaValue *value)
{
    ShvNames *names = data;
    const ShvNamedRun *run = names->run;
    for (const ShvVariable *variable = run->variables; variable; variable = variable->before) {
        if (strcmp(variable->name, name) != 0) continue;
        *value = variable->value;
        return true;
    }
    return find_list(run->outcome, name, value) || find_other(names, name, value) || find_figure(names, name, value);
}

ShvFormulaNames shv_names(ShvNames *names)
{
    return (ShvFormulaNames){.find = find, .call = call, .data = names, .pool = names->pool};
}
