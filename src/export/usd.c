/* USD as text: an Xform a body with time samples, its shape below it. */
#include <math.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/output.h"
#include "export/tracks.h"

/* Time codes a second where the run has no animation grid to tell. */
static const double CODES_A_SECOND = 240.0;

typedef struct Usd {
    const ShvTracks *tracks;
    FILE *stream;
    double rate; /* time codes a second */
} Usd;

/* A text between quotes: what would end it, or the line, is escaped. */
static void put_text(FILE *stream, const char *text)
{
    putc('"', stream);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            shv_print(stream, "\\%c", c);
        else
            putc(c < 0x20 || c == 0x7f ? ' ' : c, stream);
    }
    putc('"', stream);
}

/* Shortest of 6 to 9 digits that gives the same float back. */
static void put_float(FILE *stream, float value)
{
    char text[SHV_OUTPUT_NUMBER];
    for (int digits = 6; digits <= 9; digits++) {
        shv_format(text, sizeof text, "%.*g", digits, (double)value);
        if ((float)shv_text_to_double(text, NULL) == value) break;
    }
    fputs(text, stream);
}

/* (a, b, c) of numbers in this order. */
static void put_tuple(FILE *stream, const float *values, const int *order, int count)
{
    for (int i = 0; i < count; i++) {
        fputs(i > 0 ? ", " : "(", stream);
        put_float(stream, values[order[i]]);
    }
    putc(')', stream);
}

static void put_point(FILE *stream, ShvVec3 point)
{
    static const int order[] = {0, 1, 2};
    const float values[3] = {(float)point.x, (float)point.y, (float)point.z};
    put_tuple(stream, values, order, 3);
}

/* ---- samples ---- */

static void begin_sample(const Usd *usd, int64_t frame)
{
    char code[SHV_OUTPUT_NUMBER];
    /* Frames of the grid are whole numbers of codes but for rounding. */
    const double exact = usd->tracks->times[frame] * usd->rate, whole = floor(exact + 0.5);
    shv_output_format(code, fabs(exact - whole) < 1e-6 ? whole : exact);
    shv_print(usd->stream, "            %s: ", code);
}

static void put_samples(const Usd *usd, int32_t body, const char *attribute, const int *order, int count)
{
    const bool moves = shv_tracks_moves(usd->tracks, body);
    shv_print(usd->stream, "        %s.timeSamples = {\n", attribute);
    for (int64_t frame = 0; frame < (moves ? usd->tracks->frame_count : 1); frame++) {
        begin_sample(usd, frame);
        put_tuple(usd->stream, shv_tracks_pose(usd->tracks, body, frame), order, count);
        fputs(",\n", usd->stream);
    }
    fputs("        }\n", usd->stream);
}

/* Both: visibility, which some readers leave out, and scale 0 or 1. */
static void put_visibility(const Usd *usd, int32_t body)
{
    const ShvTracks *tracks = usd->tracks;
    for (int part = 0; part < 2; part++) {
        fputs(part == 0 ? "        token visibility.timeSamples = {\n"
                        : "        float3 xformOp:scale.timeSamples = {\n",
              usd->stream);
        for (int64_t frame = 0; frame < tracks->frame_count; frame++) {
            const bool there = shv_tracks_pose(tracks, body, frame)[7] > 0.5F;
            const bool before = frame > 0 && shv_tracks_pose(tracks, body, frame - 1)[7] > 0.5F;
            const bool last = frame + 1 == tracks->frame_count;
            /* Scales are interpolated: the sample before a change is needed, too. */
            const bool next = !last && (shv_tracks_pose(tracks, body, frame + 1)[7] > 0.5F) != there;
            if (frame > 0 && there == before && !(part == 1 && next)) continue;
            begin_sample(usd, frame);
            fputs(part == 1 ? there ? "(1, 1, 1),\n" : "(0, 0, 0),\n"
                  : there   ? "\"inherited\",\n"
                            : "\"invisible\",\n",
                  usd->stream);
        }
        fputs("        }\n", usd->stream);
    }
}

/* ---- bodies ---- */

