/* Progress of long work on stderr: one line that renews itself on a terminal, a line every few seconds elsewhere. */
#ifndef SHV_CLI_PROGRESS_H
#define SHV_CLI_PROGRESS_H

#include "cli/time_to_go.h"

typedef struct ShvProgress {
    const ShvSimulation *simulation; /* NULL until it is made */
    bool quiet, terminal;
    double start, shown; /* wall clock, s */
    int64_t shown_steps;
    ShvTimeToGo estimate;
    double processor_start; /* s */
    double sampled, asking; /* s: wall clock when the simulation was asked last, and how long that took */
    bool woken;             /* steps of fracture mode were made */
} ShvProgress;

ShvProgress shv_progress_start(double duration, bool quiet);
/* Called often: shows where the simulation stands when it is time to. */
void shv_progress_tick(ShvProgress *progress);
void shv_progress_end(ShvProgress *progress);

#endif
