#include "mesh/scan.h"

#include <stdarg.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

/* Larger files hold more nodes than indices can number. */
static const size_t longest_file = (size_t)1 << 38;

ShvStatus shv_scan_open(ShvScan *scan, ShvMemory *memory, const char *path, ShvError *error)
{
    *scan = (ShvScan){.path = path, .line = 1};
    const ShvStatus status =
        shv_read_file(memory, SHV_PART_GENERAL, path, longest_file, &scan->text, &scan->size, error);
    if (status != SHV_OK) *scan = (ShvScan){0};
    return status;
}

void shv_scan_close(ShvScan *scan)
{
    shv_release(scan->text);
    *scan = (ShvScan){0};
}

ShvStatus shv_scan_fail(const ShvScan *scan, ShvError *error, const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    shv_format_list(message, sizeof message, format, arguments);
    va_end(arguments);
    if (scan->binary) return shv_fail(error, SHV_BAD_INPUT, "%s: at byte %zu: %s", scan->path, scan->at, message);
    return shv_fail(error, SHV_BAD_INPUT, "%s:%lld: %s", scan->path, (long long)scan->line, message);
}

static bool at_line_end(const ShvScan *scan)
{
    return scan->at >= scan->size || scan->text[scan->at] == '\n' || scan->text[scan->at] == '\r';
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

void shv_scan_leave_line(ShvScan *scan)
{
    while (!at_line_end(scan)) scan->at++;
    scan->inside_line = false;
    if (scan->at >= scan->size) return;
    /* "\r\n" is one end of line, and so is a lone "\r". */
    if (scan->text[scan->at] == '\r' && scan->at + 1 < scan->size && scan->text[scan->at + 1] == '\n') scan->at++;
    scan->at++;
    scan->line++;
}

/* Skips blanks and a comment; true when a word follows. */
static bool word_follows(ShvScan *scan)
{
    while (!at_line_end(scan) && is_blank(scan->text[scan->at])) scan->at++;
    if (at_line_end(scan)) return false;
    return scan->comment == '\0' || scan->text[scan->at] != scan->comment;
}

bool shv_scan_record(ShvScan *scan)
{
    if (scan->inside_line) shv_scan_leave_line(scan);
    while (scan->at < scan->size) {
        if (word_follows(scan)) {
            scan->inside_line = true;
            return true;
        }
        shv_scan_leave_line(scan);
    }
    return false;
}

bool shv_scan_word(ShvScan *scan, ShvWord *word)
{
    if (!word_follows(scan)) return false;
    word->start = scan->text + scan->at;
    while (!at_line_end(scan) && !is_blank(scan->text[scan->at]) &&
           (scan->comment == '\0' || scan->text[scan->at] != scan->comment))
        scan->at++;
    word->end = scan->text + scan->at;
    return true;
}

bool shv_word_is(ShvWord word, const char *text)
{
    const size_t length = (size_t)(word.end - word.start);
    return strlen(text) == length && memcmp(word.start, text, length) == 0;
}

ShvShown shv_word_show(ShvWord word)
{
    ShvShown shown = {{0}};
    size_t n = 0;
    for (const char *c = word.start; c < word.end && n + 4 < sizeof shown.text; c++)
        shown.text[n++] = *c >= 0x20 && *c < 0x7f ? *c : '?';
    if ((size_t)(word.end - word.start) > n) memcpy(shown.text + n, "...", 3);
    return shown;
}

bool shv_word_whole(ShvWord word, int64_t *value)
{
    return shv_parse_int64(word.start, (size_t)(word.end - word.start), value, NULL) == SHV_OK;
}

ShvStatus shv_scan_number(ShvScan *scan, const char *what, double *value, ShvError *error)
{
    ShvWord word;
    if (!shv_scan_word(scan, &word))
        return shv_scan_fail(scan, error, "expected %s, but the line ends; is the file cut off?", what);
    if (shv_parse_double(word.start, (size_t)(word.end - word.start), false, value, NULL) == SHV_OK) return SHV_OK;
    return shv_scan_fail(scan, error, "expected %s, a finite number, not '%s'", what, shv_word_show(word).text);
}

ShvStatus shv_scan_whole(ShvScan *scan, const char *what, int64_t low, int64_t high, int64_t *value, ShvError *error)
{
    ShvWord word;
    if (!shv_scan_word(scan, &word))
        return shv_scan_fail(scan, error, "expected %s, but the line ends; is the file cut off?", what);
    if (!shv_word_whole(word, value))
        return shv_scan_fail(scan, error, "expected %s, a whole number, not '%s'", what, shv_word_show(word).text);
    if (*value >= low && *value <= high) return SHV_OK;
    return shv_scan_fail(scan, error, "%s must lie between %lld and %lld, not be %lld", what, (long long)low,
                         (long long)high, (long long)*value);
}

ShvStatus shv_scan_end_line(ShvScan *scan, ShvError *error)
{
    ShvWord word;
    if (!shv_scan_word(scan, &word)) return SHV_OK;
    return shv_scan_fail(scan, error, "expected the end of the line, not '%s'", shv_word_show(word).text);
}

ShvStatus shv_scan_check_count(const ShvScan *scan, int64_t count, int64_t bytes, const char *what, ShvError *error)
{
    const int64_t left = (int64_t)(scan->size - scan->at);
    if (count >= 0 && count <= left / bytes) return SHV_OK;
    return shv_scan_fail(scan, error,
                         "%lld %s are announced, more than the remaining %lld bytes of the file can hold; "
                         "is it cut off?",
                         (long long)count, what, (long long)left);
}

const unsigned char *shv_scan_bytes(ShvScan *scan, size_t count)
{
    if (count > scan->size - scan->at) return NULL;
    const unsigned char *bytes = (const unsigned char *)scan->text + scan->at;
    scan->at += count;
    return bytes;
}
