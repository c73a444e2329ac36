/* What names stand for in formulas: variables, what is kept of a run, its figures, other runs, and functions of two runs. */
#ifndef SHV_EVALUATE_NAMES_H
#define SHV_EVALUATE_NAMES_H

#include "evaluate/formula.h"
#include "evaluate/trajectory.h"

typedef struct ShvVariable {
    const char *name;
    ShvFormulaValue value;
    struct ShvVariable *before;
} ShvVariable;

typedef struct ShvNamedRun {
    const char *name;
    const ShvOutcome *outcome;        /* NULL: the closed form */
    ShvVariable *variables;           /* the last one defined */
    const struct ShvNamedRun *before; /* another run, for runs.NAME.x and f(NAME) */
} ShvNamedRun;

typedef struct ShvNames {
    ShvPool *pool;              /* of intermediate series */
    const ShvNamedRun *run;     /* what names are of; the most recent of variables of one name counts */
    ShvStatus status;           /* of what a function needed and could not do; */
    ShvError error;             /* why */
    int32_t depth;              /* of figures within figures */
    const ShvOutcome *followed; /* whose errors these are, from `beside` */
    const ShvOutcome *beside;
    double errors[SHV_TRAJECTORY_MEASURES];
} ShvNames;

/* For shv_formula_number and shv_formula_evaluate. After them names->status tells whether a function failed. */
ShvFormulaNames shv_names(ShvNames *names);

/* Kolmogorov and Smirnov: largest difference of the shares of pieces that are lighter than m, over all m, where m is in shares
   of all mass; masses ascending. 1 where one has no pieces, 0 where both have none. */
double shv_masses_distance(const double *a, int64_t a_count, const double *b, int64_t b_count);

#endif
