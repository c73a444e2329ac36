#include "cli/progress.h"

#include <stdio.h>
#include <unistd.h>

#include "base/timer.h"

ShvProgress shv_progress_start(double duration, bool quiet)
{
    const double now = shv_now();
    return (ShvProgress){
        .duration = duration, .quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1, .start = now, .shown = now};
}

static void show(ShvProgress *progress, double now)
{
    const ShvMomentView view = shv_simulation_moment(progress->simulation);
    const double wall = now - progress->start;
    const double rate = (double)(view.steps - progress->shown_steps) / (now - progress->shown);
    const double remaining = view.time > 0.0 ? wall * (progress->duration / view.time - 1.0) : 0.0;
    fprintf(stderr, "%st = %.6f of %.6g s, %s, %d fragments, %.0f steps/s, %.0f s run, about %.0f s to go%s",
            progress->terminal ? "\r\033[K" : "", view.time, progress->duration,
            view.fracture ? "fracture mode" : "in flight", (int)view.alive_count, rate, wall, remaining,
            progress->terminal ? "" : "\n");
    fflush(stderr);
    progress->shown = now;
    progress->shown_steps = view.steps;
}

void shv_progress_tick(ShvProgress *progress)
{
    if (progress->quiet || !progress->simulation) return;
    const double now = shv_now();
    if (now - progress->shown >= (progress->terminal ? 0.2 : 5.0)) show(progress, now);
}

void shv_progress_end(ShvProgress *progress)
{
    if (progress->terminal && !progress->quiet) fprintf(stderr, "\r\033[K");
}
