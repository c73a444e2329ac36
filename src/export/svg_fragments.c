/* The fragments of a frame as flat triangles, the far ones first. */
#include <stdlib.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/svg.h"

enum { COLOURS = 12, STONE = COLOURS, SMALL_FROM = 60000 };

static const uint32_t COLOUR[COLOURS + 1] = {0xd1495b, 0xedae49, 0x2a8fa3, 0x6aa58f, 0x9a73a3, 0xf4845f, 0x4f7fb8,
                                             0xa9c777, 0xcf7fa4, 0x86b3d9, 0xe3c567, 0x4fa37a, 0xd9d1c2};

typedef struct Patch {
    ShvScreenPoint corner[3];
    double near;    /* of the middle */
    int64_t item;   /* the triangle, then the path */
    int32_t colour; /* colour and shade */
    bool seen;
} Patch;

typedef struct Patches {
    Patch *list;
    int64_t count, path_count;
    int64_t *last;  /* of each pixel: the latest path over it, −1: none */
    int64_t *begin; /* of each path: its first patch in `order` */
    int64_t *order;
    int32_t columns, rows;
} Patches;

ShvVec3 shv_svg_light(void)
{
    return shv_unit(shv_vec3(-0.3, -0.45, 1.0));
}

/* ---- colours ---- */

/* Multiplicative hashing (Knuth, The Art of Computer Programming 3, 6.4) spreads neighbouring numbers. */
static int32_t colour_of(int32_t line)
{
    return (int32_t)((((uint32_t)line * UINT32_C(2654435769)) >> 16) % COLOURS);
}

static uint32_t shaded(int32_t colour, int shade)
{
    const double light = 0.5 + 0.56 * shade / (SHV_SVG_SHADES - 1);
    uint32_t result = 0;
    for (int k = 16; k >= 0; k -= 8) {
        const double part = fmin(255.0, floor(light * ((COLOUR[colour] >> k) & 255u) + 0.5));
        result |= (uint32_t)part << k;
    }
    return result;
}

uint32_t shv_svg_colour(int32_t line, bool largest, int shade)
{
    return shaded(largest ? (int32_t)STONE : colour_of(line), shade);
}

/* Of flat light: from the sky, and from the lamp where the face is turned to it. */
static int shade_of(const ShvTriangle *triangle)
{
    const ShvVec3 normal = shv_unit(shv_cross(shv_sub(triangle->corner[1], triangle->corner[0]),
                                              shv_sub(triangle->corner[2], triangle->corner[0])));
    const double light = 0.15 * (1.0 + normal.z) + 0.7 * fmax(0.0, shv_dot(normal, shv_svg_light()));
    return (int)(light * (SHV_SVG_SHADES - 1) + 0.5);
}

static int32_t largest_fragment(const ShvSvg *svg)
{
    const ShvPieces *pieces = &svg->skin.pieces;
    int32_t largest = -1;
    for (int32_t i = 0; i < shv_run_file_info(pieces->file)->fragment_count; i++)
        if (pieces->alive[i] && (largest < 0 || pieces->fragments[i].mass > pieces->fragments[largest].mass))
            largest = i;
    return largest;
}

/* ---- what is seen ---- */

/* Twice, square pixels; positive when the triangle faces the viewer (y points down). */
static double area_of(const ShvScreenPoint corner[3])
{
    return (corner[1].y - corner[0].y) * (corner[2].x - corner[0].x) -
           (corner[1].x - corner[0].x) * (corner[2].y - corner[0].y);
}

static void find_patches(const ShvSvg *svg, Patches *patches)
{
    const int32_t largest = largest_fragment(svg);
    for (int64_t i = 0; i < svg->skin.count; i++) {
        const ShvTriangle *triangle = &svg->skin.triangles[i];
        Patch *patch = &patches->list[patches->count];
        bool seen = true;
        for (int k = 0; k < 3; k++)
            seen = seen && shv_camera_project(&svg->camera, triangle->corner[k], &patch->corner[k]);
        if (!seen || !(area_of(patch->corner) > 0.0)) continue;
        patch->near = (patch->corner[0].near + patch->corner[1].near + patch->corner[2].near) / 3.0;
        const int32_t line = svg->skin.pieces.lineage[triangle->fragment];
        const int32_t colour = triangle->fragment == largest ? STONE : colour_of(line);
        patch->colour = SHV_SVG_SHADES * colour + shade_of(triangle);
        patch->item = i;
        patches->count++;
    }
}

/* Keeps those that win a sample; where these are very many, only those of a pixel or more. */
static void keep_seen(ShvSvg *svg, Patches *patches)
{
    shv_raster_clear(&svg->raster);
    for (int64_t i = 0; i < patches->count; i++) shv_raster_enter(&svg->raster, patches->list[i].corner, i);
    for (int64_t i = 0; i < (int64_t)svg->raster.columns * svg->raster.rows; i++)
        if (svg->raster.item[i] >= 0) patches->list[svg->raster.item[i]].seen = true;
    int64_t seen = 0, kept = 0;
    for (int64_t i = 0; i < patches->count; i++) seen += patches->list[i].seen;
    for (int64_t i = 0; i < patches->count; i++)
        if (patches->list[i].seen && (seen <= SMALL_FROM || area_of(patches->list[i].corner) >= 2.0))
            patches->list[kept++] = patches->list[i];
    patches->count = kept;
}

static int far_first(const void *a, const void *b)
{
    const Patch *left = a, *right = b;
    if (left->near < right->near) return -1;
    return left->near > right->near ? 1 : (left->item > right->item) - (left->item < right->item);
}

