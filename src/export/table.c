#include "export/table.h"

#include <math.h>
#include <string.h>

#include "base/text.h"
#include "export/html.h"
#include "export/output.h"

ShvTable shv_table_begin(FILE *stream, ShvTableForm form)
{
    static const char *const begins[] = {"<div class=\"wide\"><table>\n", "", "", "", "["};
    shv_print(stream, "%s", begins[form]);
    return (ShvTable){.stream = stream, .form = form, .heads = true};
}

/* A bar would end a cell. */
static void put_markdown(ShvTable *table, const char *class, const char *text)
{
    const char *mark = !table->heads && class && strstr(class, "best") ? "**" : "";
    shv_print(table->stream, " %s", mark);
    for (; *text; text++) shv_print(table->stream, *text == '|' ? "\\|" : *text == '\n' ? " " : "%c", *text);
    shv_print(table->stream, "%s |", mark);
    if (table->heads && class && strstr(class, "number")) table->right |= (uint64_t)1 << table->column % 64;
}

/* Numbers to the right. A text that is longer than most hangs over; control characters would move the terminal. */
static void put_aligned(ShvTable *table, const char *class, const char *text)
{
    enum { LONGEST = 72 };
    const bool number = class && strstr(class, "number");
    const char *mark = !class || table->heads ? "" : strstr(class, "best") ? "*" : number ? " " : "";
    int length = (int)strlen(mark), *width = &table->widths[table->column % SHV_TABLE_ALIGNED];
    for (const char *c = text; *c; c++) length += ((unsigned char)*c & 0xc0) != 0x80; /* begins a character of UTF-8 */
    if (!table->stream) {
        if (length > *width && length <= LONGEST) *width = length;
        return;
    }
    const int rest = *width > length ? *width - length : 0;
    shv_print(table->stream, "%*s", table->fill + (number ? rest : 0), "");
    for (; *text; text++) shv_print(table->stream, "%c", (unsigned char)*text < 0x20 ? ' ' : *text);
    shv_print(table->stream, "%s", mark);
    table->fill = 2 + (number ? 0 : rest);
}

/* Whether there is a member to put: JSON has no heads. */
static bool begin_member(ShvTable *table, ShvMembers *members)
{
    *members = (ShvMembers){table->stream, table->column++ > 0};
    if (!members->any && !table->heads) shv_print(table->stream, table->any ? ",\n {" : "\n {");
    table->any |= !table->heads;
    return !table->heads;
}

void shv_table_text(ShvTable *table, const char *head, const char *class, const char *text)
{
    static const char *const starts[][3] = {{"<tr>", "|", ""}, {"<thead><tr>", "|", ""}};
    if (table->column == 0 && table->form <= SHV_TABLE_CSV)
        shv_print(table->stream, "%s", starts[table->heads][table->form]);
    if (table->form == SHV_TABLE_JSON) {
        ShvMembers members;
        if (begin_member(table, &members)) shv_member_text(&members, head, text);
        return;
    }
    if (table->heads) text = head;
    if (table->form == SHV_TABLE_HTML) {
        shv_html_element(table->stream, table->heads ? "th" : "td", table->heads ? NULL : class, text);
        if (table->heads) shv_print(table->stream, "\n");
    } else if (table->form == SHV_TABLE_MARKDOWN) {
        put_markdown(table, class, text);
    } else if (table->form == SHV_TABLE_TEXT) {
        put_aligned(table, class, text);
    } else if (table->form == SHV_TABLE_CSV) {
        if (table->column > 0) shv_print(table->stream, ",");
        shv_output_field(table->stream, text);
    }
    table->column++;
}

void shv_table_put(ShvTable *table, const char *head, const char *class, const char *format, ...)
{
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    shv_format_list(text, sizeof text, format, arguments);
    va_end(arguments);
    shv_table_text(table, head, class, text);
}

void shv_table_number(ShvTable *table, const char *head, const char *unit, const char *class, const char *format,
                      double value)
{
    char full[160], text[64] = "";
    const bool csv = table->form == SHV_TABLE_CSV;
    if (table->form == SHV_TABLE_JSON) {
        ShvMembers members;
        if (begin_member(table, &members)) shv_member_number(&members, head, value);
        return;
    }
    shv_format(full, sizeof full, !unit || unit[0] == '\0' ? "%s" : csv ? "%s [%s]" : "%s, %s", head, unit);
    if (csv && isfinite(value))
        shv_output_format(text, value);
    else if (!csv && isnan(value))
        shv_format(text, sizeof text, table->form == SHV_TABLE_TEXT ? "-" : "–");
    else if (!csv)
        shv_format(text, sizeof text, format, value);
    shv_table_text(table, full, class, text);
}

void shv_table_flag(ShvTable *table, const char *head, bool flag)
{
    ShvMembers members;
    if (table->form != SHV_TABLE_JSON)
        shv_table_text(table, head, NULL, flag ? "yes" : "");
    else if (begin_member(table, &members))
        shv_member_flag(&members, head, flag);
}

void shv_table_end_row(ShvTable *table)
{
    static const char *const ends[][5] = {{"</tr>\n", "\n", "\n", "\n", "}"},
                                          {"</tr></thead>\n<tbody>\n", "\n|", "\n", "\n", ""}};
    if (table->stream) shv_print(table->stream, "%s", ends[table->heads][table->form]);
    if (table->heads && table->form == SHV_TABLE_MARKDOWN) {
        for (int i = 0; i < table->column; i++) shv_print(table->stream, table->right >> i % 64 & 1 ? "--:|" : "---|");
        shv_print(table->stream, "\n");
    }
    table->heads = false;
    table->column = table->fill = 0;
}

void shv_table_end(ShvTable *table)
{
    static const char *const ends[] = {"</tbody>\n</table></div>\n", "", "", "", "\n]"};
    shv_print(table->stream, "%s", ends[table->form]);
}

void shv_table_write(FILE *stream, ShvTableForm form, int32_t count,
                     void (*put)(ShvTable *table, const void *data, int32_t index), const void *data)
{
    if (count == 0 && form != SHV_TABLE_JSON) return;
    ShvTable table = shv_table_begin(stream, form);
    for (int pass = form == SHV_TABLE_TEXT ? 0 : 1; pass < 2; pass++) {
        table.heads = true;
        table.stream = pass == 0 ? NULL : stream;
        for (int32_t i = -1; i < count && count > 0; i++) {
            put(&table, data, i < 0 ? 0 : i);
            shv_table_end_row(&table);
        }
    }
    shv_table_end(&table);
}
