#include "export/svg.h"

#include <stdlib.h>

#include "base/memory.h"
#include "base/text.h"

static const char *const SUFFIX[] = {".svg"};

ShvSvgOptions shv_svg_default(void)
{
    return (ShvSvgOptions){.cookie = SHV_DEFINITION_COOKIE, .size = 1200, .mass_in_view = 0.98};
}

static ShvStatus check_options(const ShvSvgOptions *options, ShvError *error)
{
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the drawing's options did not start from shv_svg_default()");
    if (options->size < 200 || options->size > 4000)
        return shv_fail(error, SHV_BAD_INPUT, "a drawing is 200 to 4000 pixels wide; %d were given",
                        (int)options->size);
    if (!(options->mass_in_view >= 0.0 && options->mass_in_view <= 1.0))
        return shv_fail(error, SHV_BAD_INPUT, "the share of the mass in view is 0 to 1; %g was given",
                        options->mass_in_view);
    const ShvVec3 normal = shv_load3(options->floor_normal);
    if (options->floor && !(shv_finite3(normal) && shv_norm(normal) > 0.0 && isfinite(options->floor_offset)))
        return shv_fail(error, SHV_BAD_INPUT, "the floor needs a normal that is not zero and a finite offset");
    return SHV_OK;
}

/* ---- what is in view ---- */

typedef struct Place {
    double key, mass;
    int32_t fragment;
} Place;

static int by_place(const void *a, const void *b)
{
    const Place *left = a, *right = b;
    if (left->key < right->key) return -1;
    return left->key > right->key ? 1 : (left->fragment > right->fragment) - (left->fragment < right->fragment);
}

/* Index of the place at which this mass is reached in the order of the keys. */
static int32_t reach(Place *places, int32_t count, double mass)
{
    double sum = 0.0;
    qsort(places, (size_t)count, sizeof *places, by_place);
    for (int32_t i = 0; i < count; i++) {
        sum += places[i].mass;
        if (sum >= mass) return i;
    }
    return count - 1;
}

static int32_t living_places(const ShvPieces *pieces, Place *places, double *mass)
{
    int32_t count = 0;
    *mass = 0.0;
    for (int32_t i = 0; i < shv_run_file_info(pieces->file)->fragment_count; i++) {
        if (!pieces->alive[i] || !shv_finite3(shv_load3(pieces->position + 3 * (int64_t)i))) continue;
        places[count++] = (Place){0.0, pieces->fragments[i].mass, i};
        *mass += pieces->fragments[i].mass;
    }
    return count;
}

/* Marks the fragments nearest to the middle, the median of the mass along each axis, that have the share wanted. */
static void mark_shown(const ShvSvg *svg, Place *places, uint8_t *shown)
{
    const ShvPieces *pieces = &svg->skin.pieces;
    double mass, middle[3];
    const int32_t count = living_places(pieces, places, &mass);
    for (int k = 0; k < 3; k++) {
        for (int32_t i = 0; i < count; i++) places[i].key = pieces->position[3 * (int64_t)places[i].fragment + k];
        if (count > 0) middle[k] = places[reach(places, count, 0.5 * mass)].key;
    }
    for (int32_t i = 0; i < count; i++)
        places[i].key =
            shv_norm(shv_sub(shv_load3(pieces->position + 3 * (int64_t)places[i].fragment), shv_load3(middle)));
    const bool all = !(svg->options.mass_in_view < 1.0);
    const int32_t last = all ? count - 1 : reach(places, count, svg->options.mass_in_view * mass);
    for (int32_t i = 0; i < shv_run_file_info(pieces->file)->fragment_count; i++) shown[i] = 0;
    for (int32_t i = 0; i <= last; i++) shown[places[i].fragment] = 1;
}

static ShvStatus include_frames(ShvSvg *svg, const int64_t *frames, int32_t count, Place *places, uint8_t *shown,
                                ShvError *error)
{
    for (int32_t i = 0; i < count; i++) {
        SHV_TRY(shv_skin_move(&svg->skin, frames[i], error));
        mark_shown(svg, places, shown);
        for (int64_t t = 0; t < svg->skin.count; t++) {
            const ShvTriangle *triangle = &svg->skin.triangles[t];
            for (int k = 0; k < 3 && shown[triangle->fragment]; k++)
                shv_camera_include(&svg->camera, triangle->corner[k]);
        }
    }
    return SHV_OK;
}

/* One camera for all frames. */
static ShvStatus aim(ShvSvg *svg, const int64_t *frames, int32_t count, double width, ShvError *error)
{
    const size_t most = (size_t)shv_run_file_info(svg->skin.pieces.file)->fragment_count;
    Place *places = shv_allocate(svg->options.memory, SHV_PART_RECORD, most, sizeof *places);
    uint8_t *shown = shv_allocate(svg->options.memory, SHV_PART_RECORD, most, 1);
    svg->camera = shv_camera_begin();
    const ShvStatus status = places && shown ? include_frames(svg, frames, count, places, shown, error)
                                             : shv_fail_memory(error, "fragments", most * (sizeof *places + 1));
    shv_release(places);
    shv_release(shown);
    shv_camera_aim(&svg->camera, width);
    return status;
}