/* ---- paths ---- */

static int32_t pixel_at(double place, int32_t count)
{
    return place < 0.0 ? 0 : place >= count ? count - 1 : (int32_t)place;
}

/* Calls for every pixel around a patch: the latest path there; with `path` ≥ 0 that becomes the latest. */
static int64_t latest_path(const Patches *patches, const Patch *patch, int64_t path)
{
    const ShvScreenPoint *c = patch->corner;
    const int32_t left = pixel_at(fmin(c[0].x, fmin(c[1].x, c[2].x)), patches->columns);
    const int32_t right = pixel_at(fmax(c[0].x, fmax(c[1].x, c[2].x)), patches->columns);
    const int32_t bottom = pixel_at(fmax(c[0].y, fmax(c[1].y, c[2].y)), patches->rows);
    int64_t latest = -1;
    for (int32_t row = pixel_at(fmin(c[0].y, fmin(c[1].y, c[2].y)), patches->rows); row <= bottom; row++)
        for (int32_t column = left; column <= right; column++) {
            int64_t *last = &patches->last[(int64_t)row * patches->columns + column];
            if (*last > latest) latest = *last;
            if (path >= 0) *last = path;
        }
    return latest;
}

/* A patch joins the latest path of its colour unless a later path lies below it: fewer paths, the same picture. */
static void make_paths(Patches *patches)
{
    int64_t newest[SHV_SVG_SHADES * (COLOURS + 1)];
    for (int i = 0; i < SHV_SVG_SHADES * (COLOURS + 1); i++) newest[i] = -1;
    for (int64_t i = 0; i < (int64_t)patches->columns * patches->rows; i++) patches->last[i] = -1;
    for (int64_t i = 0; i < patches->count; i++) {
        Patch *patch = &patches->list[i];
        int64_t *path = &newest[patch->colour];
        if (*path < 0 || *path < latest_path(patches, patch, -1)) *path = patches->path_count++;
        patch->item = *path;
        patches->begin[*path + 1]++;
        latest_path(patches, patch, *path);
    }
    for (int64_t p = 0; p < patches->path_count; p++) patches->begin[p + 1] += patches->begin[p];
    for (int64_t i = patches->count - 1; i >= 0; i--) patches->order[--patches->begin[patches->list[i].item + 1]] = i;
}

void shv_svg_triangle(FILE *stream, const ShvScreenPoint corner[3])
{
    double tenths[6];
    for (int k = 0; k < 3; k++) {
        tenths[2 * k] = floor(10.0 * corner[k].x + 0.5);
        tenths[2 * k + 1] = floor(10.0 * corner[k].y + 0.5);
    }
    shv_print(stream, "M%g %gl%g %g %g %gz", tenths[0] / 10.0, tenths[1] / 10.0, (tenths[2] - tenths[0]) / 10.0,
              (tenths[3] - tenths[1]) / 10.0, (tenths[4] - tenths[2]) / 10.0, (tenths[5] - tenths[3]) / 10.0);
}

/* A thin stroke of the same colour closes the seams that smooth edges leave between neighbours. */
static void print_paths(const ShvSvg *svg, const Patches *patches)
{
    shv_print(svg->stream, "<g stroke-width=\".5\" stroke-linejoin=\"round\">\n");
    for (int64_t p = 0, i = 0; p < patches->path_count; p++) {
        const int32_t colour = patches->list[patches->order[i]].colour;
        const unsigned value = shaded(colour / SHV_SVG_SHADES, colour % SHV_SVG_SHADES);
        shv_print(svg->stream, "<path fill=\"#%06x\" stroke=\"#%06x\" d=\"", value, value);
        for (; i < patches->count && patches->list[patches->order[i]].item == p; i++)
            shv_svg_triangle(svg->stream, patches->list[patches->order[i]].corner);
        shv_print(svg->stream, "\"/>\n");
    }
    shv_print(svg->stream, "</g>\n");
}

static ShvStatus draw(ShvSvg *svg, Patches *patches, ShvError *error)
{
    struct ShvMemory *memory = svg->options.memory;
    find_patches(svg, patches);
    keep_seen(svg, patches);
    qsort(patches->list, (size_t)patches->count, sizeof *patches->list, far_first);
    const size_t pixels = (size_t)patches->columns * (size_t)patches->rows, count = (size_t)patches->count;
    patches->last = shv_allocate(memory, SHV_PART_RECORD, pixels, sizeof *patches->last);
    patches->begin = shv_allocate(memory, SHV_PART_RECORD, count + 1, sizeof *patches->begin);
    patches->order = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *patches->order);
    if (!patches->last || !patches->begin || !patches->order)
        return shv_fail_memory(error, "a picture", 8 * (pixels + 2 * count));
    make_paths(patches);
    print_paths(svg, patches);
    return SHV_OK;
}

ShvStatus shv_svg_draw_fragments(ShvSvg *svg, ShvError *error)
{
    const size_t most = (size_t)svg->skin.count;
    Patches patches = {.columns = (int32_t)svg->camera.width, .rows = (int32_t)svg->camera.height};
    patches.list = shv_allocate(svg->options.memory, SHV_PART_RECORD, most, sizeof *patches.list);
    const ShvStatus status =
        patches.list ? draw(svg, &patches, error) : shv_fail_memory(error, "triangles", most * sizeof *patches.list);
    shv_release(patches.list);
    shv_release(patches.last);
    shv_release(patches.begin);
    shv_release(patches.order);
    return status;
}
