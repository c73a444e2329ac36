/* The tables of a study. Results and run times are apart: the former are the same, bit for bit, wherever and however often the
   study is run. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"

/* A row as it is put. */
typedef struct Cells {
    ShvTable *table;
    void (*put)(const struct Cells *cells);
    const ShvStudy *study;
    int32_t index;
    const ShvStudyRow *row; /* of a setting, or the scatter of an ensemble, which has nothing but errors */
    bool scatter;
} Cells;

static void put_number(const Cells *cells, const char *name, const char *unit, const char *class, double value)
{
    if (cells->scatter && !isfinite(value))
        shv_table_text(cells->table, "", class, "");
    else
        shv_table_number(cells->table, name, unit, class, "%.3g", value);
}

static void put_part(const Cells *cells, const char *part, const ShvMeasure *measure, const char *class, double value)
{
    char name[128];
    shv_format(name, sizeof name, "%s%s", part, measure->name);
    put_number(cells, name, measure->error_unit, class, value);
}

static void put_keys(const Cells *cells)
{
    const ShvStudyPlan *plan = &cells->study->plan;
    for (int32_t i = 0; i < plan->key_count; i++)
        shv_table_text(cells->table, plan->keys[i], NULL,
                       !cells->scatter ? plan->settings[cells->index].values[i]
                       : i             ? ""
                                       : "scatter");
}

static void put_state(const Cells *cells)
{
    shv_table_flag(cells->table, "reference", cells->row->is_reference);
    shv_table_text(cells->table, "status", NULL, shv_status_name(cells->row->status));
}

/* What a run has none of is 0. */
static double positive(double value)
{
    return value > 0.0 ? value : (double)NAN;
}

/* ---- in full: results, run times ---- */

static void put_results(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const ShvStudyPlan *plan = &cells->study->plan;
    put_keys(cells);
    put_state(cells);
    put_number(cells, "stable step", "s", NULL, row->stable_step);
    put_number(cells, "step", "s", NULL, row->step);
    put_number(cells, "Courant number", "", NULL, row->courant);
    for (int32_t i = 0; i < plan->measure_count; i++) {
        const ShvMeasure *of = &plan->measures[i];
        if (of->unit) put_number(cells, of->name, of->unit, NULL, row->values[i]);
        put_part(cells, "error of ", of, NULL, row->errors[i]);
        if (plan->members == 1) continue;
        put_part(cells, "least error of ", of, NULL, row->errors_low[i]);
        put_part(cells, "most error of ", of, NULL, row->errors_high[i]);
        put_part(cells, "scatter of ", of, NULL, cells->study->view.scatter[i]);
    }
    shv_table_text(cells->table, "message", NULL, row->message);
}

static void put_timings(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    char head[96];
    put_keys(cells);
    put_state(cells);
    shv_table_text(cells->table, "valid", NULL, cells->study->view.timings_valid ? "yes" : "no");
    put_number(cells, "median", "s", NULL, row->seconds);
    put_number(cells, "least", "s", NULL, row->seconds_low);
    put_number(cells, "most", "s", NULL, row->seconds_high);
    for (int c = 0; c < SHV_COST_COUNT; c++) put_number(cells, shv_cost_name((ShvCost)c), "s", NULL, row->costs[c]);
    for (int32_t i = 0; i < cells->study->plan.measure_count; i++) {
        shv_format(head, sizeof head, "on front of %s", cells->study->plan.measures[i].name);
        shv_table_flag(cells->table, head, row->on_front[i]);
    }
}

/* ---- to be read: lines of table.md and of a terminal, the table of the page ---- */

/* Columns in which no row would have a figure are left out: `measure` −1 is the Courant number. Where all runs failed, what was
   to be measured is told. */
static bool has_figure(const ShvStudy *study, int32_t measure)
{
    bool failed = measure >= 0;
    for (int32_t i = 0; i < study->setting_count; i++) {
        const ShvStudyRow *row = &study->rows[i];
        if (measure < 0 ? row->courant > 0.0 : row->status == SHV_OK && isfinite(row->errors[measure])) return true;
        failed &= row->status != SHV_OK;
    }
    return failed;
}

