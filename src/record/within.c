/* Which corners are recorded, where the scene asks for some of the frames or tets alone. */
#include <math.h>

#include "base/vector.h"
#include "record/record.h"
#include "record/run_file.h"

static bool is_in(const ShvSelection *box, const double point[3])
{
    for (int k = 0; k < 3; k++)
        if (!(point[k] >= box->box_min[k] && point[k] <= box->box_max[k])) return false;
    return true;
}

ShvStatus shv_within_prepare(ShvRecord *record, const ShvSimulation *simulation, const ShvMeshView *mesh,
                             ShvError *error)
{
    record->within = shv_simulation_nodes_within(simulation);
    if (!record->corners || !shv_nodes_limited(&record->within)) return SHV_OK;
    record->chosen = shv_allocate(record->memory, SHV_PART_RECORD, (size_t)mesh->element_count, 1);
    if (!record->chosen) return shv_fail_memory(error, "the run file", (size_t)mesh->element_count);
    int64_t count = 0;
    for (int64_t i = 0; i < 4 * (int64_t)mesh->element_count; i++) {
        if (record->chosen[i / 4] || !is_in(&record->within.box, mesh->positions + 3 * (int64_t)mesh->elements[i]))
            continue;
        record->chosen[i / 4] = 1;
        count++;
    }
    if (count > 0) return SHV_OK;
    return shv_fail(
        error, SHV_BAD_INPUT,
        "no node lies in the box of output.nodes_within at the start; move it to where bodies are, or leave "
        "it out");
}

/* Times of frames are quotients: equal within rounding counts. */
static bool is_frame_in(const ShvNodesWithin *within, int64_t frame, double time)
{
    const double slack = 1e-9 * fabs(time);
    return frame % within->every == 0 && time >= within->from - slack && time <= within->to + slack;
}

void shv_within_blank(ShvRecord *record, double time)
{
    if (!record->chosen) return;
    const bool frame = is_frame_in(&record->within, record->frames, time);
    for (int64_t i = 0; i < 12 * (int64_t)record->element_count; i++)
        if (!frame || !record->chosen[i / 12]) record->corners[i] = (double)NAN;
}

/* ---- reading ---- */

/* What it takes to put a tet where its fragment's pose has it. */
typedef struct Poses {
    double *nodes, *positions, *orientations;
    int32_t *elements, *owners;
    ShvFragmentView *fragments;
} Poses;

static void release(Poses *poses)
{
    shv_release(poses->nodes);
    shv_release(poses->positions);
    shv_release(poses->orientations);
    shv_release(poses->elements);
    shv_release(poses->owners);
    shv_release(poses->fragments);
}

static ShvStatus read_poses(ShvRunFile *file, int64_t frame, Poses *poses, ShvError *error)
{
    const size_t nodes = (size_t)file->info.node_count, elements = (size_t)file->info.element_count;
    const size_t fragments = (size_t)file->info.fragment_count;
    poses->nodes = shv_allocate(file->memory, SHV_PART_RECORD, 3 * nodes, sizeof(double));
    poses->positions = shv_allocate(file->memory, SHV_PART_RECORD, 3 * fragments, sizeof(double));
    poses->orientations = shv_allocate(file->memory, SHV_PART_RECORD, 4 * fragments, sizeof(double));
    poses->elements = shv_allocate(file->memory, SHV_PART_RECORD, 4 * elements, sizeof(int32_t));
    poses->owners = shv_allocate(file->memory, SHV_PART_RECORD, elements, sizeof(int32_t));
    poses->fragments = shv_allocate(file->memory, SHV_PART_RECORD, fragments, sizeof *poses->fragments);
    if (!poses->nodes || !poses->positions || !poses->orientations || !poses->elements || !poses->owners ||
        !poses->fragments)
        return shv_fail_memory(error, "poses of tets", 24 * nodes + 20 * elements);
    SHV_TRY(shv_run_file_mesh(file, poses->nodes, poses->elements, NULL, NULL, error));
    SHV_TRY(shv_run_file_fragments(file, poses->fragments, error));
    SHV_TRY(
        shv_run_file_frame(file, frame, NULL, NULL, NULL, poses->positions, poses->orientations, NULL, NULL, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_NODE_FRAGMENT, frame, (int64_t)elements, poses->owners, error));
    for (size_t i = 0; i < elements; i++)
        if (poses->owners[i] < 0 || (size_t)poses->owners[i] >= fragments)
            return shv_run_fail_damaged(file, "/nodes/fragment", error);
    return SHV_OK;
}

static ShvVec3 place(const Poses *poses, int32_t node, int32_t owner)
{
    return shv_pose_point(poses->positions + 3 * (int64_t)owner, poses->orientations + 4 * (int64_t)owner,
                          poses->fragments[owner].reference_centre, poses->nodes + 3 * (int64_t)node);
}

ShvStatus shv_within_fill(ShvRunFile *file, int64_t frame, double *corners, ShvError *error)
{
    Poses poses = {.nodes = NULL};
    const ShvStatus status = read_poses(file, frame, &poses, error);
    for (int64_t i = 0; status == SHV_OK && i < 4 * (int64_t)file->info.element_count; i++)
        if (isnan(corners[3 * i])) shv_store3(corners + 3 * i, place(&poses, poses.elements[i], poses.owners[i / 4]));
    release(&poses);
    return status;
}
