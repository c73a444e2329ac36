/* The files of a study. */
#include <string.h>

#include "base/text.h"
#include "evaluate/html.h"
#include "evaluate/study.h"
#include "export/output.h"
#include "shiver/version.h"

/* ---- the page ---- */

static void put_number(FILE *stream, double value, const char *class)
{
    char text[32] = "–";
    if (isfinite(value)) shv_format(text, sizeof text, "%.3g", value);
    shv_html_cell(stream, text, class);
}

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

static void put_heads(const ShvStudy *study, FILE *stream)
{
    const char *heads[SHV_STUDY_MOST_KEYS + 4 + 2 * SHV_STUDY_MOST_MEASURES];
    char errors[SHV_STUDY_MOST_MEASURES][64], values[SHV_STUDY_MOST_MEASURES][64];
    int32_t count = 0;
    for (int32_t i = 0; i < study->plan.key_count; i++) heads[count++] = study->plan.keys[i];
    heads[count++] = "step, s";
    heads[count++] = "Courant number";
    heads[count++] = "run time, s";
    heads[count++] = "";
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        const char *comma = measure->unit && measure->unit[0] ? ", " : "";
        shv_format(values[i], sizeof values[i], "%s%s%s", measure->name, comma, measure->unit ? measure->unit : "");
        shv_format(errors[i], sizeof errors[i], "error of %s%s%s", measure->name, measure->error_unit[0] ? ", " : "",
                   measure->error_unit);
        if (measure->unit) heads[count++] = values[i];
        heads[count++] = errors[i];
    }
    shv_html_table_begin(stream, heads, count);
}

static void put_error(const ShvStudy *study, const ShvStudyRow *row, int32_t measure, FILE *stream)
{
    char text[96] = "–";
    const double error = row->errors[measure], scatter = study->view.scatter[measure];
    const bool spread = study->plan.members > 1 && isfinite(row->errors_low[measure]);
    if (isfinite(error)) shv_format(text, sizeof text, "%.3g", error);
    if (isfinite(error) && spread)
        shv_format(text, sizeof text, "%.3g (%.3g to %.3g)", error, row->errors_low[measure],
                   row->errors_high[measure]);
    const bool within = study->plan.members > 1 && error <= scatter;
    shv_html_cell(stream, text, row->on_front[measure] ? "number best" : within ? "number warn" : "number");
}

static void put_row(const ShvStudy *study, int32_t index, FILE *stream)
{
    const ShvStudySetting *setting = shv_study_setting(study, index);
    const ShvStudyRow *row = &study->rows[index];
    shv_html_row_begin(stream, NULL);
    for (int32_t i = 0; i < study->plan.key_count; i++) shv_html_cell(stream, setting->values[i], NULL);
    put_number(stream, row->step > 0.0 ? row->step : (double)NAN, "number");
    put_number(stream, row->courant > 0.0 ? row->courant : (double)NAN, "number");
    put_number(stream, row->seconds, study->view.timings_valid ? "number" : "number warn");
    if (row->status != SHV_OK)
        shv_html_cell(stream, "failed", "miss");
    else
        shv_html_cell(stream, row->is_reference ? "reference" : "", NULL);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        if (study->plan.measures[i].unit) put_number(stream, row->values[i], "number");
        put_error(study, row, i, stream);
    }
    shv_html_row_end(stream);
}

/* Messages are long: below the table, not in it. */
static void put_failures(const ShvStudy *study, FILE *stream)
{
    const char *heads[SHV_STUDY_MOST_KEYS + 1];
    int32_t failed = 0;
    for (int32_t i = 0; i < study->setting_count; i++) failed += study->rows[i].status != SHV_OK;
    if (failed == 0) return;
    for (int32_t i = 0; i < study->plan.key_count; i++) heads[i] = study->plan.keys[i];
    heads[study->plan.key_count] = "why it failed";
    shv_html_table_begin(stream, heads, study->plan.key_count + 1);
    for (int32_t i = 0; i < study->setting_count; i++) {
        if (study->rows[i].status == SHV_OK) continue;
        shv_html_row_begin(stream, NULL);
        for (int32_t k = 0; k < study->plan.key_count; k++)
            shv_html_cell(stream, shv_study_setting(study, i)->values[k], NULL);
        shv_html_cell(stream, study->rows[i].message, "miss");
        shv_html_row_end(stream);
    }
    shv_html_table_end(stream);
}

