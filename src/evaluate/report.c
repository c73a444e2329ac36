/* The table of verification as HTML and as Markdown. */
#include <math.h>
#include <string.h>

#include "base/publish.h"
#include "base/text.h"
#include "evaluate/html.h"
#include "export/output.h"
#include "shiver/verify.h"

enum { CELL = 96, COLUMNS = 9 };
static const char *const heads[COLUMNS] = {"quantity", "run",       "reference", "Shiver",     "unit",
                                           "error",    "tolerance", "verdict",   "run time, s"};

const char *shv_verify_relation(const ShvVerifyRow *row)
{
    static const char *const relations[] = {"", "≤ ", "≥ ", ""}, *const strict[] = {"", "< ", "> ", ""};
    return (row->strict ? strict : relations)[row->compare];
}

/* Nothing where there is no number. */
static void put_figure(char cell[CELL], const char *before, const char *format, double value)
{
    const int length = shv_format(cell, CELL, "%s", isnan(value) ? "" : before);
    if (!isnan(value)) shv_format(cell + length, CELL - (size_t)length, format, value);
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

static const char *class_of(ShvVerdict verdict)
{
    switch (verdict) {
    case SHV_VERDICT_PASS:
        return "pass";
    case SHV_VERDICT_EXPLAINED:
        return "warn";
    case SHV_VERDICT_SHOWN:
        return NULL;
    default:
        return "miss";
    }
}

/* Shares of the reference in percent. */
static void put_row(FILE *stream, const ShvVerifyRow *row, bool html)
{
    static const char *const right = "number";
    const double scale = row->absolute ? 1.0 : 100.0;
    char reference[CELL], value[CELL], error[CELL], tolerance[CELL], seconds[CELL];
    put_figure(reference, shv_verify_relation(row), "%.6g", row->reference);
    put_figure(value, "", "%.6g", row->value);
    put_figure(error, "", row->absolute ? "%+.3g" : "%+.3g %%", scale * row->error);
    put_figure(tolerance, "", row->absolute ? "%.3g" : "%.3g %%",
               row->verdict == SHV_VERDICT_SHOWN ? (double)NAN : scale * row->tolerance);
    put_figure(seconds, "", "%.3g", row->seconds);
    const char *const texts[COLUMNS] = {row->quantity, row->run, reference, value,
                                        row->unit,     error,    tolerance, shv_verdict_name(row->verdict),
                                        seconds};
    const char *const classes[COLUMNS] = {NULL, NULL, right, right, NULL, right, right, class_of(row->verdict), right};
    shv_table_row(stream, html, texts, classes, COLUMNS);
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

static void put_sentences(FILE *stream, const ShvVerifyCase *of, Paragraph put)
{
    char text[4096];
    if (of->remark[0]) put(stream, of->remark);
    shv_format(text, sizeof text, "Source: %s", of->source);
    put(stream, text);
    for (int32_t i = 0; i < of->row_count; i++) {
        const ShvVerifyRow *row = &of->rows[i];
        if (!said_before(of, i, false)) {
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

static void put_head(FILE *stream, const ShvVerifyCase *of, bool html)
{
    char command[256];
    shv_format(command, sizeof command, "shiver verify --full %s", of->name);
    if (html) {
        shv_html_heading(stream, 2, of->title);
        shv_html_command(stream, command);
        shv_html_table_begin(stream, heads, COLUMNS);
    } else {
        shv_print(stream, "\n## %s\n\n`%s` (%s)\n\n", of->title, of->name, of->scene);
        shv_table_row(stream, false, heads, NULL, COLUMNS);
        shv_print(stream, "|---|---|--:|--:|---|--:|--:|---|--:|\n");
    }
}

static void put_page(FILE *stream, bool html, const ShvVerifyCase *const *cases, int32_t count)
{
    const ShvVerifyCase totals = shv_verify_sum(cases, count);
    char text[256];
    shv_format(text, sizeof text,
               "%d cases; %d quantities pass, %d miss with an explanation, %d miss without one; %.0f s of run time.",
               (int)count, (int)totals.passes, (int)totals.explained, (int)totals.misses, totals.seconds);
    if (html) shv_html_begin(stream, "Verification");
    if (html) shv_html_paragraph(stream, text);
    if (!html) shv_print(stream, "%s\n", text);
    for (int32_t i = 0; i < count; i++) {
        put_head(stream, cases[i], html);
        for (int32_t k = 0; k < cases[i]->row_count; k++) put_row(stream, &cases[i]->rows[k], html);
        if (html) shv_html_table_end(stream);
        put_sentences(stream, cases[i], html ? shv_html_paragraph : markdown_paragraph);
    }
    if (html) shv_html_end(stream);
}

ShvStatus shv_verify_write(const char *path, bool html, bool force, const ShvVerifyCase *const *cases, int32_t count,
                           ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    ShvOutput output;
    options.force = force;
    SHV_TRY(shv_publish_check(path, force, error));
    SHV_TRY(shv_output_open(&output, &options, path, "", error));
    put_page(output.stream, html, cases, count);
    return shv_output_close(&output, &options, SHV_OK, error);
}