static void put_shape(const Usd *usd, int32_t body)
{
    const ShvTracks *tracks = usd->tracks;
    FILE *stream = usd->stream;
    const int64_t count = shv_tracks_triangle_count(tracks, body), vertices = shv_tracks_vertex_count(tracks, body);
    const int32_t *corners = shv_tracks_triangles(tracks, body);
    double colour[3];
    shv_tracks_colour(tracks, body, colour);
    fputs("        def Mesh \"shape\"\n        {\n            uniform token subdivisionScheme = \"none\"\n", stream);
    shv_print(stream, "            color3f[] primvars:displayColor = [(%.4g, %.4g, %.4g)]\n", pow(colour[0], 2.2),
              pow(colour[1], 2.2), pow(colour[2], 2.2));
    fputs("            int[] faceVertexCounts = [", stream);
    for (int64_t i = 0; i < count; i++) fputs(i > 0 ? ",3" : "3", stream);
    fputs("]\n            int[] faceVertexIndices = [", stream);
    for (int64_t i = 0; i < 3 * count; i++) shv_print(stream, i > 0 ? ",%d" : "%d", (int)corners[i]);
    fputs("]\n            point3f[] points = [", stream);
    for (int64_t i = 0; i < vertices; i++) {
        if (i > 0) putc(',', stream);
        put_point(stream, shv_tracks_vertex(tracks, body, i));
    }
    fputs("]\n            uniform normal3f[] normals = [", stream);
    for (int64_t i = 0; i < count; i++) {
        if (i > 0) putc(',', stream);
        put_point(stream, shv_tracks_normal(tracks, body, i));
    }
    fputs("] (\n                interpolation = \"uniform\"\n            )\n        }\n", stream);
}

static void put_data(const Usd *usd, int32_t body)
{
    const ShvLines *lines = &usd->tracks->lines;
    fputs(" (\n        customData = {\n", usd->stream);
    if (body < lines->count) {
        const ShvFragmentView *fragment = &lines->pieces.fragments[lines->leaf[body]];
        shv_print(usd->stream,
                  "            int line = %d\n            int fragment = %d\n            int parent = %d\n",
                  (int)lines->pieces.lineage[fragment->id], (int)fragment->id, (int)fragment->parent);
        shv_print(usd->stream,
                  "            double birth = %.17g\n            double mass = %.17g\n            string object = ",
                  fragment->birth, fragment->mass);
        put_text(usd->stream, shv_run_file_object_name(lines->pieces.file, fragment->object));
    } else {
        fputs("            string obstacle = ", usd->stream);
        put_text(usd->stream, usd->tracks->obstacles[body - lines->count].body.name);
    }
    fputs("\n        }\n    )\n    {\n", usd->stream);
}

static void put_body(const Usd *usd, int32_t body)
{
    static const int place[] = {0, 1, 2}, turn[] = {6, 3, 4, 5}; /* w first */
    const bool vanishes = shv_tracks_vanishes(usd->tracks, body);
    char name[32];
    shv_tracks_name(usd->tracks, body, name);
    shv_print(usd->stream, "    def Xform \"%s\"", name);
    put_data(usd, body);
    put_samples(usd, body, "float3 xformOp:translate", place, 3);
    put_samples(usd, body, "quatf xformOp:orient", turn, 4);
    if (vanishes) put_visibility(usd, body);
    shv_print(usd->stream, "        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"%s]\n",
              vanishes ? ", \"xformOp:scale\"" : "");
    put_shape(usd, body);
    fputs("    }\n", usd->stream);
}

/* ---- the file ---- */

/* Of the animation grid: from its first two frames. */
static double find_rate(ShvRunFile *file)
{
    const double *times = shv_run_file_times(file);
    const uint8_t *grid = shv_run_file_animation(file);
    int64_t first = -1;
    for (int64_t frame = 0; frame < shv_run_file_info(file)->frame_count; frame++) {
        if (!grid[frame]) continue;
        if (first >= 0 && times[frame] > times[first]) {
            const double rate = 1.0 / (times[frame] - times[first]), whole = floor(rate + 0.5);
            return whole >= 1.0 && fabs(rate - whole) < 1e-6 * whole ? whole : rate;
        }
        if (first < 0) first = frame;
    }
    return CODES_A_SECOND;
}

static void put_file(const Usd *usd)
{
    const ShvTracks *tracks = usd->tracks;
    FILE *stream = usd->stream;
    fputs("#usda 1.0\n(\n    defaultPrim = \"run\"\n    doc = ", stream);
    put_text(stream, shv_run_file_info(tracks->lines.pieces.file)->scene_name);
    shv_print(stream,
              "\n    metersPerUnit = 1\n    upAxis = \"Z\"\n    startTimeCode = %.15g\n    endTimeCode = %.15g\n"
              "    timeCodesPerSecond = %.15g\n    framesPerSecond = %.15g\n)\n\ndef Xform \"run\"\n{\n",
              tracks->times[0] * usd->rate, tracks->times[tracks->frame_count - 1] * usd->rate, usd->rate, usd->rate);
    for (int32_t body = 0; body < tracks->body_count; body++) put_body(usd, body);
    fputs("}\n", stream);
}

static ShvStatus write_usd(const ShvTracks *tracks, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    (void)options;
    (void)error;
    const Usd usd = {tracks, stream, find_rate(tracks->lines.pieces.file)};
    put_file(&usd);
    return SHV_OK;
}

ShvStatus shv_export_usd(ShvRunFile *file, const char *prefix, const ShvExportOptions *given, ShvError *error)
{
    return shv_tracks_export(file, prefix, ".usda", given, write_usd, error);
}