static void put_scatter(const ShvStudy *study, FILE *stream)
{
    if (study->plan.members == 1) return;
    shv_html_row_begin(stream, NULL);
    for (int32_t i = 0; i < study->plan.key_count; i++) shv_html_cell(stream, i == 0 ? "scatter" : "", NULL);
    for (int i = 0; i < 4; i++) shv_html_cell(stream, "", NULL);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        if (study->plan.measures[i].unit) shv_html_cell(stream, "", NULL);
        put_number(stream, study->view.scatter[i], "number");
    }
    shv_html_row_end(stream);
}

static void put_definitions(const ShvStudy *study, FILE *stream)
{
    static const char *const heads[] = {"measure", "error"};
    shv_html_heading(stream, 2, "What the errors are");
    shv_html_table_begin(stream, heads, 2);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        static const char *const classes[2] = {NULL, NULL};
        const char *const texts[2] = {measure->name, measure->sentence ? measure->sentence : measure->error};
        shv_table_row(stream, true, texts, classes, 2);
    }
    shv_html_table_end(stream);
}

void shv_study_put_html(const ShvStudy *study, FILE *stream)
{
    put_head(study, stream);
    shv_html_heading(stream, 2, "Runs");
    put_heads(study, stream);
    for (int32_t i = 0; i < study->setting_count; i++) put_row(study, i, stream);
    put_scatter(study, stream);
    shv_html_table_end(stream);
    shv_html_paragraph(stream, "Bold: on the Pareto front, nothing cheaper is as good. Yellow: not above the scatter.");
    put_failures(study, stream);
    shv_html_heading(stream, 2, "Error against run time");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        shv_print(stream, "<figure>\n");
        shv_study_put_error_plot(study, i, stream, true);
        shv_print(stream, "</figure>\n");
    }
    shv_html_heading(stream, 2, "Run time by part");
    shv_print(stream, "<figure>\n");
    shv_study_put_cost_plot(study, stream, true);
    shv_print(stream, "</figure>\n");
    put_definitions(study, stream);
    shv_html_end(stream);
}

/* ---- files ---- */

static void put_costs(const ShvStudy *study, FILE *stream)
{
    shv_study_put_cost_plot(study, stream, false);
}

static ShvStatus write_file(const ShvStudy *study, const char *name, void (*put)(const ShvStudy *study, FILE *stream),
                            int32_t measure, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    ShvOutput output;
    char path[SHV_STUDY_PATH];
    options.force = true;
    options.memory = study->memory;
    SHV_TRY(shv_study_path(study, -1, name, path, error));
    SHV_TRY(shv_output_open(&output, &options, path, "", error));
    if (put)
        put(study, output.stream);
    else
        shv_study_put_error_plot(study, measure, output.stream, false);
    return shv_output_close(&output, &options, SHV_OK, error);
}

ShvStatus shv_study_write(const ShvStudy *study, ShvError *error)
{
    static const struct {
        const char *name;
        void (*put)(const ShvStudy *study, FILE *stream);
    } files[] = {{"results.csv", shv_study_put_results},
                 {"timings.csv", shv_study_put_timings},
                 {"table.md", shv_study_put_markdown},
                 {"study.json", shv_study_print_json},
                 {"cost.svg", put_costs},
                 {"report.html", shv_study_put_html}};
    if (!study->view.rows) return shv_fail(error, SHV_BAD_INPUT, "a study is written after it has been measured");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        char name[96];
        shv_format(name, sizeof name, "error_%s.svg", study->plan.measures[i].name);
        SHV_TRY(write_file(study, name, NULL, i, error));
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        SHV_TRY(write_file(study, files[i].name, files[i].put, 0, error));
    return SHV_OK;
}
