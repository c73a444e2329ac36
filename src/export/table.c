#include "export/table.h"

#include <string.h>

#include "base/text.h"
#include "export/html.h"
#include "export/output.h"

ShvTable shv_table_begin(FILE *stream, ShvTableForm form)
{
    if (form == SHV_TABLE_HTML) shv_print(stream, "<div class=\"wide\"><table>\n");
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

void shv_table_text(ShvTable *table, const char *head, const char *class, const char *text)
{
    static const char *const starts[][3] = {{"<tr>", "|", ""}, {"<thead><tr>", "|", ""}};
    if (table->column == 0) shv_print(table->stream, "%s", starts[table->heads][table->form]);
    if (table->heads) text = head;
    if (table->form == SHV_TABLE_HTML) {
        shv_html_element(table->stream, table->heads ? "th" : "td", table->heads ? NULL : class, text);
        if (table->heads) shv_print(table->stream, "\n");
    } else if (table->form == SHV_TABLE_MARKDOWN) {
        put_markdown(table, class, text);
    } else {
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

void shv_table_end_row(ShvTable *table)
{
    static const char *const ends[][3] = {{"</tr>\n", "\n", "\n"}, {"</tr></thead>\n<tbody>\n", "\n|", "\n"}};
    shv_print(table->stream, "%s", ends[table->heads][table->form]);
    if (table->heads && table->form == SHV_TABLE_MARKDOWN) {
        for (int i = 0; i < table->column; i++) shv_print(table->stream, table->right >> i % 64 & 1 ? "--:|" : "---|");
        shv_print(table->stream, "\n");
    }
    table->heads = false;
    table->column = 0;
}

void shv_table_end(ShvTable *table)
{
    if (table->form == SHV_TABLE_HTML) shv_print(table->stream, "</tbody>\n</table></div>\n");
}

void shv_table_write(FILE *stream, ShvTableForm form, int32_t count,
                     void (*put)(ShvTable *table, const void *data, int32_t index), const void *data)
{
    if (count == 0) return;
    ShvTable table = shv_table_begin(stream, form);
    for (int32_t i = -1; i < count; i++) {
        put(&table, data, i < 0 ? 0 : i);
        shv_table_end_row(&table);
    }
    shv_table_end(&table);
}
