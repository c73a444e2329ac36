#include "evaluate/html.h"

#include "base/text.h"

static void put_element(FILE *stream, const char *name, const char *text)
{
    shv_print(stream, "<%s>", name);
    shv_html_text(stream, text);
    shv_print(stream, "</%s>\n", name);
}

static void put_open(FILE *stream, const char *name, const char *class)
{
    shv_print(stream, "<%s", name);
    if (class) {
        shv_print(stream, " class=\"");
        shv_html_text(stream, class);
        shv_print(stream, "\"");
    }
    shv_print(stream, ">");
}

void shv_html_begin(FILE *stream, const char *title)
{
    shv_print(stream, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    put_element(stream, "title", title);
    shv_print(stream, "<style>\n"
                      "body{font-family:Helvetica,Arial,sans-serif;color:#2c2a26;background:#fff;max-width:72rem;"
                      "margin:2rem auto;padding:0 1rem;line-height:1.45}\n"
                      ".wide{overflow-x:auto}\n"
                      "table{border-collapse:collapse;font-size:.9rem;margin:1rem 0}\n"
                      "th,td{border-bottom:1px solid #e2dfd8;padding:.3rem .7rem;text-align:left;vertical-align:top}\n"
                      "th{border-bottom-color:#8d877b}\n"
                      ".number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}\n"
                      ".pass{background:#dff1e2}.miss{background:#f7d9d3}.warn{background:#f8efcf}"
                      ".best{font-weight:bold}\n"
                      "pre{background:#f4f2ee;padding:.7rem 1rem;border-radius:6px;white-space:pre-wrap}\n"
                      "figure{margin:1rem 0}svg{max-width:100%%;height:auto}\n"
                      "</style>\n</head>\n<body>\n");
    put_element(stream, "h1", title);
}

void shv_html_end(FILE *stream)
{
    shv_print(stream, "</body>\n</html>\n");
}

void shv_html_heading(FILE *stream, int level, const char *text)
{
    const char name[] = {'h', (char)('0' + (level < 2 ? 2 : level > 6 ? 6 : level)), '\0'};
    put_element(stream, name, text);
}

void shv_html_paragraph(FILE *stream, const char *text)
{
    put_element(stream, "p", text);
}

void shv_html_command(FILE *stream, const char *text)
{
    put_element(stream, "pre", text);
}

void shv_html_table_begin(FILE *stream, const char *const *heads, int32_t count)
{
    shv_print(stream, "<div class=\"wide\"><table>\n<thead><tr>");
    for (int32_t i = 0; i < count; i++) put_element(stream, "th", heads[i]);
    shv_print(stream, "</tr></thead>\n<tbody>\n");
}

void shv_html_row_begin(FILE *stream, const char *class)
{
    put_open(stream, "tr", class);
}

void shv_html_cell(FILE *stream, const char *text, const char *class)
{
    put_open(stream, "td", class);
    shv_html_text(stream, text);
    shv_print(stream, "</td>");
}

void shv_html_row_end(FILE *stream)
{
    shv_print(stream, "</tr>\n");
}

void shv_html_table_end(FILE *stream)
{
    shv_print(stream, "</tbody>\n</table></div>\n");
}

/* A bar would end a cell of Markdown. */
static void put_markdown_cell(FILE *stream, const char *text)
{
    shv_print(stream, " ");
    for (; *text; text++) shv_print(stream, *text == '|' ? "\\|" : *text == '\n' ? " " : "%c", *text);
    shv_print(stream, " |");
}

void shv_table_row(FILE *stream, bool html, const char *const *texts, const char *const *classes, int32_t count)
{
    shv_print(stream, html ? "<tr>" : "|");
    for (int32_t i = 0; i < count; i++)
        if (html)
            shv_html_cell(stream, texts[i], classes[i]);
        else
            put_markdown_cell(stream, texts[i]);
    shv_print(stream, html ? "</tr>\n" : "\n");
}

void shv_html_plot(FILE *stream, const ShvPlot *plot)
{
    shv_print(stream, "<figure>\n");
    shv_plot_write(stream, plot, true);
    shv_print(stream, "</figure>\n");
}
