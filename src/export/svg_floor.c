/* The floor: a grid that fades with the distance, and what stands between it and the light. */
#include <stdlib.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/svg.h"

static const char FLOOR[] = "#e9e5dd", LINE[] = "#d6d0c5", SHADOW[] = "#8b8478";

typedef struct Floor {
    ShvVec3 normal, one, two; /* unit axes: out of the floor, and in it */
    ShvVec3 centre;           /* below the centre of the picture, m */
    double reach;             /* half an edge of the square that is drawn, m */
} Floor;

/* False when there is none, or the camera is not clearly above it. */
static bool find_floor(const ShvSvg *svg, Floor *floor_found)
{
    const ShvCamera *camera = &svg->camera;
    const double *normal = svg->options.floor_normal;
    floor_found->normal = shv_unit(shv_load3(normal));
    if (!svg->options.floor || !(shv_dot(floor_found->normal, camera->toward) > 0.1)) return false;
    const double offset = svg->options.floor_offset / shv_norm(shv_load3(normal));
    const double height = shv_dot(camera->centre, floor_found->normal) - offset;
    const double reach = 1.2 * fmax(camera->width, camera->height) / camera->scale;
    if (!(fabs(height) < 2.0 * reach)) return false;
    floor_found->centre = shv_madd(camera->centre, -height, floor_found->normal);
    floor_found->one = shv_unit(shv_cross(camera->up, floor_found->normal));
    /* Along the axes of the world on a level floor: lines at the camera's angle would hide the perspective. */
    if (floor_found->normal.z > 0.999) floor_found->one = shv_vec3(1.0, 0.0, 0.0);
    floor_found->one =
        shv_unit(shv_madd(floor_found->one, -shv_dot(floor_found->one, floor_found->normal), floor_found->normal));
    floor_found->two = shv_cross(floor_found->normal, floor_found->one);
    floor_found->reach = reach;
    return true;
}

static ShvVec3 floor_point(const Floor *found, double one, double two)
{
    return shv_madd(shv_madd(found->centre, one, found->one), two, found->two);
}

/* 1, 2 or 5 times a power of ten: the largest that is no more than `most`. */
static double round_spacing(double most)
{
    double power = 1.0;
    while (power > most) power /= 10.0;
    while (10.0 * power <= most) power *= 10.0;
    return power * (most >= 5.0 * power ? 5.0 : most >= 2.0 * power ? 2.0 : 1.0);
}

static void print_line(const ShvSvg *svg, ShvVec3 from, ShvVec3 to)
{
    ShvScreenPoint a, b;
    if (!shv_camera_project(&svg->camera, from, &a) || !shv_camera_project(&svg->camera, to, &b)) return;
    shv_print(svg->stream, "M%.1f %.1fL%.1f %.1f", a.x, a.y, b.x, b.y);
}

static void print_grid(const ShvSvg *svg, const Floor *found)
{
    const double spacing = round_spacing(found->reach / 8.0);
    const ShvVec3 axes[2] = {found->one, found->two};
    shv_print(svg->stream, "<path fill=\"none\" stroke=\"url(#line)\" d=\"");
    for (int k = 0; k < 2; k++) {
        /* Through the origin of the world, so that lines stand at round coordinates. */
        const double origin = shv_dot(found->centre, axes[k]);
        const double last = floor((origin + found->reach) / spacing);
        for (double i = ceil((origin - found->reach) / spacing); i <= last; i += 1.0) {
            const double place = i * spacing - origin, reach = found->reach;
            print_line(svg, k == 0 ? floor_point(found, place, -reach) : floor_point(found, -reach, place),
                       k == 0 ? floor_point(found, place, reach) : floor_point(found, reach, place));
        }
    }
    shv_print(svg->stream, "\"/>");
}

static void print_fade(const ShvSvg *svg, const char *name, const char *colour, ShvScreenPoint centre, double radius)
{
    shv_print(svg->stream,
              "<radialGradient id=\"%s\" gradientUnits=\"userSpaceOnUse\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\">"
              "<stop offset=\".35\" stop-color=\"%s\"/><stop offset=\"1\" stop-color=\"%s\" stop-opacity=\"0\"/>"
              "</radialGradient>",
              name, centre.x, centre.y, radius, colour, colour);
}

