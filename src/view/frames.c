/* The frames of a run: differences from one frame to the next of numbers of 16 and 8 bits, which deflate well. */
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "view/data.h"

/* Of a line: position, orientation (x, y, z, w) and velocity. */
enum { NUMBERS = 10, FACE_NUMBERS = 9, HALF = 32767 };

/* Numbers of a frame and of the one before. */
typedef struct Frame {
    uint16_t *motion, *last_motion; /* by number, then by line */
    uint16_t *shape, *last_shape;   /* by number, then by face: displacements of its corners */
    uint8_t *bytes, *last_bytes;    /* by line: fracture mode; by face: damage, stress */
    int32_t *carrier, *last_carrier;
    double *quaternion; /* 4 × lines: the last ones, for the sign */
    uint8_t *awake;     /* of each fragment: 0 in flight, 1 in fracture mode, 2 as its parent */
    unsigned char *scratch;
    int64_t event; /* the next to be looked at */
} Frame;

static ShvStatus create(const ShvViewData *data, Frame *frame, ShvError *error)
{
    const size_t lines = (size_t)data->lines.count, faces = data->corners ? (size_t)data->face_count : 0,
                 fragments = (size_t)data->info->fragment_count;
    struct ShvMemory *memory = data->memory;
    frame->motion = shv_allocate(memory, SHV_PART_RECORD, 2 * NUMBERS * lines, sizeof(uint16_t));
    frame->shape = shv_allocate(memory, SHV_PART_RECORD, 2 * FACE_NUMBERS * faces, sizeof(uint16_t));
    frame->bytes = shv_allocate(memory, SHV_PART_RECORD, 2 * (lines + 2 * faces), 1);
    frame->carrier = shv_allocate(memory, SHV_PART_RECORD, 2 * lines, sizeof(int32_t));
    frame->quaternion = shv_allocate(memory, SHV_PART_RECORD, 4 * lines, sizeof(double));
    frame->awake = shv_allocate(memory, SHV_PART_RECORD, fragments, 1);
    frame->scratch = shv_allocate(memory, SHV_PART_RECORD, 2 * (NUMBERS * lines + FACE_NUMBERS * faces), 1);
    if (!frame->motion || !frame->shape || !frame->bytes || !frame->carrier || !frame->quaternion || !frame->awake ||
        !frame->scratch)
        return shv_fail_memory(error, "a frame", 100 * lines + 60 * faces);
    frame->last_motion = frame->motion + NUMBERS * lines;
    frame->last_shape = frame->shape + FACE_NUMBERS * faces;
    frame->last_bytes = frame->bytes + lines + 2 * faces;
    frame->last_carrier = frame->carrier + lines;
    memset(frame->awake, 2, fragments);
    return SHV_OK;
}

static void release(Frame *frame)
{
    shv_release(frame->motion);
    shv_release(frame->shape);
    shv_release(frame->bytes);
    shv_release(frame->carrier);
    shv_release(frame->quaternion);
    shv_release(frame->awake);
    shv_release(frame->scratch);
}

/* ---- numbers ---- */

static uint16_t quantised(double value, ShvViewRange range)
{
    if (!(range.step > 0.0F)) return 0;
    return (uint16_t)fmin(65535.0, fmax(0.0, floor((value - (double)range.low) / (double)range.step + 0.5)));
}

/* −1…1 as a 16-bit number in two's complement. */
static uint16_t signed_part(double share)
{
    return (uint16_t)(int16_t)floor(HALF * fmin(1.0, fmax(-1.0, share)) + 0.5);
}

/* Of q and −q, the same rotation, the one nearer to the last: differences stay small. */
static void put_orientation(const ShvViewData *data, Frame *frame, int32_t line, ShvQuat q)
{
    double *last = frame->quaternion + 4 * (int64_t)line;
    const double sign = last[0] * q.x + last[1] * q.y + last[2] * q.z + last[3] * q.w < 0.0 ? -1.0 : 1.0;
    const double now[4] = {sign * q.x, sign * q.y, sign * q.z, sign * q.w};
    for (int k = 0; k < 4; k++) {
        last[k] = now[k];
        frame->motion[(int64_t)(3 + k) * data->lines.count + line] = signed_part(now[k]);
    }
}

static void put_motion(const ShvViewData *data, Frame *frame)
{
    const int64_t count = data->lines.count;
    for (int32_t line = 0; line < count; line++) {
        double values[SHV_VIEW_RANGES];
        const ShvPose pose = shv_lines_pose(&data->lines, line);
        frame->carrier[line] = pose.lives ? pose.fragment : -1;
        if (!shv_view_data_motion(data, line, values)) continue;
        for (int k = 0; k < SHV_VIEW_RANGES; k++)
            frame->motion[(k < 3 ? k : k + 4) * count + line] =
                quantised(values[k], data->ranges[SHV_VIEW_RANGES * line + k]);
        put_orientation(data, frame, line, pose.orientation);
    }
}

