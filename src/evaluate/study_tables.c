/* The tables of a study. Results and run times are apart: the former are the same, bit for bit, wherever and however often the
   study is run. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"
#include "export/output.h"
#include "export/table.h"

/* ---- columns ---- */

static void put_number(ShvTable *table, const char *name, const char *unit, const char *class, double value)
{
    char head[160], text[SHV_OUTPUT_NUMBER] = "–";
    const bool csv = table->form == SHV_TABLE_CSV;
    shv_format(head, sizeof head, unit[0] == '\0' ? "%s" : csv ? "%s [%s]" : "%s, %s", name, unit);
    if (csv && isfinite(value))
        shv_output_format(text, value);
    else if (csv || isfinite(value))
        shv_format(text, sizeof text, csv ? "" : "%.3g", value);
    shv_table_text(table, head, class, text);
}

static void put_part(ShvTable *table, const char *part, const ShvMeasure *measure, const char *class, double value)
{
    char name[128];
    shv_format(name, sizeof name, "%s%s", part, measure->name);
    put_number(table, name, part[0] ? measure->error_unit : measure->unit, class, value);
}

static void put_keys(ShvTable *table, const ShvStudy *study, int32_t index)
{
    for (int32_t i = 0; i < study->plan.key_count; i++)
        shv_table_text(table, study->plan.keys[i], NULL, shv_study_setting(study, index)->values[i]);
}

typedef void (*PutCells)(ShvTable *table, const ShvStudy *study, int32_t index);

/* All rows, and that of the scatter of an ensemble where there is one. */
static void put_table(const ShvStudy *study, FILE *stream, ShvTableForm form, PutCells put, PutCells put_scatter)
{
    ShvTable table = shv_table_begin(stream, form);
    const int32_t count = study->setting_count, more = put_scatter && study->plan.members > 1 ? 1 : 0;
    for (int32_t i = -1; i < count + more; i++) {
        (i < count ? put : put_scatter)(&table, study, i < 0 ? 0 : i);
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
}

/* ---- CSV ---- */

static void put_setting(ShvTable *table, const ShvStudy *study, int32_t index)
{
    put_keys(table, study, index);
    shv_table_text(table, "reference", NULL, study->rows[index].is_reference ? "yes" : "");
    shv_table_text(table, "status", NULL, shv_status_name(study->rows[index].status));
}

static void put_result(ShvTable *table, const ShvStudy *study, int32_t index)
{
    static const char *const parts[] = {"error of ", "least error of ", "most error of ", "scatter of "};
    const ShvStudyRow *row = &study->rows[index];
    put_setting(table, study, index);
    put_number(table, "stable step", "s", NULL, row->stable_step);
    put_number(table, "step", "s", NULL, row->step);
    put_number(table, "Courant number", "", NULL, row->courant);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        const double values[] = {row->errors[i], row->errors_low[i], row->errors_high[i], study->view.scatter[i]};
        if (measure->unit) put_part(table, "", measure, NULL, row->values[i]);
        for (int k = 0; k < (study->plan.members > 1 ? 4 : 1); k++) put_part(table, parts[k], measure, NULL, values[k]);
    }
    shv_table_text(table, "message", NULL, row->message);
}

void shv_study_put_results(const ShvStudy *study, FILE *stream)
{
    put_table(study, stream, SHV_TABLE_CSV, put_result, NULL);
}

static void put_timing(ShvTable *table, const ShvStudy *study, int32_t index)
{
    const ShvStudyRow *row = &study->rows[index];
    char head[96];
    put_setting(table, study, index);
    shv_table_text(table, "valid", NULL, study->view.timings_valid ? "yes" : "no");
    put_number(table, "median", "s", NULL, row->seconds);
    put_number(table, "least", "s", NULL, row->seconds_low);
    put_number(table, "most", "s", NULL, row->seconds_high);
    for (int c = 0; c < SHV_COST_COUNT; c++) put_number(table, shv_cost_name((ShvCost)c), "s", NULL, row->costs[c]);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        shv_format(head, sizeof head, "on front of %s", study->plan.measures[i].name);
        shv_table_text(table, head, NULL, row->on_front[i] ? "yes" : "");
    }
}

void shv_study_put_timings(const ShvStudy *study, FILE *stream)
{
    put_table(study, stream, SHV_TABLE_CSV, put_timing, NULL);
}

/* ---- Markdown ---- */

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

static double courant_of(const ShvStudyRow *row)
{
    return row->courant > 0.0 ? row->courant : (double)NAN;
}

