/* Frames of a run side by side: triangles that face the viewer, the far ones first. */
#include "shiver/export.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/camera.h"
#include "export/colour.h"
#include "export/obstacle_mesh.h"
#include "export/output.h"

enum { PANELS = 4, MOST_PANELS = 24 };
/* Of the heaviest fragment of a frame: lighter ones may be outside of the picture. */
static const double LEAST_SHARE = 0.05;
/* Obstacles that hide more than this share of the pieces are opened towards the viewer, as a drum around them is. */
static const double MOST_HIDDEN = 0.5;
static const char *const SUFFIX[] = {".svg"};

/* A face of a body, its corners anticlockwise from outside. */
typedef struct Face {
    ShvVec3 corner[3];
    int32_t node[3]; /* of the body's mesh */
    int32_t body;    /* a fragment, or −1 − an obstacle */
} Face;

typedef struct Patch {
    ShvScreenPoint corner[3];
    int32_t node[3], body;
    double near; /* of the middle */
    int64_t item;
    uint32_t colour;
    bool seen;
    bool away;       /* turned away from the middle of the pieces */
    bool goes_on[3]; /* at the edge from corner k to the next, under a patch that is drawn later */
} Patch;

/* Of a patch. */
typedef struct Edge {
    int32_t body, low, high; /* nodes; copies of one node count as one */
    int64_t patch;
    int number;
} Edge;

typedef struct Svg {
    ShvSvgOptions options;
    ShvRunFile *file;
    const ShvRunFileInfo *info;
    ShvLines lines;
    ShvObstacleMesh *obstacles;
    ShvObstacleView *views;
    double *corners; /* 12 × tets where the run recorded nodes, else NULL */
    uint8_t *bonds;  /* 4 × tets, likewise: whether the tet is held across a facet */
    ShvCamera camera;
    Patch *patches;
    int64_t patch_count;
    FILE *stream;
} Svg;

ShvSvgOptions shv_svg_default(void)
{
    return (ShvSvgOptions){.cookie = SHV_DEFINITION_COOKIE, .size = 1200};
}

