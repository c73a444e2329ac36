/* glTF 2.0 in one binary file: a JSON chunk and a chunk of numbers. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/json.h"
#include "export/output.h"
#include "export/tracks.h"

enum { UNSIGNED_INT = 5125, FLOAT = 5126, HEAD = 12, CHUNK_HEAD = 8 };
static const uint32_t MAGIC = 0x46546c67, VERSION = 2, JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942;

/* Accessors one after another: each has a view of its own of the chunk of numbers. */
typedef struct Gltf {
    const ShvTracks *tracks;
    ShvJson json, views, accessors, channels, samplers;
    int32_t accessor_count, sampler_count;
    uint64_t bytes; /* of numbers so far */
} Gltf;

/* ---- accessors ---- */

/* `components` of `type` of each of `count` elements, 1, 3 or 4; low and high may be NULL. */
static int32_t add_accessor(Gltf *gltf, int type, int64_t count, int components, const double *low, const double *high)
{
    static const char *const kinds[] = {"", "SCALAR", "", "VEC3", "VEC4"};
    ShvJson *view = &gltf->views, *accessor = &gltf->accessors;
    const uint64_t bytes = 4 * (uint64_t)components * (uint64_t)count;
    shv_json_plain(view, gltf->accessor_count > 0 ? ",{" : "{");
    shv_json_number_member(view, "buffer", 0);
    shv_json_number_member(view, "byteOffset", (double)gltf->bytes);
    shv_json_number_member(view, "byteLength", (double)bytes);
    shv_json_plain(view, "}");
    shv_json_plain(accessor, gltf->accessor_count > 0 ? ",{" : "{");
    shv_json_number_member(accessor, "bufferView", gltf->accessor_count);
    shv_json_number_member(accessor, "componentType", type);
    shv_json_number_member(accessor, "count", (double)count);
    shv_json_text_member(accessor, "type", kinds[components]);
    if (low) {
        shv_json_key(accessor, "min");
        shv_json_numbers(accessor, low, components);
        shv_json_key(accessor, "max");
        shv_json_numbers(accessor, high, components);
    }
    shv_json_plain(accessor, "}");
    gltf->bytes += bytes;
    return gltf->accessor_count++;
}

/* A body's vertices and the triangles that share them; returns the first of the two accessors. Without normals every program is
   to shade flat (glTF 2.0, 3.7.2.1), as faces of tets are. */
static int32_t add_shape(Gltf *gltf, int32_t body)
{
    const ShvTracks *tracks = gltf->tracks;
    const int64_t count = shv_tracks_vertex_count(tracks, body);
    double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
    for (int64_t i = 0; i < count; i++) {
        const ShvVec3 vertex = shv_tracks_vertex(tracks, body, i);
        const double x[3] = {vertex.x, vertex.y, vertex.z};
        for (int k = 0; k < 3; k++) {
            const double value = (double)(float)x[k];
            low[k] = i == 0 ? value : fmin(low[k], value);
            high[k] = i == 0 ? value : fmax(high[k], value);
        }
    }
    const int32_t first = add_accessor(gltf, FLOAT, count, 3, low, high);
    add_accessor(gltf, UNSIGNED_INT, 3 * shv_tracks_triangle_count(tracks, body), 1, NULL, NULL);
    return first;
}

/* ---- nodes ---- */

static void add_extras(Gltf *gltf, int32_t body)
{
    const ShvLines *lines = &gltf->tracks->lines;
    ShvJson *json = &gltf->json;
    shv_json_key(json, "extras");
    shv_json_plain(json, "{");
    if (body < lines->count) {
        const ShvFragmentView *fragment = &lines->pieces.fragments[lines->leaf[body]];
        shv_json_number_member(json, "line", lines->pieces.lineage[fragment->id]);
        shv_json_number_member(json, "fragment", fragment->id);
        shv_json_number_member(json, "parent", fragment->parent);
        shv_json_number_member(json, "birth", fragment->birth);
        shv_json_number_member(json, "mass", fragment->mass);
        shv_json_number_member(json, "volume", fragment->volume);
        shv_json_text_member(json, "object", shv_run_file_object_name(lines->pieces.file, fragment->object));
    } else {
        const ShvObstacleBody *obstacle = &gltf->tracks->obstacles[body - lines->count].body;
        shv_json_text_member(json, "obstacle", obstacle->name);
    }
    shv_json_plain(json, "}");
}

