/* A measurement as text, JSON, CSV and plots. */
#include <stdio.h>
#include <string.h>

#include "base/publish.h"
#include "base/text.h"
#include "export/output.h"
#include "export/plot.h"
#include "export/table.h"
#include "stability/stability.h"

/* ---- tables: the same columns as text, JSON and CSV ---- */

typedef struct Column {
    const char *name, *unit, *brief, *format; /* brief: the head of a text */
    size_t offset;                            /* of a number */
} Column;
#define ROW(member)   offsetof(ShvStabilityRow, member)
#define POINT(member) offsetof(ShvStabilityPoint, member)
#define COUNT(array)  ((int)(sizeof(array) / sizeof *(array)))
static const Column setting_columns[] = {{"youngs_modulus", "Pa", "E, Pa", "%.3g", ROW(modulus)},
                                         {"k", "", "k", "%.3g", ROW(stiffness)}},
                    limit_columns[] = {{"stable_step", "s", "step, s", "%.3e", ROW(stable_step)},
                                       {"limit", "stable steps", "limit", "%.2f", ROW(limit)},
                                       {"failed", "stable steps", "fails at", "%.2f", ROW(failed)},
                                       {"limit over that without bars", "", "of mesh", "%.2f", ROW(over_mesh)},
                                       {"unstable_below", "stable steps", "unstable at", "%.2f", ROW(unstable_below)},
                                       {"stable_again", "stable steps", "stable at", "%.2f", ROW(stable_again)}},
                    refusal_column[] = {{"refused_above", "", "refused above", "%.2f", ROW(refused_above)}},
                    point_columns[] = {{"step", "stable steps", "step", "%.2f", POINT(multiple)},
                                       {"stiffness", "", "stiffness", "%.4g", POINT(stiffness)},
                                       {"stiffness of bars alone", "", "bars alone", "%.4g", POINT(closed_form)},
                                       {"frequency", "", "frequency", "%.4f", POINT(frequency)},
                                       {"displacement error", "", "displ.", "%.3g", POINT(displacement)},
                                       {"energy kept", "", "energy", "%.3g", POINT(energy_kept)}};

static void put_columns(ShvTable *table, const void *item, const Column *columns, int count)
{
    const bool text = table->form == SHV_TABLE_TEXT;
    for (int i = 0; i < count; i++) {
        double value;
        memcpy(&value, (const char *)item + columns[i].offset, sizeof value);
        shv_table_number(table, text ? columns[i].brief : columns[i].name, text ? NULL : columns[i].unit, "number",
                         columns[i].format, value);
    }
}

static void put_setting(ShvTable *table, const ShvStabilityRow *row)
{
    const bool text = table->form == SHV_TABLE_TEXT;
    shv_table_text(table, text ? "" : "stabiliser", NULL, row->iterations > 0 ? "bars" : "none");
    shv_table_number(table, text ? "n" : "iterations", NULL, "number", "%.0f", row->iterations);
    put_columns(table, row, setting_columns, COUNT(setting_columns));
}

static void put_limit(ShvTable *table, const ShvStabilityRow *row)
{
    put_columns(table, row, limit_columns, COUNT(limit_columns));
    shv_table_text(table, "class at failed", NULL, shv_stability_class_name(row->beyond));
    shv_table_text(table, "class at 3 x failed", NULL, shv_stability_class_name(row->far));
}

static void put_row(ShvTable *table, const void *data, int32_t index)
{
    const ShvStabilityRow *row = &((const ShvStability *)data)->rows[index];
    put_setting(table, row);
    put_limit(table, row);
    put_columns(table, row, refusal_column, 1);
    shv_table_flag(table, "monotone", row->monotone);
}

/* Points of all rows, one after the other; in CSV with what is known of the row. */
static void put_point(ShvTable *table, const void *data, int32_t index)
{
    const ShvStability *stability = data;
    const ShvStabilityRow *row = stability->rows;
    while (index >= row->point_count) index -= (row++)->point_count;
    put_setting(table, row);
    if (table->form == SHV_TABLE_CSV) put_limit(table, row);
    if (table->form == SHV_TABLE_CSV) shv_table_number(table, "steps", NULL, NULL, "", stability->options.steps);
    shv_table_text(table, "class", NULL, shv_stability_class_name(row->points[index].outcome));
    put_columns(table, &row->points[index], point_columns, COUNT(point_columns));
}

static void put_points(FILE *stream, ShvTableForm form, const ShvStability *stability)
{
    int32_t count = 0;
    for (int32_t i = 0; i < stability->count; i++) count += stability->rows[i].point_count;
    shv_table_write(stream, form, count, put_point, stability);
}

