/* A table, cell by cell, as HTML, Markdown, CSV, text for a terminal, or an array of JSON. The first row that is put is that of the heads; the same calls put both, so
   that what stands above a figure is told where the figure is:

     ShvTable table = shv_table_begin(stream, SHV_TABLE_HTML);
     for (int i = -1; i < count; i++) {
         shv_table_text(&table, "run", NULL, i < 0 ? "" : runs[i].name);
         shv_table_put(&table, "error", "number", "%.3g", i < 0 ? 0.0 : runs[i].error);
         shv_table_end_row(&table);
     }
     shv_table_end(&table);

   Texts are plain text and are escaped here. Errors of writing are the stream's. */
#ifndef SHV_EXPORT_TABLE_H
#define SHV_EXPORT_TABLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef enum ShvTableForm {
    SHV_TABLE_HTML,
    SHV_TABLE_MARKDOWN,
    SHV_TABLE_CSV,
    SHV_TABLE_TEXT, /* columns below each other where shv_table_write writes it all */
    SHV_TABLE_JSON  /* an object a row, heads as keys */
} ShvTableForm;

enum { SHV_TABLE_ALIGNED = 64 }; /* columns of text, at most */

typedef struct ShvTable {
    FILE *stream; /* NULL: widths are found */
    ShvTableForm form;
    bool heads; /* the row under way is the first */
    bool any;   /* JSON: an object is there */
    int column;
    int fill, widths[SHV_TABLE_ALIGNED]; /* text: spaces before the next cell; characters by column */
    uint64_t right; /* bit by column: of numbers, which Markdown sets to the right; of the first 64 */
} ShvTable;

ShvTable shv_table_begin(FILE *stream, ShvTableForm form);
/* `class` as of the page in HTML (NULL: none); of its words Markdown knows "number" in heads, and "best", which is bold, and text
   "number", and "best", which gets a star. */
void shv_table_text(ShvTable *table, const char *head, const char *class, const char *text);
/* The same from a format, cut after some 400 bytes. */
void shv_table_put(ShvTable *table, const char *head, const char *class, const char *format, ...);
/* A number of that unit (NULL or "": none), which stands behind the head: by `format` or, in CSV and JSON, which has no units, in
   full. What is no number is a dash or, there, nothing and null. */
void shv_table_number(ShvTable *table, const char *head, const char *unit, const char *class, const char *format,
                      double value);
/* Yes, or nothing; JSON has true and false. */
void shv_table_flag(ShvTable *table, const char *head, bool flag);
void shv_table_end_row(ShvTable *table);
void shv_table_end(ShvTable *table);
/* All at once: `put` puts the cells of a row, of the first one for the heads, too. Nothing, of JSON an empty array, where there
   are no rows. */
void shv_table_write(FILE *stream, ShvTableForm form, int32_t count,
                     void (*put)(ShvTable *table, const void *data, int32_t index), const void *data);

#endif
