/* The tables of a study. Results and run times are apart: the former are the same, bit for bit, wherever and however often the
   study is run. */
#include <string.h>

#include "base/text.h"
#include "evaluate/study.h"

/* A row as it is put. */
typedef struct Cells {
    ShvTable *table;
    ShvStudyTable kind;
    ShvTableForm form;
    const ShvStudy *study;
    const ShvStudyRow *row; /* of a setting, or the scatter of an ensemble, which has nothing but errors */
    const char *const *values;
    bool scatter;
} Cells;

typedef struct Column {
    const char *head, *unit;
    size_t offset; /* of a number in the row */
    unsigned in;   /* tables */
} Column;
#define ROW(member) offsetof(ShvStudyRow, member)
static const Column columns[] = {{"stable step", "s", ROW(stable_step), SHV_STUDY_RESULTS},
                                 {"step", "s", ROW(step), SHV_STUDY_RESULTS | SHV_STUDY_RUNS},
                                 {"Courant number", "", ROW(courant), SHV_STUDY_RESULTS | SHV_STUDY_RUNS},
                                 {"Courant", "", ROW(courant), SHV_STUDY_LINES},
                                 {"run time", "s", ROW(seconds), SHV_STUDY_LINES | SHV_STUDY_RUNS},
                                 {"median", "s", ROW(seconds), SHV_STUDY_TIMINGS},
                                 {"least", "s", ROW(seconds_low), SHV_STUDY_TIMINGS},
                                 {"most", "s", ROW(seconds_high), SHV_STUDY_TIMINGS}};

static void put_number(const Cells *cells, const char *name, const char *unit, const char *class, double value)
{
    if (!class && (cells->kind == SHV_STUDY_RUNS || cells->form == SHV_TABLE_TEXT)) class = "number";
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

/* Columns of table.md in which no row would have a figure are left out: `measure` −1 is the Courant number. Where all runs
   failed, what was to be measured is told. */
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

static void put_numbers(const Cells *cells)
{
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        double value;
        memcpy(&value, (const char *)cells->row + columns[i].offset, sizeof value);
        if (!(columns[i].in & cells->kind) || (columns[i].in == SHV_STUDY_LINES && !has_figure(cells->study, -1)))
            continue;
        if (!(cells->kind & SHV_STUDY_EXACT) && !(value > 0.0)) value = (double)NAN;
        const bool doubtful = columns[i].offset == ROW(seconds) && !cells->study->view.timings_valid;
        put_number(cells, columns[i].head, columns[i].unit,
                   doubtful && cells->kind == SHV_STUDY_RUNS ? "number warn" : NULL, value);
    }
}

static void put_setting(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const ShvStudyPlan *plan = &cells->study->plan;
    if (cells->kind == SHV_STUDY_LINES)
        shv_table_put(cells->table, "setting", NULL, "%s%s%s%s", row->series, row->label[0] ? ", " : "", row->label,
                      row->is_reference ? " (reference)" : "");
    for (int32_t i = 0; i < plan->key_count && cells->kind != SHV_STUDY_LINES; i++)
        shv_table_text(cells->table, plan->keys[i], NULL, !cells->scatter ? cells->values[i] : i ? "" : "scatter");
    if (!(cells->kind & SHV_STUDY_EXACT)) return;
    shv_table_text(cells->table, "reference", NULL, row->is_reference ? "yes" : "");
    shv_table_text(cells->table, "status", NULL, shv_status_name(row->status));
}

static void put_error(const Cells *cells, int32_t measure)
{
    const ShvStudyRow *row = cells->row;
    const ShvMeasure *of = &cells->study->plan.measures[measure];
    const double error = row->errors[measure], low = row->errors_low[measure], high = row->errors_high[measure];
    const double scatter = cells->study->view.scatter[measure];
    const bool best = row->on_front[measure], ensemble = cells->study->plan.members > 1 && !cells->scatter;
    if (cells->kind == SHV_STUDY_LINES) {
        put_number(cells, of->name, of->error_unit,
                   best ? "number best" + (cells->form == SHV_TABLE_MARKDOWN ? 7 : 0) : NULL, error);
        return;
    }
    if (of->unit) put_number(cells, of->name, of->unit, NULL, row->values[measure]);
    const char *class = best ? "number best" : ensemble && error <= scatter ? "number warn" : "number";
    if (cells->kind == SHV_STUDY_RUNS && ensemble && !cells->table->heads && isfinite(error) && isfinite(low))
        shv_table_put(cells->table, "", class, "%.3g (%.3g to %.3g)", error, low, high);
    else
        put_part(cells, "error of ", of, class, error);
    if (cells->kind != SHV_STUDY_RESULTS || !ensemble) return;
    put_part(cells, "least error of ", of, NULL, low);
    put_part(cells, "most error of ", of, NULL, high);
    put_part(cells, "scatter of ", of, NULL, scatter);
}

/* Of a run that failed table.md says in its first column what happened; what to do about it is in the page. */
static void put_errors(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const bool told = cells->kind == SHV_STUDY_LINES && row->status != SHV_OK && !cells->table->heads;
    bool first = true;
    for (int32_t i = 0; i < cells->study->plan.measure_count; i++) {
        if (cells->kind == SHV_STUDY_LINES && !has_figure(cells->study, i)) continue;
        if (told)
            shv_table_put(cells->table, "", NULL, first ? "failed: %.*s" : "", (int)strcspn(row->message, ";"),
                          row->message);
        else
            put_error(cells, i);
        first = false;
    }
    if (told && first) shv_table_put(cells->table, "", NULL, "failed: %s", row->message);
}

static void put_row(const Cells *cells)
{
    const ShvStudyRow *row = cells->row;
    const bool failed = row->status != SHV_OK;
    char head[96];
    put_setting(cells);
    if (cells->kind == SHV_STUDY_TIMINGS)
        shv_table_text(cells->table, "valid", NULL, cells->study->view.timings_valid ? "yes" : "no");
    put_numbers(cells);
    if (cells->kind == SHV_STUDY_RUNS)
        shv_table_text(cells->table, "", failed ? "miss" : NULL,
                       failed              ? "failed"
                       : row->is_reference ? "reference"
                                           : "");
    if (cells->kind != SHV_STUDY_TIMINGS) put_errors(cells);
    if (cells->kind == SHV_STUDY_RESULTS) shv_table_text(cells->table, "message", NULL, row->message);
    if (cells->kind != SHV_STUDY_TIMINGS) return;
    for (int c = 0; c < SHV_COST_COUNT; c++) put_number(cells, shv_cost_name((ShvCost)c), "s", NULL, row->costs[c]);
    for (int32_t i = 0; i < cells->study->plan.measure_count; i++) {
        shv_format(head, sizeof head, "on front of %s", cells->study->plan.measures[i].name);
        shv_table_text(cells->table, head, NULL, row->on_front[i] ? "yes" : "");
    }
}

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
    cells.scatter = index == study->setting_count;
    cells.row = cells.scatter ? &scatter : &study->rows[index];
    cells.values = cells.scatter || !study->plan.settings ? NULL : study->plan.settings[index].values;
    put_row(&cells);
}

void shv_study_put_table(const ShvStudy *study, ShvStudyTable kind, ShvTableForm form, FILE *stream)
{
    const Cells cells = {.kind = kind, .form = form, .study = study};
    const int32_t scatter = !(kind & SHV_STUDY_EXACT) && study->plan.members > 1 ? 1 : 0;
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
