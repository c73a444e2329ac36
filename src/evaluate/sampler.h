/* From a simulation to an outcome, frame by frame. */
#ifndef SHV_EVALUATE_SAMPLER_H
#define SHV_EVALUATE_SAMPLER_H

#include "evaluate/closed_form.h"
#include "evaluate/outcome.h"
#include "scene/pool.h"
#include "shiver/plan.h"

typedef struct ShvSampler {
    ShvOutcome *outcome;
    const ShvSceneDefinition *scene;
    int32_t begun, body_count; /* fragments of the first frame; bodies whose way is kept */
    ShvPool pool;              /* of what is below */
    ShvClosedForm *forms;      /* one a body; NULL: none */
    double *corners;           /* 12 per element */
    int32_t *fragments;        /* per element */
    double *damage;            /* 4 per element */
} ShvSampler;

/* At the first frame, before it is sampled: room, and the bodies whose way is kept. */
ShvStatus shv_sample_start(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* The present frame. */
ShvStatus shv_sample_frame(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* What is known at the end: pieces, cracks, costs. */
ShvStatus shv_sample_end(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* Numbers of the scene and of its meshes. */
ShvStatus shv_sample_scene(const ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);

/* Ascending. */
void shv_sort_numbers(double *values, int64_t count);

#endif
