/* The shape of a body that is to be filled with tets: a box, or what a closed profile sweeps when it is turned about z. Both
   are centred as they come: a box about the origin, a turned body where its profile is. */
#ifndef SHV_MESH_OUTLINE_H
#define SHV_MESH_OUTLINE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vector.h"

typedef struct ShvOutline {
    double half[3];        /* of a box; the third 0: a rectangle */
    const double *profile; /* turned: radius and height of each corner; the last joins the first. NULL: a box */
    int32_t count;         /* corners of the profile */
} ShvOutline;

/* What a node is held to. Of a box: bit k where it keeps its coordinate k, so that 7 are corners. Of a turned body: */
enum { SHV_HELD_NOT = 0, SHV_HELD_SURFACE = 1, SHV_HELD_RING = 2 };

/* Half the size of the box round the body, and its middle. */
ShvVec3 shv_outline_half(const ShvOutline *outline, ShvVec3 *middle);
/* Distance from the surface, negative outside. */
double shv_outline_depth(const ShvOutline *outline, ShvVec3 x);
/* Whether two places of the surface are on opposite sides of a wall of a turned body. */
bool shv_outline_are_opposite(const ShvOutline *outline, ShvVec3 a, ShvVec3 b);
/* Where a node that is held to something goes when it would move from `old` to `wanted`: never to the other side of a wall. */
ShvVec3 shv_outline_keep(const ShvOutline *outline, uint8_t held, ShvVec3 old, ShvVec3 wanted);
/* A point of the surface, all places alike, from three numbers in (0, 1); what it is held to. */
ShvVec3 shv_outline_draw(const ShvOutline *outline, const double draw[3], uint8_t *held);
double shv_outline_area(const ShvOutline *outline);
double shv_outline_volume(const ShvOutline *outline);
/* Whether the profile turns there by more than a smooth curve's would: its ring is then an edge of the body. */
bool shv_outline_is_sharp(const ShvOutline *outline, int32_t corner);

#endif
