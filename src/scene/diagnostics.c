#include "scene/diagnostics.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

enum { LARGEST_COUNT = 200, LONGEST_MESSAGE = 1200 };

typedef struct Entry {
    ShvDiagnostic public;
    ShvPlace place;
    int32_t order;
} Entry;

struct ShvDiagnostics {
    ShvPool pool;
    const char *name;
    const char *const *origins; /* "--set a.b.c" of each override */
    Entry *entries;             /* LARGEST_COUNT, taken with the first fault */
    int32_t count, errors, warnings;
};

/* "--set a.b.c" of "a.b.c=value". */
static const char *origin_of(ShvPool *pool, const char *override)
{
    const char *option = "--set ";
    const size_t length = strcspn(override, "="), before = strlen(option);
    char *text = shv_pool_take(pool, before + length + 1, 1);
    if (!text) return NULL;
    memcpy(text, option, before);
    memcpy(text + before, override, length);
    return text;
}

ShvDiagnostics *shv_diagnostics_create(ShvMemory *memory, const char *name, const char *const *overrides,
                                       int32_t override_count)
{
    ShvDiagnostics *diagnostics = shv_allocate(memory, SHV_PART_SCENE, 1, sizeof *diagnostics);
    if (!diagnostics) return NULL;
    ShvPool *pool = &diagnostics->pool;
    pool->memory = memory;
    const char **origins = shv_pool_take(pool, (size_t)override_count, sizeof *origins);
    for (int32_t i = 0; i < override_count && !pool->failed; i++) origins[i] = origin_of(pool, overrides[i]);
    diagnostics->origins = origins;
    diagnostics->name = shv_pool_text(pool, name, strlen(name));
    if (pool->failed) {
        shv_diagnostics_destroy(diagnostics);
        return NULL;
    }
    return diagnostics;
}

static int write_place(const ShvDiagnostics *diagnostics, ShvPlace place, char *buffer, size_t size)
{
    if (place.origin > 0) return shv_format(buffer, size, "%.200s: ", diagnostics->origins[place.origin - 1]);
    return shv_format(buffer, size, "%.200s:%d:%d: ", diagnostics->name, (int)place.line, (int)place.column);
}

void shv_diagnose(ShvDiagnostics *diagnostics, ShvSeverity severity, ShvPlace place, const char *format, ...)
{
    const bool is_error = severity == SHV_SEVERITY_ERROR;
    if (is_error)
        diagnostics->errors++;
    else
        diagnostics->warnings++;
    if (diagnostics->count == LARGEST_COUNT) return;
    if (!diagnostics->entries)
        diagnostics->entries = shv_pool_take(&diagnostics->pool, LARGEST_COUNT, sizeof *diagnostics->entries);
    if (!diagnostics->entries) return;
    char message[LONGEST_MESSAGE];
    int length = write_place(diagnostics, place, message, sizeof message);
    length += shv_format(message + length, sizeof message - (size_t)length, "%s: ", is_error ? "error" : "warning");
    va_list arguments;
    va_start(arguments, format);
    shv_format_list(message + length, sizeof message - (size_t)length, format, arguments);
    va_end(arguments);
    const char *copy = shv_pool_text(&diagnostics->pool, message, strlen(message));
    if (!copy) return;
    const bool in_file = place.origin == 0;
    diagnostics->entries[diagnostics->count] =
        (Entry){{severity, in_file ? place.line : 0, in_file ? place.column : 0, copy}, place, diagnostics->count};
    diagnostics->count++;
}

static int compare_integers(int32_t a, int32_t b)
{
    return (a > b) - (a < b);
}

static int compare_entries(const void *first, const void *second)
{
    const Entry *a = first, *b = second;
    int order = compare_integers(a->place.origin, b->place.origin);
    if (order == 0) order = compare_integers(a->place.line, b->place.line);
    if (order == 0) order = compare_integers(a->place.column, b->place.column);
    return order != 0 ? order : compare_integers(a->order, b->order);
}

void shv_diagnostics_sort(ShvDiagnostics *diagnostics)
{
    if (diagnostics->count > 1)
        qsort(diagnostics->entries, (size_t)diagnostics->count, sizeof *diagnostics->entries, compare_entries);
}

ShvStatus shv_diagnostics_end(ShvDiagnostics *diagnostics, bool failed, const char *what, size_t bytes, ShvError *error)
{
    const int32_t errors = shv_diagnostics_errors(diagnostics);
    shv_diagnostics_sort(diagnostics);
    if (failed || diagnostics->pool.failed) return shv_fail_memory(error, what, bytes);
    for (int32_t i = 0; i < shv_diagnostics_count(diagnostics); i++) {
        const ShvDiagnostic *first = shv_diagnostics_get(diagnostics, i);
        if (first->severity != SHV_SEVERITY_ERROR) continue;
        if (errors == 1) return shv_fail(error, SHV_BAD_INPUT, "%s", first->message);
        return shv_fail(error, SHV_BAD_INPUT, "%d errors in %s; the first is %s", (int)errors, what, first->message);
    }
    return SHV_OK;
}

int32_t shv_diagnostics_count(const ShvDiagnostics *diagnostics)
{
    return diagnostics ? diagnostics->count : 0;
}

const ShvDiagnostic *shv_diagnostics_get(const ShvDiagnostics *diagnostics, int32_t index)
{
    return index >= 0 && index < shv_diagnostics_count(diagnostics) ? &diagnostics->entries[index].public : NULL;
}

int32_t shv_diagnostics_errors(const ShvDiagnostics *diagnostics)
{
    return diagnostics ? diagnostics->errors : 0;
}

int32_t shv_diagnostics_warnings(const ShvDiagnostics *diagnostics)
{
    return diagnostics ? diagnostics->warnings : 0;
}

void shv_diagnostics_destroy(ShvDiagnostics *diagnostics)
{
    if (!diagnostics) return;
    shv_pool_release(&diagnostics->pool);
    shv_release(diagnostics);
}

ShvQuoted shv_quoted(const char *text)
{
    enum { LONGEST = 60 };
    ShvQuoted quoted = {"'"};
    size_t length = strlen(text);
    const bool cut = length > LONGEST;
    if (cut) {
        length = LONGEST;
        while (length > 0 && ((unsigned char)text[length] & 0xC0u) == 0x80u) length--;
    }
    for (size_t i = 0; i < length; i++) {
        const unsigned char byte = (unsigned char)text[i];
        quoted.text[i + 1] = byte < 0x20 || byte == 0x7F ? '?' : text[i];
    }
    memcpy(quoted.text + length + 1, cut ? "...'" : "'", cut ? 5 : 2);
    return quoted;
}
