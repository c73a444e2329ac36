/* A measurement as text, JSON, CSV and plots. */
#include <stdio.h>
#include <string.h>

#include "base/publish.h"
#include "base/text.h"
#include "export/output.h"
#include "export/plot.h"
#include "stability/stability.h"

/* ---- numbers of rows and points ---- */

#define ROW(member)   offsetof(ShvStabilityRow, member)
#define POINT(member) offsetof(ShvStabilityPoint, member)
#define COUNT(array)  ((int)(sizeof(array) / sizeof *(array)))
static const ShvNumberField setting_fields[] = {{"youngs_modulus", NULL, ROW(modulus)}, {"k", NULL, ROW(stiffness)}},
                            limit_fields[] = {{"stable_step", "%.3e", ROW(stable_step)},
                                              {"limit", "%.2f", ROW(limit)},
                                              {"failed", "%.2f", ROW(failed)},
                                              {"over_mesh", "%.2f", ROW(over_mesh)}},
                            odd_fields[] = {{"unstable_below", NULL, ROW(unstable_below)},
                                            {"stable_again", NULL, ROW(stable_again)},
                                            {"refused_above", NULL, ROW(refused_above)}},
                            point_fields[] = {{"step", "%.2f", POINT(multiple)},
                                              {"stiffness", "%.4g", POINT(stiffness)},
                                              {"bars_alone", "%.4g", POINT(closed_form)},
                                              {"frequency", "%.4f", POINT(frequency)},
                                              {"displacement", "%.3g", POINT(displacement)},
                                              {"energy_kept", "%.3g", POINT(energy_kept)}};

static void put_text(FILE *stream, const void *item, const ShvNumberField *fields, int count)
{
    for (int i = 0; i < count; i++) {
        char text[32];
        const double value = shv_number_of(item, &fields[i]);
        shv_format(text, sizeof text, isfinite(value) ? fields[i].format : isnan(value) ? "-" : "inf", value);
        shv_print(stream, " %9s", text);
    }
}

static void put_csv(FILE *stream, const void *item, const ShvNumberField *fields, int count)
{
    for (int i = 0; i < count; i++) shv_output_number(stream, shv_number_of(item, &fields[i]));
}

/* ---- text ---- */

static void put_setting(FILE *stream, const ShvStabilityRow *row)
{
    if (row->iterations > 0)
        shv_print(stream, "%-10.3g %5.3g %4d", row->modulus, row->stiffness, (int)row->iterations);
    else
        shv_print(stream, "%-10.3g %5s %4s", row->modulus, "none", "-");
}

static void put_limits(FILE *stream, const ShvStabilityRow *row)
{
    put_setting(stream, row);
    put_text(stream, row, limit_fields, COUNT(limit_fields));
    shv_print(stream, "  %-9s %-9s ", shv_stability_class_name(row->beyond), shv_stability_class_name(row->far));
    if (row->monotone) shv_print(stream, "yes");
    if (!isnan(row->unstable_below)) shv_print(stream, "NO: unstable at %.2f", row->unstable_below);
    if (!isnan(row->stable_again))
        shv_print(stream, "%sNO: stable again at %.2f", isnan(row->unstable_below) ? "" : ", ", row->stable_again);
    if (!isnan(row->refused_above))
        shv_print(stream, "; the program refuses steps above %.2f without bars", row->refused_above);
    shv_print(stream, "\n");
}

static void put_point(FILE *stream, const ShvStabilityRow *row, const ShvStabilityPoint *point)
{
    put_setting(stream, row);
    put_text(stream, point, point_fields, 1);
    shv_print(stream, "  %-9s", shv_stability_class_name(point->outcome));
    put_text(stream, point, point_fields + 1, COUNT(point_fields) - 1);
    shv_print(stream, "\n");
}

void shv_stability_print(const ShvStability *stability, FILE *stream)
{
    shv_print(stream,
              "load: velocities of up to 0.5e-6 bar speeds, drawn node by node, rigid motion taken out; %d steps\n"
              "largest stable step, in computed stable steps\n"
              "%-10s %5s %4s %9s %9s %9s %9s  %-9s %-9s %s\n",
              (int)stability->options.steps, "E, Pa", "k", "n", "step, s", "limit", "fails at", "of mesh", "there",
              "at 3x", "monotone");
    for (int32_t i = 0; i < stability->count; i++) put_limits(stream, &stability->rows[i]);
    shv_print(stream,
              "\nhow far off: against no bars at a quarter of the stable step\n"
              "%-10s %5s %4s %9s  %-9s %9s %9s %9s %9s %9s\n",
              "E, Pa", "k", "n", "step", "class", "stiffness", "bars alone", "frequency", "displ.", "energy");
    for (int32_t i = 0; i < stability->count; i++)
        for (int32_t k = 0; k < stability->rows[i].point_count; k++)
            put_point(stream, &stability->rows[i], &stability->rows[i].points[k]);
}

/* ---- JSON ---- */

