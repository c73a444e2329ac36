/* What can be seen of the fragments at one frame: the faces of tets whose neighbour belongs to another fragment or is
   missing. */
#ifndef SHV_EXPORT_SKIN_H
#define SHV_EXPORT_SKIN_H

#include "export/pieces.h"

typedef struct ShvTriangle {
    ShvVec3 corner[3]; /* m; counter-clockwise seen from outside */
    int32_t fragment;
} ShvTriangle;

typedef struct ShvSkin {
    ShvPieces pieces;
    struct ShvMemory *memory;
    int32_t *neighbour; /* 4 × element_count: tet behind the face opposite to each corner, −1: none */
    int32_t *owner;     /* element_count: living fragment at the frame, −1: none */
    double *corners;    /* 12 × element_count where the run recorded nodes, else NULL */
    ShvTriangle *triangles;
    int64_t count, capacity;
} ShvSkin;

/* On failure everything is released. */
ShvStatus shv_skin_create(ShvSkin *skin, ShvRunFile *file, struct ShvMemory *memory, ShvError *error);
void shv_skin_release(ShvSkin *skin);
/* Goes to a frame: triangles of all living fragments. */
ShvStatus shv_skin_move(ShvSkin *skin, int64_t frame, ShvError *error);

#endif