void shv_svg_define_floor(const ShvSvg *svg)
{
    Floor found;
    ShvScreenPoint centre, corner[4];
    if (!find_floor(svg, &found) || !shv_camera_project(&svg->camera, found.centre, &centre)) return;
    const double radius = 0.62 * svg->camera.width;
    for (int k = 0; k < 4; k++) {
        const double one = k == 0 || k == 3 ? -found.reach : found.reach, two = k < 2 ? -found.reach : found.reach;
        if (!shv_camera_project(&svg->camera, floor_point(&found, one, two), &corner[k])) return;
    }
    shv_print(svg->stream, "<defs>");
    print_fade(svg, "ground", FLOOR, centre, radius);
    print_fade(svg, "line", LINE, centre, radius);
    shv_print(svg->stream,
              "<g id=\"floor\"><path fill=\"url(#ground)\" d=\"M%.1f %.1fL%.1f %.1fL%.1f %.1fL%.1f %.1fz\"/>",
              corner[0].x, corner[0].y, corner[1].x, corner[1].y, corner[2].x, corner[2].y, corner[3].x, corner[3].y);
    print_grid(svg, &found);
    shv_print(svg->stream, "</g></defs>\n");
}

/* ---- shadows ---- */

typedef struct Shade {
    ShvScreenPoint corner[3];
    double area; /* twice, square pixels */
    int64_t item;
} Shade;

static int by_area(const void *a, const void *b)
{
    const Shade *left = a, *right = b;
    if (left->area > right->area) return -1;
    return left->area < right->area ? 1 : (left->item > right->item) - (left->item < right->item);
}

/* The shadow of a triangle that faces the light; false when it faces away or its shadow is not on the screen. */
static bool throw_shade(const ShvSvg *svg, const Floor *found, const ShvTriangle *triangle, Shade *shade)
{
    const ShvVec3 light = shv_svg_light();
    const double slope = shv_dot(light, found->normal);
    const ShvVec3 normal =
        shv_cross(shv_sub(triangle->corner[1], triangle->corner[0]), shv_sub(triangle->corner[2], triangle->corner[0]));
    if (!(slope > 0.2) || !(shv_dot(normal, light) > 0.0)) return false;
    for (int k = 0; k < 3; k++) {
        const double height = shv_dot(shv_sub(triangle->corner[k], found->centre), found->normal);
        const ShvVec3 point = shv_madd(triangle->corner[k], -fmax(0.0, height) / slope, light);
        if (!shv_camera_project(&svg->camera, point, &shade->corner[k])) return false;
    }
    const ShvScreenPoint a = shade->corner[0], b = shade->corner[1], c = shade->corner[2];
    shade->area = fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    return true;
}

/* Large ones first; of the rest those that darken a sample that is not dark yet. */
static void print_shadow(ShvSvg *svg, Shade *shades, int64_t count)
{
    qsort(shades, (size_t)count, sizeof *shades, by_area);
    shv_raster_clear(&svg->raster);
    shv_print(svg->stream, "<path fill=\"%s\" fill-opacity=\".4\" d=\"", SHADOW);
    for (int64_t i = 0; i < count; i++) {
        /* A little farther each: what is dark already is not won again. */
        for (int k = 0; k < 3; k++) shades[i].corner[k].near = 2.0 - (double)i / (double)count;
        if (shv_raster_enter(&svg->raster, shades[i].corner, i) > 0) shv_svg_triangle(svg->stream, shades[i].corner);
    }
    shv_print(svg->stream, "\"/>\n");
}

ShvStatus shv_svg_draw_floor(ShvSvg *svg, ShvError *error)
{
    Floor found;
    if (!find_floor(svg, &found)) return SHV_OK;
    const size_t most = (size_t)svg->skin.count;
    Shade *shades = shv_allocate(svg->options.memory, SHV_PART_RECORD, most, sizeof *shades);
    if (!shades) return shv_fail_memory(error, "shadows", most * sizeof *shades);
    int64_t count = 0;
    for (int64_t i = 0; i < svg->skin.count; i++) {
        shades[count].item = i;
        count += throw_shade(svg, &found, &svg->skin.triangles[i], &shades[count]);
    }
    shv_print(svg->stream, "<use href=\"#floor\"/>\n");
    print_shadow(svg, shades, count);
    shv_release(shades);
    return SHV_OK;
}
