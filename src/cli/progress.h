/* Progress of long work on stderr: one line that renews itself on a terminal, a line every few seconds elsewhere. */
#ifndef SHV_CLI_PROGRESS_H
#define SHV_CLI_PROGRESS_H

#include "shiver/simulation.h"

/* What work costs in one mode: run time, and seconds of flight or of load (ShvAwakeView), of which what is long past counts less. */
typedef struct ShvCostRate {
    double wall, work;
} ShvCostRate;

enum { SHV_PROGRESS_GUESSES = 64 };

/* An earlier guess, by which later ones are judged: s since the start, and s to go. */
typedef struct ShvGuess {
    double wall, to_go;
} ShvGuess;

typedef struct ShvProgress {
    const ShvSimulation *simulation; /* NULL until it is made */
    double duration;                 /* s, simulated */
    bool quiet, terminal;
    double start, shown; /* wall clock, s */
    int64_t shown_steps;
    /* for the time to go */
    ShvCostRate rate_of[2]; /* in flight; in fracture mode */
    double sampled_at, sampled_time, sampled_load;
    ShvGuess guesses[SHV_PROGRESS_GUESSES]; /* about evenly over the run so far */
    int32_t guess_count;
    double guess_spacing; /* s */
    bool woken;           /* something was in fracture mode */
} ShvProgress;

ShvProgress shv_progress_start(double duration, bool quiet);
/* Called often: shows where the simulation stands when it is time to. */
void shv_progress_tick(ShvProgress *progress);
void shv_progress_end(ShvProgress *progress);

#endif