/* Of a run that failed what happened; what to do about it is in the page. */
static void put_line(ShvTable *table, const ShvStudy *study, int32_t index)
{
    const ShvStudyRow *row = &study->rows[index];
    bool failed = row->status != SHV_OK;
    shv_table_put(table, "setting", NULL, "%s%s%s%s", row->series, row->label[0] ? ", " : "", row->label,
                  row->is_reference ? " (reference)" : "");
    if (has_courant(study)) put_number(table, "Courant", "", NULL, courant_of(row));
    put_number(table, "run time", "s", NULL, row->seconds);
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        if (!has_error(study, i)) continue;
        if (row->status == SHV_OK || table->heads)
            put_number(table, measure->name, measure->error_unit, row->on_front[i] ? "best" : NULL, row->errors[i]);
        else
            shv_table_put(table, "", NULL, failed ? "failed: %.*s" : "", (int)strcspn(row->message, ";"), row->message);
        failed = false;
    }
    if (failed && !table->heads) shv_table_put(table, "", NULL, "failed: %s", row->message);
}

static void put_line_scatter(ShvTable *table, const ShvStudy *study, int32_t index)
{
    (void)index;
    shv_table_text(table, "", NULL, "scatter");
    for (int i = 0; i < (has_courant(study) ? 2 : 1); i++) shv_table_text(table, "", NULL, "");
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        if (has_error(study, i)) put_number(table, "", "", NULL, study->view.scatter[i]);
}

void shv_study_put_markdown(const ShvStudy *study, FILE *stream)
{
    put_table(study, stream, SHV_TABLE_MARKDOWN, put_line, put_line_scatter);
}

/* ---- HTML ---- */

static void put_error(ShvTable *table, const ShvStudy *study, const ShvStudyRow *row, int32_t measure)
{
    const double error = row->errors[measure], low = row->errors_low[measure], high = row->errors_high[measure];
    const bool ensemble = study->plan.members > 1, within = ensemble && error <= study->view.scatter[measure];
    const char *class = row->on_front[measure] ? "number best" : within ? "number warn" : "number";
    if (ensemble && !table->heads && isfinite(error) && isfinite(low))
        shv_table_put(table, "", class, "%.3g (%.3g to %.3g)", error, low, high);
    else
        put_part(table, "error of ", &study->plan.measures[measure], class, error);
}

static void put_run(ShvTable *table, const ShvStudy *study, int32_t index)
{
    const ShvStudyRow *row = &study->rows[index];
    const bool failed = row->status != SHV_OK;
    put_keys(table, study, index);
    put_number(table, "step", "s", "number", row->step > 0.0 ? row->step : (double)NAN);
    put_number(table, "Courant number", "", "number", courant_of(row));
    put_number(table, "run time", "s", study->view.timings_valid ? "number" : "number warn", row->seconds);
    shv_table_text(table, "", failed ? "miss" : NULL, failed ? "failed" : row->is_reference ? "reference" : "");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        if (study->plan.measures[i].unit) put_part(table, "", &study->plan.measures[i], "number", row->values[i]);
        put_error(table, study, row, i);
    }
}

static void put_run_scatter(ShvTable *table, const ShvStudy *study, int32_t index)
{
    (void)index;
    for (int32_t i = 0; i < study->plan.key_count + 4; i++)
        shv_table_text(table, "", NULL, i == 0 && study->plan.key_count > 0 ? "scatter" : "");
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        if (study->plan.measures[i].unit) shv_table_text(table, "", NULL, "");
        put_number(table, "", "", "number", study->view.scatter[i]);
    }
}

void shv_study_put_runs(const ShvStudy *study, FILE *stream)
{
    put_table(study, stream, SHV_TABLE_HTML, put_run, put_run_scatter);
}

/* Messages are long: below the table, not in it. */
void shv_study_put_failures(const ShvStudy *study, FILE *stream)
{
    int32_t failed = 0;
    for (int32_t i = 0; i < study->setting_count; i++) failed += study->rows[i].status != SHV_OK;
    if (failed == 0) return;
    ShvTable table = shv_table_begin(stream, SHV_TABLE_HTML);
    for (int32_t i = -1; i < study->setting_count; i++) {
        const int32_t index = i < 0 ? 0 : i;
        if (i >= 0 && study->rows[i].status == SHV_OK) continue;
        put_keys(&table, study, index);
        shv_table_text(&table, "why it failed", "miss", study->rows[index].message);
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
}

void shv_study_put_definitions(const ShvStudy *study, FILE *stream)
{
    ShvTable table = shv_table_begin(stream, SHV_TABLE_HTML);
    for (int32_t i = -1; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i < 0 ? 0 : i];
        shv_table_text(&table, "measure", NULL, measure->name);
        shv_table_text(&table, "error", NULL, measure->sentence ? measure->sentence : measure->error);
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
}