static ShvStatus check_options(const ShvSvgOptions *o, const ShvRunFile *file, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (o->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the drawing's options did not start from shv_svg_default()");
    if (o->size < 200 || o->size > 4000)
        return shv_fail(error, SHV_BAD_INPUT, "a drawing is 200 to 4000 pixels wide; %d were given", (int)o->size);
    if (info->frame_count < 1) return shv_fail(error, SHV_BAD_INPUT, "the run has no frame to draw");
    if (o->frame_count < 0 || o->time_count < 0 || (o->frame_count > 0 && o->time_count > 0))
        return shv_fail(error, SHV_BAD_INPUT, "give either frames or times to draw");
    if (o->frame_count > MOST_PANELS || o->time_count > MOST_PANELS)
        return shv_fail(error, SHV_BAD_INPUT, "a drawing shows at most %d frames; %d were given", (int)MOST_PANELS,
                        (int)(o->frame_count + o->time_count));
    for (int32_t i = 0; i < o->frame_count; i++)
        if (o->frames[i] < 0 || o->frames[i] >= info->frame_count)
            return shv_fail(error, SHV_BAD_INPUT, "there is no frame %lld: the run has frames 0 to %lld",
                            (long long)o->frames[i], (long long)(info->frame_count - 1));
    for (int32_t i = 0; i < o->time_count; i++)
        if (shv_run_file_nearest(file, o->times[i]) < 0)
            return shv_fail(error, SHV_BAD_INPUT, "there is no time %g s: the run goes from %g to %g s", o->times[i],
                            info->first_time, info->last_time);
    return SHV_OK;
}

/* ---- which frames ---- */

/* Those asked for, or evenly over the time of the run, each once. */
static int32_t choose_frames(const Svg *svg, int64_t frames[MOST_PANELS])
{
    const ShvSvgOptions *o = &svg->options;
    const double first = svg->info->first_time, span = svg->info->last_time - first;
    int32_t count = 0;
    for (int32_t i = 0; i < o->frame_count; i++) frames[count++] = o->frames[i];
    for (int32_t i = 0; i < o->time_count; i++) frames[count++] = shv_run_file_nearest(svg->file, o->times[i]);
    for (int32_t i = 0; i < PANELS && o->frame_count + o->time_count == 0; i++) {
        const int64_t frame = shv_run_file_nearest(svg->file, first + span * i / (PANELS - 1));
        if (count == 0 || frames[count - 1] != frame) frames[count++] = frame;
    }
    return count;
}

/* ---- patches ---- */

static ShvVec3 light(void)
{
    return shv_unit(shv_vec3(-0.3, -0.45, 1.0));
}

/* Of flat light: from the sky, and from the lamp where the face is turned to it. */
static int shade_of(const ShvVec3 corner[3])
{
    const ShvVec3 normal = shv_unit(shv_cross(shv_sub(corner[1], corner[0]), shv_sub(corner[2], corner[0])));
    const double strength = 0.15 * (1.0 + normal.z) + 0.7 * fmax(0.0, shv_dot(normal, light()));
    return (int)(strength * (SHV_SHADES - 1) + 0.5);
}

/* Twice, square pixels; positive when the triangle faces the viewer (y points down). */
static double area_of(const ShvScreenPoint corner[3])
{
    return (corner[1].y - corner[0].y) * (corner[2].x - corner[0].x) -
           (corner[1].x - corner[0].x) * (corner[2].y - corner[0].y);
}

static void add_patch(Svg *svg, const Face *face, uint32_t colour)
{
    Patch *patch = &svg->patches[svg->patch_count];
    bool seen = true;
    for (int k = 0; k < 3; k++) {
        seen = seen && shv_camera_project(&svg->camera, face->corner[k], &patch->corner[k]);
        patch->node[k] = face->node[k];
    }
    patch->body = face->body;
    if (!seen || !(area_of(patch->corner) > 0.0)) return;
    patch->near = (patch->corner[0].near + patch->corner[1].near + patch->corner[2].near) / 3.0;
    patch->colour = shv_shaded(colour, shade_of(face->corner));
    const ShvVec3 *x = face->corner, normal = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
    patch->away = shv_dot(normal, shv_sub(svg->camera.centre, x[0])) < 0.0;
    patch->seen = patch->goes_on[0] = patch->goes_on[1] = patch->goes_on[2] = false;
    patch->item = svg->patch_count++;
}

static ShvVec3 point_of(const Svg *svg, int64_t tet, int corner)
{
    if (svg->corners) return shv_load3(svg->corners + 12 * tet + 3 * (int64_t)corner);
    return shv_pieces_point(&svg->lines.pieces, svg->lines.pieces.owner[tet],
                            svg->lines.pieces.elements[4 * tet + corner]);
}

/* A face of a tet, and whether it is bare at the frame. The order of its corners follows from where the opposite corner is, so that a
   tet turned inside out is drawn too. */
static bool bare_face(const Svg *svg, int64_t number, Face *face)
{
    const ShvPieces *pieces = &svg->lines.pieces;
    const int32_t other = svg->lines.neighbour[number], carrier = pieces->carrier[pieces->owner[number / 4]];
    if (!pieces->alive[carrier] || (other >= 0 && pieces->carrier[pieces->owner[other]] == carrier)) return false;
    face->body = carrier;
    for (int k = 0; k < 3; k++) {
        const int corner = shv_face_corner(number, k);
        face->corner[k] = point_of(svg, number / 4, corner);
        face->node[k] = pieces->elements[4 * (number / 4) + corner];
        if (!shv_finite3(face->corner[k])) return false;
    }
    const Face found = *face;
    const ShvVec3 *x = found.corner, normal = shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0]));
    if (!(shv_dot(normal, shv_sub(point_of(svg, number / 4, (int)(number % 4)), x[0])) > 0.0)) return true;
    for (int k = 1; k < 3; k++) {
        face->corner[k] = found.corner[3 - k];
        face->node[k] = found.node[3 - k];
    }
    return true;
}

/* Whether a crack that parts no piece yet lies beside the tet. */
static bool is_cracked(const Svg *svg, int64_t tet)
{
    const ShvPieces *pieces = &svg->lines.pieces;
    for (int64_t face = 4 * tet; svg->bonds && face < 4 * tet + 4; face++) {
        const int32_t other = svg->lines.neighbour[face];
        if (!svg->bonds[face] && other >= 0 &&
            pieces->carrier[pieces->owner[other]] == pieces->carrier[pieces->owner[tet]])
            return true;
    }
    return false;
}

