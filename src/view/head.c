/* What a page holds beside the frames: a JSON text, then arrays whose lengths it tells, in the order of these functions. */
#include <math.h>
#include <string.h>

#include "base/ledger_fields.h"
#include "base/memory.h"
#include "base/text.h"
#include "export/output.h"
#include "view/data.h"

/* ---- JSON ---- */

/* The text grows as it is written: its length stands before it. */
typedef struct Json {
    struct ShvMemory *memory;
    char *text;
    size_t length, room;
    bool failed;
} Json;

static void add(Json *json, const char *part, size_t length)
{
    if (json->failed) return;
    if (json->length + length + 1 > json->room) {
        const size_t room = 2 * (json->length + length) + 4096;
        char *text = shv_reallocate(json->memory, SHV_PART_RECORD, json->text, room, 1);
        json->failed = !text;
        if (!text) return;
        json->text = text;
        json->room = room;
    }
    memcpy(json->text + json->length, part, length);
    json->length += length;
}

static void add_plain(Json *json, const char *part)
{
    add(json, part, strlen(part));
}

static void add_text(Json *json, const char *text)
{
    add_plain(json, "\"");
    for (; *text; text++) {
        char escape[8];
        const unsigned char c = (unsigned char)*text;
        if (c < 0x20 || c == '"' || c == '\\' || c == '<')
            add(json, escape, (size_t)shv_format(escape, sizeof escape, "\\u%04x", c));
        else
            add(json, text, 1);
    }
    add_plain(json, "\"");
}

static void add_number(Json *json, double value)
{
    char number[SHV_OUTPUT_NUMBER] = "null";
    if (isfinite(value)) shv_output_format(number, value);
    add_plain(json, number);
}

/* A member and the comma before it. */
static void add_key(Json *json, const char *key)
{
    if (json->text && json->length > 0 && json->text[json->length - 1] != '{') add_plain(json, ",");
    add_text(json, key);
    add_plain(json, ":");
}

static void add_text_member(Json *json, const char *key, const char *text)
{
    add_key(json, key);
    add_text(json, text);
}

static void add_number_member(Json *json, const char *key, double value)
{
    add_key(json, key);
    add_number(json, value);
}

/* ---- members ---- */

static void add_counts(Json *json, const ShvViewData *data)
{
    const ShvRunFileInfo *info = data->info;
    add_text_member(json, "name", info->scene_name);
    add_text_member(json, "status", info->status);
    add_text_member(json, "message", info->message);
    add_text_member(json, "version", info->code_version);
    add_number_member(json, "frames", (double)data->frame_count);
    add_number_member(json, "allFrames", (double)info->frame_count);
    add_number_member(json, "lines", data->lines.count);
    add_number_member(json, "faces", (double)data->face_count);
    add_number_member(json, "fragments", info->fragment_count);
    add_number_member(json, "events", (double)info->event_count);
    add_number_member(json, "shapes", data->corners ? 1 : 0);
    add_number_member(json, "reach", data->reach);
    add_number_member(json, "stress", data->stress);
}

static void add_names(Json *json, const ShvViewData *data, const ShvCostView *costs, int32_t cost_count)
{
    add_key(json, "objects");
    add_plain(json, "[");
    for (int32_t i = 0; i < data->info->object_count; i++) {
        if (i > 0) add_plain(json, ",");
        add_text(json, shv_run_file_object_name(data->file, i));
    }
    add_plain(json, "]");
    add_key(json, "costs");
    add_plain(json, "[");
    for (int32_t i = 0; i < cost_count; i++) {
        if (i > 0) add_plain(json, ",");
        add_text(json, costs[i].name);
    }
    add_plain(json, "]");
}

static void add_obstacles(Json *json, const ShvViewData *data)
{
    static const char *const shapes[] = {"plane", "sphere", "box", "mesh"}, *const motions[] = {"fixed", "scripted",
                                                                                                "free"};
    add_key(json, "obstacles");
    add_plain(json, "[");
    for (int32_t i = 0; i < data->info->obstacle_count; i++) {
        const ShvObstacleMesh *mesh = &data->obstacles[i];
        add_plain(json, i > 0 ? ",{" : "{");
        add_text_member(json, "name", mesh->body.name);
        add_text_member(json, "shape", shapes[mesh->body.shape]);
        add_text_member(json, "motion", motions[mesh->body.motion]);
        add_number_member(json, "nodes", mesh->node_count);
        add_number_member(json, "triangles", mesh->triangle_count);
        add_plain(json, "}");
    }
    add_plain(json, "]");
}

