#include "base/text.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>

/* The calling thread's locale becomes "C" between enter and leave; other threads are not touched. */
typedef struct CLocale {
    locale_t own, previous;
} CLocale;

static CLocale enter_c_locale(void)
{
    CLocale c = {newlocale(LC_ALL_MASK, "C", (locale_t)0), (locale_t)0};
    if (c.own != (locale_t)0) c.previous = uselocale(c.own);
    return c;
}

static void leave_c_locale(CLocale c)
{
    if (c.own == (locale_t)0) return;
    uselocale(c.previous);
    freelocale(c.own);
}

int shv_format_list(char *buffer, size_t size, const char *format, va_list arguments)
{
    const CLocale c = enter_c_locale();
    const int length = vsnprintf(buffer, size, format, arguments);
    leave_c_locale(c);
    /* Even when the conversion fails (an unencodable wide character) the caller gets a terminated text. */
    if (length < 0 && size > 0) buffer[0] = '\0';
    return length;
}

int shv_format(char *buffer, size_t size, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = shv_format_list(buffer, size, format, arguments);
    va_end(arguments);
    return length;
}

void shv_append(char *buffer, size_t size, const char *format, ...)
{
    const size_t length = strlen(buffer);
    va_list arguments;
    va_start(arguments, format);
    shv_format_list(buffer + length, size - length, format, arguments);
    va_end(arguments);
}

int shv_print(FILE *file, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const CLocale c = enter_c_locale();
    const int length = vfprintf(file, format, arguments);
    leave_c_locale(c);
    va_end(arguments);
    return length;
}

void shv_print_json_text(FILE *file, const char *text)
{
    shv_print(file, "\"");
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c < 0x20)
            shv_print(file, "\\u%04x", (unsigned)c);
        else
            shv_print(file, c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    shv_print(file, "\"");
}

double shv_text_to_double(const char *text, char **end)
{
    const CLocale c = enter_c_locale();
    const double value = strtod(text, end);
    leave_c_locale(c);
    return value;
}
