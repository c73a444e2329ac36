/* The tets of a run at its frames, moved rigidly with their fragments. The owners of the last frame are the finest division
   of the mesh; before its birth a fragment moves with the ancestor that lives then. */
#ifndef SHV_EXPORT_PIECES_H
#define SHV_EXPORT_PIECES_H

#include "base/vector.h"
#include "shiver/run_file.h"

typedef struct ShvPieces {
    ShvRunFile *file;
    int32_t *elements, *owner; /* 4 × element_count; element_count: owners of the last frame */
    double *reference;         /* 3 × node_count */
    ShvFragmentView *fragments;
    int32_t *lineage; /* of each fragment */
    int32_t *carrier; /* who moves each fragment at the present frame */
    double *position, *orientation;
    uint8_t *alive;
} ShvPieces;

/* Reads mesh and genealogy. On failure everything is released. */
ShvStatus shv_pieces_create(ShvPieces *pieces, ShvRunFile *file, struct ShvMemory *memory, ShvError *error);
void shv_pieces_release(ShvPieces *pieces);
/* Goes to a frame: poses, who lives, carriers. */
ShvStatus shv_pieces_move(ShvPieces *pieces, int64_t frame, ShvError *error);
/* Where a node of a tet of this last owner is at the present frame; NaN when neither it nor an ancestor lives. */
ShvVec3 shv_pieces_point(const ShvPieces *pieces, int32_t owner, int32_t node);

#endif