static void add_pieces(Svg *svg)
{
    const ShvPieces *pieces = &svg->lines.pieces;
    int32_t heaviest = -1;
    for (int32_t i = 0; i < svg->info->fragment_count; i++)
        if (pieces->alive[i] && (heaviest < 0 || pieces->fragments[i].mass > pieces->fragments[heaviest].mass))
            heaviest = i;
    for (int64_t f = 0; f < svg->lines.begin[svg->lines.count]; f++) {
        Face face;
        if (!bare_face(svg, svg->lines.face[f], &face)) continue;
        const uint32_t whole =
            face.body == heaviest ? (uint32_t)SHV_STONE_COLOUR : shv_line_colour(pieces->lineage[face.body]);
        add_patch(svg, &face, is_cracked(svg, svg->lines.face[f] / 4) ? (uint32_t)SHV_CRACK_COLOUR : whole);
    }
}

/* Whether it is drawn: planes are not by triangles. */
static bool obstacle_face(const Svg *svg, int32_t obstacle, int64_t triangle, Face *face)
{
    const ShvObstacleMesh *mesh = &svg->obstacles[obstacle];
    const double *q = svg->views[obstacle].orientation;
    face->body = -1 - obstacle;
    for (int k = 0; k < 3; k++) {
        face->node[k] = mesh->triangles[3 * triangle + k];
        const ShvVec3 x = shv_load3(mesh->positions + 3 * (int64_t)face->node[k]);
        face->corner[k] =
            shv_add(shv_load3(svg->views[obstacle].position), shv_rotate((ShvQuat){q[0], q[1], q[2], q[3]}, x));
    }
    return mesh->body.shape != SHV_OBSTACLE_PLANE;
}

static void add_obstacles(Svg *svg)
{
    Face face;
    for (int32_t i = 0; i < svg->info->obstacle_count; i++)
        for (int64_t t = 0; t < svg->obstacles[i].triangle_count; t++)
            if (obstacle_face(svg, i, t, &face)) add_patch(svg, &face, SHV_OBSTACLE_COLOUR);
}

static int far_first(const void *a, const void *b)
{
    const Patch *left = a, *right = b;
    if (left->near < right->near) return -1;
    return left->near > right->near ? 1 : (left->item > right->item) - (left->item < right->item);
}

/* Two a pixel and direction, and which patch is the nearest at each. What else lies there is drawn before it. */
typedef struct Samples {
    int32_t columns, rows;
    double *near;
    int64_t *item; /* number + 1 of the nearest; 0: none */
    int64_t *
        begin; /* patches that are drawn before patch i: before[begin[i]] to before[begin[i + 1] − 1], in any number of times */
    int64_t *before; /* NULL: they are counted */
} Samples;

static void take_nearest(Samples *samples, int64_t sample, int64_t number, double here)
{
    if (!(here > samples->near[sample])) return;
    samples->near[sample] = here;
    samples->item[sample] = number + 1;
}

/* The entry after a patch's own is where its list ends, so far. */
static void note_hidden(Samples *samples, int64_t sample, int64_t number, double here)
{
    (void)here;
    const int64_t nearest = samples->item[sample] - 1;
    if (nearest < 0 || nearest == number) return;
    if (samples->before) samples->before[samples->begin[nearest + 1]] = number;
    samples->begin[nearest + 1]++;
}

typedef void Visit(Samples *samples, int64_t sample, int64_t number, double here);

