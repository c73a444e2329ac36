/* What a page holds beside the frames: a JSON text, then arrays whose lengths it tells, in the order of these functions. */
#include <string.h>

#include "base/ledger_fields.h"
#include "base/memory.h"
#include "convex/hull.h"
#include "export/json.h"
#include "view/data.h"

static void add_counts(ShvJson *json, const ShvViewData *data)
{
    const ShvRunFileInfo *info = data->info;
    shv_json_text_member(json, "name", info->scene_name);
    shv_json_text_member(json, "status", info->status);
    shv_json_text_member(json, "message", info->message);
    shv_json_text_member(json, "version", info->code_version);
    shv_json_number_member(json, "frames", (double)data->frame_count);
    shv_json_number_member(json, "allFrames", (double)info->frame_count);
    shv_json_number_member(json, "lines", data->lines.count);
    shv_json_number_member(json, "faces", (double)data->face_count);
    shv_json_number_member(json, "fragments", info->fragment_count);
    shv_json_number_member(json, "events", (double)info->event_count);
    shv_json_number_member(json, "shapes", data->corners ? 1 : 0);
    shv_json_number_member(json, "hulls", data->hulls.count);
    shv_json_number_member(json, "reach", data->reach);
    shv_json_number_member(json, "stress", data->stress);
}

static void add_names(ShvJson *json, const ShvViewData *data, const ShvCostView *costs, int32_t cost_count)
{
    shv_json_key(json, "objects");
    shv_json_plain(json, "[");
    for (int32_t i = 0; i < data->info->object_count; i++) {
        if (i > 0) shv_json_plain(json, ",");
        shv_json_text(json, shv_run_file_object_name(data->file, i));
    }
    shv_json_plain(json, "]");
    shv_json_key(json, "costs");
    shv_json_plain(json, "[");
    for (int32_t i = 0; i < cost_count; i++) {
        if (i > 0) shv_json_plain(json, ",");
        shv_json_text(json, costs[i].name);
    }
    shv_json_plain(json, "]");
}

static void add_obstacles(ShvJson *json, const ShvViewData *data)
{
    static const char *const shapes[] = {"plane", "sphere", "box", "mesh"}, *const motions[] = {"fixed", "scripted",
                                                                                                "free"};
    shv_json_key(json, "obstacles");
    shv_json_plain(json, "[");
    for (int32_t i = 0; i < data->info->obstacle_count; i++) {
        const ShvObstacleMesh *mesh = &data->obstacles[i];
        shv_json_plain(json, i > 0 ? ",{" : "{");
        shv_json_text_member(json, "name", mesh->body.name);
        shv_json_text_member(json, "shape", shapes[mesh->body.shape]);
        shv_json_text_member(json, "motion", motions[mesh->body.motion]);
        shv_json_number_member(json, "nodes", mesh->node_count);
        shv_json_number_member(json, "triangles", mesh->triangle_count);
        shv_json_plain(json, "}");
    }
    shv_json_plain(json, "]");
}

/* Names of the events and of the ledger's members, so that the page knows neither's numbers. */
static void add_kinds(ShvJson *json)
{
    shv_json_key(json, "eventKinds");
    shv_json_plain(json, "[");
    for (int kind = SHV_RUN_WAKE; kind <= SHV_RUN_SQUEEZE; kind++) {
        if (kind > 0) shv_json_plain(json, ",");
        shv_json_text(json, shv_run_event_name((ShvRunEvent)kind));
    }
    shv_json_plain(json, "]");
    shv_json_key(json, "reasons");
    shv_json_plain(json, "[");
    for (int reason = SHV_REASON_NONE; reason <= SHV_REASON_LONGEST; reason++) {
        if (reason > 0) shv_json_plain(json, ",");
        shv_json_text(json, shv_switch_reason_name((ShvSwitchReason)reason));
    }
    shv_json_plain(json, "]");
    shv_json_key(json, "ledger");
#define NAME(member) "\"" #member "\","
#define NO_NAME(member)
    shv_json_plain(json, "[" SHV_LEDGER_FIELDS(NAME, NO_NAME) "\"time\"]");
#undef NAME
#undef NO_NAME
}

static ShvStatus put_json(ShvViewData *data, const ShvCostView *costs, int32_t cost_count, ShvError *error)
{
    ShvJson json = {.memory = data->memory};
    shv_json_plain(&json, "{");
    add_counts(&json, data);
    add_names(&json, data, costs, cost_count);
    add_obstacles(&json, data);
    add_kinds(&json);
    shv_json_plain(&json, "}");
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

static void put_double3(ShvPack *pack, const double *values)
{
    for (int c = 0; c < 3; c++) shv_pack_float(pack, values[c]);
}

/* Of a convex piece: its vertices, and its faces as numbers of them. */
static ShvStatus put_hull(ShvViewData *data, const double *vertices, int32_t count, ShvHullScratch *scratch,
                          ShvError *error)
{
    ShvHull hull;
    SHV_TRY(shv_hull_make(&hull, scratch, vertices, count, SHV_HULL_VERTICES, error));
    shv_pack_int(data->pack, hull.vertex_count);
    shv_pack_int(data->pack, hull.face_count);
    for (int32_t v = 0; v < hull.vertex_count; v++) put_double3(data->pack, vertices + 3 * hull.points[v]);
    for (int32_t f = 0; f < hull.face_count; f++)
        for (int k = 0; k < 3; k++) shv_pack_byte(data->pack, hull.faces[f][k]);
    return SHV_OK;
}

static ShvStatus put_hulls(ShvViewData *data, ShvError *error)
{
    ShvHullScratch scratch = {.memory = data->memory};
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < data->hulls.count && status == SHV_OK; i++) {
        const ShvConvexPieces *pieces = &data->hulls.items[i].pieces;
        shv_pack_int(data->pack, data->hulls.items[i].fragment);
        shv_pack_int(data->pack, pieces->count);
        for (int32_t p = 0; p < pieces->count && status == SHV_OK; p++) {
            const int32_t begin = pieces->vertex_begin[p], count = pieces->vertex_begin[p + 1] - begin;
            status = put_hull(data, pieces->vertices + 3 * (int64_t)begin, count, &scratch, error);
        }
    }
    shv_hull_scratch_release(&scratch);
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
    SHV_TRY(put_obstacles(data, error));
    return put_hulls(data, error);
}
