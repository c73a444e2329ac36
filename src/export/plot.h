/* A small plot as SVG: axes with ticks, lines with markers, labels at points, a legend. */
#ifndef SHV_EXPORT_PLOT_H
#define SHV_EXPORT_PLOT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct ShvPlotPoint {
    double x, y;
    char label[24]; /* "": none */
} ShvPlotPoint;

typedef enum ShvPlotStyle { SHV_PLOT_MARKED_LINE, SHV_PLOT_MARKERS, SHV_PLOT_PLAIN_LINE } ShvPlotStyle;

typedef struct ShvPlotLine {
    const char *name;
    const ShvPlotPoint *points;
    int32_t count;
    ShvPlotStyle style;
} ShvPlotLine;

/* Lines that are being put together: each point joins the last line. The caller has the room. */
typedef struct ShvPlotDraft {
    ShvPlotPoint *points;
    ShvPlotLine *lines;
    int32_t point_count, line_count;
} ShvPlotDraft;
void shv_plot_line(ShvPlotDraft *draft, const char *name, ShvPlotStyle style);
void shv_plot_point(ShvPlotDraft *draft, ShvPlotPoint point);
/* At the end of the line of that name, in whatever order lines get their points; a marked line where there is none yet. Returns the
   line's index. */
int32_t shv_plot_add(ShvPlotDraft *draft, const char *name, ShvPlotPoint point);

/* From `low` to `high` at x, in the colour of a line: what lies around a point. */
typedef struct ShvPlotSpan {
    double x, low, high;
    int32_t line;
} ShvPlotSpan;

typedef struct ShvPlot {
    const char *title, *x_label, *y_label;
    bool log_x, log_y;
    const ShvPlotLine *lines;
    int32_t line_count;       /* colours, dashes and markers repeat after six */
    const ShvPlotLine *front; /* dashed, with a ring around each point; NULL: none */
    const ShvPlotSpan *spans; /* vertical bars */
    int32_t span_count;
} ShvPlot;

/* Writes the whole document, or a figure `within` a page of HTML. Points that are not finite, or not positive on a logarithmic axis, are left out; the lines skip
   them. Errors of writing are the stream's. */
void shv_plot_write(FILE *stream, const ShvPlot *plot, bool within);

/* Bars that lie below each other, each of parts in colours of their own, and their sum behind it. */
enum { SHV_PLOT_BAR_NAME = 64 };
typedef struct ShvPlotBars {
    const char *title, *unit;
    const char *const *parts;
    int32_t part_count, count; /* colours of parts repeat after ten */
    /* The parts of a bar, and its name. */
    const double *(*bar)(const void *data, int32_t index, char name[SHV_PLOT_BAR_NAME]);
    const void *data;
} ShvPlotBars;
void shv_plot_bars(FILE *stream, const ShvPlotBars *bars, bool within);

/* A text within XML or HTML: escaped, its control characters made spaces. */
void shv_html_text(FILE *stream, const char *text);

typedef struct ShvPlotAxis {
    double low, high; /* of the data, widened to whole ticks; decimal exponents when `log` */
    double tick;      /* between labels */
    bool log;
} ShvPlotAxis;
/* An axis around values from `low` to `high` (low > high: no values): steps of 1, 2 or 5 times a power of ten, at most eight of
   them, and whole decades on a logarithmic axis. */
ShvPlotAxis shv_plot_axis(double low, double high, bool log);

#endif