/* All samples in which a patch lies. */
static void visit_samples(const Patch *patch, int64_t number, Samples *samples, Visit *visit)
{
    const ShvScreenPoint *c = patch->corner;
    const double area = area_of(c), left = fmin(c[0].x, fmin(c[1].x, c[2].x)), top = fmin(c[0].y, fmin(c[1].y, c[2].y));
    const double right = fmax(c[0].x, fmax(c[1].x, c[2].x)), bottom = fmax(c[0].y, fmax(c[1].y, c[2].y));
    const int32_t columns = samples->columns, rows = samples->rows;
    for (int32_t row = (int32_t)fmax(0.0, 2.0 * top); row < fmin(rows, 2.0 * bottom); row++)
        for (int32_t column = (int32_t)fmax(0.0, 2.0 * left); column < fmin(columns, 2.0 * right); column++) {
            const ShvScreenPoint p = {0.5 * column + 0.25, 0.5 * row + 0.25, 0.0};
            const double u = area_of((const ShvScreenPoint[3]){p, c[1], c[2]}) / area,
                         v = area_of((const ShvScreenPoint[3]){c[0], p, c[2]}) / area, w = 1.0 - u - v;
            if (u < 0.0 || v < 0.0 || w < 0.0) continue;
            visit(samples, (int64_t)row * columns + column, number, u * c[0].near + v * c[1].near + w * c[2].near);
        }
}

static void visit_all(const Svg *svg, Samples *samples, Visit *visit)
{
    for (int64_t i = 0; i < svg->patch_count; i++) visit_samples(&svg->patches[i], i, samples, visit);
}

static void find_nearest(const Svg *svg, Samples *samples)
{
    const size_t count = (size_t)samples->columns * (size_t)samples->rows;
    memset(samples->near, 0, count * sizeof *samples->near);
    memset(samples->item, 0, count * sizeof *samples->item);
    visit_all(svg, samples, take_nearest);
}

/* Before a sample where pieces are: their number turns negative, as they are hidden. */
static void note_before(Samples *samples, int64_t sample, int64_t number, double here)
{
    (void)number;
    if (samples->item[sample] > 0 && here > samples->near[sample]) samples->item[sample] *= -1;
}

/* Where obstacles hide most of the pieces, those that do not move freely are left without what is turned away from these. The patches
   of pieces come first. */
static void open_obstacles(Svg *svg, Samples *samples, int64_t of_pieces)
{
    const int64_t count = svg->patch_count;
    int64_t pieces = 0, hidden = 0;
    if (count == of_pieces) return;
    svg->patch_count = of_pieces;
    find_nearest(svg, samples);
    for (int64_t i = of_pieces; i < count; i++) visit_samples(&svg->patches[i], i, samples, note_before);
    for (int64_t i = 0; i < (int64_t)samples->columns * samples->rows; i++) {
        pieces += samples->item[i] != 0;
        hidden += samples->item[i] < 0;
    }
    const bool opened = (double)hidden > MOST_HIDDEN * (double)pieces;
    for (int64_t i = of_pieces; i < count; i++) {
        const Patch *patch = &svg->patches[i];
        const bool is_wall = svg->obstacles[-1 - patch->body].body.motion != SHV_OBSTACLE_FREE;
        if (!(opened && is_wall && patch->away)) svg->patches[svg->patch_count++] = *patch;
    }
}

/* Those that can be seen, by the distances of their middles. */
static void keep_seen(Svg *svg, Samples *samples)
{
    int64_t kept = 0;
    find_nearest(svg, samples);
    for (int64_t i = 0; i < (int64_t)samples->columns * samples->rows; i++)
        if (samples->item[i] > 0) svg->patches[samples->item[i] - 1].seen = true;
    for (int64_t i = 0; i < svg->patch_count; i++)
        if (svg->patches[i].seen) svg->patches[kept++] = svg->patches[i];
    svg->patch_count = kept;
    qsort(svg->patches, (size_t)kept, sizeof *svg->patches, far_first);
}

/* Lists, for each patch, those behind it: room for all is made when they have been counted. */
static ShvStatus list_hidden(const Svg *svg, Samples *samples, ShvError *error)
{
    const size_t count = (size_t)svg->patch_count;
    samples->begin = shv_allocate(svg->options.memory, SHV_PART_RECORD, count + 2, sizeof *samples->begin);
    if (!samples->begin) return shv_fail_memory(error, "patches", count * sizeof *samples->begin);
    find_nearest(svg, samples);
    visit_all(svg, samples, note_hidden);
    for (size_t i = 0; i < count; i++) samples->begin[i + 1] += samples->begin[i];
    const size_t total = (size_t)samples->begin[count];
    samples->before = shv_allocate(svg->options.memory, SHV_PART_RECORD, total + 1, sizeof *samples->before);
    if (!samples->before) return shv_fail_memory(error, "hidden patches", total * sizeof *samples->before);
    memmove(samples->begin + 1, samples->begin, count * sizeof *samples->begin);
    visit_all(svg, samples, note_hidden);
    return SHV_OK;
}

