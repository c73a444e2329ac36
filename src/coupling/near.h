/* Where a deforming fragment is, finely enough to tell its neighbours from what its box surrounds, and cheaply. */
#ifndef SHV_COUPLING_NEAR_H
#define SHV_COUPLING_NEAR_H

#include "contact/box.h"
#include "coupling/hybrid.h"

enum { SHV_NEAR_CELLS = 16 };

/* Cells of a grid over the fragment's box; marked are those that the boxes of its tets meet. */
typedef struct ShvNear {
    ShvBox box;
    ShvVec3 cell;                                  /* sides, m; 0 where the box has no extent */
    double speed;                                  /* m/s: largest of its nodes */
    uint16_t rows[SHV_NEAR_CELLS][SHV_NEAR_CELLS]; /* [z][y], a bit per x */
} ShvNear;

void shv_near_find(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvNear *near);
/* Whether a cell that is marked lies within a radius of a point. */
bool shv_near_meets(const ShvNear *near, ShvVec3 centre, double radius);

#endif
