/* A fragment as a small number of convex hulls, for rigid contact. Tets are convex already: they are clustered, and each
   cluster stands for its hull, drawn back from the tips of rough crack faces to about their mean level, so that pieces that
   lie against each other hardly overlap. Space outside counts more than tets left out, for overlap at birth makes
   pieces spring apart; where a fragment is nearly convex both count the same. Hulls of one fragment may overlap. */
#ifndef SHV_CONVEX_CONVEX_PIECES_H
#define SHV_CONVEX_CONVEX_PIECES_H

#include "convex/fragment_tets.h"

typedef struct ShvConvexPieces {
    ShvMemory *memory;
    int32_t count;         /* hulls */
    int32_t *vertex_begin; /* count + 1, into vertices */
    double *vertices;      /* 3 a vertex: from the fragment's reference centre, in reference axes, m */
    double volume;         /* m³: Σ volumes of the hulls */
    double excess;   /* volume / that of the tets − 1: hull error (overlaps of the hulls with each other count too) */
    double *volumes; /* count: of each hull, m³ */
    /* m³: space in hulls that no tet of the fragment holds, and of its tets in no hull; seen on a grid of a fifth of an edge,
       of up to 16 tets at 11 points each. 0 where the hulls are exact */
    double outside, missing;
} ShvConvexPieces;

enum { SHV_PIECE_VERTICES = 64 /* at most, a hull */ };

/* Hulls of a fragment as its reference shape stands, from the present lists of elements and nodes. Same fragment, same bits.
   One hull where that is as good; of a box, its corners. A tet that is flat to 2⁻²⁴ of its size stands as its four nodes,
   with no volume. Uses the node labels of `fragments` as scratch: one call at a time. On failure `pieces` is zeroed and owns nothing. */
ShvStatus shv_convex_pieces_make(ShvConvexPieces *pieces, const ShvFragments *fragments, const ShvModel *model,
                                 const ShvState *state, int32_t fragment, ShvError *error);
/* The same of tets that come from elsewhere. */
ShvStatus shv_convex_pieces_of_tets(ShvConvexPieces *pieces, const ShvFragmentTets *tets, ShvMemory *memory,
                                    ShvError *error);
void shv_convex_pieces_release(ShvConvexPieces *pieces);

#endif
