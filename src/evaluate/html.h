/* One self-contained page of HTML: text, tables, figures within it, nothing that is fetched from elsewhere.

     shv_html_begin(stream, "Title");
     shv_html_heading(stream, 2, "Runs");
     shv_html_paragraph(stream, "Errors are the largest over time.");
     static const char *const heads[] = {"step", "verdict"};
     shv_html_table_begin(stream, heads, 2);
     shv_html_row_begin(stream, NULL);
     shv_html_cell(stream, "1e-3", "number");
     shv_html_cell(stream, "stable", "pass");
     shv_html_row_end(stream);
     shv_html_table_end(stream);
     shv_html_plot(stream, &plot);
     shv_html_command(stream, "shiver study scene.yaml study.yaml");
     shv_html_end(stream);

   All texts are plain text in UTF-8, one line each, and are escaped here. Errors of writing are the stream's. */
#ifndef SHV_EVALUATE_HTML_H
#define SHV_EVALUATE_HTML_H

#include "evaluate/plot.h"

/* Head of the page, its style, and the title as heading 1. */
void shv_html_begin(FILE *stream, const char *title);
void shv_html_end(FILE *stream);

/* `level` 2 to 6. */
void shv_html_heading(FILE *stream, int level, const char *text);
void shv_html_paragraph(FILE *stream, const char *text);
/* A line as typed: a command. */
void shv_html_command(FILE *stream, const char *text);

/* A table: begin, then rows of cells, then end. The page has colours for the classes "pass" (green), "miss" (red), "warn"
   (yellow) and "best" (bold), and "number" is set to the right; several may stand in one text, "number miss". NULL: none. */
void shv_html_table_begin(FILE *stream, const char *const *heads, int32_t count);
void shv_html_row_begin(FILE *stream, const char *class);
void shv_html_cell(FILE *stream, const char *text, const char *class);
void shv_html_row_end(FILE *stream);
void shv_html_table_end(FILE *stream);

/* A row of texts at once: of HTML with classes (NULL: none), or of Markdown. */
void shv_table_row(FILE *stream, bool html, const char *const *texts, const char *const *classes, int32_t count);

/* The plot as a figure within the page. */
void shv_html_plot(FILE *stream, const ShvPlot *plot);

#endif
