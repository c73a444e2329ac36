/* A recorded run as an outcome. */
#include <math.h>
#include <string.h>

#include "evaluate/sampler.h"

static ShvStatus keep_pieces(ShvOutcome *outcome, ShvRunFile *file, int32_t count, ShvError *error)
{
    ShvFragmentView *fragments = shv_allocate(outcome->memory, SHV_PART_RECORD, (size_t)count, sizeof *fragments);
    if (!fragments) return shv_fail_memory(error, "fragments", (size_t)count * sizeof *fragments);
    const ShvStatus status = shv_run_file_fragments(file, fragments, error);
    if (status == SHV_OK) shv_sample_pieces(outcome, fragments, count);
    shv_release(fragments);
    return status;
}

static ShvStatus keep_frames(ShvOutcome *outcome, ShvRunFile *file, int64_t frames, ShvError *error)
{
    for (int64_t i = 0; i < frames; i++) {
        ShvLedgerView ledger;
        ShvProgressView progress;
        SHV_TRY(shv_run_file_ledger(file, i, &ledger, error));
        SHV_TRY(shv_run_file_progress(file, i, &progress, error));
        const struct {
            const char *name;
            double value;
        } numbers[] = {{"frame.time", ledger.time},
                       {"frame.step", progress.step},
                       {"frame.courant", progress.courant},
                       {"frame.inserted", progress.inserted},
                       {"frame.failed", progress.failed},
                       {"frame.alive", progress.alive},
                       {"frame.steps", (double)progress.steps}};
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
            shv_outcome_add(outcome, numbers[k].name, SHV_CLOCK_FRAME, numbers[k].value);
        shv_sample_ledger(outcome, &ledger);
    }
    return outcome->failed ? shv_fail_memory(error, "a recorded run", 0) : SHV_OK;
}

/* The hash of a mesh tells whether facets can be compared one by one; without recorded nodes nothing is known of them. */
static ShvStatus keep_crack(ShvOutcome *outcome, ShvRunFile *file, const ShvRunFileInfo *info, ShvError *error)
{
    if (!info->nodes || info->frame_count == 0) return SHV_OK;
    const size_t nodes = (size_t)info->node_count, elements = (size_t)info->element_count;
    double *positions = shv_allocate(outcome->memory, SHV_PART_RECORD, 3 * nodes, sizeof(double));
    int32_t *corners = shv_allocate(outcome->memory, SHV_PART_RECORD, 4 * elements, sizeof(int32_t));
    uint8_t *bonds = shv_allocate(outcome->memory, SHV_PART_RECORD, 4 * elements, sizeof *bonds);
    ShvStatus status = positions && corners && bonds ? SHV_OK : shv_fail_memory(error, "a recorded mesh", 24 * nodes);
    if (status == SHV_OK) status = shv_run_file_mesh(file, positions, corners, NULL, NULL, error);
    if (status == SHV_OK) status = shv_run_file_bonds(file, info->frame_count - 1, bonds, error);
    const ShvMeshView mesh = {.node_count = info->node_count,
                              .element_count = info->element_count,
                              .positions = positions,
                              .elements = corners};
    if (status == SHV_OK) status = shv_sample_crack(outcome, &mesh, bonds, error);
    shv_release(positions);
    shv_release(corners);
    shv_release(bonds);
    return status;
}

static ShvStatus keep(ShvOutcome *outcome, ShvRunFile *file, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (strcmp(info->status, "finished") != 0)
        return shv_fail(error, SHV_BAD_INPUT, "the run file's status is '%s'; a reference must have finished",
                        info->status);
    SHV_TRY(keep_pieces(outcome, file, info->fragment_count, error));
    SHV_TRY(keep_frames(outcome, file, info->frame_count, error));
    return keep_crack(outcome, file, info, error);
}

ShvStatus shv_outcome_of_run_file(ShvOutcome *outcome, const char *path, ShvMemory *memory, ShvError *error)
{
    ShvRunFile *file;
    *outcome = (ShvOutcome){.memory = memory};
    SHV_TRY(shv_run_file_open(&file, path, memory, error));
    const ShvStatus status = keep(outcome, file, error);
    shv_run_file_close(file);
    if (status != SHV_OK) shv_outcome_release(outcome);
    return status;
}
