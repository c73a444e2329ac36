#include "export/json.h"

#include <math.h>
#include <string.h>

#include "base/text.h"
#include "export/output.h"

static void add(ShvJson *json, const char *part, size_t length)
{
    if (json->failed) return;
    if (json->length + length + 1 > json->room) {
        const size_t room = 2 * (json->length + length) + 4096;
        char *text = shv_reallocate(json->memory, SHV_PART_RECORD, json->text, room, 1);
        json->failed = !text;
        if (!text) return;
        json->text = text;
        json->room = room;
    }
    memcpy(json->text + json->length, part, length);
    json->length += length;
    json->text[json->length] = '\0';
}

void shv_json_plain(ShvJson *json, const char *part)
{
    add(json, part, strlen(part));
}

void shv_json_text(ShvJson *json, const char *text)
{
    add(json, "\"", 1);
    for (; *text; text++) {
        char escape[8];
        const unsigned char c = (unsigned char)*text;
        if (c < 0x20 || c == 0x7f || c == '"' || c == '\\' || c == '<')
            add(json, escape, (size_t)shv_format(escape, sizeof escape, "\\u%04x", c));
        else
            add(json, text, 1);
    }
    add(json, "\"", 1);
}

void shv_json_number(ShvJson *json, double value)
{
    char number[SHV_OUTPUT_NUMBER] = "null";
    if (isfinite(value)) shv_output_format(number, value);
    shv_json_plain(json, number);
}

void shv_json_key(ShvJson *json, const char *key)
{
    if (json->length > 0 && !json->failed && json->text[json->length - 1] != '{') shv_json_plain(json, ",");
    shv_json_text(json, key);
    shv_json_plain(json, ":");
}

void shv_json_text_member(ShvJson *json, const char *key, const char *text)
{
    shv_json_key(json, key);
    shv_json_text(json, text);
}

void shv_json_number_member(ShvJson *json, const char *key, double value)
{
    shv_json_key(json, key);
    shv_json_number(json, value);
}

void shv_json_numbers(ShvJson *json, const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        shv_json_plain(json, i > 0 ? "," : "[");
        shv_json_number(json, values[i]);
    }
    shv_json_plain(json, "]");
}
