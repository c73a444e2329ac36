/* A study as CSV and JSON. Results and run times are apart: the former are the same, bit for bit, wherever and however often the
   study is run. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"
#include "export/output.h"
#include "shiver/version.h"

/* ---- CSV ---- */

/* Quoted where it has to be (RFC 4180). */
static void put_field(FILE *stream, const char *text)
{
    const bool quoted = strpbrk(text, ",\"\n") != NULL;
    if (quoted) shv_print(stream, "\"");
    for (; *text; text++) shv_print(stream, *text == '"' ? "\"\"" : "%c", *text);
    if (quoted) shv_print(stream, "\"");
}

/* The keys, or the values of a setting, and how it went. */
static void put_start(const ShvStudy *study, const char *const *texts, const char *reference, const char *status,
                      FILE *stream)
{
    for (int32_t i = 0; i < study->plan.key_count; i++) {
        put_field(stream, texts[i]);
        shv_print(stream, ",");
    }
    shv_print(stream, "%s,%s", reference, status);
}

static void put_setting(const ShvStudy *study, int32_t index, FILE *stream)
{
    const ShvStudyRow *row = &study->rows[index];
    put_start(study, shv_study_setting(study, index)->values, row->is_reference ? "yes" : "",
              shv_status_name(row->status), stream);
}

static void put_head(FILE *stream, const char *what, const char *name, const char *unit)
{
    shv_print(stream, unit[0] ? ",%s%s [%s]" : ",%s%s", what, name, unit);
}

static void put_measure_heads(const ShvStudy *study, FILE *stream)
{
    static const char *const parts[] = {"error of ", "least error of ", "most error of ", "scatter of "};
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        if (measure->unit) put_head(stream, "", measure->name, measure->unit);
        for (int k = 0; k < (study->plan.members > 1 ? 4 : 1); k++)
            put_head(stream, parts[k], measure->name, measure->error_unit);
    }
}

static void put_measures(const ShvStudy *study, const ShvStudyRow *row, FILE *stream)
{
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const double parts[] = {row->errors[i], row->errors_low[i], row->errors_high[i], study->view.scatter[i]};
        if (study->plan.measures[i].unit) shv_output_number(stream, row->values[i]);
        for (int k = 0; k < (study->plan.members > 1 ? 4 : 1); k++) shv_output_number(stream, parts[k]);
    }
}

void shv_study_put_results(const ShvStudy *study, FILE *stream)
{
    put_start(study, study->plan.keys, "reference", "status", stream);
    shv_print(stream, ",stable step [s],step [s],Courant number");
    put_measure_heads(study, stream);
    shv_print(stream, ",message\n");
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        put_setting(study, i, stream);
        shv_output_number(stream, row->stable_step);
        shv_output_number(stream, row->step);
        shv_output_number(stream, row->courant);
        put_measures(study, row, stream);
        shv_print(stream, ",");
        put_field(stream, row->message);
        shv_print(stream, "\n");
    }
}

void shv_study_put_timings(const ShvStudy *study, FILE *stream)
{
    put_start(study, study->plan.keys, "reference", "status", stream);
    shv_print(stream, ",valid,median [s],least [s],most [s]");
    for (int c = 0; c < SHV_COST_COUNT; c++) put_head(stream, "", shv_cost_name((ShvCost)c), "s");
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        put_head(stream, "on front of ", study->plan.measures[i].name, "");
    shv_print(stream, "\n");
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        put_setting(study, i, stream);
        shv_print(stream, ",%s", study->view.timings_valid ? "yes" : "no");
        shv_output_number(stream, row->seconds);
        shv_output_number(stream, row->seconds_low);
        shv_output_number(stream, row->seconds_high);
        for (int c = 0; c < SHV_COST_COUNT; c++) shv_output_number(stream, row->costs[c]);
        for (int32_t m = 0; m < study->plan.measure_count; m++) shv_print(stream, ",%s", row->on_front[m] ? "yes" : "");
        shv_print(stream, "\n");
    }
}

/* ---- Markdown ---- */

static void put_cell(FILE *stream, double value, bool bold)
{
    char text[32] = "–";
    if (isfinite(value)) shv_format(text, sizeof text, "%.3g", value);
    shv_print(stream, bold ? " **%s** |" : " %s |", text);
}

/* Bars would end a cell. */
static void put_words(FILE *stream, const char *text)
{
    for (; *text; text++) shv_print(stream, "%c", *text == '|' || *text == '\n' ? '/' : *text);
}

/* Columns in which no row would have a figure are left out. */
static bool has_courant(const ShvStudy *study)
{
    for (int32_t i = 0; i < study->setting_count; i++)
        if (study->rows[i].courant > 0.0) return true;
    return false;
}

static bool has_error(const ShvStudy *study, int32_t measure)
{
    bool failed = true; /* all runs: what was to be measured is told all the same */
    for (int32_t i = 0; i < study->setting_count; i++) {
        if (study->rows[i].status != SHV_OK) continue;
        if (isfinite(study->rows[i].errors[measure])) return true;
        failed = false;
    }
    return failed;
}

static void put_markdown_row(const ShvStudy *study, const ShvStudyRow *row, FILE *stream)
{
    const bool failed = row->status != SHV_OK;
    shv_print(stream, "| ");
    put_words(stream, row->series);
    shv_print(stream, "%s", row->label[0] ? ", " : "");
    put_words(stream, row->label);
    shv_print(stream, "%s |", row->is_reference ? " (reference)" : "");
    if (has_courant(study)) put_cell(stream, row->courant > 0.0 ? row->courant : (double)NAN, false);
    put_cell(stream, row->seconds, false);
    if (failed) {
        char first[sizeof row->message]; /* what happened; what to do about it is in the page */
        shv_format(first, sizeof first, "%.*s", (int)strcspn(row->message, ";"), row->message);
        shv_print(stream, " failed: ");
        put_words(stream, first);
    }
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        if (!has_error(study, i)) continue;
        if (failed)
            shv_print(stream, " |");
        else
            put_cell(stream, row->errors[i], row->on_front[i]);
    }
    shv_print(stream, "\n");
}

void shv_study_put_markdown(const ShvStudy *study, FILE *stream)
{
    int columns = has_courant(study) ? 3 : 2;
    shv_print(stream, "| setting |%s run time, s |", columns == 3 ? " Courant |" : "");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        if (!has_error(study, i)) continue;
        shv_print(stream, " %s%s%s |", measure->name, measure->error_unit[0] ? ", " : "", measure->error_unit);
        columns++;
    }
    shv_print(stream, "\n|");
    for (int i = 0; i < columns; i++) shv_print(stream, "---|");
    shv_print(stream, "\n");
    for (int32_t i = 0; i < study->setting_count; i++) put_markdown_row(study, &study->rows[i], stream);
    if (study->plan.members == 1) return;
    shv_print(stream, has_courant(study) ? "| scatter | | |" : "| scatter | |");
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        if (has_error(study, i)) put_cell(stream, study->view.scatter[i], false);
    shv_print(stream, "\n");
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
