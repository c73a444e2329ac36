#include "evaluate/reduction.h"

#include <math.h>
#include <string.h>

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

static double extreme(const ShvFormulaValue *s, Window window, bool upper)
{
    double found = (double)NAN;
    for (int64_t i = 0; i < s->count; i++)
        if (is_in(s, i, window)) found = upper ? fmax(found, s->values[i]) : fmin(found, s->values[i]);
    return found;
}

static double least(const ShvFormulaValue *s, const double *arguments, int count)
{
    return extreme(s, window_of(arguments, count), false);
}

static double largest(const ShvFormulaValue *s, const double *arguments, int count)
{
    return extreme(s, window_of(arguments, count), true);
}

typedef struct Sums {
    double number, time, value, time_time, time_value, value_value;
} Sums;

static Sums sums_of(const ShvFormulaValue *s, Window window)
{
    Sums sums = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int64_t i = 0; i < s->count; i++) {
        if (!is_in(s, i, window)) continue;
        sums.number += 1.0;
        sums.time += s->times[i];
        sums.value += s->values[i];
        sums.time_time += s->times[i] * s->times[i];
        sums.time_value += s->times[i] * s->values[i];
        sums.value_value += s->values[i] * s->values[i];
    }
    return sums;
}

static double mean(const ShvFormulaValue *s, const double *arguments, int count)
{
    const Sums sums = sums_of(s, window_of(arguments, count));
    return sums.number > 0.0 ? sums.value / sums.number : (double)NAN;
}

static double root_mean_square(const ShvFormulaValue *s, const double *arguments, int count)
{
    const Sums sums = sums_of(s, window_of(arguments, count));
    return sums.number > 0.0 ? sqrt(sums.value_value / sums.number) : (double)NAN;
}

static double slope(const ShvFormulaValue *s, const double *arguments, int count)
{
    const Sums sums = sums_of(s, window_of(arguments, count));
    const double spread = sums.number * sums.time_time - sums.time * sums.time;
    return spread > 0.0 ? (sums.number * sums.time_value - sums.time * sums.value) / spread : (double)NAN;
}

static double integral(const ShvFormulaValue *s, const double *arguments, int count)
{
    const Window window = window_of(arguments, count);
    double sum = 0.0;
    int64_t before = -1;
    for (int64_t i = 0; i < s->count; i++) {
        if (!is_in(s, i, window)) continue;
        if (before >= 0) sum += 0.5 * (s->values[i] + s->values[before]) * (s->times[i] - s->times[before]);
        before = i;
    }
    return before >= 0 ? sum : (double)NAN;
}

static double sum(const ShvFormulaValue *s, const double *arguments, int count)
{
    return sums_of(s, window_of(arguments, count)).value;
}

/* Σ of the rises from value to value, or of the falls. */
static double way_up(const ShvFormulaValue *s, Window window, double sign)
{
    double total = 0.0, before = (double)NAN;
    for (int64_t i = 0; i < s->count; i++) {
        if (!is_in(s, i, window)) continue;
        if (!isnan(before)) total += fmax(0.0, sign * (s->values[i] - before));
        before = s->values[i];
    }
    return isnan(before) ? before : total;
}

static double rise(const ShvFormulaValue *s, const double *arguments, int count)
{
    return way_up(s, window_of(arguments, count), 1.0);
}

static double fall(const ShvFormulaValue *s, const double *arguments, int count)
{
    return way_up(s, window_of(arguments, count), -1.0);
}

/* ---- moments ---- */

static double first(const ShvFormulaValue *s, const double *arguments, int count)
{
    (void)arguments;
    (void)count;
    for (int64_t i = 0; i < s->count; i++)
        if (!isnan(s->values[i])) return s->values[i];
    return (double)NAN;
}

static double last(const ShvFormulaValue *s, const double *arguments, int count)
{
    (void)arguments;
    (void)count;
    for (int64_t i = s->count - 1; i >= 0; i--)
        if (!isnan(s->values[i])) return s->values[i];
    return (double)NAN;
}

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
    if (begin < 0) return (double)NAN;
    return crossing(s, neighbour(s, begin, -1), begin, arguments[0]);
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
    const double level = count == 2 ? arguments[0] : mean(s, NULL, 1);
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

static const ShvReduction measures[] = {{"min", 1, 3, least},
                                        {"max", 1, 3, largest},
                                        {"mean", 1, 3, mean},
                                        {"slope", 1, 3, slope},
                                        {"rms", 1, 3, root_mean_square},
                                        {"integral", 1, 3, integral},
                                        {"sum", 1, 3, sum},
                                        {"rise", 1, 3, rise},
                                        {"fall", 1, 3, fall},
                                        {"first", 1, 1, first},
                                        {"last", 1, 1, last},
                                        {"at", 2, 2, value_at},
                                        {"arrival", 2, 2, arrival},
                                        {"departure", 2, 2, departure},
                                        {"duration", 2, 2, duration},
                                        {"frequency", 1, 2, frequency}};

const ShvReduction *shv_reduction_find(const char *name)
{
    for (size_t i = 0; i < sizeof measures / sizeof measures[0]; i++)
        if (strcmp(measures[i].name, name) == 0) return &measures[i];
    return NULL;
}
