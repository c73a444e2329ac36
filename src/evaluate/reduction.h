/* Numbers from series. */
#ifndef SHV_EVALUATE_REDUCTION_H
#define SHV_EVALUATE_REDUCTION_H

#include "evaluate/formula.h"

enum { SHV_MOST_ARGUMENTS = 3 };

typedef struct ShvReduction {
    const char *name;
    int least, most; /* arguments, the series counted */
    /* NaN when the series does not have what is asked for. */
    double (*take)(const ShvFormulaValue *series, const double *arguments, int count);
} ShvReduction;

/* NULL when there is none of that name. */
const ShvReduction *shv_reduction_find(const char *name);

#endif
