/* The convex pieces that Bullet moves fragments by, made anew from the shapes at the start. */
#ifndef SHV_VIEW_HULLS_H
#define SHV_VIEW_HULLS_H

#include "convex/convex_pieces.h"
#include "export/lines.h"

typedef struct ShvFragmentHulls {
    int32_t fragment;
    ShvConvexPieces pieces;
} ShvFragmentHulls;

typedef struct ShvHulls {
    struct ShvMemory *memory;
    ShvFragmentHulls *items;
    int32_t count;
} ShvHulls;

/* Of fragments without a parent, of the last one of each line, and of others as far as that takes no more than seconds;
   shv_hulls_release also after a failure. */
ShvStatus shv_hulls_create(ShvHulls *hulls, const ShvLines *lines, struct ShvMemory *memory, ShvError *error);
void shv_hulls_release(ShvHulls *hulls);

#endif
