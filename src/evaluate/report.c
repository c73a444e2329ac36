/* The table of verification as text, HTML, Markdown and JSON. */
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "export/html.h"
#include "export/output.h"
#include "export/table.h"
#include "shiver/verify.h"

/* What stands before a reference. */
static const char *relation_of(const ShvVerifyRow *row)
{
    static const char *const relations[] = {"", "≤ ", "≥ ", ""}, *const strict[] = {"", "< ", "> ", ""};
    return (row->strict ? strict : relations)[row->compare];
}

/* Nothing where there is no number. */
static void put_figure(ShvTable *table, const char *head, const char *before, const char *format, double value)
{
    char text[64] = "";
    if (!isnan(value)) shv_format(text, sizeof text, format, value);
    shv_table_put(table, head, "number", "%s%s", text[0] ? before : "", text);
}

ShvVerifyCase shv_verify_sum(const ShvVerifyCase *const *cases, int32_t count)
{
    ShvVerifyCase sum = {.name = ""};
    for (int32_t i = 0; i < count; i++) {
        sum.passes += cases[i]->passes;
        sum.misses += cases[i]->misses;
        sum.explained += cases[i]->explained;
        sum.seconds += cases[i]->seconds;
    }
    return sum;
}

static void put_name(ShvTable *table, const ShvVerifyRow *row)
{
    shv_table_text(table, "quantity", NULL, row->quantity);
    shv_table_text(table, "run", NULL, row->run);
}

/* Shares of the reference in percent. In a terminal the names, which are long, come last. */
static void put_row(ShvTable *table, const void *data, int32_t index)
{
    static const char *const classes[] = {"pass", "miss", "warn", NULL, "miss"}; /* of ShvVerdict */
    const ShvVerifyRow *row = (const ShvVerifyRow *)data + index;
    const double scale = row->absolute ? 1.0 : 100.0;
    const double tolerance = row->verdict == SHV_VERDICT_SHOWN ? (double)NAN : scale * row->tolerance;
    if (table->form != SHV_TABLE_TEXT) put_name(table, row);
    put_figure(table, "reference", relation_of(row), "%.6g", row->reference);
    put_figure(table, "Shiver", "", "%.6g", row->value);
    shv_table_text(table, "unit", NULL, row->unit);
    put_figure(table, "error", "", row->absolute ? "%+.3g" : "%+.3g %%", scale * row->error);
    put_figure(table, "tolerance", "", row->absolute ? "%.3g" : "%.3g %%", tolerance);
    shv_table_text(table, "verdict", classes[row->verdict], shv_verdict_name(row->verdict));
    put_figure(table, "run time, s", "", "%.3g", row->seconds);
    if (table->form == SHV_TABLE_TEXT) put_name(table, row);
}

/* A sentence once, however many rows it belongs to. */
static bool said_before(const ShvVerifyCase *of, int32_t index, bool notes)
{
    const char *own = notes ? of->rows[index].note : of->rows[index].source;
    if (!own[0] || (!notes && strcmp(own, of->source) == 0)) return true;
    for (int32_t i = 0; i < index; i++)
        if (strcmp(own, notes ? of->rows[i].note : of->rows[i].source) == 0) return true;
    return false;
}

static void put_paragraph(FILE *stream, ShvTableForm form, const char *text)
{
    if (form == SHV_TABLE_HTML)
        shv_html_paragraph(stream, text);
    else
        shv_print(stream, form == SHV_TABLE_MARKDOWN ? "\n%s\n" : "%s\n", text);
}

/* A terminal is told what misses, and no sources. */
static void put_sentences(FILE *stream, const ShvVerifyCase *of, ShvTableForm form)
{
    char text[4096];
    const bool sources = form != SHV_TABLE_TEXT;
    if (of->remark[0] && sources) put_paragraph(stream, form, of->remark);
    shv_format(text, sizeof text, "Source: %s", of->source);
    if (sources) put_paragraph(stream, form, text);
    for (int32_t i = 0; i < of->row_count; i++) {
        const ShvVerifyRow *row = &of->rows[i];
        if (sources && !said_before(of, i, false)) {
            shv_format(text, sizeof text, "Source of %s: %s", row->quantity, row->source);
            put_paragraph(stream, form, text);
        }
        if (said_before(of, i, true)) continue;
        shv_format(text, sizeof text, "%s of %s: %s", row->verdict == SHV_VERDICT_FAILED ? "Failure" : "Miss",
                   row->quantity, row->note);
        put_paragraph(stream, form, text);
    }
}

