/* Whether a drawing is well-formed, and how often it says something; after check.h. */
#ifndef SHV_TESTS_XML_H
#define SHV_TESTS_XML_H

static inline int count_text(const char *xml, const char *text)
{
    int count = 0;
    for (const char *at = strstr(xml, text); at; at = strstr(at + 1, text)) count++;
    return count;
}

/* Every element is closed by its own name, every attribute is quoted, every & begins an entity. */
static inline void check_well_formed(const char *xml)
{
    char open[16][32];
    int depth = 0, roots = 0;
    assert_int_equal(strncmp(xml, "<?xml ", 6), 0);
    for (const char *at = strstr(xml, "?>") + 2; *at; at++) {
        if (*at == '&')
            assert_true(strncmp(at, "&amp;", 5) == 0 || strncmp(at, "&lt;", 4) == 0 || strncmp(at, "&gt;", 4) == 0);
        if (*at != '<') continue;
        const size_t name = strcspn(at + 1, " />"), end = strcspn(at, ">");
        assert_true(at[end] == '>' && strcspn(at + 1, "<") >= end);
        int quotes = 0;
        for (size_t i = 0; i < end; i++) quotes += at[i] == '"';
        assert_int_equal(quotes % 2, 0);
        if (at[1] == '/') {
            assert_true(depth > 0 && strncmp(open[depth - 1], at + 2, end - 2) == 0 &&
                        open[depth - 1][end - 2] == '\0');
            depth--;
        } else if (at[end - 1] != '/') {
            roots += depth == 0;
            assert_true(depth < 16 && name < 32);
            snprintf(open[depth++], 32, "%.*s", (int)name, at + 1);
        }
        at += end;
    }
    assert_int_equal(depth, 0);
    assert_int_equal(roots, 1);
}

#endif
