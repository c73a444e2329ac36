/* From a simulation to an outcome, frame by frame. */
#ifndef SHV_EVALUATE_SAMPLER_H
#define SHV_EVALUATE_SAMPLER_H

#include "evaluate/body.h"
#include "evaluate/outcome.h"
#include "shiver/plan.h"

typedef struct ShvSampler {
    ShvOutcome *outcome;
    const ShvSceneDefinition *scene;
    bool tracked;       /* also the way of all bodies */
    ShvBodies bodies;   /* of the first frame, where tracked */
    double *corners;    /* 12 per element */
    int32_t *fragments; /* per element */
    double *damage;     /* 4 per element */
} ShvSampler;

void shv_sampler_release(ShvSampler *sampler);
/* The present frame. What is a number so far (not a series) is that of the run up to here. */
ShvStatus shv_sample_frame(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* sample_crack_tip.c: "crack.tip" and "crack.length" of the present frame. */
ShvStatus shv_sample_crack_tip(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* Numbers of the scene and of its meshes. */
ShvStatus shv_sample_scene(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);
/* What is known at the end: pieces, cracks, costs. */
ShvStatus shv_sample_end(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error);

/* Masses and momenta of living fragments; "pieces.mass" ascending. */
void shv_sample_pieces(ShvOutcome *outcome, const ShvFragmentView *fragments, int32_t count);
/* The failed facets. */
ShvStatus shv_sample_crack(ShvOutcome *outcome, const ShvMeshView *mesh, const uint8_t *bonds, ShvError *error);
/* Ascending. */
void shv_sort_numbers(double *values, int64_t count);
void shv_sample_ledger(ShvOutcome *outcome, const ShvLedgerView *ledger);

#endif