/* Damage of a crack is the facet's own; of the outside the largest of the tet's. Stress is a root: impacts dwarf the rest. */
static void put_face(const ShvViewData *data, Frame *frame, int64_t f, const ShvPose *pose)
{
    const int64_t face = data->lines.face[f], count = data->face_count, tet = face / 4;
    for (int k = 0; k < 3 && pose->lives; k++) {
        const ShvVec3 d = shv_view_data_displacement(data, face, k, pose);
        const double parts[3] = {d.x, d.y, d.z};
        for (int c = 0; c < 3; c++)
            frame->shape[(3 * k + c) * count + f] = data->reach > 0.0 ? signed_part(parts[c] / data->reach) : 0;
    }
    const double *facets = data->damage + 4 * tet;
    const double damage = data->lines.neighbour[face] >= 0
                              ? facets[face % 4]
                              : fmax(fmax(facets[0], facets[1]), fmax(facets[2], facets[3]));
    const double stress = shv_view_data_stress(data, tet);
    uint8_t *bytes = frame->bytes + data->lines.count;
    bytes[f] = (uint8_t)(255.0 * fmin(1.0, fmax(0.0, damage)) + 0.5);
    bytes[count + f] = stress > 0.0 ? (uint8_t)(255.0 * sqrt(fmin(1.0, stress / data->stress)) + 0.5) : 0;
}

static void put_faces(const ShvViewData *data, Frame *frame)
{
    for (int32_t line = 0; line < data->lines.count; line++) {
        const ShvPose pose = shv_lines_pose(&data->lines, line);
        for (int64_t f = data->lines.begin[line]; f < data->lines.begin[line + 1]; f++) put_face(data, frame, f, &pose);
    }
}

/* ---- modes ---- */

static ShvStatus follow_events(const ShvViewData *data, Frame *frame, double time, ShvError *error)
{
    for (; frame->event < data->info->event_count; frame->event++) {
        ShvEventView event;
        SHV_TRY(shv_run_file_event(data->file, frame->event, &event, error));
        if (event.time > time) return SHV_OK;
        if (event.fragment < 0 || event.fragment >= data->info->fragment_count) continue;
        if (event.kind == SHV_RUN_WAKE || event.kind == SHV_RUN_SPLIT) frame->awake[event.fragment] = 1;
        if (event.kind == SHV_RUN_SLEEP || event.kind == SHV_RUN_BIN) frame->awake[event.fragment] = 0;
    }
    return SHV_OK;
}

/* A piece is born in the mode of its parent; without any switch all are in the mode of the frame. */
static bool is_awake(const ShvViewData *data, const Frame *frame, int32_t fragment)
{
    while (fragment >= 0 && frame->awake[fragment] == 2) fragment = data->lines.pieces.fragments[fragment].parent;
    return data->mode == SHV_FRAGMENT_FRACTURE && (fragment < 0 || frame->awake[fragment] == 1);
}

static void put_modes(const ShvViewData *data, Frame *frame)
{
    for (int32_t line = 0; line < data->lines.count; line++)
        frame->bytes[line] = frame->carrier[line] >= 0 && is_awake(data, frame, frame->carrier[line]);
}

/* ---- all frames ---- */

static void pack_frame(ShvViewData *data, Frame *frame)
{
    const size_t lines = (size_t)data->lines.count, faces = data->corners ? (size_t)data->face_count : 0;
    shv_pack_differences(data->pack, frame->motion, frame->last_motion, NUMBERS * lines, frame->scratch);
    for (size_t i = 0; i < lines; i++) {
        shv_pack_int(data->pack, frame->carrier[i] - frame->last_carrier[i]);
        frame->last_carrier[i] = frame->carrier[i];
    }
    shv_pack_byte_differences(data->pack, frame->bytes, frame->last_bytes, lines + 2 * faces, frame->scratch);
    if (faces > 0)
        shv_pack_differences(data->pack, frame->shape, frame->last_shape, FACE_NUMBERS * faces, frame->scratch);
}

static ShvStatus put_all(ShvViewData *data, Frame *frame, ShvError *error)
{
    const double *times = shv_run_file_times(data->file);
    for (int64_t i = 0; i < data->frame_count; i++) {
        SHV_TRY(shv_view_data_move(data, data->frames[i], error));
        SHV_TRY(follow_events(data, frame, times[data->frames[i]], error));
        put_motion(data, frame);
        put_modes(data, frame);
        if (data->corners) put_faces(data, frame);
        pack_frame(data, frame);
    }
    return SHV_OK;
}

ShvStatus shv_view_put_frames(ShvViewData *data, ShvError *error)
{
    Frame frame = {.motion = NULL};
    ShvStatus status = create(data, &frame, error);
    if (status == SHV_OK) status = put_all(data, &frame, error);
    release(&frame);
    return status;
}
