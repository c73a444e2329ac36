/* Progress of long work on stderr: one line that renews itself on a terminal, a line every few seconds elsewhere. */
#ifndef SHV_CLI_PROGRESS_H
#define SHV_CLI_PROGRESS_H

#include "shiver/simulation.h"

/* What simulated time costs in one mode: run time and simulated time, of which what is long past counts less. */
typedef struct ShvPace {
    double wall, time; /* s */
} ShvPace;

typedef struct ShvProgress {
    const ShvSimulation *simulation; /* NULL until it is made */
    double duration;                 /* s, simulated */
    bool quiet, terminal;
    double start, shown; /* wall clock, s */
    int64_t shown_steps;
    /* for the time to go */
    ShvPace pace[2]; /* in flight; in fracture mode */
    double looked, looked_time;
    bool woken; /* something was in fracture mode */
} ShvProgress;

ShvProgress shv_progress_start(double duration, bool quiet);
/* Called often: shows where the simulation stands when it is time to. */
void shv_progress_tick(ShvProgress *progress);
void shv_progress_end(ShvProgress *progress);

#endif
