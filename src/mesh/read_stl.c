/* STL, as text or in binary (little endian). Normals are ignored: the order of the corners gives the outside. */
#include <string.h>

#include "mesh/soup.h"

enum { HEAD = 84, RECORD = 50 };

static uint32_t little_uint32(const unsigned char *b)
{
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static double little_float(const unsigned char *bytes)
{
    const uint32_t bits = little_uint32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static ShvStatus add_last_triangle(ShvSoup *soup, const ShvScan *scan, ShvError *error)
{
    const int32_t n = soup->vertex_count;
    return shv_soup_add_triangle(soup, scan, n - 3, n - 2, n - 1, error);
}

/* Some writers begin binary files with "solid" too, so only the length decides. */
static bool is_binary(const ShvScan *scan)
{
    if (scan->size < HEAD) return false;
    const unsigned char *bytes = (const unsigned char *)scan->text;
    return scan->size == HEAD + RECORD * (size_t)little_uint32(bytes + HEAD - 4);
}

static ShvStatus read_binary(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    scan->binary = true;
    shv_scan_bytes(scan, HEAD);
    for (const unsigned char *record; (record = shv_scan_bytes(scan, RECORD)) != NULL;) {
        for (int corner = 0; corner < 3; corner++) {
            const unsigned char *at = record + 12 + 12 * corner; /* the normal comes first */
            const ShvVec3 x = {little_float(at), little_float(at + 4), little_float(at + 8)};
            SHV_TRY(shv_soup_add_vertex(soup, scan, x, error));
        }
        SHV_TRY(add_last_triangle(soup, scan, error));
    }
    return SHV_OK;
}

static bool word_is_any_case(ShvWord word, const char *lower)
{
    for (const char *c = word.start; c < word.end; c++, lower++)
        if (*lower == '\0' || (*c >= 'A' && *c <= 'Z' ? *c + ('a' - 'A') : *c) != *lower) return false;
    return *lower == '\0';
}

/* Enters the next line, which must begin with `keyword`. */
static ShvStatus expect_line(ShvScan *scan, const char *keyword, ShvError *error)
{
    ShvWord word;
    if (!shv_scan_record(scan) || !shv_scan_word(scan, &word))
        return shv_scan_fail(scan, error, "the file ends where '%s' was expected; it is cut off", keyword);
    if (word_is_any_case(word, keyword)) return SHV_OK;
    return shv_scan_fail(scan, error, "expected '%s', not '%s'", keyword, shv_word_show(word).text);
}

/* From after "facet" to "endfacet". */
static ShvStatus read_facet(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    SHV_TRY(expect_line(scan, "outer", error));
    for (int corner = 0; corner < 3; corner++) {
        double x[3];
        SHV_TRY(expect_line(scan, "vertex", error));
        for (int k = 0; k < 3; k++) SHV_TRY(shv_scan_number(scan, "a coordinate", &x[k], error));
        SHV_TRY(shv_scan_end_line(scan, error));
        SHV_TRY(shv_soup_add_vertex(soup, scan, shv_load3(x), error));
    }
    SHV_TRY(add_last_triangle(soup, scan, error));
    SHV_TRY(expect_line(scan, "endloop", error));
    return expect_line(scan, "endfacet", error);
}

/* One solid or several. */
static ShvStatus read_text(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    bool inside = false;
    ShvWord word;
    while (shv_scan_record(scan) && shv_scan_word(scan, &word)) {
        if (!inside && word_is_any_case(word, "solid"))
            inside = true;
        else if (inside && word_is_any_case(word, "endsolid"))
            inside = false;
        else if (inside && word_is_any_case(word, "facet"))
            SHV_TRY(read_facet(soup, scan, error));
        else
            return shv_scan_fail(scan, error, "expected '%s', not '%s'", inside ? "facet" : "solid",
                                 shv_word_show(word).text);
    }
    return inside ? shv_scan_fail(scan, error, "the file ends without 'endsolid'; it is cut off") : SHV_OK;
}

ShvStatus shv_read_stl(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    if (is_binary(scan)) return read_binary(soup, scan, error);
    ShvWord word;
    ShvScan look = *scan;
    if (shv_scan_record(&look) && shv_scan_word(&look, &word) && word_is_any_case(word, "solid"))
        return read_text(soup, scan, error);
    return shv_fail(error, SHV_BAD_INPUT,
                    "%s: neither text (it would begin with 'solid') nor binary STL (%zu bytes are "
                    "not 84 and 50 for each triangle its head announces); is it cut off?",
                    scan->path, scan->size);
}