static void put_row_json(FILE *stream, const ShvStabilityRow *row)
{
    ShvMembers members = {.stream = stream};
    shv_member_flag(&members, "bars", row->iterations > 0);
    shv_member_fields(&members, row, setting_fields, COUNT(setting_fields));
    shv_member_number(&members, "iterations", row->iterations);
    shv_member_fields(&members, row, limit_fields, COUNT(limit_fields));
    shv_member_fields(&members, row, odd_fields, COUNT(odd_fields));
    shv_member_text(&members, "beyond", shv_stability_class_name(row->beyond));
    shv_member_text(&members, "far", shv_stability_class_name(row->far));
    shv_member_flag(&members, "monotone", row->monotone);
    shv_member_key(&members, "points");
    for (int32_t k = 0; k < row->point_count; k++) {
        ShvMembers point = {.stream = stream};
        shv_print(stream, k > 0 ? "},\n  {" : "[{");
        shv_member_text(&point, "class", shv_stability_class_name(row->points[k].outcome));
        shv_member_fields(&point, &row->points[k], point_fields, COUNT(point_fields));
    }
    shv_print(stream, row->point_count > 0 ? "}]" : "[]");
}

void shv_stability_print_json(const ShvStability *stability, FILE *stream)
{
    shv_print(stream, "{\"rows\": [");
    for (int32_t i = 0; i < stability->count; i++) {
        shv_print(stream, i > 0 ? ",\n {" : "{");
        put_row_json(stream, &stability->rows[i]);
        shv_print(stream, "}");
    }
    shv_print(stream, "]}\n");
}

/* ---- CSV: a line a point ---- */

static void put_lines(FILE *stream, const ShvStability *stability, const ShvStabilityRow *row)
{
    for (int32_t k = 0; k < row->point_count; k++) {
        shv_print(stream, "%s,%d", row->iterations > 0 ? "bars" : "none", (int)row->iterations);
        put_csv(stream, row, setting_fields, COUNT(setting_fields));
        put_csv(stream, row, limit_fields, COUNT(limit_fields));
        put_csv(stream, row, odd_fields, 2);
        shv_print(stream, ",%s,%s,%d,%s", shv_stability_class_name(row->beyond), shv_stability_class_name(row->far),
                  (int)stability->options.steps, shv_stability_class_name(row->points[k].outcome));
        put_csv(stream, &row->points[k], point_fields, COUNT(point_fields));
        shv_print(stream, "\n");
    }
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
    char names[MOST_LINES][24];
    ShvPlotDraft draft;
} Drawing;

/* The largest steps of one k (without bars of all) against the number of iterations. */
static void add_limits(Drawing *drawing, const ShvStabilityRow *row, const ShvStabilityValues *iterations)
{
    char *name = drawing->names[drawing->draft.line_count];
    shv_format(name, sizeof drawing->names[0], row->iterations > 0 ? "k = %g" : "no bars", row->stiffness);
    shv_plot_line(&drawing->draft, name, SHV_PLOT_MARKED_LINE);
    for (int32_t n = 0; n < iterations->count; n++)
        shv_plot_point(&drawing->draft,
                       (ShvPlotPoint){.x = iterations->values[n], .y = row[row->iterations > 0 ? n : 0].limit});
}

/* What is wrong at each step. */
static void add_steps(Drawing *drawing, const ShvStabilityRow *row, int picture)
{
    char *name = drawing->names[drawing->draft.line_count];
    shv_format(name, sizeof drawing->names[0], row->iterations > 0 ? "k %g, n %d" : "no bars", row->stiffness,
               (int)row->iterations);
    shv_plot_line(&drawing->draft, name, SHV_PLOT_MARKED_LINE);
    for (int32_t k = 0; k < row->point_count; k++) {
        const ShvStabilityPoint *point = &row->points[k];
        const double value = picture == 1 ? point->stiffness : point->displacement;
        shv_plot_point(&drawing->draft, (ShvPlotPoint){.x = point->multiple, .y = value});
    }
}

/* Lines against the step: without bars, each of the first four k with the middle number of iterations, the first with the
   last. More could not be told apart; the table has them all. */
static void put_picture(FILE *stream, const ShvStability *stability, int picture)
{
    enum { MOST_K = 4 };
    const ShvStabilityValues *iterations = &stability->options.iterations;
    const int32_t stiffnesses = stability->options.stiffness.count, n = iterations->count, middle = n / 2;
    const ShvStabilityRow *bars = stability->rows + 1;
    Drawing drawing;
    drawing.draft = (ShvPlotDraft){.points = drawing.points, .lines = drawing.lines};
    if (picture > 0) add_steps(&drawing, stability->rows, picture);
    for (int32_t k = 0; k < stiffnesses && n > 0; k++) {
        if (picture == 0) add_limits(&drawing, bars + k * n, iterations);
        if (picture > 0 && k < MOST_K) add_steps(&drawing, bars + k * n + middle, picture);
    }
    if (picture == 0) add_limits(&drawing, stability->rows, iterations);
    if (picture > 0 && stiffnesses > 0 && middle < n - 1) add_steps(&drawing, bars + n - 1, picture);
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

static void put_file(const void *data, int index, FILE *stream)
{
    put_picture(stream, data, index);
}

static void put_table(const void *data, int index, FILE *stream)
{
    const ShvStability *stability = data;
    (void)index;
    shv_print(stream,
              "stabiliser,iterations,youngs_modulus [Pa],k,stable_step [s],limit [stable steps],"
              "failed [stable steps],limit over that without bars,unstable_below [stable steps],"
              "stable_again [stable steps],class at failed,class at 3 x failed,steps,class,"
              "step [stable steps],stiffness,stiffness of bars alone,frequency,displacement error,energy kept\n");
    for (int32_t i = 0; i < stability->count; i++) put_lines(stream, stability, &stability->rows[i]);
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
    if (csv) SHV_TRY(shv_output_write_all(&options, csv, whole, 1, put_table, stability, error));
    return svg ? shv_output_write_all(&options, svg, suffixes, PICTURES, put_file, stability, error) : SHV_OK;
}
