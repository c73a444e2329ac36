#include "view/data.h"

#include <math.h>

#include "base/memory.h"
#include "export/tet_stress.h"

/* A browser holds what a page unpacks in one block of memory, and the page's text in one string of at most 2^29 letters. */
static const double MOST_BYTES = 1.0e9;

/* ---- frames ---- */

/* Bytes that a frame has when it is unpacked: 26 a line and, with nodes, 20 a face. */
static double frame_bytes(const ShvViewData *data)
{
    return 26.0 * data->lines.count + (data->info->nodes ? 20.0 * (double)data->face_count : 0.0) +
           28.0 * data->info->obstacle_count;
}

static ShvStatus choose_frames(ShvViewData *data, int32_t every, ShvError *error)
{
    const int64_t count = data->info->frame_count;
    data->frame_count = (count + every - 1) / every;
    if ((count - 1) % every != 0) data->frame_count++;
    const double bytes = frame_bytes(data) * (double)data->frame_count;
    if (bytes > MOST_BYTES)
        return shv_fail(
            error, SHV_BAD_INPUT,
            "a page of these %lld frames would need %.3g GB in the browser; take every %d-th frame (--every)",
            (long long)data->frame_count, 1e-9 * bytes, (int)(ceil(bytes / MOST_BYTES) * every));
    data->frames = shv_allocate(data->memory, SHV_PART_RECORD, (size_t)data->frame_count, sizeof *data->frames);
    if (!data->frames) return shv_fail_memory(error, "frames", 8 * (size_t)data->frame_count);
    for (int64_t i = 0; i < data->frame_count; i++) data->frames[i] = i * every < count ? i * every : count - 1;
    return SHV_OK;
}

/* ---- mesh ---- */

/* Faces that have been damaged by the last frame: cracks that do not part a piece show them. */
static ShvStatus find_cracks(ShvViewData *data, uint8_t **cracks, ShvError *error)
{
    const size_t tets = (size_t)data->info->element_count;
    if (!data->info->nodes) return SHV_OK;
    data->corners = shv_allocate(data->memory, SHV_PART_RECORD, 12 * tets, sizeof(double));
    data->damage = shv_allocate(data->memory, SHV_PART_RECORD, 4 * tets, sizeof(double));
    *cracks = shv_allocate(data->memory, SHV_PART_RECORD, 4 * tets, 1);
    if (!data->corners || !data->damage || !*cracks) return shv_fail_memory(error, "the mesh", 132 * tets);
    SHV_TRY(shv_run_file_corners(data->file, data->info->frame_count - 1, NULL, data->damage, NULL, error));
    for (size_t i = 0; i < 4 * tets; i++) (*cracks)[i] = data->damage[i] > 0.0;
    return SHV_OK;
}

static ShvStatus read_mesh(ShvViewData *data, ShvError *error)
{
    uint8_t *cracks = NULL;
    ShvStatus status = find_cracks(data, &cracks, error);
    if (status == SHV_OK) status = shv_lines_create(&data->lines, data->file, data->memory, cracks, error);
    shv_release(cracks);
    SHV_TRY(status);
    data->face_count = data->lines.begin[data->lines.count];
    return shv_obstacle_meshes_create(&data->obstacles, &data->lines.pieces, data->memory, error);
}

/* ---- one frame ---- */

ShvStatus shv_view_data_move(ShvViewData *data, int64_t frame, ShvError *error)
{
    SHV_TRY(shv_lines_move(&data->lines, frame, error));
    SHV_TRY(shv_run_file_frame(data->file, frame, NULL, &data->mode, NULL, NULL, NULL, data->velocity, NULL, error));
    return data->corners ? shv_run_file_corners(data->file, frame, data->corners, data->damage, NULL, error) : SHV_OK;
}

bool shv_view_data_motion(const ShvViewData *data, int32_t line, double values[SHV_VIEW_RANGES])
{
    const ShvPose pose = shv_lines_pose(&data->lines, line);
    shv_store3(values, pose.position);
    for (int k = 0; k < 3; k++) values[3 + k] = data->velocity[3 * (int64_t)pose.fragment + k];
    return pose.lives;
}

ShvVec3 shv_view_data_displacement(const ShvViewData *data, int64_t face, int k, const ShvPose *pose)
{
    const int64_t tet = face / 4;
    const ShvVec3 seen = shv_load3(data->corners + 12 * tet + 3 * shv_face_corner(face, k));
    const ShvVec3 arm = shv_rotate(shv_quat_conjugate(pose->orientation), shv_sub(seen, pose->position));
    const ShvVec3 still = shv_sub(shv_lines_corner(&data->lines, face, k),
                                  shv_lines_centre(&data->lines, shv_lines_of(&data->lines, tet)));
    const ShvVec3 displacement = shv_sub(arm, still);
    return shv_finite3(displacement) ? displacement : shv_vec3(0.0, 0.0, 0.0);
}

