/* A run in memory: samples of probes and numbers of frames. */
#ifndef SHV_EVALUATE_RECORDING_H
#define SHV_EVALUATE_RECORDING_H

#include "base/memory.h"
#include "evaluate/formula.h"
#include "shiver/plan.h"

typedef struct ShvRecordedFrame {
    ShvLedgerView ledger;
    double step, courant, inserted, failed, alive, steps;
} ShvRecordedFrame;

typedef struct ShvRecording {
    ShvMemory *memory;
    int32_t probe_count;
    const ShvProbeView *probes; /* of the simulation */
    double *probe_times;
    ShvProbeSample *samples; /* row by row */
    int64_t rows, row_capacity;
    double *frame_times;
    ShvRecordedFrame *frames;
    int64_t frame_count, frame_capacity;
    ShvPreflight *preflights; /* one an object */
    int32_t object_count;
    double largest_mass, mass; /* kg, at the end */
    double worst_overshoot;
    int32_t pieces;       /* fragments alive at the end */
    double *piece_masses; /* kg, each of them */
    ShvCrackView crack;
    double wall_seconds;
} ShvRecording;

void shv_recording_release(ShvRecording *recording);
ShvStatus shv_recording_start(ShvRecording *recording, ShvMemory *memory, const ShvSimulation *simulation,
                              ShvError *error);
/* The simulation's present frame. */
ShvStatus shv_recording_add(ShvRecording *recording, const ShvSimulation *simulation, ShvError *error);
/* What is known at the end. */
ShvStatus shv_recording_finish(ShvRecording *recording, const ShvSimulation *simulation, ShvError *error);

/* Names of formulas (README.md of scenes/verification lists them): series of probes and frames, numbers of the end, of objects'
   preflight and of the scene. False when there is no such name. `pool` gets series; out of memory counts as no such name with
   pool->failed. */
bool shv_recording_find(const ShvRecording *recording, const ShvSceneDefinition *scene, ShvPool *pool, const char *name,
                        ShvFormulaValue *value);

#endif