static void add_node(Gltf *gltf, int32_t body)
{
    ShvJson *json = &gltf->json;
    char name[32];
    double pose[7];
    for (int k = 0; k < 7; k++) pose[k] = (double)shv_tracks_pose(gltf->tracks, body, 0)[k];
    shv_tracks_name(gltf->tracks, body, name);
    shv_json_plain(json, ",{");
    shv_json_text_member(json, "name", name);
    shv_json_number_member(json, "mesh", body);
    shv_json_key(json, "translation");
    shv_json_numbers(json, pose, 3);
    shv_json_key(json, "rotation");
    shv_json_numbers(json, pose + 3, 4);
    add_extras(gltf, body);
    shv_json_plain(json, "}");
}

/* The root turns z up into glTF's y up; every body is its child. */
static void add_nodes(Gltf *gltf)
{
    ShvJson *json = &gltf->json;
    const double quarter[4] = {-sqrt(0.5), 0.0, 0.0, sqrt(0.5)};
    shv_json_key(json, "nodes");
    shv_json_plain(json, "[{");
    shv_json_text_member(json, "name", "z_up");
    shv_json_key(json, "rotation");
    shv_json_numbers(json, quarter, 4);
    shv_json_key(json, "children");
    for (int32_t body = 0; body < gltf->tracks->body_count; body++) {
        shv_json_plain(json, body > 0 ? "," : "[");
        shv_json_number(json, body + 1);
    }
    shv_json_plain(json, "]}");
    for (int32_t body = 0; body < gltf->tracks->body_count; body++) add_node(gltf, body);
    shv_json_plain(json, "]");
}

static void add_meshes(Gltf *gltf, const int32_t *shapes)
{
    ShvJson *json = &gltf->json;
    shv_json_key(json, "meshes");
    for (int32_t body = 0; body < gltf->tracks->body_count; body++) {
        shv_json_plain(json, body > 0 ? ",{" : "[{");
        shv_json_key(json, "primitives");
        shv_json_plain(json, "[{\"attributes\":{");
        shv_json_number_member(json, "POSITION", shapes[body]);
        shv_json_plain(json, "}");
        shv_json_number_member(json, "indices", shapes[body] + 1);
        shv_json_number_member(json, "material", body);
        shv_json_plain(json, "}]}");
    }
    shv_json_plain(json, "]");
    shv_json_key(json, "materials");
    for (int32_t body = 0; body < gltf->tracks->body_count; body++) {
        double colour[4] = {0.0, 0.0, 0.0, 1.0};
        shv_tracks_colour(gltf->tracks, body, colour);
        for (int k = 0; k < 3; k++) colour[k] = pow(colour[k], 2.2); /* glTF wants linear light */
        shv_json_plain(json, body > 0 ? ",{" : "[{");
        shv_json_key(json, "pbrMetallicRoughness");
        shv_json_plain(json, "{");
        shv_json_key(json, "baseColorFactor");
        shv_json_numbers(json, colour, 4);
        shv_json_plain(json, ",\"metallicFactor\":0,\"roughnessFactor\":0.9}}");
    }
    shv_json_plain(json, "]");
}

/* ---- animation ---- */

