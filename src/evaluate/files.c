/* The files of a comparison. */
#include "base/text.h"
#include "evaluate/compare.h"
#include "evaluate/plot.h"
#include "export/output.h"

static const char *const suffixes[] = {"_compare.csv", "_compare.svg"};

/* ---- the table ---- */

static void put_vector(FILE *stream, ShvVec3 v)
{
    shv_output_number(stream, v.x);
    shv_output_number(stream, v.y);
    shv_output_number(stream, v.z);
}

static void put_state(FILE *stream, const ShvBodyState *state)
{
    put_vector(stream, state->position);
    shv_output_number(stream, state->orientation.w);
    put_vector(stream, shv_vec3(state->orientation.x, state->orientation.y, state->orientation.z));
    put_vector(stream, state->velocity);
    put_vector(stream, state->angular_velocity);
}

static void put_row(FILE *stream, const ShvComparedRun *run, const ShvTrackRow *row)
{
    const double numbers[] = {row->position, row->orientation, row->velocity,        row->surface,
                              row->spin,     row->energy,      row->reference_energy};
    shv_print(stream, "%s", shv_rigid_engine_name(run->engine));
    shv_output_number(stream, run->step);
    shv_output_number(stream, row->time);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) shv_output_number(stream, numbers[i]);
    put_vector(stream, row->momentum);
    put_vector(stream, row->angular_momentum);
    put_state(stream, &row->state);
    put_state(stream, &row->reference);
    shv_print(stream, "\n");
}

static void put_table(FILE *stream, const ShvComparison *comparison)
{
    static const char *const names[] = {"position", "orientation", "velocity", "surface"};
    static const char *const units[] = {"m", "rad", "m/s", "m"};
    shv_print(stream, "engine,step [s],time [s]");
    for (int i = 0; i < 4; i++) shv_print(stream, ",error of %s [%s]", names[i], units[i]);
    shv_print(stream,
              ",error of angular momentum [kg m2/s],energy [J],energy of reference [J],momentum.x [kg m/s],"
              "momentum.y [kg m/s],momentum.z [kg m/s],angular_momentum.x [kg m2/s],angular_momentum.y [kg m2/s],"
              "angular_momentum.z [kg m2/s]");
    for (int i = 0; i < 2; i++) {
        const char *of = i ? "reference." : "";
        shv_print(stream, ",%sP.x [m],%sP.y [m],%sP.z [m],%sorient.w,%sorient.x,%sorient.y,%sorient.z", of, of, of, of,
                  of, of, of);
        shv_print(stream, ",%sv.x [m/s],%sv.y [m/s],%sv.z [m/s],%sw.x [rad/s],%sw.y [rad/s],%sw.z [rad/s]", of, of, of,
                  of, of, of);
    }
    shv_print(stream, "\n");
    for (int32_t i = 0; i < comparison->count; i++)
        for (int32_t k = 0; k < comparison->runs[i].track.count; k++)
            put_row(stream, &comparison->runs[i].view, &comparison->runs[i].track.rows[k]);
}

/* ---- the plot ---- */

/* Errors below what double precision resolves count as that. */
static ShvPlotPoint point_of(const ShvComparedRun *run)
{
    const bool show = run->status == SHV_OK && !run->is_reference;
    ShvPlotPoint point = {.x = show ? run->seconds : (double)NAN, .y = fmax(run->surface, 1e-16)};
    shv_format(point.label, sizeof point.label, "%g s", run->step);
    return point;
}

static void put_plot(FILE *stream, const ShvComparison *comparison)
{
    ShvPlotPoint points[SHV_MOST_COMPARED_ENGINES][SHV_MOST_COMPARED_STEPS];
    ShvPlotLine lines[SHV_MOST_COMPARED_ENGINES];
    const ShvCompareOptions *options = &comparison->options;
    for (int32_t e = 0; e < options->engine_count; e++) {
        for (int32_t s = 0; s < options->step_count; s++)
            points[e][s] = point_of(&comparison->runs[e * options->step_count + s].view);
        lines[e] = (ShvPlotLine){shv_rigid_engine_name(options->engines[e]), points[e], options->step_count,
                                 SHV_PLOT_MARKED_LINE};
    }
    const ShvPlot plot = {.title = comparison->scene->name ? comparison->scene->name : "comparison",
                          .x_label = "run time, s",
                          .y_label = "largest error of a point of the surface, m",
                          .log_x = true,
                          .log_y = true,
                          .lines = lines,
                          .line_count = options->engine_count};
    shv_plot_write(stream, &plot);
}

ShvStatus shv_comparison_check_files(const char *prefix, bool force, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    return shv_output_check(&options, prefix, suffixes, 2, error);
}

ShvStatus shv_comparison_write(const ShvComparison *comparison, const char *prefix, bool force, ShvError *error)
{
    static void (*const writers[])(FILE * stream, const ShvComparison *comparison) = {put_table, put_plot};
    ShvExportOptions options = shv_export_default();
    options.force = force;
    options.memory = comparison->memory;
    SHV_TRY(shv_output_check(&options, prefix, suffixes, 2, error));
    for (int i = 0; i < 2; i++) {
        ShvOutput output;
        SHV_TRY(shv_output_open(&output, &options, prefix, suffixes[i], error));
        writers[i](output.stream, comparison);
        SHV_TRY(shv_output_close(&output, &options, SHV_OK, error));
    }
    return SHV_OK;
}
