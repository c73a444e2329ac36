/* A JSON text that grows in memory, where its length is wanted before it. */
#ifndef SHV_EXPORT_JSON_H
#define SHV_EXPORT_JSON_H

#include <stdbool.h>
#include <stddef.h>

#include "base/memory.h"

/* Starts from zeros and a memory; the caller releases `text`, which is NULL while it is empty. */
typedef struct ShvJson {
    struct ShvMemory *memory;
    char *text; /* terminated */
    size_t length, room;
    bool failed; /* out of memory: nothing is added any more */
} ShvJson;

/* Letters as they are. */
void shv_json_plain(ShvJson *json, const char *part);
/* A string with its quotes; a "<" is escaped, too, for texts within HTML. */
void shv_json_text(ShvJson *json, const char *text);
/* null when it is not finite. */
void shv_json_number(ShvJson *json, double value);
/* "key": and a comma before it unless a brace is before it. */
void shv_json_key(ShvJson *json, const char *key);
void shv_json_text_member(ShvJson *json, const char *key, const char *text);
void shv_json_number_member(ShvJson *json, const char *key, double value);
/* An array of numbers. */
void shv_json_numbers(ShvJson *json, const double *values, int count);

#endif
