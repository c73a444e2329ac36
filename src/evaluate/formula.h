/* Formulas of verification cases: numbers, names, + - * / ^, parentheses and functions, over numbers and over series in time.

   A name is looked up by whoever evaluates; `pi` is known here. Operators and functions of one number act on series value by
   value; two series in one operation must have the same times. Values that are NaN count as not recorded.
     sqrt abs exp log sin cos tan sinh cosh asinh atan
     min(a, b) max(a, b)            of two numbers
     over(a, b) share(a, b)         a / b and |a − b| / |b|, where 0 of 0 is 0
     nonzero(a, b)                  a, or b where a is 0 or not a number
     min max mean rms slope integral sum rise fall (s [, from, to])
                                    slope: least squares, 1/s; integral: trapezia; rise, fall: Σ of changes up, down
     first last (s)  at(s, time)
     arrival departure duration (s, level)   first and last time on the other side of `level` than the first value or, where that
                                             is the level itself, off it; duration: departure − arrival; linear in between
     frequency(s [, level])         1/s: mean of the periods between upward crossings of `level` (unless given, the mean)
     arms(crack.opened, radius, gap) directions in which a star of cracks about the z axis crosses a circle (crack_surface.h) */
#ifndef SHV_EVALUATE_FORMULA_H
#define SHV_EVALUATE_FORMULA_H

#include "scene/pool.h"

typedef struct ShvFormulaValue {
    bool series;
    double number;        /* not of a series */
    const double *times;  /* s, not decreasing; the same block: the same clock */
    const double *values; /* per time; also of a list that is no series */
    int64_t count;
} ShvFormulaValue;

typedef struct ShvFormulaNames {
    /* False when there is no such name. */
    bool (*find)(void *data, const char *name, ShvFormulaValue *value);
    /* A function of a run by name, as in crack_distance(fine); false when there is no such function or run. May be NULL. */
    bool (*call)(void *data, const char *function, const char *run, ShvFormulaValue *value);
    void *data;
    ShvPool *pool; /* of intermediate series */
} ShvFormulaNames;

/* SHV_BAD_INPUT with the place and what was expected. */
ShvStatus shv_formula_evaluate(const char *text, const ShvFormulaNames *names, ShvFormulaValue *value, ShvError *error);
/* The same where a number is needed. */
ShvStatus shv_formula_number(const char *text, const ShvFormulaNames *names, double *number, ShvError *error);

/* reduction.c: numbers from series and lists. */
enum { SHV_MOST_ARGUMENTS = 3 };

typedef struct ShvReduction {
    const char *name;
    int least, most; /* arguments, the series counted */
    size_t part;     /* of what sums up a window, unless `take` is given */
    double (*take)(const ShvFormulaValue *series, const double *arguments, int count);
    bool of_list; /* and not of a series */
} ShvReduction;

/* NULL when there is none of that name. */
const ShvReduction *shv_reduction_find(const char *name);
/* NaN when the series does not have what is asked for. */
double shv_reduction_take(const ShvReduction *reduction, const ShvFormulaValue *series, const double *arguments,
                          int count);

#endif
