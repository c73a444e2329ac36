#include "scene/source.h"

#include <string.h>

/* Length of the UTF-8 character at text[0 … length), 0 when it is none: overlong forms, surrogates and values beyond
   U+10FFFF are none (Unicode standard, table 3-7). */
static size_t character_length(const unsigned char *text, size_t length)
{
    const unsigned first = text[0];
    if (first < 0x80) return 1;
    if (first < 0xC2 || first > 0xF4) return 0;
    const size_t wanted = first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (length < wanted) return 0;
    const unsigned second = text[1];
    if (first == 0xE0 && second < 0xA0) return 0;
    if (first == 0xED && second > 0x9F) return 0;
    if (first == 0xF0 && second < 0x90) return 0;
    if (first == 0xF4 && second > 0x8F) return 0;
    for (size_t i = 1; i < wanted; i++)
        if ((text[i] & 0xC0u) != 0x80u) return 0;
    return wanted;
}

static bool is_control(unsigned byte)
{
    return (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r') || byte == 0x7F;
}

static bool is_blank(unsigned byte)
{
    return byte == ' ' || byte == '\t' || byte == '\n' || byte == '\r';
}

static bool is_space(unsigned byte)
{
    return byte == ' ' || byte == '\t';
}

/* Whether a '?' that begins a key of its own may stand here. */
static bool is_complex_key(const char *text, size_t length, size_t i)
{
    return text[i] == '?' && (i + 1 == length || is_blank((unsigned char)text[i + 1]));
}

/* A colon, spaces with a tab among them, and what begins a block: what libfyaml takes for indentation by a tab. */
static bool is_tab_before_block(const char *text, size_t length, size_t i)
{
    bool tab = false;
    if (text[i] != ':') return false;
    for (i++; i < length && is_space((unsigned char)text[i]); i++) tab = tab || text[i] == '\t';
    return tab && i < length && strchr("?:|>-", text[i]);
}

/* libfyaml 0.7.12 frees a key twice where it finds such a tab within or after a complex key. */
static bool check_complex_keys(ShvDiagnostics *diagnostics, const char *text, size_t length, int32_t origin)
{
    ShvPlace place = {1, 1, origin};
    bool complex_key = false;
    for (size_t i = 0; i < length; i++) {
        complex_key = complex_key || is_complex_key(text, length, i);
        if (complex_key && is_tab_before_block(text, length, i)) {
            shv_error(diagnostics, place, "a tab follows this colon, after a key that begins with '?'; use spaces");
            return false;
        }
        place.column++;
        if (text[i] == '\n') place = (ShvPlace){place.line + 1, 1, origin};
    }
    return true;
}

bool shv_source_check(ShvDiagnostics *diagnostics, const char *text, size_t length, int32_t origin)
{
    ShvPlace place = {1, 1, origin};
    int brackets = 0;
    for (size_t i = 0; i < length;) {
        const unsigned char *at = (const unsigned char *)text + i;
        const size_t step = character_length(at, length - i);
        if (step == 0 || is_control(*at)) {
            shv_error(diagnostics, place, "byte 0x%02X is not text; a scene is YAML in UTF-8", (unsigned)*at);
            return false;
        }
        if (*at == '[' || *at == '{')
            brackets++;
        else if (!is_blank(*at))
            brackets = 0;
        if (brackets > SHV_SCENE_LARGEST_DEPTH) {
            shv_error(diagnostics, place, "more than %d brackets are opened in a row; a scene nests less than that",
                      (int)SHV_SCENE_LARGEST_DEPTH);
            return false;
        }
        place.column++;
        if (*at == '\n') place = (ShvPlace){place.line + 1, 1, origin};
        i += step;
    }
    return check_complex_keys(diagnostics, text, length, origin);
}
