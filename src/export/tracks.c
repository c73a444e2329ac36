#include "export/tracks.h"

#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "export/colour.h"
#include "export/output.h"

/* ---- reading ---- */

static void put_pose(ShvTracks *tracks, int32_t body, int64_t frame, ShvVec3 position, ShvQuat q, bool there)
{
    float *pose = tracks->poses + SHV_TRACK_NUMBERS * (body * tracks->frame_count + frame);
    const float *last = frame > 0 ? pose - SHV_TRACK_NUMBERS : pose;
    if (!there) { /* where it was last */
        memcpy(pose, last, SHV_TRACK_NUMBERS * sizeof *pose);
        if (frame == 0) pose[6] = 1.0F;
        pose[7] = 0.0F;
        return;
    }
    const double sign = (double)last[3] * q.x + (double)last[4] * q.y + (double)last[5] * q.z + (double)last[6] * q.w;
    const double turn = sign < 0.0 ? -1.0 : 1.0;
    const double values[SHV_TRACK_NUMBERS] = {position.x, position.y, position.z, turn * q.x,
                                              turn * q.y, turn * q.z, turn * q.w, 1.0};
    for (int k = 0; k < SHV_TRACK_NUMBERS; k++) pose[k] = (float)values[k];
}

static ShvStatus read_frame(ShvTracks *tracks, int64_t frame, int64_t index, ShvObstacleView *views, ShvError *error)
{
    SHV_TRY(shv_lines_move(&tracks->lines, frame, error));
    for (int32_t line = 0; line < tracks->lines.count; line++) {
        const ShvPose pose = shv_lines_pose(&tracks->lines, line);
        put_pose(tracks, line, index, pose.position, pose.orientation, pose.lives);
    }
    if (tracks->body_count == tracks->lines.count) return SHV_OK;
    SHV_TRY(shv_run_file_obstacles(tracks->lines.pieces.file, frame, views, error));
    for (int32_t body = tracks->lines.count; body < tracks->body_count; body++) {
        const ShvObstacleView *view = &views[body - tracks->lines.count];
        const double *q = view->orientation;
        put_pose(tracks, body, index, shv_load3(view->position), (ShvQuat){q[0], q[1], q[2], q[3]}, true);
    }
    return SHV_OK;
}

static ShvStatus read_frames(ShvTracks *tracks, const ShvExportOptions *options, ShvObstacleView *views,
                             ShvError *error)
{
    ShvRunFile *file = tracks->lines.pieces.file;
    int64_t index = 0;
    for (int64_t frame = 0; frame < shv_run_file_info(file)->frame_count; frame++) {
        if (!shv_output_takes(options, file, frame)) continue;
        tracks->times[index] = shv_run_file_times(file)[frame];
        SHV_TRY(read_frame(tracks, frame, index++, views, error));
    }
    return SHV_OK;
}

static int64_t count_frames(const ShvRunFile *file, const ShvExportOptions *options)
{
    const int64_t all = shv_run_file_info(file)->frame_count;
    int64_t count = 0;
    for (int64_t frame = 0; frame < all; frame++) count += shv_output_takes(options, file, frame);
    return count;
}

static ShvStatus prepare(ShvTracks *tracks, const ShvExportOptions *options, ShvError *error)
{
    ShvRunFile *file = tracks->lines.pieces.file;
    const int32_t obstacles = shv_run_file_info(file)->obstacle_count;
    SHV_TRY(shv_obstacle_meshes_create(&tracks->obstacles, &tracks->lines.pieces, options->memory, error));
    tracks->body_count = tracks->lines.count + obstacles;
    tracks->frame_count = count_frames(file, options);
    if (tracks->body_count < 1) return shv_fail(error, SHV_BAD_INPUT, "the run has no body to export");
    if (tracks->frame_count < 1) return shv_fail(error, SHV_BAD_INPUT, "the run has no frame to export");
    const size_t poses = (size_t)tracks->frame_count * (size_t)tracks->body_count * SHV_TRACK_NUMBERS;
    tracks->times = shv_allocate(options->memory, SHV_PART_RECORD, (size_t)tracks->frame_count, sizeof(double));
    tracks->poses = shv_allocate(options->memory, SHV_PART_RECORD, poses, sizeof(float));
    ShvObstacleView *views = shv_allocate(options->memory, SHV_PART_RECORD, (size_t)obstacles, sizeof *views);
    const ShvStatus status = tracks->times && tracks->poses && views ? read_frames(tracks, options, views, error)
                                                                     : shv_fail_memory(error, "poses", 4 * poses);
    shv_release(views);
    return status;
}

ShvStatus shv_tracks_create(ShvTracks *tracks, ShvRunFile *file, const ShvExportOptions *options, ShvError *error)
{
    memset(tracks, 0, sizeof *tracks);
    SHV_TRY(shv_lines_create(&tracks->lines, file, options->memory, NULL, error));
    ShvStatus status = shv_vertices_create(&tracks->vertices, &tracks->lines, error);
    if (status == SHV_OK) status = prepare(tracks, options, error);
    if (status != SHV_OK) shv_tracks_release(tracks);
    return status;
}