/* Far ones first, but none before what it hides: a large face is nearer in one place and farther in another than what is small. Where
   that goes in a circle, the far one comes first. `stack`, `next`: room for as many as there are patches. */
static void sort_patches(const Svg *svg, const Samples *samples, int64_t *stack, int64_t *next, Patch *sorted)
{
    int64_t done = 0;
    for (int64_t i = 0; i < svg->patch_count; i++) next[i] = -1; /* not begun */
    for (int64_t i = 0; i < svg->patch_count; i++) {
        int64_t depth = 0;
        if (next[i] >= 0) continue;
        next[i] = samples->begin[i];
        stack[depth++] = i;
        while (depth > 0) {
            const int64_t top = stack[depth - 1];
            if (next[top] == samples->begin[top + 1]) {
                sorted[done++] = svg->patches[top];
                depth--;
                continue;
            }
            const int64_t hidden = samples->before[next[top]++];
            if (next[hidden] >= 0) continue;
            next[hidden] = samples->begin[hidden];
            stack[depth++] = hidden;
        }
    }
}

static ShvStatus order_seen(Svg *svg, Samples *samples, ShvError *error)
{
    ShvMemory *memory = svg->options.memory;
    SHV_TRY(list_hidden(svg, samples, error));
    const size_t count = (size_t)svg->patch_count + 1;
    int64_t *stack = shv_allocate(memory, SHV_PART_RECORD, 2 * count, sizeof *stack);
    Patch *sorted = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *sorted);
    const bool room = stack && sorted;
    if (room) {
        sort_patches(svg, samples, stack, stack + count, sorted);
        memcpy(svg->patches, sorted, (size_t)svg->patch_count * sizeof *sorted);
    }
    shv_release(stack);
    shv_release(sorted);
    return room ? SHV_OK : shv_fail_memory(error, "patches", count * sizeof *sorted);
}

/* Keeps what can be seen, in the order in which it is drawn; `of_pieces`: how many patches are not of obstacles. */
static ShvStatus choose_patches(Svg *svg, int64_t of_pieces, ShvError *error)
{
    ShvMemory *memory = svg->options.memory;
    Samples samples = {.columns = (int32_t)(2.0 * svg->camera.width), .rows = (int32_t)(2.0 * svg->camera.height)};
    const size_t count = (size_t)samples.columns * (size_t)samples.rows;
    samples.near = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *samples.near);
    samples.item = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *samples.item);
    ShvStatus status = samples.near && samples.item ? SHV_OK : shv_fail_memory(error, "samples", 16 * count);
    if (status == SHV_OK) {
        open_obstacles(svg, &samples, of_pieces);
        keep_seen(svg, &samples);
        status = order_seen(svg, &samples, error);
    }
    shv_release(samples.near);
    shv_release(samples.item);
    shv_release(samples.begin);
    shv_release(samples.before);
    return status;
}

/* ---- edges ----
   Two patches with smooth edges leave a seam that what is behind shines through. So the one that is drawn first goes on a little
   under the other, which then ends exactly where it should; outlines are exact as nothing goes on there. */

static Edge edge_of(const Patch *patch, int64_t number, int k)
{
    const int32_t a = patch->node[k], b = patch->node[(k + 1) % 3];
    return (Edge){patch->body, a < b ? a : b, a < b ? b : a, number, k};
}

static bool is_same(const Edge *a, const Edge *b)
{
    return a->body == b->body && a->low == b->low && a->high == b->high;
}

static int by_nodes(const void *a, const void *b)
{
    const Edge *left = a, *right = b;
    if (left->body != right->body) return left->body < right->body ? -1 : 1;
    if (left->low != right->low) return left->low < right->low ? -1 : 1;
    if (left->high != right->high) return left->high < right->high ? -1 : 1;
    return (left->patch > right->patch) - (left->patch < right->patch);
}