static void put_case(FILE *stream, const ShvVerifyCase *of, ShvTableForm form)
{
    char command[256];
    shv_format(command, sizeof command, "shiver verify --full %s", of->name);
    if (form == SHV_TABLE_HTML) {
        shv_html_heading(stream, 2, of->title);
        shv_html_command(stream, command);
    } else if (form == SHV_TABLE_MARKDOWN) {
        shv_print(stream, "\n## %s\n\n`%s` (%s)\n\n", of->title, of->name, of->scene);
    } else {
        shv_print(stream, "%s: %s (%.2f s)\n", of->name, of->title, of->seconds);
    }
    shv_table_write(stream, form, of->row_count, put_row, of->rows);
    put_sentences(stream, of, form);
}

void shv_verify_print(const ShvVerifyCase *verified, FILE *stream)
{
    put_case(stream, verified, SHV_TABLE_TEXT);
}

/* ---- JSON ---- */

typedef struct Cases {
    const ShvVerifyCase *const *cases;
    int32_t count;
    ShvTableForm form;
} Cases;

static void put_json_row(ShvTable *table, const void *data, int32_t index)
{
    static const char *const comparisons[] = {"near", "below", "above", "shown"};
    const ShvVerifyCase *const *of = ((const Cases *)data)->cases;
    while (index >= (*of)->row_count) index -= (*of++)->row_count;
    const ShvVerifyRow *row = &(*of)->rows[index];
    shv_table_text(table, "case", NULL, (*of)->name);
    shv_table_text(table, "quantity", NULL, row->quantity);
    shv_table_text(table, "run", NULL, row->run);
    shv_table_text(table, "unit", NULL, row->unit);
    shv_table_text(table, "compare", NULL, comparisons[row->compare]);
    shv_table_number(table, "reference", NULL, NULL, "", row->reference);
    shv_table_number(table, "value", NULL, NULL, "", row->value);
    shv_table_number(table, "error", NULL, NULL, "", row->error);
    shv_table_number(table, "tolerance", NULL, NULL, "", row->tolerance);
    shv_table_flag(table, "absolute", row->absolute);
    shv_table_text(table, "verdict", NULL, shv_verdict_name(row->verdict));
    shv_table_number(table, "seconds", NULL, NULL, "", row->seconds);
    shv_table_text(table, "source", NULL, row->source);
    shv_table_text(table, "note", NULL, row->note);
}

void shv_verify_print_json(const ShvVerifyCase *const *cases, int32_t count, FILE *stream)
{
    int32_t rows = 0;
    for (int32_t i = 0; i < count; i++) rows += cases[i]->row_count;
    shv_table_write(stream, SHV_TABLE_JSON, rows, put_json_row, &(Cases){.cases = cases});
    shv_print(stream, "\n");
}

/* ---- pages ---- */

static void put_page(const void *data, FILE *stream)
{
    const Cases *page = data;
    const ShvVerifyCase totals = shv_verify_sum(page->cases, page->count);
    const bool html = page->form == SHV_TABLE_HTML;
    char text[256];
    shv_format(text, sizeof text,
               "%d cases; %d quantities pass, %d miss with an explanation, %d miss without one; %.0f s of run time.",
               (int)page->count, (int)totals.passes, (int)totals.explained, (int)totals.misses, totals.seconds);
    if (html) shv_html_begin(stream, "Verification");
    put_paragraph(stream, html ? SHV_TABLE_HTML : SHV_TABLE_TEXT, text);
    for (int32_t i = 0; i < page->count; i++) put_case(stream, page->cases[i], page->form);
    if (html) shv_html_end(stream);
}

ShvStatus shv_verify_write(const char *path, bool html, bool force, const ShvVerifyCase *const *cases, int32_t count,
                           ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    const Cases page = {cases, count, html ? SHV_TABLE_HTML : SHV_TABLE_MARKDOWN};
    return shv_output_write(&options, path, put_page, &page, error);
}
