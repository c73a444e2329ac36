/* Numbers from series. */
#ifndef SHV_EVALUATE_MEASURE_H
#define SHV_EVALUATE_MEASURE_H

#include "evaluate/formula.h"

enum { SHV_MOST_ARGUMENTS = 3 };

typedef struct ShvMeasure {
    const char *name;
    int least, most; /* arguments, the series counted */
    /* NaN when the series does not have what is asked for. */
    double (*take)(const ShvFormulaValue *series, const double *arguments, int count);
} ShvMeasure;

/* NULL when there is none of that name. */
const ShvMeasure *shv_measure_find(const char *name);

#endif
