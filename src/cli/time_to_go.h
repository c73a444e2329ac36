/* Processor time to go of a run, from what its work has cost so far and what of it is ahead. Arithmetic alone: it reads no clock. */
#ifndef SHV_CLI_TIME_TO_GO_H
#define SHV_CLI_TIME_TO_GO_H

#include "shiver/plan.h"

/* What work costs in one mode: s of processor time, and s of flight or of load (ShvAwakeView), of which what is long past counts less. */
typedef struct ShvCostRate {
    double processor, work;
} ShvCostRate;

/* Where a run stands: s of processor time since some time before it, and what the simulation says. */
typedef struct ShvRunSample {
    double processor;
    ShvSimulationSummary summary;
    ShvAwakeView awake;
} ShvRunSample;

typedef struct ShvTimeToGo {
    double duration;  /* s, simulated */
    double start;     /* s: of processor time, at the first sample */
    bool unbreakable; /* nothing in the scene can crack: what is awake stays as it is until it rests */
    bool begun;
    ShvRunSample last;
    ShvCostRate flight, fracture;
    double load; /* s: of load so far */
} ShvTimeToGo;

void shv_time_to_go_add(ShvTimeToGo *estimate, const ShvRunSample *sample);
/* s of processor time; NaN: what is ahead has not been seen at work yet. */
double shv_time_to_go(const ShvTimeToGo *estimate);
/* Once something has been in fracture mode the truth lies within this factor of the estimate, in the mean of nine scenes, at 86
   guesses of a hundred (docs/cli.md). */
extern const double shv_time_to_go_spread;

#endif
