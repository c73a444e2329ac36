/* Progress of long work on stderr: one line that renews itself on a terminal, a line every few seconds elsewhere. */
#ifndef SHV_CLI_PROGRESS_H
#define SHV_CLI_PROGRESS_H

#include "shiver/simulation.h"

typedef struct ShvProgress {
    double duration;         /* s, simulated */
    bool quiet, terminal;
    double start, shown;     /* wall clock */
    double time;             /* s, simulated: of the last frame */
    bool fracture;
    int32_t fragments;
    int64_t steps, shown_steps;
} ShvProgress;

ShvProgress shv_progress_start(double duration, bool quiet);
/* Takes in a new frame. */
void shv_progress_frame(ShvProgress *progress, const ShvFrameView *frame);
/* Called often: shows what is known when it is time to. */
void shv_progress_tick(ShvProgress *progress);
void shv_progress_end(ShvProgress *progress);

#endif
