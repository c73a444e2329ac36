/* Whether a text is one JSON value (RFC 8259) and nothing else. */
#ifndef SHV_TESTS_CLI_JSON_H
#define SHV_TESTS_CLI_JSON_H

#include <stdbool.h>
#include <string.h>

static inline const char *json_value(const char *c);

static inline const char *json_space(const char *c)
{
    return c ? c + strspn(c, " \t\r\n") : NULL;
}

static inline const char *json_string(const char *c)
{
    if (*c++ != '"') return NULL;
    for (; *c != '"'; c++) {
        if ((unsigned char)*c < 0x20) return NULL;
        if (*c == '\\' && (!c[1] || !strchr("\"\\/bfnrtu", *++c))) return NULL;
    }
    return c + 1;
}

static inline const char *json_digits(const char *c)
{
    const size_t count = strspn(c, "0123456789");
    return count > 0 ? c + count : NULL;
}

static inline const char *json_number(const char *c)
{
    c = json_digits(c + (*c == '-'));
    if (c && *c == '.') c = json_digits(c + 1);
    if (c && (*c == 'e' || *c == 'E')) c = json_digits(c + 1 + (c[1] == '+' || c[1] == '-'));
    return c;
}

/* The items of an array, or the members of an object when `close` is '}'. */
static inline const char *json_list(const char *c, char close)
{
    c = json_space(c + 1);
    if (*c == close) return c + 1;
    for (;; c = json_space(c + 1)) {
        if (close == '}') {
            c = json_space(json_string(c));
            if (!c || *c++ != ':') return NULL;
        }
        c = json_space(json_value(json_space(c)));
        if (!c) return NULL;
        if (*c == close) return c + 1;
        if (*c != ',') return NULL;
    }
}

static inline const char *json_value(const char *c)
{
    if (*c == '{') return json_list(c, '}');
    if (*c == '[') return json_list(c, ']');
    if (*c == '"') return json_string(c);
    if (strncmp(c, "true", 4) == 0 || strncmp(c, "null", 4) == 0) return c + 4;
    if (strncmp(c, "false", 5) == 0) return c + 5;
    return json_number(c);
}

static inline bool json_valid(const char *text)
{
    const char *end = json_space(json_value(json_space(text)));
    return end && *end == '\0';
}

#endif
