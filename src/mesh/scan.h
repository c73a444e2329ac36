/* Reads a file word by word, line by line or byte by byte, and names the place in every message. Numbers are those of
   the C locale. */
#ifndef SHV_MESH_SCAN_H
#define SHV_MESH_SCAN_H

#include <stdbool.h>

#include "base/memory.h"

typedef struct ShvScan {
    const char *path; /* of the caller */
    char *text;       /* size bytes and a terminating zero */
    size_t size, at;
    int64_t line;     /* of the byte `at`, from 1 */
    char comment;     /* starts a comment that ends with the line; 0: none */
    bool inside_line; /* a record has been entered */
    bool binary;      /* messages name bytes instead of lines */
} ShvScan;

typedef struct ShvWord {
    const char *start, *end;
} ShvWord;

/* Loads the whole file. On failure the scan is zeroed and owns nothing. */
ShvStatus shv_scan_open(ShvScan *scan, ShvMemory *memory, const char *path, ShvError *error);
void shv_scan_close(ShvScan *scan);

/* SHV_BAD_INPUT with "path:line: message", in a binary file "path: at byte n: message". */
ShvStatus shv_scan_fail(const ShvScan *scan, ShvError *error, const char *format, ...);

/* Goes to the next line that holds a word; false at the end of the file. The first call enters the first such line. */
bool shv_scan_record(ShvScan *scan);
/* The next word of the line; false at its end. */
bool shv_scan_word(ShvScan *scan, ShvWord *word);
bool shv_word_is(ShvWord word, const char *text);
/* Copies the word for a message: cut when long, unprintable bytes as '?'. Gives `buffer`. */
typedef struct ShvShown {
    char text[48];
} ShvShown;
ShvShown shv_word_show(ShvWord word);
/* The word as a whole number; false when it is none or too large. */
bool shv_word_whole(ShvWord word, int64_t *value);

/* The next word of the line as a finite number or as a whole number within [low, high]; `what` names it in messages. */
ShvStatus shv_scan_number(ShvScan *scan, const char *what, double *value, ShvError *error);
ShvStatus shv_scan_whole(ShvScan *scan, const char *what, int64_t low, int64_t high, int64_t *value, ShvError *error);
/* Refuses further words on the line. */
ShvStatus shv_scan_end_line(ShvScan *scan, ShvError *error);
/* Refuses a count that the rest of the file cannot hold at `bytes` ≥ 1 each, before anything is allocated. */
ShvStatus shv_scan_check_count(const ShvScan *scan, int64_t count, int64_t bytes, const char *what, ShvError *error);

/* Leaves the current line, so that bytes or a new record follow. */
void shv_scan_leave_line(ShvScan *scan);
/* The next `count` bytes, or NULL when the file is shorter. */
const unsigned char *shv_scan_bytes(ShvScan *scan, size_t count);

#endif
