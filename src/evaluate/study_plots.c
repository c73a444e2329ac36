/* Figures of a study. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"

/* ---- error against run time ---- */

/* A figure as it is put together, in the study's room. */
typedef struct Figure {
    const ShvStudy *study;
    int32_t measure;
    ShvStudyFigure room;
    int32_t front_count, span_count;
    double least; /* an error of zero has a place here, below all others */
} Figure;

static double least_error(const ShvStudy *study, int32_t measure)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        if (shv_study_counts(row, measure) && row->errors[measure] > 0.0) least = fmin(least, row->errors[measure]);
    }
    return isfinite(least) ? 0.1 * least : 1e-16;
}

static ShvPlotPoint point_of(const Figure *figure, const ShvStudyRow *row)
{
    const double error = row->errors[figure->measure];
    ShvPlotPoint point = {.x = shv_study_counts(row, figure->measure) ? row->seconds : (double)NAN,
                          .y = fmax(error, figure->least)};
    shv_format(point.label, sizeof point.label, "%.18s%s", row->label, error <= figure->least ? " (0)" : "");
    return point;
}

/* A row on the line of its series. */
static void add_row(Figure *figure, const ShvStudyRow *row)
{
    ShvPlotDraft *draft = &figure->room.draft;
    const int32_t measure = figure->measure;
    int32_t line = 0;
    if (row->is_reference) return;
    shv_plot_add(draft, row->series, point_of(figure, row));
    while (strcmp(draft->lines[line].name, row->series) != 0) line++;
    if (figure->study->plan.members > 1 && shv_study_counts(row, measure))
        figure->room.spans[figure->span_count++] =
            (ShvPlotSpan){row->seconds, fmax(row->errors_low[measure], figure->least), row->errors_high[measure], line};
}

/* By run time; there are few of them. */
static void add_to_front(Figure *figure, const ShvStudyRow *row)
{
    ShvPlotPoint *front = figure->room.front;
    int32_t k = figure->front_count++;
    for (; k > 0 && front[k - 1].x > row->seconds; k--) front[k] = front[k - 1];
    front[k] = point_of(figure, row);
}

void shv_study_put_error_plot(const ShvStudy *study, int32_t measure, FILE *stream, bool within)
{
    const ShvMeasure *kind = &study->plan.measures[measure];
    Figure figure = {study, measure, study->figure, 0, 0, least_error(study, measure)};
    char title[200], label[96];
    for (int32_t i = 0; i < study->setting_count; i++) {
        add_row(&figure, &study->rows[i]);
        if (study->rows[i].on_front[measure]) add_to_front(&figure, &study->rows[i]);
    }
    shv_format(title, sizeof title, "%.120s: %s", study->plan.name, kind->name);
    shv_format(label, sizeof label, "error of %s%s%s", kind->name, kind->error_unit[0] ? ", " : "", kind->error_unit);
    const ShvPlotLine front = {"Pareto front", figure.room.front, figure.front_count, SHV_PLOT_MARKED_LINE};
    const ShvPlot plot = {.title = title,
                          .x_label = study->view.timings_valid ? "run time, s"
                                                               : "run time, s (invalid: runs shared the machine)",
                          .y_label = label,
                          .log_x = true,
                          .log_y = true,
                          .lines = figure.room.draft.lines,
                          .line_count = figure.room.draft.line_count,
                          .front = &front,
                          .spans = figure.room.spans,
                          .span_count = figure.span_count};
    shv_plot_write(stream, &plot, within);
}

/* ---- run time by part ---- */

static const double *costs_of(const void *data, int32_t index, char name[SHV_PLOT_BAR_NAME])
{
    const ShvStudyRow *row = &((const ShvStudy *)data)->rows[index];
    shv_format(name, SHV_PLOT_BAR_NAME, "%.34s%s%.20s", row->series, row->label[0] ? ", " : "", row->label);
    return row->costs;
}

void shv_study_put_cost_plot(const ShvStudy *study, FILE *stream, bool within)
{
    enum { MOST_BARS = 60 };
    const char *parts[SHV_COST_COUNT];
    char title[300];
    for (int c = 0; c < SHV_COST_COUNT; c++) parts[c] = shv_cost_name((ShvCost)c);
    shv_format(title, sizeof title, "%.250s: run time by part", study->plan.name);
    const ShvPlotBars bars = {.title = title,
                              .unit = "s",
                              .parts = parts,
                              .part_count = SHV_COST_COUNT,
                              .count = study->setting_count < MOST_BARS ? study->setting_count : MOST_BARS,
                              .bar = costs_of,
                              .data = study};
    shv_plot_bars(stream, &bars, within);
}
