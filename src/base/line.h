/* The line through points, by least squares. */
#ifndef SHV_BASE_LINE_H
#define SHV_BASE_LINE_H

#include <math.h>

/* Starts from zeros. */
typedef struct ShvLine {
    double number, x, y, xx, xy; /* sums over the points */
} ShvLine;

static inline void shv_line_add(ShvLine *line, double x, double y)
{
    line->number += 1.0;
    line->x += x;
    line->y += y;
    line->xx += x * x;
    line->xy += x * y;
}

/* NaN of points at one x. */
static inline double shv_line_slope(const ShvLine *line)
{
    const double spread = line->number * line->xx - line->x * line->x;
    return spread > 0.0 ? (line->number * line->xy - line->x * line->y) / spread : (double)NAN;
}

#endif