/* Names of the events and of the ledger's members, so that the page knows neither's numbers. */
static void add_kinds(Json *json)
{
    add_key(json, "eventKinds");
    add_plain(json, "[");
    for (int kind = SHV_RUN_WAKE; kind <= SHV_RUN_SQUEEZE; kind++) {
        if (kind > 0) add_plain(json, ",");
        add_text(json, shv_run_event_name((ShvRunEvent)kind));
    }
    add_plain(json, "]");
    add_key(json, "reasons");
    add_plain(json, "[");
    for (int reason = SHV_REASON_NONE; reason <= SHV_REASON_LONGEST; reason++) {
        if (reason > 0) add_plain(json, ",");
        add_text(json, shv_switch_reason_name((ShvSwitchReason)reason));
    }
    add_plain(json, "]");
    add_key(json, "ledger");
#define NAME(member) "\"" #member "\","
#define NO_NAME(member)
    add_plain(json, "[" SHV_LEDGER_FIELDS(NAME, NO_NAME) "\"time\"]");
#undef NAME
#undef NO_NAME
}

static ShvStatus put_json(ShvViewData *data, const ShvCostView *costs, int32_t cost_count, ShvError *error)
{
    Json json = {.memory = data->memory};
    add_plain(&json, "{");
    add_counts(&json, data);
    add_names(&json, data, costs, cost_count);
    add_obstacles(&json, data);
    add_kinds(&json);
    add_plain(&json, "}");
    if (!json.failed) {
        shv_pack_int(data->pack, (int32_t)json.length);
        shv_pack_bytes(data->pack, json.text, json.length);
    }
    shv_release(json.text);
    return json.failed ? shv_fail_memory(error, "names", json.length) : SHV_OK;
}

/* ---- arrays ---- */

static ShvStatus put_curves(ShvViewData *data, int32_t cost_count, double *costs, ShvError *error)
{
    for (int64_t i = 0; i < data->frame_count; i++) {
        const int64_t frame = data->frames[i];
        ShvLedgerView ledger;
        ShvProgressView progress;
        double wall;
        int32_t mode;
        SHV_TRY(shv_run_file_ledger(data->file, frame, &ledger, error));
        SHV_TRY(shv_run_file_progress(data->file, frame, &progress, error));
        SHV_TRY(shv_run_file_cost_at(data->file, frame, &wall, costs, error));
        SHV_TRY(shv_run_file_frame(data->file, frame, NULL, &mode, NULL, NULL, NULL, NULL, NULL, error));
        const double row[] = {shv_run_file_times(data->file)[frame],
                              (double)frame,
                              mode,
                              progress.alive,
                              progress.inserted,
                              progress.failed,
                              wall};
        for (size_t k = 0; k < sizeof row / sizeof row[0]; k++) shv_pack_double(data->pack, row[k]);
#define PUT(member) shv_pack_double(data->pack, ledger.member);
#define PUT_NOT(member)
        SHV_LEDGER_FIELDS(PUT, PUT_NOT)
#undef PUT
#undef PUT_NOT
        shv_pack_double(data->pack, ledger.time);
        for (int32_t k = 0; k < cost_count; k++) shv_pack_double(data->pack, costs[k]);
    }
    return SHV_OK;
}

static void put_fragments(ShvViewData *data)
{
    for (int32_t i = 0; i < data->info->fragment_count; i++) {
        const ShvFragmentView *fragment = &data->lines.pieces.fragments[i];
        const double row[] = {fragment->parent,
                              data->lines.pieces.lineage[i],
                              fragment->object,
                              fragment->tets,
                              fragment->birth,
                              fragment->death,
                              fragment->mass,
                              fragment->volume,
                              fragment->reference_centre[0],
                              fragment->reference_centre[1],
                              fragment->reference_centre[2]};
        for (size_t k = 0; k < sizeof row / sizeof row[0]; k++) shv_pack_double(data->pack, row[k]);
    }
}

