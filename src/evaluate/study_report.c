/* The files of a study. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"
#include "export/html.h"
#include "export/output.h"
#include "shiver/version.h"

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
    put_head(study, stream);
    shv_html_heading(stream, 2, "Runs");
    shv_study_put_runs(study, stream);
    shv_html_paragraph(stream, "Bold: on the Pareto front, nothing cheaper is as good. Yellow: not above the scatter.");
    shv_study_put_failures(study, stream);
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
    shv_html_heading(stream, 2, "What the errors are");
    shv_study_put_definitions(study, stream);
    shv_html_end(stream);
}

/* ---- JSON ---- */

/* `before` what comes between it and the member before. */
static void put_pair(FILE *stream, const char *before, const char *name, const char *text)
{
    shv_print(stream, "%s", before);
    shv_print_json_text(stream, name);
    shv_print(stream, ": ");
    shv_print_json_text(stream, text);
}

typedef struct Number {
    const char *name;
    double value;
} Number;

static void put_numbers(FILE *stream, const char *before, const Number *numbers, int count)
{
    for (int i = 0; i < count; i++) {
        shv_print(stream, "%s", i > 0 ? ", " : before);
        shv_output_member(stream, numbers[i].name, numbers[i].value);
    }
}

static void put_row(const ShvStudy *study, int32_t index, FILE *stream)
{
    const ShvStudySetting *setting = shv_study_setting(study, index);
    const ShvStudyRow *row = &study->rows[index];
    const char *before = "";
    const Number numbers[] = {{"seconds", row->seconds},
                              {"seconds_low", row->seconds_low},
                              {"seconds_high", row->seconds_high},
                              {"stable_step", row->stable_step},
                              {"step", row->step},
                              {"courant", row->courant}};
    shv_print(stream, "{\"setting\": {");
    for (int32_t i = 0; i < study->plan.key_count; i++) {
        if (setting->values[i][0] == '\0') continue;
        put_pair(stream, before, study->plan.keys[i], setting->values[i]);
        before = ", ";
    }
    shv_print(stream, "}, \"reference\": %s", row->is_reference ? "true" : "false");
    put_pair(stream, ", ", "status", shv_status_name(row->status));
    put_pair(stream, ", ", "message", row->message);
    put_numbers(stream, ", ", numbers, 6);
    shv_print(stream, ", \"costs\": {");
    for (int c = 0; c < SHV_COST_COUNT; c++)
        put_numbers(stream, c > 0 ? ", " : "", &(Number){shv_cost_name((ShvCost)c), row->costs[c]}, 1);
    shv_print(stream, "}, \"measures\": {");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const Number parts[] = {{"value", row->values[i]},
                                {"error", row->errors[i]},
                                {"error_low", row->errors_low[i]},
                                {"error_high", row->errors_high[i]}};
        shv_print(stream, "%s\"%s\": {", i > 0 ? ", " : "", study->plan.measures[i].name);
        put_numbers(stream, "", parts, 4);
        shv_print(stream, ", \"on_front\": %s}", row->on_front[i] ? "true" : "false");
    }
    shv_print(stream, "}}");
}

void shv_study_print_json(const ShvStudy *study, FILE *stream)
{
    put_pair(stream, "{", "study", study->plan.name);
    put_pair(stream, ", ", "scene", study->scene_path);
    put_pair(stream, ", ", "version", shv_version());
    put_pair(stream, ", ", "processor", study->processor);
    put_pair(stream, ", ", "errors_from", study->view.reference);
    shv_print(stream, ", \"timings_valid\": %s, \"members\": %d, \"repeats\": %d, \"scatter\": {",
              study->view.timings_valid ? "true" : "false", (int)study->plan.members, (int)study->plan.repeats);
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        put_numbers(stream, i > 0 ? ", " : "", &(Number){study->plan.measures[i].name, study->view.scatter[i]}, 1);
    shv_print(stream, "}, \"rows\": [");
    for (int32_t i = 0; i < study->setting_count; i++) {
        shv_print(stream, "%s", i > 0 ? ",\n " : "\n ");
        put_row(study, i, stream);
    }
    shv_print(stream, "]}\n");
}

/* ---- files ---- */

/* A file of a study as it is written: `put` NULL is the figure of a measure. */
typedef struct Writing {
    const ShvStudy *study;
    void (*put)(const ShvStudy *study, FILE *stream);
    int32_t measure;
} Writing;

static void put_costs(const ShvStudy *study, FILE *stream)
{
    shv_study_put_cost_plot(study, stream, false);
}

static void put_file(const void *data, FILE *stream)
{
    const Writing *writing = data;
    if (writing->put)
        writing->put(writing->study, stream);
    else
        shv_study_put_error_plot(writing->study, writing->measure, stream, false);
}

static ShvStatus write_file(const Writing *writing, const char *name, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    char path[SHV_STUDY_PATH];
    options.force = true;
    options.memory = writing->study->memory;
    SHV_TRY(shv_study_path(writing->study, -1, name, path, error));
    return shv_output_write(&options, path, put_file, writing, error);
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
                 {"report.html", put_html}};
    if (!study->view.rows) return shv_fail(error, SHV_BAD_INPUT, "a study is written after it has been measured");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        char name[96];
        shv_format(name, sizeof name, "error_%s.svg", study->plan.measures[i].name);
        SHV_TRY(write_file(&(Writing){study, NULL, i}, name, error));
    }
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        SHV_TRY(write_file(&(Writing){study, files[i].put, 0}, files[i].name, error));
    return SHV_OK;
}
