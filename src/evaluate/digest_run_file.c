/* A recorded run as a digest. */
#include <string.h>

#include "base/text.h"
#include "evaluate/digest.h"

static ShvStatus keep_fragments(ShvDigest *digest, ShvRunFile *file, int32_t count, ShvFragmentView *fragments,
                                ShvError *error)
{
    double *n = digest->numbers;
    ShvVec3 momentum = shv_vec3(0.0, 0.0, 0.0);
    SHV_TRY(shv_run_file_fragments(file, fragments, error));
    for (int32_t i = 0; i < count; i++) {
        if (fragments[i].mode == SHV_FRAGMENT_DEAD) continue;
        digest->masses[digest->mass_count++] = fragments[i].mass;
        momentum = shv_madd(momentum, fragments[i].mass, shv_load3(fragments[i].velocity));
    }
    shv_sort_numbers(digest->masses, digest->mass_count);
    n[SHV_DIGEST_MASS] = 0.0;
    for (int32_t i = 0; i < digest->mass_count; i++) n[SHV_DIGEST_MASS] += digest->masses[i];
    n[SHV_DIGEST_FRAGMENTS] = digest->mass_count;
    if (digest->mass_count > 0)
        n[SHV_DIGEST_LARGEST_MASS] = digest->masses[digest->mass_count - 1] / n[SHV_DIGEST_MASS];
    shv_store3(n + SHV_DIGEST_MOMENTUM_X, momentum);
    return SHV_OK;
}

/* What the bars did between frames, the largest residual. */
static ShvStatus keep_ledger(ShvDigest *digest, ShvRunFile *file, int64_t frames, ShvError *error)
{
    double *n = digest->numbers, bars = 0.0;
    ShvLedgerView ledger;
    ShvProgressView progress;
    n[SHV_DIGEST_BARS_GIVEN] = n[SHV_DIGEST_BARS_TAKEN] = n[SHV_DIGEST_RESIDUAL] = 0.0;
    for (int64_t i = 0; i < frames; i++) {
        SHV_TRY(shv_run_file_ledger(file, i, &ledger, error));
        const double change = ledger.bars - bars;
        bars = ledger.bars;
        n[change > 0.0 ? SHV_DIGEST_BARS_GIVEN : SHV_DIGEST_BARS_TAKEN] += fabs(change);
        n[SHV_DIGEST_RESIDUAL] = fmax(n[SHV_DIGEST_RESIDUAL], fabs(ledger.residual));
    }
    if (frames == 0) return SHV_OK;
    SHV_TRY(shv_run_file_progress(file, frames - 1, &progress, error));
    n[SHV_DIGEST_TIME] = ledger.time;
    n[SHV_DIGEST_KINETIC] = ledger.kinetic;
    n[SHV_DIGEST_STRAIN] = ledger.strain;
    n[SHV_DIGEST_DISSIPATED] = ledger.fracture_dissipation;
    n[SHV_DIGEST_LARGEST] = ledger.largest;
    n[SHV_DIGEST_FAILED_AREA] = ledger.failed_area;
    n[SHV_DIGEST_STEPS] = (double)progress.steps;
    n[SHV_DIGEST_STEP] = progress.step;
    n[SHV_DIGEST_COURANT] = progress.courant;
    n[SHV_DIGEST_INSERTED] = progress.inserted;
    n[SHV_DIGEST_FAILED] = progress.failed;
    return SHV_OK;
}

/* The hash of a mesh tells whether facets can be compared one by one; without recorded nodes nothing is known of them. */
static ShvStatus keep_crack(ShvDigest *digest, ShvRunFile *file, const ShvRunFileInfo *info, ShvError *error)
{
    if (!info->nodes || info->frame_count == 0) return SHV_OK;
    const size_t nodes = (size_t)info->node_count, elements = (size_t)info->element_count;
    double *positions = shv_allocate(digest->memory, SHV_PART_RECORD, 3 * nodes, sizeof(double));
    int32_t *corners = shv_allocate(digest->memory, SHV_PART_RECORD, 4 * elements, sizeof(int32_t));
    uint8_t *bonds = shv_allocate(digest->memory, SHV_PART_RECORD, 4 * elements, sizeof *bonds);
    ShvStatus status = positions && corners && bonds ? SHV_OK : shv_fail_memory(error, "a recorded mesh", 24 * nodes);
    if (status == SHV_OK) status = shv_run_file_mesh(file, positions, corners, NULL, NULL, error);
    if (status == SHV_OK) status = shv_run_file_bonds(file, info->frame_count - 1, bonds, error);
    const ShvMeshView mesh = {.node_count = info->node_count,
                              .element_count = info->element_count,
                              .positions = positions,
                              .elements = corners};
    if (status == SHV_OK) status = shv_crack_surface_create(&digest->crack, &mesh, bonds, digest->memory, error);
    shv_release(positions);
    shv_release(corners);
    shv_release(bonds);
    return status;
}

static ShvStatus keep(ShvDigest *digest, ShvRunFile *file, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    const size_t count = (size_t)info->fragment_count;
    if (strcmp(info->status, "finished") != 0)
        return shv_fail(error, SHV_BAD_INPUT, "the run file's status is '%s'; a reference must have finished",
                        info->status);
    digest->masses = shv_allocate(digest->memory, SHV_PART_RECORD, count, sizeof(double));
    ShvFragmentView *fragments = shv_allocate(digest->memory, SHV_PART_RECORD, count, sizeof *fragments);
    ShvStatus status =
        digest->masses && fragments ? SHV_OK : shv_fail_memory(error, "fragments", count * sizeof *fragments);
    if (status == SHV_OK) status = keep_fragments(digest, file, info->fragment_count, fragments, error);
    if (status == SHV_OK) status = keep_ledger(digest, file, info->frame_count, error);
    if (status == SHV_OK) status = keep_crack(digest, file, info, error);
    shv_release(fragments);
    return status;
}

ShvStatus shv_digest_of_run_file(ShvDigest *digest, const char *path, ShvMemory *memory, ShvError *error)
{
    ShvRunFile *file;
    *digest = (ShvDigest){.memory = memory};
    SHV_TRY(shv_run_file_open(&file, path, memory, error));
    for (int i = 0; i < SHV_DIGEST_NUMBERS; i++) digest->numbers[i] = (double)NAN;
    const ShvStatus status = keep(digest, file, error);
    shv_run_file_close(file);
    if (status != SHV_OK) shv_digest_release(digest);
    return status;
}
