#include "base/file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/text.h"

ShvStatus shv_path_join(ShvMemory *memory, ShvPart part, const char *folder, const char *file, char **path,
                        ShvError *error)
{
    const size_t before = folder && file[0] != '/' ? strlen(folder) : 0, after = strlen(file);
    const size_t slash = before > 0 && folder[before - 1] != '/' ? 1 : 0;
    char *joined = shv_allocate(memory, part, before + slash + after + 1, 1);
    *path = joined;
    if (!joined) return shv_fail_memory(error, "a path", before + slash + after + 1);
    if (before > 0) memcpy(joined, folder, before);
    if (slash) joined[before] = '/';
    memcpy(joined + before + slash, file, after);
    return SHV_OK;
}

ShvStatus shv_path_folder(ShvMemory *memory, ShvPart part, const char *path, char **folder, ShvError *error)
{
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (slash == path) length = 1; /* the root is named by its slash */
    *folder = shv_allocate(memory, part, length + 1, 1);
    if (!*folder) return shv_fail_memory(error, "a path", length + 1);
    memcpy(*folder, path, length);
    return SHV_OK;
}

/* ---- whole files -------------------------------------------------------------------------------------- */

static ShvStatus fail_reading(ShvError *error, const char *path, int number)
{
    char reason[128] = "unknown error";
    if (number == 0 || strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "read error");
    return shv_fail(error, SHV_FILE_ERROR, "cannot read '%s': %s; check the name and the permissions", path, reason);
}

/* Bytes to ask for at first: the length of an ordinary file and one more, so that its end is seen in one reading. */
static size_t first_capacity(FILE *file, size_t limit)
{
    struct stat about;
    if (fstat(fileno(file), &about) != 0 || !S_ISREG(about.st_mode) || about.st_size <= 0) return 4096;
    const uint64_t length = (uint64_t)about.st_size;
    return (length < limit ? (size_t)length : limit) + 2;
}

static ShvStatus read_all(ShvMemory *memory, ShvPart part, FILE *file, const char *path, size_t limit, char **data,
                          size_t *size, ShvError *error)
{
    size_t capacity = first_capacity(file, limit);
    for (;;) {
        char *grown = shv_reallocate(memory, part, *data, capacity, 1);
        if (!grown) return shv_fail_memory(error, path, capacity);
        *data = grown;
        errno = 0;
        *size += fread(*data + *size, 1, capacity - 1 - *size, file);
        if (ferror(file)) return fail_reading(error, path, errno);
        if (*size > limit)
            return shv_fail(error, SHV_BAD_INPUT, "'%s' is longer than %zu bytes; is it the right file?", path, limit);
        if (*size < capacity - 1) break;
        capacity *= 2;
    }
    (*data)[*size] = '\0';
    return SHV_OK;
}

ShvStatus shv_read_file(ShvMemory *memory, ShvPart part, const char *path, size_t limit, char **data, size_t *size,
                        ShvError *error)
{
    *data = NULL;
    *size = 0;
    errno = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return fail_reading(error, path, errno);
    const ShvStatus status = read_all(memory, part, file, path, limit, data, size, error);
    fclose(file);
    if (status != SHV_OK) {
        shv_release(*data);
        *data = NULL;
        *size = 0;
    }
    return status;
}

/* ---- numbers ------------------------------------------------------------------------------------------ */

/* Longer numbers are refused: 17 digits tell all doubles apart, and no writer pads to this. */
enum { LONGEST_NUMBER = 511, SHOWN = 40 };

static size_t skip_digits(const char *text, size_t i, size_t length)
{
    while (i < length && text[i] >= '0' && text[i] <= '9') i++;
    return i;
}

static size_t skip_sign(const char *text, size_t i, size_t length)
{
    return i < length && (text[i] == '+' || text[i] == '-') ? i + 1 : i;
}

/* sign? (digits ('.' digits?)? | '.' digits) ([eE] sign? digits)? */
static bool is_decimal(const char *text, size_t length)
{
    const size_t start = skip_sign(text, 0, length);
    size_t i = skip_digits(text, start, length), digits = i - start;
    if (i < length && text[i] == '.') {
        const size_t point = i + 1;
        i = skip_digits(text, point, length);
        digits += i - point;
    }
    if (digits == 0) return false;
    if (i < length && (text[i] == 'e' || text[i] == 'E')) {
        const size_t exponent = skip_sign(text, i + 1, length);
        i = skip_digits(text, exponent, length);
        if (i == exponent) return false;
    }
    return i == length;
}

static bool same_word(const char *text, size_t length, const char *word)
{
    if (length != strlen(word)) return false;
    for (size_t i = 0; i < length; i++)
        if ((text[i] | 0x20) != word[i]) return false;
    return true;
}

static bool parse_special(const char *text, size_t length, double *value)
{
    const size_t sign = skip_sign(text, 0, length);
    const char *word = text + sign;
    const size_t rest = length - sign;
    if (same_word(word, rest, "nan"))
        *value = (double)NAN;
    else if (same_word(word, rest, "inf") || same_word(word, rest, "infinity"))
        *value = text[0] == '-' ? -(double)INFINITY : (double)INFINITY;
    else
        return false;
    return true;
}

static ShvStatus fail_number(ShvError *error, const char *text, size_t length, const char *problem)
{
    const bool cut = length > SHOWN;
    return shv_fail(error, SHV_BAD_INPUT, "'%.*s%s' %s", (int)(cut ? SHOWN : length), text, cut ? "…" : "", problem);
}

ShvStatus shv_parse_double(const char *text, size_t length, bool special, double *value, ShvError *error)
{
    if (special && parse_special(text, length, value)) return SHV_OK;
    if (!is_decimal(text, length)) return fail_number(error, text, length, "is not a number");
    if (length > LONGEST_NUMBER) return fail_number(error, text, length, "is too long for a number");
    char copy[LONGEST_NUMBER + 1];
    memcpy(copy, text, length);
    copy[length] = '\0';
    const double result = shv_text_to_double(copy, NULL);
    if (isinf(result)) return fail_number(error, text, length, "is beyond the largest number (1.8e308)");
    *value = result;
    return SHV_OK;
}

ShvStatus shv_parse_int64(const char *text, size_t length, int64_t *value, ShvError *error)
{
    size_t i = skip_sign(text, 0, length);
    if (i == length || skip_digits(text, i, length) != length)
        return fail_number(error, text, length, "is not a whole number");
    const bool negative = text[0] == '-';
    int64_t result = 0; /* counted downwards: the most negative number has no positive twin */
    for (; i < length; i++) {
        const int digit = text[i] - '0';
        if (result < (INT64_MIN + digit) / 10) return fail_number(error, text, length, "is beyond 64 bits");
        result = result * 10 - digit;
    }
    if (!negative && result == INT64_MIN) return fail_number(error, text, length, "is beyond 64 bits");
    *value = negative ? result : -result;
    return SHV_OK;
}
