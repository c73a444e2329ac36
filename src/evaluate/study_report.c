/* The files of a study: figures, page, JSON. */
#include "base/text.h"
#include "evaluate/study.h"
#include "export/html.h"
#include "export/output.h"
#include "shiver/version.h"

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
    const int32_t measure = figure->measure;
    if (row->is_reference) return;
    const int32_t line = shv_plot_add(&figure->room.draft, row->series, point_of(figure, row));
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

static void put_error_plot(const ShvStudy *study, int32_t measure, FILE *stream, bool within)
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

static void put_cost_plot(const ShvStudy *study, FILE *stream, bool within)
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

/* ---- the page ---- */

static void put_head(const ShvStudy *study, FILE *stream)
{
    char text[1024];
    shv_html_begin(stream, study->plan.name);
    shv_format(text, sizeof text, "Scene %.300s. Errors are taken from: %.250s. Shiver %s on %.120s.",
               study->scene_path, study->view.reference, shv_version(), study->processor);
    shv_html_paragraph(stream, text);
    if (study->options.command) shv_html_command(stream, study->options.command);
    shv_format(text, sizeof text,
               "Run times are medians of %d repeat%s, one run at a time, without making the simulation.",
               (int)study->plan.repeats, study->plan.repeats == 1 ? "" : "s");
    shv_html_paragraph(stream, study->view.timings_valid
                                   ? text
                                   : "Run times are not valid: runs shared the machine, or were made on "
                                     "different ones. Nothing should be concluded from them.");
    if (study->plan.members == 1) return;
    shv_format(
        text, sizeof text,
        "Each setting was run %d times with %s. Errors are medians; scatter is the median error of the reference's "
        "runs against each other. Errors that differ by less are not ranked: the cheaper setting counts.",
        (int)study->plan.members, study->plan.seeds ? "other seeds" : "objects shifted by tiny amounts");
    shv_html_paragraph(stream, text);
}

static void put_html(const ShvStudy *study, FILE *stream)
{
    char text[1024];
    put_head(study, stream);
    shv_html_heading(stream, 2, "Runs");
    shv_study_put_table(study, SHV_STUDY_RUNS, SHV_TABLE_HTML, stream);
    shv_html_paragraph(stream, "Bold: on the Pareto front, nothing cheaper is as good. Yellow: not above the scatter.");
    /* Messages are long: below the table, not in it. */
    for (int32_t i = 0; i < study->setting_count; i++) {
        if (study->rows[i].status == SHV_OK) continue;
        shv_format(text, sizeof text, "%.600s failed: %s", study->rows[i].name, study->rows[i].message);
        shv_html_paragraph(stream, text);
    }
    shv_html_heading(stream, 2, "Error against run time");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        put_error_plot(study, i, stream, true);
    }
    shv_html_heading(stream, 2, "Run time by part");
    put_cost_plot(study, stream, true);
    shv_html_heading(stream, 2, "What the errors are");
    shv_study_put_definitions(study, stream);
    shv_html_end(stream);
}

/* ---- text and JSON ---- */

void shv_study_print(const ShvStudy *study, FILE *stream)
{
    shv_print(stream, "errors from %s; * on the Pareto front%s\n", study->view.reference,
              study->view.timings_valid ? "" : "; run times are not valid");
    shv_study_put_table(study, SHV_STUDY_LINES, SHV_TABLE_TEXT, stream);
}

void shv_study_print_json(const ShvStudy *study, FILE *stream)
{
    ShvMembers members = {.stream = stream}, scatter = members;
    shv_print(stream, "{");
    shv_member_text(&members, "study", study->plan.name);
    shv_member_text(&members, "scene", study->scene_path);
    shv_member_text(&members, "version", shv_version());
    shv_member_text(&members, "processor", study->processor);
    shv_member_text(&members, "errors_from", study->view.reference);
    shv_member_flag(&members, "timings_valid", study->view.timings_valid);
    shv_member_number(&members, "members", study->plan.members);
    shv_member_number(&members, "repeats", study->plan.repeats);
    shv_print(stream, ", \"scatter\": {");
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        shv_member_number(&scatter, study->plan.measures[i].name, study->view.scatter[i]);
    shv_print(stream, "}, \"results\": ");
    shv_study_put_table(study, SHV_STUDY_RESULTS, SHV_TABLE_JSON, stream);
    shv_print(stream, ", \"timings\": ");
    shv_study_put_table(study, SHV_STUDY_TIMINGS, SHV_TABLE_JSON, stream);
    shv_print(stream, "}\n");
}

/* ---- files ---- */

enum { RESULTS, TIMINGS, TABLE, JSON, COSTS, PAGE, FILES };

/* Those above, and a figure of each measure. */
static void put_file(const void *data, int index, FILE *stream)
{
    const ShvStudy *study = data;
    if (index <= TABLE)
        shv_study_put_table(study, (ShvStudyTable)index, index == TABLE ? SHV_TABLE_MARKDOWN : SHV_TABLE_CSV, stream);
    else if (index == JSON)
        shv_study_print_json(study, stream);
    else if (index == COSTS)
        put_cost_plot(study, stream, false);
    else if (index == PAGE)
        put_html(study, stream);
    else
        put_error_plot(study, index - FILES, stream, false);
}

ShvStatus shv_study_write(const ShvStudy *study, ShvError *error)
{
    const char *names[FILES + SHV_STUDY_MOST_MEASURES] = {"results.csv", "timings.csv", "table.md",
                                                          "study.json",  "cost.svg",    "report.html"};
    char figures[SHV_STUDY_MOST_MEASURES][96], folder[SHV_STUDY_PATH];
    ShvExportOptions options = shv_export_default();
    options.force = true;
    options.memory = study->memory;
    if (!study->view.rows) return shv_fail(error, SHV_BAD_INPUT, "a study is written after it has been measured");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        shv_format(figures[i], sizeof figures[i], "error_%s.svg", study->plan.measures[i].name);
        names[FILES + i] = figures[i];
    }
    SHV_TRY(shv_study_path(study, -1, "", folder, error));
    return shv_output_write_all(&options, folder, names, FILES + study->plan.measure_count, put_file, study, error);
}
