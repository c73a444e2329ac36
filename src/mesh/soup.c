#include "mesh/soup.h"

#include <string.h>

#include "base/random.h"

void shv_soup_release(ShvSoup *soup)
{
    shv_release(soup->positions);
    shv_release(soup->triangles);
    *soup = (ShvSoup){0};
}

ShvStatus shv_soup_add_vertex(ShvSoup *soup, const ShvScan *scan, ShvVec3 position, ShvError *error)
{
    const ShvVec3 scaled = shv_scale(position, soup->scale);
    if (!shv_finite3(scaled)) return shv_scan_fail(scan, error, "a scaled coordinate is not finite");
    if (soup->vertex_count == INT32_MAX) return shv_scan_fail(scan, error, "more than %d vertices", INT32_MAX);
    if (soup->vertex_count == soup->vertex_capacity) {
        const int64_t capacity = soup->vertex_capacity ? 2 * soup->vertex_capacity : 64;
        double *grown =
            shv_reallocate(soup->memory, SHV_PART_GENERAL, soup->positions, (size_t)capacity, 3 * sizeof *grown);
        if (!grown) return shv_fail_memory(error, "the vertices of a surface file", (size_t)capacity * 24);
        soup->positions = grown;
        soup->vertex_capacity = capacity;
    }
    shv_store3(soup->positions + 3 * (int64_t)soup->vertex_count++, scaled);
    return SHV_OK;
}

ShvStatus shv_soup_add_triangle(ShvSoup *soup, const ShvScan *scan, int32_t a, int32_t b, int32_t c, ShvError *error)
{
    if (soup->triangle_count == INT32_MAX / 3)
        return shv_scan_fail(scan, error, "more than %d triangles", INT32_MAX / 3);
    if (soup->triangle_count == soup->triangle_capacity) {
        const int64_t capacity = soup->triangle_capacity ? 2 * soup->triangle_capacity : 64;
        int32_t *grown =
            shv_reallocate(soup->memory, SHV_PART_GENERAL, soup->triangles, (size_t)capacity, 3 * sizeof *grown);
        if (!grown) return shv_fail_memory(error, "the triangles of a surface file", (size_t)capacity * 12);
        soup->triangles = grown;
        soup->triangle_capacity = capacity;
    }
    int32_t *corners = soup->triangles + 3 * (int64_t)soup->triangle_count++;
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
    return SHV_OK;
}

static uint64_t hash_position(const double *position)
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        const double plain = position[k] + 0.0; /* −0 and 0 are equal */
        uint64_t bits;
        memcpy(&bits, &plain, sizeof bits);
        hash = shv_random_bits(hash, bits);
    }
    return hash;
}

/* first[v]: the first vertex with the coordinates of v. */
static ShvStatus find_first(const ShvSoup *soup, int32_t *first, ShvError *error)
{
    uint64_t size = 16;
    while (size < 2 * (uint64_t)soup->vertex_count) size *= 2;
    int32_t *slots = shv_allocate(soup->memory, SHV_PART_GENERAL, size, sizeof *slots);
    if (!slots) return shv_fail_memory(error, "the vertices of a surface file", size * sizeof *slots);
    for (int32_t v = 0; v < soup->vertex_count; v++) {
        const double *p = soup->positions + 3 * (int64_t)v;
        uint64_t slot = hash_position(p) & (size - 1);
        for (; slots[slot]; slot = (slot + 1) & (size - 1)) {
            const double *q = soup->positions + 3 * (int64_t)(slots[slot] - 1);
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
        }
        if (!slots[slot]) slots[slot] = v + 1;
        first[v] = slots[slot] - 1;
    }
    shv_release(slots);
    return SHV_OK;
}

/* Keeps, in place, the triangles whose corners are three different points. */
static void drop_collapsed(ShvSoup *soup, const int32_t *first)
{
    int32_t kept = 0;
    for (int32_t t = 0; t < soup->triangle_count; t++) {
        const int32_t *old = soup->triangles + 3 * (int64_t)t;
        const int32_t a = first[old[0]], b = first[old[1]], c = first[old[2]];
        if (a == b || b == c || c == a) continue;
        int32_t *corners = soup->triangles + 3 * (int64_t)kept++;
        corners[0] = a;
        corners[1] = b;
        corners[2] = c;
    }
    soup->triangle_count = kept;
}