void shv_tracks_release(ShvTracks *tracks)
{
    if (tracks->lines.pieces.file)
        shv_obstacle_meshes_release(tracks->obstacles, shv_run_file_info(tracks->lines.pieces.file)->obstacle_count);
    shv_vertices_release(&tracks->vertices);
    shv_lines_release(&tracks->lines);
    shv_release(tracks->times);
    shv_release(tracks->poses);
    memset(tracks, 0, sizeof *tracks);
}

/* ---- asking ---- */

const float *shv_tracks_pose(const ShvTracks *tracks, int32_t body, int64_t frame)
{
    return tracks->poses + SHV_TRACK_NUMBERS * (body * tracks->frame_count + frame);
}

bool shv_tracks_vanishes(const ShvTracks *tracks, int32_t body)
{
    for (int64_t frame = 0; frame < tracks->frame_count; frame++)
        if (shv_tracks_pose(tracks, body, frame)[7] < 0.5F) return true;
    return false;
}

bool shv_tracks_moves(const ShvTracks *tracks, int32_t body)
{
    const float *first = shv_tracks_pose(tracks, body, 0);
    for (int64_t frame = 1; frame < tracks->frame_count; frame++)
        if (memcmp(first, shv_tracks_pose(tracks, body, frame), SHV_TRACK_NUMBERS * sizeof *first) != 0) return true;
    return false;
}

/* NULL: a line of descent. */
static const ShvObstacleMesh *obstacle_of(const ShvTracks *tracks, int32_t body)
{
    return body < tracks->lines.count ? NULL : &tracks->obstacles[body - tracks->lines.count];
}

int64_t shv_tracks_vertex_count(const ShvTracks *tracks, int32_t body)
{
    const ShvObstacleMesh *mesh = obstacle_of(tracks, body);
    return mesh ? mesh->node_count : shv_vertices_count(&tracks->vertices, body);
}

ShvVec3 shv_tracks_vertex(const ShvTracks *tracks, int32_t body, int64_t vertex)
{
    const ShvObstacleMesh *mesh = obstacle_of(tracks, body);
    return mesh ? shv_load3(mesh->positions + 3 * vertex)
                : shv_vertices_place(&tracks->vertices, &tracks->lines, body, vertex);
}

int64_t shv_tracks_triangle_count(const ShvTracks *tracks, int32_t body)
{
    const ShvObstacleMesh *mesh = obstacle_of(tracks, body);
    return mesh ? mesh->triangle_count : tracks->lines.begin[body + 1] - tracks->lines.begin[body];
}

const int32_t *shv_tracks_triangles(const ShvTracks *tracks, int32_t body)
{
    const ShvObstacleMesh *mesh = obstacle_of(tracks, body);
    return mesh ? mesh->triangles : tracks->vertices.corners + 3 * tracks->lines.begin[body];
}

ShvVec3 shv_tracks_normal(const ShvTracks *tracks, int32_t body, int64_t triangle)
{
    const int32_t *corners = shv_tracks_triangles(tracks, body) + 3 * triangle;
    const ShvVec3 a = shv_tracks_vertex(tracks, body, corners[0]);
    const ShvVec3 normal = shv_cross(shv_sub(shv_tracks_vertex(tracks, body, corners[1]), a),
                                     shv_sub(shv_tracks_vertex(tracks, body, corners[2]), a));
    return shv_norm(normal) > 0.0 ? shv_unit(normal) : shv_vec3(0.0, 0.0, 1.0);
}

void shv_tracks_colour(const ShvTracks *tracks, int32_t body, double colour[3])
{
    const ShvLines *lines = &tracks->lines;
    const uint32_t value =
        body < lines->count ? shv_line_colour(lines->pieces.lineage[lines->leaf[body]]) : SHV_OBSTACLE_COLOUR;
    for (int k = 0; k < 3; k++) colour[k] = (value >> (16 - 8 * k) & 255u) / 255.0;
}

void shv_tracks_name(const ShvTracks *tracks, int32_t body, char name[32])
{
    const ShvLines *lines = &tracks->lines;
    if (body < lines->count)
        shv_format(name, 32, "line_%d", (int)lines->pieces.lineage[lines->leaf[body]]);
    else
        shv_format(name, 32, "obstacle_%d", (int)(body - lines->count));
}

ShvStatus shv_tracks_export(ShvRunFile *file, const char *prefix, const char *suffix, const ShvExportOptions *given,
                            ShvTracksWriter write, ShvError *error)
{
    ShvExportOptions options;
    ShvTracks tracks;
    ShvOutput output;
    SHV_TRY(shv_export_options(given, &options, error));
    SHV_TRY(shv_output_check(&options, prefix, &suffix, 1, error));
    SHV_TRY(shv_tracks_create(&tracks, file, &options, error));
    ShvStatus status = shv_output_open(&output, &options, prefix, suffix, error);
    if (status == SHV_OK) {
        status = write(&tracks, &options, output.stream, error);
        status = shv_output_close(&output, &options, status, error);
    }
    shv_tracks_release(&tracks);
    return status;
}
