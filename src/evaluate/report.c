/* The table of verification as HTML and as Markdown. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "evaluate/html.h"
#include "export/output.h"
#include "shiver/verify.h"

enum { CELL = 96, COLUMNS = 9 };
static const char *const heads[COLUMNS] = {"quantity", "run",       "reference", "Shiver",     "unit",
                                           "error",    "tolerance", "verdict",   "run time, s"};

/* Texts of one row. */
typedef struct Cells {
    char reference[CELL], value[CELL], error[CELL], tolerance[CELL], seconds[CELL];
} Cells;

const char *shv_verify_relation(const ShvVerifyRow *row)
{
    static const char *const relations[] = {"", "≤ ", "≥ ", ""}, *const strict[] = {"", "< ", "> ", ""};
    return (row->strict ? strict : relations)[row->compare];
}

static void put_number(char *cell, const char *before, double value)
{
    if (isnan(value))
        shv_format(cell, CELL, "%s", "");
    else
        shv_format(cell, CELL, "%s%.6g", before, value);
}

/* Shares of the reference in percent. */
static void put_share(char *cell, double value, bool absolute, bool sign)
{
    if (isnan(value))
        cell[0] = '\0';
    else if (absolute)
        shv_format(cell, CELL, sign ? "%+.3g" : "%.3g", value);
    else
        shv_format(cell, CELL, sign ? "%+.3g %%" : "%.3g %%", 100.0 * value);
}

static Cells cells_of(const ShvVerifyRow *row)
{
    Cells cells;
    put_number(cells.reference, shv_verify_relation(row), row->reference);
    put_number(cells.value, "", row->value);
    put_share(cells.error, row->error, row->absolute, true);
    put_share(cells.tolerance, row->verdict == SHV_VERDICT_SHOWN ? (double)NAN : row->tolerance, row->absolute, false);
    if (isnan(row->seconds))
        cells.seconds[0] = '\0';
    else
        shv_format(cells.seconds, CELL, "%.3g", row->seconds);
    return cells;
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

static void summarise(char *text, size_t size, const ShvVerifyCase *const *cases, int32_t count)
{
    const ShvVerifyCase totals = shv_verify_sum(cases, count);
    shv_format(text, size,
               "%d cases; %d quantities pass, %d miss with an explanation, %d miss without one; %.0f s of run time.",
               (int)count, (int)totals.passes, (int)totals.explained, (int)totals.misses, totals.seconds);
}

/* ---- HTML ---- */

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

static void html_row(FILE *stream, const ShvVerifyRow *row)
{
    const Cells cells = cells_of(row);
    shv_html_row_begin(stream, NULL);
    shv_html_cell(stream, row->quantity, NULL);
    shv_html_cell(stream, row->run, NULL);
    shv_html_cell(stream, cells.reference, "number");
    shv_html_cell(stream, cells.value, "number");
    shv_html_cell(stream, row->unit, NULL);
    shv_html_cell(stream, cells.error, "number");
    shv_html_cell(stream, cells.tolerance, "number");
    shv_html_cell(stream, shv_verdict_name(row->verdict), class_of(row->verdict));
    shv_html_cell(stream, cells.seconds, "number");
    shv_html_row_end(stream);
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

static void html_page(FILE *stream, const ShvVerifyCase *const *cases, int32_t count)
{
    char text[256];
    shv_html_begin(stream, "Verification");
    summarise(text, sizeof text, cases, count);
    shv_html_paragraph(stream, text);
    for (int32_t i = 0; i < count; i++) {
        shv_html_heading(stream, 2, cases[i]->title);
        shv_format(text, sizeof text, "shiver verify --full %s", cases[i]->name);
        shv_html_command(stream, text);
        shv_html_table_begin(stream, heads, COLUMNS);
        for (int32_t k = 0; k < cases[i]->row_count; k++) html_row(stream, &cases[i]->rows[k]);
        shv_html_table_end(stream);
        put_sentences(stream, cases[i], shv_html_paragraph);
    }
    shv_html_end(stream);
}

/* ---- Markdown ---- */

/* A bar would end the cell. */
static void markdown_cell(FILE *stream, const char *text)
{
    shv_print(stream, " ");
    for (; *text; text++) shv_print(stream, *text == '|' ? "\\|" : *text == '\n' ? " " : "%c", *text);
    shv_print(stream, " |");
}

static void markdown_paragraph(FILE *stream, const char *text)
{
    shv_print(stream, "\n%s\n", text);
}

static void markdown_row(FILE *stream, const ShvVerifyRow *row)
{
    const Cells cells = cells_of(row);
    const char *const texts[COLUMNS] = {row->quantity, row->run,    cells.reference, cells.value,
                                        row->unit,     cells.error, cells.tolerance, shv_verdict_name(row->verdict),
                                        cells.seconds};
    shv_print(stream, "|");
    for (int i = 0; i < COLUMNS; i++) markdown_cell(stream, texts[i]);
    shv_print(stream, "\n");
}

static void markdown_tables(FILE *stream, const ShvVerifyCase *const *cases, int32_t count)
{
    char text[256];
    summarise(text, sizeof text, cases, count);
    shv_print(stream, "%s\n", text);
    for (int32_t i = 0; i < count; i++) {
        shv_print(stream, "\n## %s\n\n`%s` (%s)\n\n|", cases[i]->title, cases[i]->name, cases[i]->scene);
        for (int k = 0; k < COLUMNS; k++) markdown_cell(stream, heads[k]);
        shv_print(stream, "\n|---|---|--:|--:|---|--:|--:|---|--:|\n");
        for (int32_t k = 0; k < cases[i]->row_count; k++) markdown_row(stream, &cases[i]->rows[k]);
        put_sentences(stream, cases[i], markdown_paragraph);
    }
}

/* ---- files ---- */

typedef void (*WritePage)(FILE *stream, const ShvVerifyCase *const *cases, int32_t count);

static ShvStatus write_page(const char *path, bool force, WritePage page, const ShvVerifyCase *const *cases,
                            int32_t count, ShvError *error)
{
    static const char *const suffixes[] = {""};
    ShvExportOptions options = shv_export_default();
    ShvOutput output;
    options.force = force;
    SHV_TRY(shv_output_check(&options, path, suffixes, 1, error));
    SHV_TRY(shv_output_open(&output, &options, path, "", error));
    page(output.stream, cases, count);
    return shv_output_close(&output, &options, SHV_OK, error);
}

ShvStatus shv_verify_write_html(const char *path, bool force, const ShvVerifyCase *const *cases, int32_t count,
                                ShvError *error)
{
    return write_page(path, force, html_page, cases, count, error);
}

ShvStatus shv_verify_write_markdown(const char *path, bool force, const ShvVerifyCase *const *cases, int32_t count,
                                    ShvError *error)
{
    return write_page(path, force, markdown_tables, cases, count, error);
}
