/* From a simulation to an outcome, frame by frame. */
#ifndef SHV_EVALUATE_SAMPLER_H
#define SHV_EVALUATE_SAMPLER_H

#include "evaluate/body.h"
#include "evaluate/outcome.h"
#include "scene/pool.h"
#include "shiver/plan.h"

typedef struct ShvSampler {
    ShvOutcome *outcome;
    const ShvSceneDefinition *scene;
    bool tracked;       /* also the way of all bodies */
    ShvBodies bodies;   /* of the first frame, where tracked */
    ShvPool pool;       /* of the scratch below */
    double *corners;    /* 12 per element */
    int32_t *fragments; /* per element */
    double *damage;     /* 4 per element */
} ShvSampler;

void shv_sampler_release(ShvSampler *sampler);
/* The present frame. */
ShvStatus shv_sample_frame(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* Numbers of the scene and of its meshes. */
ShvStatus shv_sample_scene(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* What is known at the end: pieces, cracks, costs. */
ShvStatus shv_sample_end(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* Ascending. */
void shv_sort_numbers(double *values, int64_t count);

#endif
