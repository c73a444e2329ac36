/* A glass ball of radius 0.1 m, meshed or read from a gmsh file, in one piece or cut by the nearest of random seeds. */
#ifndef BENCH_BROKEN_BALL_H
#define BENCH_BROKEN_BALL_H

#include "fragment/fragment.h"

#define BROKEN_BALL_RADIUS 0.1

typedef struct BrokenBall {
    ShvModel model;
    ShvState state;
    ShvFragments fragments;
} BrokenBall;

/* `file` NULL: a mesh of that edge, m. What was made is released in any case by broken_ball_release. */
ShvStatus broken_ball_make(BrokenBall *ball, const char *file, double edge, int32_t seeds, ShvError *error);
void broken_ball_release(BrokenBall *ball);

#endif
