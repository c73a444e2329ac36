#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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

ShvStatus shv_make_folder(const char *path, ShvError *error)
{
    struct stat about;
    if (mkdir(path, 0777) == 0) return SHV_OK;
    if (errno == EEXIST && stat(path, &about) == 0 && S_ISDIR(about.st_mode)) return SHV_OK;
    return shv_fail(error, SHV_FILE_ERROR, "cannot make the folder '%s': %s", path, strerror(errno));
}

bool shv_same_file(const char *a, const char *b)
{
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

/* ---- whole files -------------------------------------------------------------------------------------- */

static ShvStatus fail_reading(ShvError *error, const char *path, int number)
{
    char reason[128] = "unknown error";
    if (number == 0 || strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "read error");
    return shv_fail(error, SHV_FILE_ERROR, "cannot read '%s': %s; check the name and the permissions", path, reason);
}

/* s; that long a named pipe waits for somebody to write to it */
enum { PATIENCE = 5 };
/* Bytes that a pipe may deliver: it does not say how many there will be. */
static const size_t LONGEST_PIPE = (size_t)1 << 30;

/* A pipe is opened without waiting for its other end, and then read as any file. */
static ShvStatus await_pipe(int descriptor, const char *path, ShvError *error)
{
    struct pollfd wanted = {.fd = descriptor, .events = POLLIN};
    int ready = poll(&wanted, 1, 1000 * PATIENCE);
    while (ready < 0 && errno == EINTR) ready = poll(&wanted, 1, 1000 * PATIENCE);
    if (ready < 0) return fail_reading(error, path, errno);
    if (ready == 0)
        return shv_fail(error, SHV_BAD_INPUT, "nothing has been written to the pipe '%s' for %d s; give a file", path,
                        PATIENCE);
    const int flags = fcntl(descriptor, F_GETFL);
    if (flags < 0 || fcntl(descriptor, F_SETFL, flags & ~O_NONBLOCK) < 0) return fail_reading(error, path, errno);
    return SHV_OK;
}

/* A device never ends: files and pipes are read. */
static ShvStatus open_readable(const char *path, FILE **file, int64_t *length, ShvError *error)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return fail_reading(error, path, errno);
    struct stat about;
    ShvStatus status = SHV_OK;
    if (fstat(descriptor, &about) != 0)
        status = fail_reading(error, path, errno);
    else if (S_ISDIR(about.st_mode))
        status = shv_fail(error, SHV_BAD_INPUT, "'%s' is a folder; give a file", path);
    else if (S_ISFIFO(about.st_mode))
        status = await_pipe(descriptor, path, error);
    else if (!S_ISREG(about.st_mode))
        status = shv_fail(error, SHV_BAD_INPUT, "'%s' is a device; give a file", path);
    if (status == SHV_OK && !(*file = fdopen(descriptor, "rb"))) status = shv_fail_memory(error, path, sizeof **file);
    if (status != SHV_OK) close(descriptor);
    *length = status == SHV_OK && S_ISREG(about.st_mode) ? (int64_t)about.st_size : 0;
    return status;
}

/* `length` and one more byte are asked for at first, so that the end is seen in one reading. */
static ShvStatus read_all(ShvMemory *memory, ShvPart part, FILE *file, const char *path, int64_t length, size_t limit,
                          char **data, size_t *size, ShvError *error)
{
    if (length > 0 && (uint64_t)length > limit)
        return shv_fail(error, SHV_BAD_INPUT, "'%s' is longer than %zu bytes; is it the right file?", path, limit);
    if (length == 0 && limit > LONGEST_PIPE) limit = LONGEST_PIPE;
    size_t capacity = length > 0 ? (size_t)length + 2 : 4096;
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
    FILE *file = NULL;
    int64_t length = 0;
    SHV_TRY(open_readable(path, &file, &length, error));
    const ShvStatus status = read_all(memory, part, file, path, length, limit, data, size, error);
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
