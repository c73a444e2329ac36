#include "export/pieces.h"

#include "base/memory.h"

static ShvStatus allocate(ShvPieces *pieces, struct ShvMemory *memory, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(pieces->file);
    const size_t elements = (size_t)info->element_count, fragments = (size_t)info->fragment_count;
    pieces->elements = shv_allocate(memory, SHV_PART_RECORD, 4 * elements, sizeof(int32_t));
    pieces->owner = shv_allocate(memory, SHV_PART_RECORD, elements, sizeof(int32_t));
    pieces->reference = shv_allocate(memory, SHV_PART_RECORD, 3 * (size_t)info->node_count, sizeof(double));
    pieces->fragments = shv_allocate(memory, SHV_PART_RECORD, fragments, sizeof(ShvFragmentView));
    pieces->lineage = shv_allocate(memory, SHV_PART_RECORD, fragments, sizeof(int32_t));
    pieces->carrier = shv_allocate(memory, SHV_PART_RECORD, fragments, sizeof(int32_t));
    pieces->position = shv_allocate(memory, SHV_PART_RECORD, 3 * fragments, sizeof(double));
    pieces->orientation = shv_allocate(memory, SHV_PART_RECORD, 4 * fragments, sizeof(double));
    pieces->alive = shv_allocate(memory, SHV_PART_RECORD, fragments, 1);
    if (pieces->elements && pieces->owner && pieces->reference && pieces->fragments && pieces->lineage &&
        pieces->carrier && pieces->position && pieces->orientation && pieces->alive)
        return SHV_OK;
    return shv_fail_memory(error, "the mesh", 20 * elements + 24 * (size_t)info->node_count);
}

ShvStatus shv_pieces_create(ShvPieces *pieces, ShvRunFile *file, struct ShvMemory *memory, ShvError *error)
{
    *pieces = (ShvPieces){.file = file};
    ShvStatus status = allocate(pieces, memory, error);
    if (status == SHV_OK)
        status = shv_run_file_mesh(file, pieces->reference, pieces->elements, NULL, pieces->owner, error);
    if (status == SHV_OK) status = shv_run_file_fragments(file, pieces->fragments, error);
    if (status == SHV_OK) status = shv_run_file_lineages(file, pieces->lineage, error);
    if (status != SHV_OK) shv_pieces_release(pieces);
    return status;
}

void shv_pieces_release(ShvPieces *pieces)
{
    shv_release(pieces->elements);
    shv_release(pieces->owner);
    shv_release(pieces->reference);
    shv_release(pieces->fragments);
    shv_release(pieces->lineage);
    shv_release(pieces->carrier);
    shv_release(pieces->position);
    shv_release(pieces->orientation);
    shv_release(pieces->alive);
    *pieces = (ShvPieces){.file = NULL};
}

ShvStatus shv_pieces_move(ShvPieces *pieces, int64_t frame, ShvError *error)
{
    const int32_t count = shv_run_file_info(pieces->file)->fragment_count;
    SHV_TRY(shv_run_file_frame(pieces->file, frame, NULL, NULL, pieces->alive, pieces->position, pieces->orientation,
                               NULL, NULL, error));
    for (int32_t i = 0; i < count; i++) {
        int32_t carrier = i;
        while (!pieces->alive[carrier] && pieces->fragments[carrier].parent >= 0)
            carrier = pieces->fragments[carrier].parent;
        pieces->carrier[i] = carrier;
    }
    return SHV_OK;
}

ShvVec3 shv_pieces_point(const ShvPieces *pieces, int32_t owner, int32_t node)
{
    const int32_t carrier = pieces->carrier[owner];
    return shv_pose_point(pieces->position + 3 * (int64_t)carrier, pieces->orientation + 4 * (int64_t)carrier,
                          pieces->fragments[carrier].reference_centre, pieces->reference + 3 * (int64_t)node);
}
