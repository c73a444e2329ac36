/* The table of verification as text, HTML, Markdown and JSON. */
#include <math.h>
#include <string.h>

#include "base/text.h"
#include "export/html.h"
#include "export/output.h"
#include "export/table.h"
#include "shiver/verify.h"

const char *shv_verify_relation(const ShvVerifyRow *row)
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
    put_figure(table, "reference", shv_verify_relation(row), "%.6g", row->reference);
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

typedef void (*Paragraph)(FILE *stream, const char *text);

static void put_sentences(FILE *stream, const ShvVerifyCase *of, Paragraph put, bool sources)
{
    char text[4096];
    if (of->remark[0] && sources) put(stream, of->remark);
    shv_format(text, sizeof text, "Source: %s", of->source);
    if (sources) put(stream, text);
    for (int32_t i = 0; i < of->row_count; i++) {
        const ShvVerifyRow *row = &of->rows[i];
        if (sources && !said_before(of, i, false)) {
            shv_format(text, sizeof text, "Source of %s: %s", row->quantity, row->source);
            put(stream, text);
        }
        if (said_before(of, i, true)) continue;
        shv_format(text, sizeof text, "%s of %s: %s", row->verdict == SHV_VERDICT_FAILED ? "Failure" : "Miss",
                   row->quantity, row->note);
        put(stream, text);
    }
}

static void markdown_paragraph(FILE *stream, const char *text)
{
    shv_print(stream, "\n%s\n", text);
}

static void plain_paragraph(FILE *stream, const char *text)
{
    shv_print(stream, "%s\n", text);
}

static void put_case(FILE *stream, const ShvVerifyCase *of, bool html)
{
    char command[256];
    shv_format(command, sizeof command, "shiver verify --full %s", of->name);
    if (html) {
        shv_html_heading(stream, 2, of->title);
        shv_html_command(stream, command);
    } else {
        shv_print(stream, "\n## %s\n\n`%s` (%s)\n\n", of->title, of->name, of->scene);
    }
    shv_table_write(stream, html ? SHV_TABLE_HTML : SHV_TABLE_MARKDOWN, of->row_count, put_row, of->rows);
    put_sentences(stream, of, html ? shv_html_paragraph : markdown_paragraph, true);
}

void shv_verify_print(const ShvVerifyCase *verified, FILE *stream)
{
    shv_print(stream, "%s: %s (%.2f s)\n", verified->name, verified->title, verified->seconds);
    shv_table_write(stream, SHV_TABLE_TEXT, verified->row_count, put_row, verified->rows);
    put_sentences(stream, verified, plain_paragraph, false);
}

/* ---- JSON ---- */

static void put_json_row(FILE *stream, const ShvVerifyCase *verified, const ShvVerifyRow *row)
{
    static const char *const comparisons[] = {"near", "below", "above", "shown"};
    ShvMembers members = {.stream = stream};
    shv_print(stream, "\n  {");
    shv_member_text(&members, "case", verified->name);
    shv_member_text(&members, "quantity", row->quantity);
    shv_member_text(&members, "run", row->run);
    shv_member_text(&members, "unit", row->unit);
    shv_member_text(&members, "compare", comparisons[row->compare]);
    shv_member_number(&members, "reference", row->reference);
    shv_member_number(&members, "value", row->value);
    shv_member_number(&members, "error", row->error);
    shv_member_number(&members, "tolerance", row->tolerance);
    shv_member_flag(&members, "absolute", row->absolute);
    shv_member_text(&members, "verdict", shv_verdict_name(row->verdict));
    shv_member_number(&members, "seconds", row->seconds);
    shv_member_text(&members, "source", row->source);
    shv_member_text(&members, "note", row->note);
    shv_print(stream, "}");
}

void shv_verify_print_json(const ShvVerifyCase *const *cases, int32_t count, FILE *stream)
{
    const char *comma = "";
    shv_print(stream, "[");
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = 0; k < cases[i]->row_count; k++, comma = ",") {
            shv_print(stream, "%s", comma);
            put_json_row(stream, cases[i], &cases[i]->rows[k]);
        }
    shv_print(stream, "\n]\n");
}

/* ---- pages ---- */

typedef struct Page {
    bool html;
    const ShvVerifyCase *const *cases;
    int32_t count;
} Page;

static void put_page(const void *data, FILE *stream)
{
    const Page *page = data;
    const ShvVerifyCase totals = shv_verify_sum(page->cases, page->count);
    char text[256];
    shv_format(text, sizeof text,
               "%d cases; %d quantities pass, %d miss with an explanation, %d miss without one; %.0f s of run time.",
               (int)page->count, (int)totals.passes, (int)totals.explained, (int)totals.misses, totals.seconds);
    if (page->html) shv_html_begin(stream, "Verification");
    if (page->html) shv_html_paragraph(stream, text);
    if (!page->html) shv_print(stream, "%s\n", text);
    for (int32_t i = 0; i < page->count; i++) put_case(stream, page->cases[i], page->html);
    if (page->html) shv_html_end(stream);
}

ShvStatus shv_verify_write(const char *path, bool html, bool force, const ShvVerifyCase *const *cases, int32_t count,
                           ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = force;
    return shv_output_write(&options, path, put_page, &(Page){html, cases, count}, error);
}