/* numbers[v] becomes the new number of a used vertex, −1 of others. */
static int32_t number_used(const ShvSoup *soup, int32_t *numbers)
{
    for (int32_t v = 0; v < soup->vertex_count; v++) numbers[v] = -1;
    for (int64_t i = 0; i < 3 * (int64_t)soup->triangle_count; i++) numbers[soup->triangles[i]] = 0;
    int32_t used = 0;
    for (int32_t v = 0; v < soup->vertex_count; v++)
        if (numbers[v] == 0) numbers[v] = used++;
    return used;
}

static ShvStatus fill_surface(const ShvSoup *soup, int32_t *numbers, ShvSurface *surface, ShvError *error)
{
    const int32_t used = number_used(soup, numbers);
    surface->positions = shv_allocate(surface->memory, surface->part, (size_t)used, 3 * sizeof(double));
    surface->triangles =
        shv_allocate(surface->memory, surface->part, (size_t)soup->triangle_count, 3 * sizeof(int32_t));
    if (!surface->positions || !surface->triangles)
        return shv_fail_memory(error, "a surface", (size_t)used * 24 + (size_t)soup->triangle_count * 12);
    for (int32_t v = 0; v < soup->vertex_count; v++)
        if (numbers[v] >= 0)
            memcpy(surface->positions + 3 * (int64_t)numbers[v], soup->positions + 3 * (int64_t)v, 3 * sizeof(double));
    for (int64_t i = 0; i < 3 * (int64_t)soup->triangle_count; i++) surface->triangles[i] = numbers[soup->triangles[i]];
    surface->node_count = used;
    surface->triangle_count = soup->triangle_count;
    return SHV_OK;
}

ShvStatus shv_soup_finish(ShvSoup *soup, ShvSurface *surface, ShvError *error)
{
    int32_t *first = shv_allocate(soup->memory, SHV_PART_GENERAL, (size_t)soup->vertex_count, sizeof *first);
    if (!first) return shv_fail_memory(error, "a surface", (size_t)soup->vertex_count * sizeof *first);
    ShvStatus status = find_first(soup, first, error);
    if (status == SHV_OK) {
        drop_collapsed(soup, first);
        status = fill_surface(soup, first, surface, error);
    }
    shv_release(first);
    return status;
}

/* Whether the path ends in "." and `extension`, in any case. */
static bool has_extension(const char *path, const char *extension)
{
    const char *dot = strrchr(path, '.');
    if (!dot || strlen(dot + 1) != strlen(extension)) return false;
    for (size_t i = 0; extension[i]; i++) {
        const char c = dot[1 + i];
        if ((c >= 'A' && c <= 'Z' ? c + ('a' - 'A') : c) != extension[i]) return false;
    }
    return true;
}

ShvStatus shv_surface_read(ShvSurface *surface, ShvMemory *memory, ShvPart part, const char *path, double scale,
                           ShvError *error)
{
    *surface = (ShvSurface){.memory = memory, .part = part};
    ShvStatus (*read)(ShvSoup *, ShvScan *, ShvError *) = NULL;
    if (has_extension(path, "obj")) read = shv_read_obj;
    if (has_extension(path, "stl")) read = shv_read_stl;
    if (has_extension(path, "ply")) read = shv_read_ply;
    if (!read) return shv_fail(error, SHV_BAD_INPUT, "%s: a surface file must end in .obj, .stl or .ply", path);
    if (!(scale > 0.0) || !isfinite(scale))
        return shv_fail(error, SHV_BAD_INPUT, "%s: the scale must be a positive number, not %g", path, scale);
    ShvScan scan;
    ShvSoup soup = {.memory = memory, .scale = scale};
    ShvStatus status = shv_scan_open(&scan, memory, path, error);
    if (status == SHV_OK) status = read(&soup, &scan, error);
    if (status == SHV_OK && soup.triangle_count == 0)
        status = shv_fail(error, SHV_BAD_INPUT, "%s: the file holds no triangles or polygons", path);
    if (status == SHV_OK) status = shv_soup_finish(&soup, surface, error);
    shv_scan_close(&scan);
    shv_soup_release(&soup);
    if (status != SHV_OK) shv_surface_release(surface);
    return status;
}
