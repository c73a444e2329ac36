/* The bodies of a run as viewers and exports show them: one a line of descent, with the tets that its last fragment owns.
   Before that fragment is born they move with the ancestor that lives then, so that a line is one body from the first frame
   to the last and no geometry is stored twice. */
#ifndef SHV_EXPORT_LINES_H
#define SHV_EXPORT_LINES_H

#include <stdbool.h>

#include "export/pieces.h"

typedef struct ShvLines {
    ShvPieces pieces;
    struct ShvMemory *memory;
    int32_t count;
    int32_t *leaf;      /* count: the last fragment of each line */
    int32_t *index;     /* fragment_count: line that ends with the fragment, −1: none */
    int32_t *neighbour; /* 4 × element_count: tet behind the face opposite to each corner, −1: none */
    int64_t *face;      /* 4 × tet + opposite corner of what can come to be seen, those of a line together */
    int64_t *begin;     /* count + 1: in `face` */
} ShvLines;

typedef struct ShvPose {
    ShvVec3 position; /* m: where the centre of mass of the line's last fragment is */
    ShvQuat orientation;
    int32_t fragment; /* that lives at the frame and moves the line */
    bool lives;       /* false: position is NaN */
} ShvPose;

/* Faces between the tets of two lines or on the outside; with `cracks` (one flag a face, may be NULL) also those flagged. On
   failure everything is released. */
ShvStatus shv_lines_create(ShvLines *lines, ShvRunFile *file, struct ShvMemory *memory, const uint8_t *cracks,
                           ShvError *error);
void shv_lines_release(ShvLines *lines);
/* Goes to a frame. */
ShvStatus shv_lines_move(ShvLines *lines, int64_t frame, ShvError *error);
ShvPose shv_lines_pose(const ShvLines *lines, int32_t line);
/* Line of a tet. */
int32_t shv_lines_of(const ShvLines *lines, int64_t tet);
/* Corner k (0…2) of a face in the reference mesh, counter-clockwise seen from outside, and its number in the tet. */
ShvVec3 shv_lines_corner(const ShvLines *lines, int64_t face, int k);
int shv_face_corner(int64_t face, int k);
/* The reference centre of a line's last fragment. */
ShvVec3 shv_lines_centre(const ShvLines *lines, int32_t line);

#endif