/* ---- the page ---- */

typedef struct Page {
    double gap, panel, label; /* pixels: around panels, width of one, size of the letters */
} Page;

static Page lay_out(int32_t size, int32_t count)
{
    const double gap = floor(0.012 * size + 0.5);
    const double panel = floor((size - gap * (count + 1)) / count);
    return (Page){gap, fmax(40.0, panel), fmin(18.0, fmax(7.0, 0.055 * panel))};
}

static ShvStatus print_head(const ShvSvg *svg, const ShvExportOptions *output, const Page *page, ShvError *error)
{
    const char *given = shv_run_file_info(svg->skin.pieces.file)->scene_name;
    char *name = shv_output_escaped(output, given);
    if (!name) return shv_fail_memory(error, "a title", 1);
    const double height = svg->camera.height + 2.0 * page->gap + 1.9 * page->label;
    shv_print(svg->stream,
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" viewBox=\"0 0 %d %.0f\">\n"
              "<title>%s</title>\n<rect width=\"100%%\" height=\"100%%\" rx=\"%.0f\" fill=\"#fbfaf8\"/>\n",
              (int)svg->options.size, height, (int)svg->options.size, height, name, page->gap);
    shv_release(name);
    shv_svg_define_floor(svg);
    return SHV_OK;
}

static void print_label(const ShvSvg *svg, const Page *page, double left, int64_t frame)
{
    int64_t alive = 0;
    for (int32_t i = 0; i < shv_run_file_info(svg->skin.pieces.file)->fragment_count; i++)
        alive += svg->skin.pieces.alive[i];
    shv_print(svg->stream,
              "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\" font-family=\"Helvetica, Arial, sans-serif\" "
              "font-size=\"%.1f\" fill=\"#4a463f\">%.4g s<tspan fill=\"#9a9488\" dx=\"%.1f\">%lld "
              "fragment%s</tspan></text>\n",
              left + 0.5 * page->panel, page->gap + svg->camera.height + 1.6 * page->label, page->label,
              shv_run_file_times(svg->skin.pieces.file)[frame], 0.7 * page->label, (long long)alive,
              alive == 1 ? "" : "s");
}

static ShvStatus print_panel(ShvSvg *svg, const Page *page, int32_t index, int64_t frame, ShvError *error)
{
    const double left = page->gap + index * (page->panel + page->gap);
    SHV_TRY(shv_skin_move(&svg->skin, frame, error));
    shv_print(svg->stream,
              "<svg class=\"panel\" x=\"%.1f\" y=\"%.1f\" width=\"%.0f\" height=\"%.0f\">\n"
              "<rect width=\"100%%\" height=\"100%%\" fill=\"#f4f2ee\"/>\n",
              left, page->gap, svg->camera.width, svg->camera.height);
    SHV_TRY(shv_svg_draw_floor(svg, error));
    SHV_TRY(shv_svg_draw_fragments(svg, error));
    shv_print(svg->stream, "</svg>\n");
    print_label(svg, page, left, frame);
    return SHV_OK;
}

static ShvStatus print_panels(ShvSvg *svg, const ShvExportOptions *output, const int64_t *frames, int32_t count,
                              ShvError *error)
{
    const Page page = lay_out(svg->options.size, count);
    SHV_TRY(aim(svg, frames, count, page.panel, error));
    SHV_TRY(shv_raster_create(&svg->raster, svg->camera.width, svg->camera.height, svg->options.memory, error));
    ShvStatus status = print_head(svg, output, &page, error);
    for (int32_t i = 0; i < count && status == SHV_OK; i++) status = print_panel(svg, &page, i, frames[i], error);
    shv_print(svg->stream, "</svg>\n");
    shv_raster_release(&svg->raster);
    return status;
}

static ShvStatus draw(ShvSvg *svg, ShvRunFile *file, const char *prefix, const ShvExportOptions *output,
                      const int64_t *frames, int32_t count, ShvError *error)
{
    ShvOutput written;
    SHV_TRY(shv_skin_create(&svg->skin, file, svg->options.memory, error));
    ShvStatus status = shv_output_open(&written, output, prefix, SUFFIX[0], error);
    svg->stream = written.stream;
    if (status == SHV_OK) status = print_panels(svg, output, frames, count, error);
    shv_skin_release(&svg->skin);
    return shv_output_close(&written, output, status, error);
}

ShvStatus shv_export_svg(ShvRunFile *file, const char *prefix, const ShvSvgOptions *given, ShvError *error)
{
    ShvSvg svg = {.options = given ? *given : shv_svg_default()};
    SHV_TRY(check_options(&svg.options, error));
    ShvExportOptions output = shv_export_default();
    output.force = svg.options.force;
    output.memory = svg.options.memory;
    SHV_TRY(shv_output_check(&output, prefix, SUFFIX, 1, error));
    int64_t *frames;
    int32_t count;
    ShvStatus status = shv_svg_frames(&svg.options, file, &frames, &count, error);
    if (status == SHV_OK) status = draw(&svg, file, prefix, &output, frames, count, error);
    shv_release(frames);
    return status;
}