void shv_stability_print(const ShvStability *stability, FILE *stream)
{
    shv_print(stream,
              "load: velocities of up to 0.5e-6 bar speeds, drawn node by node, rigid motion taken out; %d steps\n"
              "largest stable step, in computed stable steps; the program refuses steps above some without bars\n",
              (int)stability->options.steps);
    shv_table_write(stream, SHV_TABLE_TEXT, stability->count, put_row, stability);
    shv_print(stream, "\nhow far off: against no bars at a quarter of the stable step\n");
    put_points(stream, SHV_TABLE_TEXT, stability);
}

void shv_stability_print_json(const ShvStability *stability, FILE *stream)
{
    shv_print(stream, "{\"rows\": ");
    shv_table_write(stream, SHV_TABLE_JSON, stability->count, put_row, stability);
    shv_print(stream, ", \"points\": ");
    put_points(stream, SHV_TABLE_JSON, stability);
    shv_print(stream, "}\n");
}

/* ---- plots, of the first modulus ---- */

enum { MOST_LINES = SHV_MOST_STABILITY_VALUES + 1, PICTURES = 3 };
static const char *const suffixes[PICTURES] = {"_limit.svg", "_stiffness.svg", "_error.svg"};
static const char *const labels[PICTURES] = {"largest stable step, computed stable steps",
                                             "static stiffness over that without bars",
                                             "largest error of displacement over its largest"};

/* Room for one plot. */
typedef struct Drawing {
    ShvPlotPoint points[MOST_LINES * SHV_MOST_STABILITY_VALUES];
    ShvPlotLine lines[MOST_LINES];
    char names[MOST_LINES + 1][24]; /* the last: of a point that joins a line */
    ShvPlotDraft draft;
} Drawing;

static void add(Drawing *drawing, const char *name, double x, double y)
{
    char *kept = drawing->names[drawing->draft.line_count];
    shv_format(kept, sizeof drawing->names[0], "%s", name);
    (void)shv_plot_add(&drawing->draft, kept, (ShvPlotPoint){.x = x, .y = y});
}

/* The limit against the number of sweeps, a line a k; else what is wrong at each step, a line a setting. */
static void add_row(Drawing *drawing, const ShvStabilityRow *row, int picture, const ShvStabilityValues *sweeps)
{
    char name[sizeof drawing->names[0]] = "no bars";
    const bool bars = row->iterations > 0;
    if (bars) shv_format(name, sizeof name, picture ? "k %g, n %d" : "k = %g", row->stiffness, (int)row->iterations);
    for (int32_t n = 0; n < sweeps->count && picture == 0; n++)
        if (!bars || sweeps->values[n] == row->iterations) add(drawing, name, sweeps->values[n], row->limit);
    for (int32_t i = 0; i < row->point_count && picture > 0; i++) {
        const ShvStabilityPoint *point = &row->points[i];
        add(drawing, name, point->multiple, picture == 1 ? point->stiffness : point->displacement);
    }
}

/* Lines against the step: without bars, each of the first four k with the middle number of iterations, the first with the
   last. More could not be told apart; the table has them all. */
static void put_picture(const void *data, int picture, FILE *stream)
{
    enum { MOST_K = 4 };
    const ShvStability *stability = data;
    const ShvStabilityValues *sweeps = &stability->options.iterations;
    const int32_t n = sweeps->count, bars = stability->options.stiffness.count * n;
    Drawing drawing;
    drawing.draft = (ShvPlotDraft){.points = drawing.points, .lines = drawing.lines};
    for (int32_t i = -1; i < bars; i++) {
        const bool shown = i < 0 || (i / n < MOST_K && i % n == n / 2) || i == n - 1;
        if (picture == 0 || shown) add_row(&drawing, &stability->rows[1 + i], picture, sweeps);
    }
    const ShvPlot plot = {.title = stability->name,
                          .x_label = picture > 0 ? "step, computed stable steps" : "sweeps of bars a step",
                          .y_label = labels[picture],
                          .log_x = true,
                          .log_y = true,
                          .lines = drawing.lines,
                          .line_count = drawing.draft.line_count};
    shv_plot_write(stream, &plot, false);
}

/* ---- files ---- */

static void put_csv(const void *data, int index, FILE *stream)
{
    (void)index;
    put_points(stream, SHV_TABLE_CSV, data);
}

ShvStatus shv_stability_check_files(const char *csv, const char *svg, bool force, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    if (csv) SHV_TRY(shv_publish_check(csv, force, error));
    return svg ? shv_output_check(&options, svg, suffixes, PICTURES, error) : SHV_OK;
}

ShvStatus shv_stability_write(const ShvStability *stability, const char *csv, const char *svg, bool force,
                              ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    options.memory = stability->memory;
    static const char *const whole[] = {""};
    SHV_TRY(shv_stability_check_files(csv, svg, force, error));
    if (csv) SHV_TRY(shv_output_write_all(&options, csv, whole, 1, put_csv, stability, error));
    return svg ? shv_output_write_all(&options, svg, suffixes, PICTURES, put_picture, stability, error) : SHV_OK;
}