static ShvStatus put_events(ShvViewData *data, ShvError *error)
{
    for (int64_t i = 0; i < data->info->event_count; i++) {
        ShvEventView event;
        SHV_TRY(shv_run_file_event(data->file, i, &event, error));
        const double row[] = {event.time,     (double)event.kind,   event.fragment,
                              event.obstacle, (double)event.reason, event.value};
        for (size_t k = 0; k < sizeof row / sizeof row[0]; k++) shv_pack_double(data->pack, row[k]);
    }
    return SHV_OK;
}

static void put_lines(ShvViewData *data)
{
    const ShvLines *lines = &data->lines;
    for (int32_t line = 0; line < lines->count; line++) shv_pack_int(data->pack, lines->leaf[line]);
    for (int32_t line = 0; line <= lines->count; line++) shv_pack_int(data->pack, (int32_t)lines->begin[line]);
    for (int64_t i = 0; i < SHV_VIEW_RANGES * (int64_t)lines->count; i++) {
        shv_pack_float(data->pack, (double)data->ranges[i].low);
        shv_pack_float(data->pack, (double)data->ranges[i].step);
    }
    for (int64_t f = 0; f < data->face_count; f++) {
        const int32_t other = lines->neighbour[lines->face[f]];
        shv_pack_int(data->pack, other < 0 ? -1 : shv_lines_of(lines, other));
    }
    for (int64_t f = 0; f < data->face_count; f++) {
        const ShvVec3 centre = shv_lines_centre(lines, shv_lines_of(lines, lines->face[f] / 4));
        for (int k = 0; k < 3; k++) {
            const ShvVec3 corner = shv_sub(shv_lines_corner(lines, lines->face[f], k), centre);
            shv_pack_float(data->pack, corner.x);
            shv_pack_float(data->pack, corner.y);
            shv_pack_float(data->pack, corner.z);
        }
    }
}

static ShvStatus put_obstacles(ShvViewData *data, ShvError *error)
{
    const int32_t count = data->info->obstacle_count;
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacleMesh *mesh = &data->obstacles[i];
        for (int64_t k = 0; k < 3 * (int64_t)mesh->node_count; k++) shv_pack_float(data->pack, mesh->positions[k]);
        for (int64_t k = 0; k < 3 * (int64_t)mesh->triangle_count; k++) shv_pack_int(data->pack, mesh->triangles[k]);
    }
    ShvObstacleView *views = shv_allocate(data->memory, SHV_PART_RECORD, (size_t)count, sizeof *views);
    if (!views) return shv_fail_memory(error, "obstacles", (size_t)count * sizeof *views);
    ShvStatus status = SHV_OK;
    for (int64_t i = 0; i < data->frame_count && status == SHV_OK && count > 0; i++) {
        status = shv_run_file_obstacles(data->file, data->frames[i], views, error);
        for (int32_t k = 0; k < count && status == SHV_OK; k++) {
            for (int c = 0; c < 3; c++) shv_pack_float(data->pack, views[k].position[c]);
            for (int c = 1; c <= 4; c++) shv_pack_float(data->pack, views[k].orientation[c % 4]);
        }
    }
    shv_release(views);
    return status;
}

ShvStatus shv_view_put_head(ShvViewData *data, ShvError *error)
{
    const ShvCostView *costs;
    const ShvBytesView *bytes;
    int32_t cost_count, bytes_count;
    SHV_TRY(shv_run_file_cost(data->file, &costs, &cost_count, &bytes, &bytes_count, error));
    SHV_TRY(put_json(data, costs, cost_count, error));
    double *seconds = shv_allocate(data->memory, SHV_PART_RECORD, (size_t)cost_count, sizeof *seconds);
    ShvStatus status = seconds ? put_curves(data, cost_count, seconds, error)
                               : shv_fail_memory(error, "costs", 8 * (size_t)cost_count);
    shv_release(seconds);
    SHV_TRY(status);
    put_fragments(data);
    SHV_TRY(put_events(data, error));
    put_lines(data);
    return put_obstacles(data, error);
}
