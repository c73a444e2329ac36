/* One self-contained page of HTML: text, tables, figures within it, nothing that is fetched from elsewhere.

     shv_html_begin(stream, "Title");
     shv_html_heading(stream, 2, "Runs");
     shv_html_paragraph(stream, "Errors are the largest over time.");
     shv_plot_write(stream, &plot, true);
     shv_html_command(stream, "shiver study scene.yaml study.yaml");
     shv_html_end(stream);

   table.h has its tables. All texts are plain text in UTF-8, one line each, and are escaped here. Errors of writing are the
   stream's. */
#ifndef SHV_EXPORT_HTML_H
#define SHV_EXPORT_HTML_H

#include "export/plot.h"

/* Head of the page, its style, and the title as heading 1. The page has colours for the classes of cells "pass" (green), "miss"
   (red), "warn" (yellow) and "best" (bold), and "number" is set to the right; several may stand in one text, "number miss". */
void shv_html_begin(FILE *stream, const char *title);
void shv_html_end(FILE *stream);

/* `level` 2 to 6. */
void shv_html_heading(FILE *stream, int level, const char *text);
void shv_html_paragraph(FILE *stream, const char *text);
/* A line as typed: a command. */
void shv_html_command(FILE *stream, const char *text);
/* An element of that name around a text; `class` may be NULL. */
void shv_html_element(FILE *stream, const char *name, const char *class, const char *text);

#endif
