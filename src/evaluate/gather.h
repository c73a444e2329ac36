/* From a simulation to an outcome, frame by frame. */
#ifndef SHV_EVALUATE_GATHER_H
#define SHV_EVALUATE_GATHER_H

#include "evaluate/body.h"
#include "evaluate/outcome.h"
#include "scene/pool.h"
#include "shiver/plan.h"

typedef struct ShvGather {
    ShvOutcome *outcome;
    const ShvSceneDefinition *scene;
    bool tracked;       /* also the way of all bodies */
    ShvBodies bodies;   /* of the first frame, where tracked */
    ShvPool pool;       /* of the scratch below */
    double *corners;    /* 12 per element */
    int32_t *fragments; /* per element */
    double *damage;     /* 4 per element */
} ShvGather;

void shv_gather_release(ShvGather *gather);
/* The present frame. */
ShvStatus shv_gather_frame(ShvGather *gather, const ShvSimulation *simulation, ShvError *error);
/* Numbers of the scene and of its meshes. */
ShvStatus shv_gather_facts(ShvGather *gather, const ShvSimulation *simulation, ShvError *error);
/* What is known at the end: pieces, cracks, costs. */
ShvStatus shv_gather_end(ShvGather *gather, const ShvSimulation *simulation, ShvError *error);
/* Ascending. */
void shv_sort_numbers(double *values, int64_t count);

#endif