/* Of patches in their order of drawing. */
static ShvStatus find_shared_edges(Svg *svg, ShvError *error)
{
    const int64_t count = 3 * svg->patch_count;
    Edge *edges = shv_allocate(svg->options.memory, SHV_PART_RECORD, (size_t)count, sizeof *edges);
    if (!edges) return shv_fail_memory(error, "edges", (size_t)count * sizeof *edges);
    for (int64_t i = 0; i < count; i++) edges[i] = edge_of(&svg->patches[i / 3], i / 3, (int)(i % 3));
    qsort(edges, (size_t)count, sizeof *edges, by_nodes);
    for (int64_t i = 0; i + 1 < count; i++)
        if (is_same(&edges[i], &edges[i + 1])) svg->patches[edges[i].patch].goes_on[edges[i].number] = true;
    shv_release(edges);
    return SHV_OK;
}

/* ---- drawing ---- */

/* How far a patch goes on under the next, pixels; and by how much of that it is narrower there on either side, so that little shows
   beside corners. */
static const double OVERLAP = 0.7, INSET = 0.25;

/* A path is in tenths of a pixel; `at`: where it is. */
static void print_line_to(FILE *stream, double at[2], double x, double y)
{
    const double to[2] = {floor(10.0 * x + 0.5), floor(10.0 * y + 0.5)};
    shv_print(stream, "l%g %g", (to[0] - at[0]) / 10.0, (to[1] - at[1]) / 10.0);
    at[0] = to[0];
    at[1] = to[1];
}

static void print_patch(FILE *stream, const Patch *patch)
{
    double at[2] = {floor(10.0 * patch->corner[0].x + 0.5), floor(10.0 * patch->corner[0].y + 0.5)};
    shv_print(stream, "M%g %g", at[0] / 10.0, at[1] / 10.0);
    for (int k = 0; k < 3; k++) {
        const ShvScreenPoint a = patch->corner[k], b = patch->corner[(k + 1) % 3];
        const double x = b.x - a.x, y = b.y - a.y, share = OVERLAP / fmax(sqrt(x * x + y * y), 2.0 * OVERLAP);
        if (patch->goes_on[k]) {
            print_line_to(stream, at, a.x + share * (INSET * x - y), a.y + share * (INSET * y + x));
            print_line_to(stream, at, b.x - share * (INSET * x + y), b.y - share * (INSET * y - x));
        }
        if (k < 2) print_line_to(stream, at, b.x, b.y);
    }
    shv_print(stream, "z");
}

/* Neighbours in the order of drawing share a path where they share a colour. */
static void print_patches(const Svg *svg)
{
    for (int64_t i = 0; i < svg->patch_count;) {
        const uint32_t colour = svg->patches[i].colour;
        shv_print(svg->stream, "<path fill=\"#%06x\" d=\"", (unsigned)colour);
        for (; i < svg->patch_count && svg->patches[i].colour == colour; i++)
            print_patch(svg->stream, &svg->patches[i]);
        shv_print(svg->stream, "\"/>\n");
    }
}

/* Of a triangle on a plane, in the light; none where it is not above the plane, or hardly to be seen. */
static void print_shadow(const Svg *svg, const ShvObstacleBody *plane, const ShvVec3 corner[3])
{
    const ShvVec3 normal = shv_load3(plane->normal);
    Patch shadow = {.colour = 0};
    for (int k = 0; k < 3; k++) {
        const double height = shv_dot(corner[k], normal) - plane->offset;
        const ShvVec3 foot = shv_madd(corner[k], -height / shv_dot(normal, light()), light());
        if (height < 0.0 || !shv_camera_project(&svg->camera, foot, &shadow.corner[k])) return;
    }
    if (area_of(shadow.corner) > 1.0) print_patch(svg->stream, &shadow);
}