static void add_channel(Gltf *gltf, int32_t body, const char *path, const char *interpolation, int32_t output)
{
    ShvJson *sampler = &gltf->samplers, *channel = &gltf->channels;
    shv_json_plain(sampler, gltf->sampler_count > 0 ? ",{" : "{");
    shv_json_number_member(sampler, "input", 0);
    shv_json_number_member(sampler, "output", output);
    shv_json_text_member(sampler, "interpolation", interpolation);
    shv_json_plain(sampler, "}");
    shv_json_plain(channel, gltf->sampler_count > 0 ? ",{" : "{");
    shv_json_number_member(channel, "sampler", gltf->sampler_count++);
    shv_json_key(channel, "target");
    shv_json_plain(channel, "{");
    shv_json_number_member(channel, "node", body + 1);
    shv_json_text_member(channel, "path", path);
    shv_json_plain(channel, "}}");
}

/* In the order in which put_tracks writes them. */
static void add_tracks(Gltf *gltf)
{
    const ShvTracks *tracks = gltf->tracks;
    for (int32_t body = 0; body < tracks->body_count; body++) {
        if (!shv_tracks_moves(tracks, body)) continue;
        add_channel(gltf, body, "translation", "LINEAR", add_accessor(gltf, FLOAT, tracks->frame_count, 3, NULL, NULL));
        add_channel(gltf, body, "rotation", "LINEAR", add_accessor(gltf, FLOAT, tracks->frame_count, 4, NULL, NULL));
        if (shv_tracks_vanishes(tracks, body))
            add_channel(gltf, body, "scale", "STEP", add_accessor(gltf, FLOAT, tracks->frame_count, 3, NULL, NULL));
    }
}

static void add_list(ShvJson *json, const char *key, const ShvJson *list)
{
    shv_json_key(json, key);
    shv_json_plain(json, "[");
    if (list->text) shv_json_plain(json, list->text);
    shv_json_plain(json, "]");
    json->failed = json->failed || list->failed;
}

static void make_json(Gltf *gltf, int32_t *shapes)
{
    const ShvTracks *tracks = gltf->tracks;
    const ShvRunFileInfo *info = shv_run_file_info(tracks->lines.pieces.file);
    ShvJson *json = &gltf->json;
    add_accessor(gltf, FLOAT, tracks->frame_count, 1, (double[1]){(double)(float)tracks->times[0]},
                 (double[1]){(double)(float)tracks->times[tracks->frame_count - 1]});
    for (int32_t body = 0; body < tracks->body_count; body++) shapes[body] = add_shape(gltf, body);
    add_tracks(gltf);
    shv_json_plain(json, "{\"asset\":{\"version\":\"2.0\"");
    shv_json_text_member(json, "generator", "shiver " SHIVER_VERSION);
    shv_json_plain(json, "},\"scene\":0,\"scenes\":[{\"nodes\":[0]");
    shv_json_text_member(json, "name", info->scene_name);
    shv_json_plain(json, "}]");
    add_nodes(gltf);
    add_meshes(gltf, shapes);
    if (gltf->sampler_count > 0) {
        shv_json_key(json, "animations");
        shv_json_plain(json, "[{");
        shv_json_text_member(json, "name", "run");
        add_list(json, "channels", &gltf->channels);
        add_list(json, "samplers", &gltf->samplers);
        shv_json_plain(json, "}]");
    }
    add_list(json, "accessors", &gltf->accessors);
    add_list(json, "bufferViews", &gltf->views);
    shv_json_plain(json, ",\"buffers\":[{");
    shv_json_number_member(json, "byteLength", (double)gltf->bytes);
    shv_json_plain(json, "}]}");
    while (json->length % 4 != 0 && !json->failed) shv_json_plain(json, " ");
}

/* ---- numbers ---- */

static void put_int(FILE *stream, uint32_t value)
{
    for (int i = 0; i < 4; i++) putc((int)(value >> 8 * i & 255u), stream);
}

static void put_float(FILE *stream, double value)
{
    const float single = (float)value;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    put_int(stream, bits);
}

