/* Wavefront OBJ: vertices and faces; everything else does not change the shape and is ignored. */
#include "mesh/soup.h"

/* "v x y z", then perhaps a weight or a colour. */
static ShvStatus read_vertex(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    double x[3];
    for (int k = 0; k < 3; k++) SHV_TRY(shv_scan_number(scan, "a coordinate", &x[k], error));
    return shv_soup_add_vertex(soup, scan, shv_load3(x), error);
}

/* The part of "i", "i/j", "i//k" or "i/j/k" before the first slash, counted from 1, or from −1 backwards. */
static ShvStatus read_corner(const ShvSoup *soup, const ShvScan *scan, ShvWord word, int32_t *corner, ShvError *error)
{
    ShvWord number = {word.start, word.start};
    while (number.end < word.end && *number.end != '/') number.end++;
    int64_t index;
    if (!shv_word_whole(number, &index))
        return shv_scan_fail(scan, error, "expected the number of a vertex, not '%s'", shv_word_show(word).text);
    const int64_t count = soup->vertex_count;
    if (index == 0 || index > count || index < -count)
        return shv_scan_fail(scan, error, "vertex %lld is not among the %lld vertices so far; numbers begin at 1",
                             (long long)index, (long long)count);
    *corner = (int32_t)(index > 0 ? index - 1 : count + index);
    return SHV_OK;
}

static ShvStatus read_face(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    ShvWord word;
    int32_t first = 0, previous = 0, corner = 0, count = 0;
    while (shv_scan_word(scan, &word)) {
        SHV_TRY(read_corner(soup, scan, word, &corner, error));
        if (count == 0) first = corner;
        if (count >= 2) SHV_TRY(shv_soup_add_triangle(soup, scan, first, previous, corner, error));
        previous = corner;
        if (count < 3) count++;
    }
    if (count == 3) return SHV_OK;
    return shv_scan_fail(scan, error, "a face needs at least three vertices");
}

ShvStatus shv_read_obj(ShvSoup *soup, ShvScan *scan, ShvError *error)
{
    scan->comment = '#';
    ShvWord word;
    while (shv_scan_record(scan) && shv_scan_word(scan, &word)) {
        if (shv_word_is(word, "v")) SHV_TRY(read_vertex(soup, scan, error));
        if (shv_word_is(word, "f")) SHV_TRY(read_face(soup, scan, error));
    }
    return SHV_OK;
}