/* A plane that the camera is above, and on it what stands between it and the lamp: one path, so that nothing darkens twice. */
static void print_plane(const Svg *svg, int32_t obstacle)
{
    const ShvObstacleBody *plane = &svg->obstacles[obstacle].body;
    const ShvVec3 normal = shv_load3(plane->normal);
    Face face;
    if (!(shv_dot(normal, svg->camera.toward) > 0.1)) return;
    shv_print(svg->stream, "<rect width=\"100%%\" height=\"100%%\" fill=\"#e9e5dd\"/>\n");
    if (!(shv_dot(normal, light()) > 0.1)) return;
    shv_print(svg->stream, "<path fill=\"#8b8478\" fill-opacity=\".45\" d=\"");
    for (int64_t f = 0; f < svg->lines.begin[svg->lines.count]; f++)
        if (bare_face(svg, svg->lines.face[f], &face)) print_shadow(svg, plane, face.corner);
    for (int32_t i = 0; i < svg->info->obstacle_count; i++)
        for (int64_t t = 0; t < svg->obstacles[i].triangle_count; t++)
            if (obstacle_face(svg, i, t, &face)) print_shadow(svg, plane, face.corner);
    shv_print(svg->stream, "\"/>\n");
}

typedef struct Page {
    double gap, panel, label; /* pixels: around panels, width of one, size of the letters */
} Page;

static ShvStatus print_head(const Svg *svg, const ShvExportOptions *output, const Page *page, ShvError *error)
{
    char *name = shv_output_escaped(output, svg->info->scene_name);
    if (!name) return shv_fail_memory(error, "a title", 1);
    const double height = svg->camera.height + 2.0 * page->gap + 1.9 * page->label;
    shv_print(svg->stream,
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" viewBox=\"0 0 %d %.0f\">\n"
              "<title>%s</title>\n<rect width=\"100%%\" height=\"100%%\" rx=\"%.0f\" fill=\"#fbfaf8\"/>\n",
              (int)svg->options.size, height, (int)svg->options.size, height, name, page->gap);
    shv_release(name);
    return SHV_OK;
}

static ShvStatus move(Svg *svg, int64_t frame, ShvError *error)
{
    SHV_TRY(shv_lines_move(&svg->lines, frame, error));
    if (svg->info->obstacle_count > 0) SHV_TRY(shv_run_file_obstacles(svg->file, frame, svg->views, error));
    if (!svg->info->nodes) return SHV_OK;
    SHV_TRY(shv_run_file_bonds(svg->file, frame, svg->bonds, error));
    return shv_run_file_corners(svg->file, frame, svg->corners, NULL, NULL, error);
}

static ShvStatus print_panel(Svg *svg, const Page *page, int32_t index, int64_t frame, ShvError *error)
{
    const double left = page->gap + index * (page->panel + page->gap);
    int alive = 0;
    SHV_TRY(move(svg, frame, error));
    for (int32_t i = 0; i < svg->info->fragment_count; i++) alive += svg->lines.pieces.alive[i];
    shv_print(svg->stream,
              "<svg class=\"panel\" x=\"%.1f\" y=\"%.1f\" width=\"%.0f\" height=\"%.0f\">\n"
              "<rect width=\"100%%\" height=\"100%%\" fill=\"#f4f2ee\"/>\n",
              left, page->gap, svg->camera.width, svg->camera.height);
    for (int32_t i = 0; i < svg->info->obstacle_count; i++)
        if (svg->obstacles[i].body.shape == SHV_OBSTACLE_PLANE) print_plane(svg, i);
    svg->patch_count = 0;
    add_pieces(svg);
    const int64_t of_pieces = svg->patch_count;
    add_obstacles(svg);
    SHV_TRY(choose_patches(svg, of_pieces, error));
    SHV_TRY(find_shared_edges(svg, error));
    print_patches(svg);
    shv_print(
        svg->stream,
        "</svg>\n<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\" font-family=\"Helvetica, Arial, sans-serif\" "
        "font-size=\"%.1f\" fill=\"#4a463f\">%.4g s<tspan fill=\"#9a9488\" dx=\"%.1f\">%d fragment%s</tspan></text>\n",
        left + 0.5 * page->panel, page->gap + svg->camera.height + 1.6 * page->label, page->label,
        shv_run_file_times(svg->file)[frame], 0.7 * page->label, alive, alive == 1 ? "" : "s");
    return SHV_OK;
}