/* Of a run that failed the first column of errors says what happened; what to do about it is in the page. */
static void put_line(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const ShvStudy *study = cells->study;
    const char *number = cells->table->form == SHV_TABLE_TEXT ? "number" : NULL;
    bool told = row->status == SHV_OK || cells->table->heads;
    shv_table_put(cells->table, "setting", NULL, "%s%s%s%s", row->series, row->label[0] ? ", " : "", row->label,
                  row->is_reference ? " (reference)" : "");
    if (has_figure(study, -1)) put_number(cells, "Courant", "", number, positive(row->courant));
    put_number(cells, "run time", "s", number, positive(row->seconds));
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *of = &study->plan.measures[i];
        if (!has_figure(study, i)) continue;
        if (row->status == SHV_OK || cells->table->heads)
            put_number(cells, of->name, of->error_unit,
                       !row->on_front[i] ? number
                       : number          ? "number best"
                                         : "best",
                       row->errors[i]);
        else
            shv_table_put(cells->table, "", NULL, told ? "" : "failed: %.*s", (int)strcspn(row->message, ";"),
                          row->message);
        told = true;
    }
    if (!told) shv_table_put(cells->table, "", NULL, "failed: %s", row->message);
}

static void put_run(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const ShvStudyView *view = &cells->study->view;
    const ShvStudyPlan *plan = &cells->study->plan;
    const bool failed = row->status != SHV_OK, ensemble = plan->members > 1 && !cells->scatter;
    put_keys(cells);
    put_number(cells, "step", "s", "number", positive(row->step));
    put_number(cells, "Courant number", "", "number", positive(row->courant));
    put_number(cells, "run time", "s", view->timings_valid ? "number" : "number warn", positive(row->seconds));
    shv_table_text(cells->table, "", failed ? "miss" : NULL, failed ? "failed" : row->is_reference ? "reference" : "");
    for (int32_t i = 0; i < plan->measure_count; i++) {
        const ShvMeasure *of = &plan->measures[i];
        const double error = row->errors[i], low = row->errors_low[i];
        const bool doubtful = ensemble && error <= view->scatter[i];
        const char *class = row->on_front[i] ? "number best" : doubtful ? "number warn" : "number";
        if (of->unit) put_number(cells, of->name, of->unit, "number", row->values[i]);
        if (ensemble && !cells->table->heads && isfinite(error) && isfinite(low))
            shv_table_put(cells->table, "", class, "%.3g (%.3g to %.3g)", error, low, row->errors_high[i]);
        else
            put_part(cells, "error of ", of, class, error);
    }
}

/* ---- all rows ---- */

static void put_cells(ShvTable *table, const void *data, int32_t index)
{
    Cells cells = *(const Cells *)data;
    const ShvStudy *study = cells.study;
    ShvStudyRow scatter = {.series = "scatter", .label = ""};
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        scatter.values[i] = (double)NAN;
        scatter.errors[i] = study->view.scatter[i];
    }
    cells.table = table;
    cells.index = index;
    cells.scatter = index == study->setting_count;
    cells.row = cells.scatter ? &scatter : &study->rows[index];
    cells.put(&cells);
}

void shv_study_put_table(const ShvStudy *study, ShvStudyTable kind, ShvTableForm form, FILE *stream)
{
    static void (*const puts[])(const Cells *cells) = {put_results, put_timings, put_line, put_run};
    const bool scatter = kind >= SHV_STUDY_LINES && study->plan.members > 1;
    const Cells cells = {.put = puts[kind], .study = study};
    shv_table_write(stream, form, study->setting_count + scatter, put_cells, &cells);
}

static void put_definition(ShvTable *table, const void *data, int32_t index)
{
    const ShvMeasure *measure = (const ShvMeasure *)data + index;
    shv_table_text(table, "measure", NULL, measure->name);
    shv_table_text(table, "error", NULL, measure->sentence ? measure->sentence : measure->error);
}

void shv_study_put_definitions(const ShvStudy *study, FILE *stream)
{
    shv_table_write(stream, SHV_TABLE_HTML, study->plan.measure_count, put_definition, study->plan.measures);
}
