/* Numbers from series. */
#ifndef SHV_EVALUATE_REDUCTION_H
#define SHV_EVALUATE_REDUCTION_H

#include "evaluate/formula.h"

enum { SHV_MOST_ARGUMENTS = 3 };

typedef struct ShvReduction {
    const char *name;
    int least, most; /* arguments, the series counted */
    size_t part;     /* of what sums up a window, unless `take` is given */
    double (*take)(const ShvFormulaValue *series, const double *arguments, int count);
} ShvReduction;

/* NULL when there is none of that name. */
const ShvReduction *shv_reduction_find(const char *name);
/* NaN when the series does not have what is asked for. */
double shv_reduction_take(const ShvReduction *reduction, const ShvFormulaValue *series, const double *arguments,
                          int count);

#endif