/* One camera for all frames. */
static ShvStatus aim(Svg *svg, const int64_t *frames, int32_t count, double width, ShvError *error)
{
    const ShvPieces *pieces = &svg->lines.pieces;
    svg->camera = shv_camera_begin();
    for (int32_t i = 0; i < count; i++) {
        double least = 0.0;
        SHV_TRY(move(svg, frames[i], error));
        for (int32_t k = 0; k < svg->info->fragment_count; k++)
            if (pieces->alive[k]) least = fmax(least, LEAST_SHARE * pieces->fragments[k].mass);
        for (int64_t f = 0; f < svg->lines.begin[svg->lines.count]; f++) {
            Face face;
            if (!bare_face(svg, svg->lines.face[f], &face) || pieces->fragments[face.body].mass < least) continue;
            for (int k = 0; k < 3; k++) shv_camera_include(&svg->camera, face.corner[k]);
        }
    }
    shv_camera_aim(&svg->camera, width);
    return SHV_OK;
}

static ShvStatus print_page(Svg *svg, const ShvExportOptions *output, ShvError *error)
{
    int64_t frames[MOST_PANELS];
    const int32_t count = choose_frames(svg, frames), size = svg->options.size;
    const double gap = floor(0.012 * size + 0.5), panel = fmax(40.0, floor((size - gap * (count + 1)) / count));
    const Page page = {gap, panel, fmin(18.0, fmax(7.0, 0.055 * panel))};
    SHV_TRY(aim(svg, frames, count, page.panel, error));
    ShvStatus status = print_head(svg, output, &page, error);
    for (int32_t i = 0; i < count && status == SHV_OK; i++) status = print_panel(svg, &page, i, frames[i], error);
    shv_print(svg->stream, "</svg>\n");
    return status;
}

static ShvStatus draw(Svg *svg, const ShvExportOptions *output, ShvError *error)
{
    struct ShvMemory *memory = svg->options.memory;
    const size_t obstacles = (size_t)svg->info->obstacle_count;
    size_t most = 0;
    SHV_TRY(shv_obstacle_meshes_create(&svg->obstacles, &svg->lines.pieces, memory, error));
    for (size_t i = 0; i < obstacles; i++) most += (size_t)svg->obstacles[i].triangle_count;
    most += (size_t)svg->lines.begin[svg->lines.count] + 1;
    svg->views = shv_allocate(memory, SHV_PART_RECORD, obstacles, sizeof *svg->views);
    svg->patches = shv_allocate(memory, SHV_PART_RECORD, most, sizeof *svg->patches);
    if (svg->info->nodes) {
        svg->corners = shv_allocate(memory, SHV_PART_RECORD, 12 * (size_t)svg->info->element_count, sizeof(double));
        svg->bonds = shv_allocate(memory, SHV_PART_RECORD, 4 * (size_t)svg->info->element_count, 1);
    }
    const bool good = svg->views && svg->patches && ((svg->corners && svg->bonds) || !svg->info->nodes);
    return good ? print_page(svg, output, error) : shv_fail_memory(error, "triangles", most * sizeof *svg->patches);
}

ShvStatus shv_export_svg(ShvRunFile *file, const char *prefix, const ShvSvgOptions *given, ShvError *error)
{
    Svg svg = {.options = given ? *given : shv_svg_default(), .file = file, .info = shv_run_file_info(file)};
    ShvOutput written;
    SHV_TRY(check_options(&svg.options, svg.file, error));
    ShvExportOptions output = shv_export_default();
    output.force = svg.options.force;
    output.memory = svg.options.memory;
    SHV_TRY(shv_output_check(&output, prefix, SUFFIX, 1, error));
    SHV_TRY(shv_lines_create(&svg.lines, file, output.memory, NULL, error));
    ShvStatus status = shv_output_open(&written, &output, prefix, SUFFIX[0], error);
    if (status == SHV_OK) {
        svg.stream = written.stream;
        status = draw(&svg, &output, error);
        status = shv_output_close(&written, &output, status, error);
    }
    shv_obstacle_meshes_release(svg.obstacles, svg.info->obstacle_count);
    shv_lines_release(&svg.lines);
    shv_release(svg.views);
    shv_release(svg.corners);
    shv_release(svg.bonds);
    shv_release(svg.patches);
    return status;
}
