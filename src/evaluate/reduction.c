#include "evaluate/formula.h"

#include <math.h>
#include <string.h>

#include "base/line.h"
#include "evaluate/crack_surface.h"

/* ---- windows ---- */

typedef struct Window {
    double from, to;
} Window;

static Window window_of(const double *arguments, int count)
{
    return count == 3 ? (Window){arguments[0], arguments[1]} : (Window){-HUGE_VAL, HUGE_VAL};
}

static bool is_in(const ShvFormulaValue *s, int64_t i, Window window)
{
    return !isnan(s->values[i]) && s->times[i] >= window.from && s->times[i] <= window.to;
}

/* Of the values in a window: NaN where there is nothing to take it from. */
typedef struct Summary {
    double least, largest, mean, root_mean_square, slope, integral, sum, rise, fall, first, last;
} Summary;

static void add(Summary *summary, ShvLine *line, double time, double value, double since)
{
    const double change = value - summary->last;
    if (line->number == 0.0) {
        summary->first = value;
        summary->integral = summary->rise = summary->fall = 0.0;
    } else {
        summary->integral += 0.5 * (value + summary->last) * since;
        summary->rise += fmax(0.0, change);
        summary->fall += fmax(0.0, -change);
    }
    summary->least = fmin(summary->least, value);
    summary->largest = fmax(summary->largest, value);
    summary->last = value;
    shv_line_add(line, time, value);
}

static Summary summarise(const ShvFormulaValue *s, Window window)
{
    const double none = (double)NAN;
    Summary summary = {none, none, none, none, none, none, 0.0, none, none, none, none};
    ShvLine line = {0.0, 0.0, 0.0, 0.0, 0.0};
    double before = 0.0, squares = 0.0;
    for (int64_t i = 0; i < s->count; i++) {
        if (!is_in(s, i, window)) continue;
        add(&summary, &line, s->times[i], s->values[i], s->times[i] - before);
        squares += s->values[i] * s->values[i];
        before = s->times[i];
    }
    summary.sum = line.y;
    summary.slope = shv_line_slope(&line);
    if (line.number == 0.0) return summary;
    summary.mean = line.y / line.number;
    summary.root_mean_square = sqrt(squares / line.number);
    return summary;
}

/* ---- moments ---- */

/* Time at which the line between two samples meets a level. */
static double crossing(const ShvFormulaValue *s, int64_t before, int64_t after, double level)
{
    const double rise = s->values[after] - s->values[before];
    const double share = rise != 0.0 ? (level - s->values[before]) / rise : 0.0;
    return s->times[before] + share * (s->times[after] - s->times[before]);
}

static double value_at(const ShvFormulaValue *s, const double *arguments, int count)
{
    (void)count;
    int64_t before = -1;
    for (int64_t i = 0; i < s->count; i++) {
        if (isnan(s->values[i])) continue;
        if (s->times[i] == arguments[0]) return s->values[i];
        if (s->times[i] > arguments[0]) {
            if (before < 0) return (double)NAN;
            const double share = (arguments[0] - s->times[before]) / (s->times[i] - s->times[before]);
            return s->values[before] + share * (s->values[i] - s->values[before]);
        }
        before = i;
    }
    return (double)NAN;
}

/* +1 above the level, −1 below it, 0 on it. */
static int side(double value, double level)
{
    return (value > level) - (value < level);
}

/* First and last known sample off the side on which the series begins; −1 where it never leaves it. */
static void find_stay(const ShvFormulaValue *s, double level, int64_t *begin, int64_t *end)
{
    int start = 2;
    *begin = *end = -1;
    for (int64_t i = 0; i < s->count; i++) {
        if (isnan(s->values[i])) continue;
        const int now = side(s->values[i], level);
        if (start == 2) start = now;
        if (now == start || now == 0) continue;
        if (*begin < 0) *begin = i;
        *end = i;
    }
}

static int64_t neighbour(const ShvFormulaValue *s, int64_t i, int64_t by)
{
    for (i += by; i >= 0 && i < s->count; i += by)
        if (!isnan(s->values[i])) return i;
    return -1;
}

static double arrival(const ShvFormulaValue *s, const double *arguments, int count)
{
    (void)count;
    int64_t begin, end;
    find_stay(s, arguments[0], &begin, &end);
    return begin < 0 ? (double)NAN : crossing(s, neighbour(s, begin, -1), begin, arguments[0]);
}

static double departure(const ShvFormulaValue *s, const double *arguments, int count)
{
    (void)count;
    int64_t begin, end;
    find_stay(s, arguments[0], &begin, &end);
    const int64_t after = end < 0 ? -1 : neighbour(s, end, 1);
    return after < 0 ? (double)NAN : crossing(s, end, after, arguments[0]);
}

static double duration(const ShvFormulaValue *s, const double *arguments, int count)
{
    return departure(s, arguments, count) - arrival(s, arguments, count);
}

static double frequency(const ShvFormulaValue *s, const double *arguments, int count)
{
    const double level = count == 2 ? arguments[0] : summarise(s, window_of(NULL, 1)).mean;
    double begin = (double)NAN, end = (double)NAN;
    int64_t crossings = 0, before = -1;
    for (int64_t i = 0; i < s->count; i++) {
        if (isnan(s->values[i])) continue;
        if (before >= 0 && s->values[before] < level && s->values[i] >= level) {
            end = crossing(s, before, i, level);
            if (crossings++ == 0) begin = end;
        }
        before = i;
    }
    return crossings > 1 ? (double)(crossings - 1) / (end - begin) : (double)NAN;
}

static double arms(const ShvFormulaValue *facets, const double *arguments, int count)
{
    (void)count;
    return shv_crack_arms((const void *)facets->values, facets->count / 9, arguments[0], arguments[1]);
}

#define PART(member) offsetof(Summary, member), NULL, false
static const ShvReduction reductions[] = {{"min", 1, 3, PART(least)},
                                          {"max", 1, 3, PART(largest)},
                                          {"mean", 1, 3, PART(mean)},
                                          {"slope", 1, 3, PART(slope)},
                                          {"rms", 1, 3, PART(root_mean_square)},
                                          {"integral", 1, 3, PART(integral)},
                                          {"sum", 1, 3, PART(sum)},
                                          {"rise", 1, 3, PART(rise)},
                                          {"fall", 1, 3, PART(fall)},
                                          {"first", 1, 1, PART(first)},
                                          {"last", 1, 1, PART(last)},
                                          {"at", 2, 2, 0, value_at, false},
                                          {"arrival", 2, 2, 0, arrival, false},
                                          {"departure", 2, 2, 0, departure, false},
                                          {"duration", 2, 2, 0, duration, false},
                                          {"frequency", 1, 2, 0, frequency, false},
                                          {"arms", 3, 3, 0, arms, true}};

const ShvReduction *shv_reduction_find(const char *name)
{
    for (size_t i = 0; i < sizeof reductions / sizeof reductions[0]; i++)
        if (strcmp(reductions[i].name, name) == 0) return &reductions[i];
    return NULL;
}

double shv_reduction_take(const ShvReduction *reduction, const ShvFormulaValue *series, const double *arguments,
                          int count)
{
    if (reduction->take) return reduction->take(series, arguments, count);
    const Summary summary = summarise(series, window_of(arguments, count));
    double number;
    memcpy(&number, (const char *)&summary + reduction->part, sizeof number);
    return number;
}