double shv_view_data_stress(const ShvViewData *data, int64_t tet)
{
    if (!data->corners || !data->run->elasticity) return (double)NAN;
    const ShvPieces *pieces = &data->lines.pieces;
    const int32_t object = pieces->fragments[pieces->owner[tet]].object;
    double rest[12];
    for (int c = 0; c < 4; c++)
        shv_store3(rest + 3 * c, shv_load3(pieces->reference + 3 * (int64_t)pieces->elements[4 * tet + c]));
    return shv_tet_stress(rest, data->corners + 12 * tet, data->run->elasticity[object]);
}

/* ---- ranges ---- */

static void widen(double *low, double *high, double value)
{
    *low = isnan(*low) ? value : fmin(*low, value);
    *high = isnan(*high) ? value : fmax(*high, value);
}

static void widen_deformation(ShvViewData *data)
{
    int32_t line = 0;
    for (int64_t f = 0; f < data->face_count; f++) {
        while (f >= data->lines.begin[line + 1]) line++;
        const ShvPose pose = shv_lines_pose(&data->lines, line);
        const int64_t face = data->lines.face[f];
        for (int k = 0; k < 3 && pose.lives; k++) {
            const ShvVec3 d = shv_view_data_displacement(data, face, k, &pose);
            data->reach = fmax(data->reach, fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))));
        }
        const double stress = shv_view_data_stress(data, face / 4);
        if (stress > data->stress) data->stress = stress;
    }
}

static ShvStatus show_frames(ShvViewData *data, double *low, double *high, ShvError *error)
{
    for (int64_t i = 0; i < SHV_VIEW_RANGES * (int64_t)data->lines.count; i++) low[i] = high[i] = (double)NAN;
    for (int64_t i = 0; i < data->frame_count; i++) {
        SHV_TRY(shv_view_data_move(data, data->frames[i], error));
        for (int32_t line = 0; line < data->lines.count; line++) {
            double values[SHV_VIEW_RANGES];
            if (!shv_view_data_motion(data, line, values)) continue;
            for (int k = 0; k < SHV_VIEW_RANGES; k++) {
                const int64_t place = SHV_VIEW_RANGES * (int64_t)line + k;
                widen(&low[place], &high[place], values[k]);
            }
        }
        if (data->corners) widen_deformation(data);
    }
    return SHV_OK;
}

/* The step is rounded up to a float, so that 65535 steps reach the high end. */
static void set_ranges(ShvViewData *data, const double *low, const double *high)
{
    for (int64_t i = 0; i < SHV_VIEW_RANGES * (int64_t)data->lines.count; i++) {
        const bool known = isfinite(low[i]) && isfinite(high[i]);
        const float first = known ? (float)low[i] : 0.0F;
        const float start = known && (double)first > low[i] ? nextafterf(first, -INFINITY) : first;
        const float step = known ? nextafterf((float)((high[i] - (double)start) / 65535.0), INFINITY) : 0.0F;
        data->ranges[i] = (ShvViewRange){start, step};
    }
}

static ShvStatus find_ranges(ShvViewData *data, ShvError *error)
{
    const size_t count = SHV_VIEW_RANGES * (size_t)data->lines.count;
    data->velocity =
        shv_allocate(data->memory, SHV_PART_RECORD, 3 * (size_t)data->info->fragment_count, sizeof(double));
    data->ranges = shv_allocate(data->memory, SHV_PART_RECORD, count, sizeof *data->ranges);
    double *low = shv_allocate(data->memory, SHV_PART_RECORD, count, sizeof *low);
    double *high = shv_allocate(data->memory, SHV_PART_RECORD, count, sizeof *high);
    ShvStatus status = data->velocity && data->ranges && low && high ? show_frames(data, low, high, error)
                                                                     : shv_fail_memory(error, "ranges", 24 * count);
    if (status == SHV_OK) set_ranges(data, low, high);
    shv_release(low);
    shv_release(high);
    return status;
}

/* ---- making ---- */

static ShvStatus prepare(ShvViewData *data, const ShvViewOptions *options, ShvError *error)
{
    if (data->info->frame_count < 1)
        return shv_fail(error, SHV_BAD_INPUT, "the run '%s' has no frame to show", data->info->scene_name);
    SHV_TRY(read_mesh(data, error));
    SHV_TRY(choose_frames(data, options->every, error));
    if (data->run->convex) SHV_TRY(shv_hulls_create(&data->hulls, &data->lines, data->memory, error));
    return find_ranges(data, error);
}

ShvStatus shv_view_data_create(ShvViewData *data, const ShvViewRun *run, const ShvViewOptions *options, ShvError *error)
{
    *data =
        (ShvViewData){.run = run, .file = run->file, .info = shv_run_file_info(run->file), .memory = options->memory};
    const ShvStatus status = prepare(data, options, error);
    if (status != SHV_OK) shv_view_data_release(data);
    return status;
}

void shv_view_data_release(ShvViewData *data)
{
    if (!data->file) return;
    shv_obstacle_meshes_release(data->obstacles, data->info->obstacle_count);
    shv_hulls_release(&data->hulls);
    shv_lines_release(&data->lines);
    shv_release(data->frames);
    shv_release(data->velocity);
    shv_release(data->ranges);
    shv_release(data->corners);
    shv_release(data->damage);
    *data = (ShvViewData){.file = NULL};
}
