#include "export/html.h"

#include "base/text.h"

void shv_html_element(FILE *stream, const char *name, const char *class, const char *text)
{
    shv_print(stream, "<%s", name);
    if (class) {
        shv_print(stream, " class=\"");
        shv_html_text(stream, class);
        shv_print(stream, "\"");
    }
    shv_print(stream, ">");
    shv_html_text(stream, text);
    shv_print(stream, "</%s>", name);
}

static void put_line(FILE *stream, const char *name, const char *text)
{
    shv_html_element(stream, name, NULL, text);
    shv_print(stream, "\n");
}

void shv_html_begin(FILE *stream, const char *title)
{
    shv_print(stream, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    put_line(stream, "title", title);
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
    put_line(stream, "h1", title);
}

void shv_html_end(FILE *stream)
{
    shv_print(stream, "</body>\n</html>\n");
}

void shv_html_heading(FILE *stream, int level, const char *text)
{
    const char name[] = {'h', (char)('0' + (level < 2 ? 2 : level > 6 ? 6 : level)), '\0'};
    put_line(stream, name, text);
}

void shv_html_paragraph(FILE *stream, const char *text)
{
    put_line(stream, "p", text);
}

void shv_html_command(FILE *stream, const char *text)
{
    put_line(stream, "pre", text);
}
