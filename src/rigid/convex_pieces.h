/* A fragment as a small number of convex hulls, for rigid contact. Tets are convex already: they are clustered, and each cluster
   stands for its hull. */
#ifndef SHV_RIGID_CONVEX_PIECES_H
#define SHV_RIGID_CONVEX_PIECES_H

#include "rigid/fragment.h"

typedef struct ShvConvexPieces {
    ShvMemory *memory;
    int32_t count;         /* hulls */
    int32_t *vertex_begin; /* count + 1, into vertices */
    double *vertices;      /* 3 a vertex: from the fragment's reference centre, in reference axes, m */
    double volume;         /* m³: Σ volumes of the hulls */
    double excess;         /* volume / that of the tets − 1: hull error (overlaps of the hulls with each other count too) */
} ShvConvexPieces;

enum { SHV_PIECE_VERTICES = 64 /* at most, a hull */ };

/* Hulls of a fragment as its reference shape stands, from the present lists of elements and nodes. Same fragment, same bits.
   One hull where that is as good. On failure `pieces` is zeroed and owns nothing. */
ShvStatus shv_convex_pieces_make(ShvConvexPieces *pieces, const ShvFragments *fragments, const ShvModel *model,
                                 const ShvState *state, int32_t fragment, ShvError *error);
void shv_convex_pieces_release(ShvConvexPieces *pieces);

#endif
