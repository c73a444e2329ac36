/* The files of a measurement. */
#include "base/publish.h"
#include "base/text.h"
#include "export/output.h"
#include "export/plot.h"
#include "stability/stability.h"

enum { MOST_LINES = SHV_MOST_STABILITY_VALUES + 1, PICTURES = 3 };

static const char *const pictures[PICTURES] = {"_limit.svg", "_stiffness.svg", "_error.svg"};

/* ---- plots, of the first modulus ---- */

/* Room for one plot. */
typedef struct Drawing {
    const ShvStability *stability;
    ShvPlotPoint points[MOST_LINES * SHV_MOST_STABILITY_VALUES];
    ShvPlotLine lines[MOST_LINES];
    char names[MOST_LINES][24];
    ShvPlotDraft draft;
} Drawing;

/* Begins a line; its points come next. Returns the room of its name, for another than "no bars". */
static char *begin_line(Drawing *drawing)
{
    char *name = drawing->names[drawing->draft.line_count];
    shv_format(name, sizeof drawing->names[0], "no bars");
    shv_plot_line(&drawing->draft, name, SHV_PLOT_MARKED_LINE);
    return name;
}

static void put_plot(FILE *stream, const Drawing *drawing, const char *x, const char *y)
{
    const ShvPlot plot = {.title = drawing->stability->name,
                          .x_label = x,
                          .y_label = y,
                          .log_x = true,
                          .log_y = true,
                          .lines = drawing->draft.lines,
                          .line_count = drawing->draft.line_count};
    shv_plot_write(stream, &plot, false);
}

static void put_limits(FILE *stream, Drawing *drawing)
{
    const ShvStability *stability = drawing->stability;
    const ShvStabilityValues *stiffness = &stability->options.stiffness, *iterations = &stability->options.iterations;
    for (int32_t k = 0; k <= stiffness->count; k++) {
        const bool bars = k < stiffness->count;
        char *name = begin_line(drawing);
        if (bars) shv_format(name, sizeof drawing->names[0], "k = %g", stiffness->values[k]);
        for (int32_t n = 0; n < iterations->count; n++)
            shv_plot_point(&drawing->draft,
                           (ShvPlotPoint){.x = iterations->values[n],
                                          .y = stability->rows[bars ? 1 + k * iterations->count + n : 0].limit});
    }
    put_plot(stream, drawing, "sweeps of bars a step", "largest stable step, computed stable steps");
}

static void add_line(Drawing *drawing, const ShvStabilityRow *row, double (*value)(const ShvStabilityPoint *point))
{
    char *name = begin_line(drawing);
    for (int32_t k = 0; k < row->point_count; k++)
        shv_plot_point(&drawing->draft, (ShvPlotPoint){.x = row->points[k].multiple, .y = value(&row->points[k])});
    if (row->iterations > 0)
        shv_format(name, sizeof drawing->names[0], "k %g, n %d", row->stiffness, (int)row->iterations);
}

/* Lines against the step: without bars, each of the first four k with the middle number of iterations, the first with the
   last. More could not be told apart; the table has them all. */
static void put_against_step(FILE *stream, Drawing *drawing, const char *label,
                             double (*value)(const ShvStabilityPoint *point))
{
    enum { MOST_K = 4 };
    const ShvStabilityOptions *options = &drawing->stability->options;
    const ShvStabilityRow *rows = drawing->stability->rows;
    const int32_t n = options->iterations.count, middle = n / 2;
    add_line(drawing, &rows[0], value);
    for (int32_t k = 0; n > 0 && k < options->stiffness.count && k < MOST_K; k++)
        add_line(drawing, &rows[1 + k * n + middle], value);
    if (options->stiffness.count > 0 && middle < n - 1) add_line(drawing, &rows[n], value);
    put_plot(stream, drawing, "step, computed stable steps", label);
}

static double stiffness_of(const ShvStabilityPoint *point)
{
    return point->stiffness;
}

static double error_of(const ShvStabilityPoint *point)
{
    return point->displacement;
}

static void put_picture(FILE *stream, Drawing *drawing, int which)
{
    drawing->draft = (ShvPlotDraft){.points = drawing->points, .lines = drawing->lines};
    if (which == 0)
        put_limits(stream, drawing);
    else if (which == 1)
        put_against_step(stream, drawing, "static stiffness over that without bars", stiffness_of);
    else
        put_against_step(stream, drawing, "largest error of displacement over its largest", error_of);
}

/* ---- files ---- */

ShvStatus shv_stability_check_files(const char *csv, const char *svg, bool force, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    if (csv) SHV_TRY(shv_publish_check(csv, force, error));
    return svg ? shv_output_check(&options, svg, pictures, PICTURES, error) : SHV_OK;
}

static ShvStatus write_files(Drawing *drawing, const ShvExportOptions *options, const char *csv, const char *svg,
                             ShvError *error)
{
    for (int i = csv ? -1 : 0; i < (svg ? PICTURES : 0); i++) {
        ShvOutput output;
        SHV_TRY(shv_output_open(&output, options, i < 0 ? csv : svg, i < 0 ? "" : pictures[i], error));
        if (i < 0)
            shv_stability_put_csv(drawing->stability, output.stream);
        else
            put_picture(output.stream, drawing, i);
        SHV_TRY(shv_output_close(&output, options, SHV_OK, error));
    }
    return SHV_OK;
}

ShvStatus shv_stability_write(const ShvStability *stability, const char *csv, const char *svg, bool force,
                              ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    options.memory = stability->memory;
    SHV_TRY(shv_stability_check_files(csv, svg, force, error));
    Drawing *drawing = shv_allocate(stability->memory, SHV_PART_GENERAL, 1, sizeof *drawing);
    if (!drawing) return shv_fail_memory(error, "pictures", sizeof *drawing);
    drawing->stability = stability;
    const ShvStatus status = write_files(drawing, &options, csv, svg, error);
    shv_release(drawing);
    return status;
}
