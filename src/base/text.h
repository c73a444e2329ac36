/* Text output whose numbers always have a decimal point: as printf in the C locale, whatever setlocale says. */
#ifndef SHV_BASE_TEXT_H
#define SHV_BASE_TEXT_H

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* As snprintf and vsnprintf: always terminated (when size > 0), returns the length that was wanted. */
int shv_format(char *buffer, size_t size, const char *format, ...);
int shv_format_list(char *buffer, size_t size, const char *format, va_list arguments);
/* Behind what is there already; what does not fit is cut. */
void shv_append(char *buffer, size_t size, const char *format, ...);
/* As fprintf: a negative result is a write error. */
int shv_print(FILE *file, const char *format, ...);
/* A string of JSON with its quotes. */
void shv_print_json_text(FILE *file, const char *text);

/* strtod of the C locale. `text` must start with a number of that locale. */
double shv_text_to_double(const char *text, char **end);

#endif