static void put_vector(FILE *stream, ShvVec3 vector)
{
    put_float(stream, vector.x);
    put_float(stream, vector.y);
    put_float(stream, vector.z);
}

static void put_shapes(const ShvTracks *tracks, FILE *stream)
{
    for (int32_t body = 0; body < tracks->body_count; body++) {
        const int64_t vertices = shv_tracks_vertex_count(tracks, body);
        const int64_t corners = 3 * shv_tracks_triangle_count(tracks, body);
        const int32_t *triangles = shv_tracks_triangles(tracks, body);
        for (int64_t i = 0; i < vertices; i++) put_vector(stream, shv_tracks_vertex(tracks, body, i));
        for (int64_t i = 0; i < corners; i++) put_int(stream, (uint32_t)triangles[i]);
    }
}

static void put_tracks(const ShvTracks *tracks, FILE *stream)
{
    for (int32_t body = 0; body < tracks->body_count; body++) {
        const bool vanishes = shv_tracks_vanishes(tracks, body);
        for (int part = 0; part < (vanishes ? 3 : 2) && shv_tracks_moves(tracks, body); part++)
            for (int64_t frame = 0; frame < tracks->frame_count; frame++) {
                const float *pose = shv_tracks_pose(tracks, body, frame);
                for (int k = 0; k < (part == 1 ? 4 : 3); k++)
                    put_float(stream, (double)(part == 2 ? pose[7] : pose[3 * part + k]));
            }
    }
}

static ShvStatus put_file(const Gltf *gltf, FILE *stream, ShvError *error)
{
    const ShvTracks *tracks = gltf->tracks;
    const uint64_t bytes = HEAD + CHUNK_HEAD + gltf->json.length + CHUNK_HEAD + gltf->bytes;
    if (gltf->json.failed) return shv_fail_memory(error, "the glTF file's text", gltf->json.length);
    if (bytes > UINT32_MAX)
        return shv_fail(error, SHV_UNSUPPORTED,
                        "a .glb file holds at most 4 GB and this run would need %.3g; take fewer frames (--animation)",
                        1e-9 * (double)bytes);
    const uint32_t head[] = {MAGIC, VERSION, (uint32_t)bytes, (uint32_t)gltf->json.length, JSON_CHUNK};
    for (size_t i = 0; i < sizeof head / sizeof head[0]; i++) put_int(stream, head[i]);
    fwrite(gltf->json.text, 1, gltf->json.length, stream);
    put_int(stream, (uint32_t)gltf->bytes);
    put_int(stream, BINARY_CHUNK);
    for (int64_t frame = 0; frame < tracks->frame_count; frame++) put_float(stream, tracks->times[frame]);
    put_shapes(tracks, stream);
    put_tracks(tracks, stream);
    return SHV_OK;
}

static ShvStatus write_gltf(const ShvTracks *tracks, const ShvExportOptions *options, FILE *stream, ShvError *error)
{
    struct ShvMemory *memory = options->memory;
    const ShvJson empty = {.memory = memory};
    Gltf gltf = {
        .tracks = tracks, .json = empty, .views = empty, .accessors = empty, .channels = empty, .samplers = empty};
    int32_t *shapes = shv_allocate(memory, SHV_PART_RECORD, (size_t)tracks->body_count, sizeof *shapes);
    if (!shapes) return shv_fail_memory(error, "bodies", 4 * (size_t)tracks->body_count);
    make_json(&gltf, shapes);
    const ShvStatus status = put_file(&gltf, stream, error);
    shv_release(shapes);
    shv_release(gltf.json.text);
    shv_release(gltf.views.text);
    shv_release(gltf.accessors.text);
    shv_release(gltf.channels.text);
    shv_release(gltf.samplers.text);
    return status;
}

ShvStatus shv_export_gltf(ShvRunFile *file, const char *prefix, const ShvExportOptions *given, ShvError *error)
{
    return shv_tracks_export(file, prefix, ".glb", given, write_gltf, error);
}
