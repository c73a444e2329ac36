#include "cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/timer.h"
#include "cli/command.h"

ShvProgress shv_progress_start(double duration, bool quiet)
{
    const double now = shv_now();
    return (ShvProgress){.quiet = quiet,
                         .terminal = isatty(STDERR_FILENO) == 1,
                         .start = now,
                         .shown = now,
                         .estimate = {.duration = duration},
                         .processor_start = shv_processor_now(),
                         .sampled = now};
}

/* Work is measured in processor time, which other programs leave alone, and told in run time at the rate of the run so far. */
static double run_time_to_go(const ShvProgress *progress, double now)
{
    const double processor = progress->estimate.last.processor - progress->processor_start;
    return shv_time_to_go(&progress->estimate) * (processor > 0.0 ? (now - progress->start) / processor : 1.0);
}

static void tell(const ShvProgress *progress, double to_go, char *text, size_t size)
{
    const double spread = shv_time_to_go_spread;
    if (isnan(to_go))
        snprintf(text, size, "time to go: cannot tell yet");
    else if (progress->estimate.unbreakable)
        snprintf(text, size, "about %.3g s to go", to_go);
    else if (!progress->woken)
        snprintf(text, size, "about %.3g s to go if nothing breaks", to_go);
    else
        snprintf(text, size, "%.2g to %.2g s to go: cracking decides", to_go / spread, to_go * spread);
}

/* In one piece, for whoever reads it from a pipe. */
static void show(ShvProgress *progress, double now)
{
    const ShvSimulationSummary *view = &progress->estimate.last.summary;
    const double steps = (double)(view->steps - progress->shown_steps) / (now - progress->shown);
    char to_go[96];
    tell(progress, run_time_to_go(progress, now), to_go, sizeof to_go);
    fprintf(stderr, "%st = %.6f of %.6g s, %s, %d fragments, %.0f steps/s, %.0f s run, %s%s",
            progress->terminal ? "\r\033[K" : "", view->time, progress->estimate.duration,
            view->fracture ? "fracture mode" : "in flight", (int)view->alive_count, steps, now - progress->start, to_go,
            progress->terminal ? "" : "\n");
    fflush(stderr);
    progress->shown = now;
    progress->shown_steps = view->steps;
}

/* Often enough to see flight and fracture mode apart, and at a fiftieth of the run time at most. */
static bool sample_is_due(const ShvProgress *progress, double now)
{
    const double least = 0.05, share = 0.02; /* s */
    return now - progress->sampled >= fmax(least, progress->asking / share);
}

void shv_progress_tick(ShvProgress *progress)
{
    const double line_every = progress->terminal ? 0.2 : 5.0; /* s */
    if (progress->quiet || !progress->simulation) return;
    const double now = shv_now();
    if (progress->estimate.begun && !sample_is_due(progress, now)) return;
    const ShvRunSample sample = {.processor = shv_processor_now(),
                                 .summary = shv_simulation_summary(progress->simulation),
                                 .awake = shv_simulation_awake(progress->simulation)};
    if (!progress->estimate.begun) progress->estimate.unbreakable = !shv_cli_can_break(progress->simulation);
    progress->sampled = now;
    progress->asking = shv_now() - now;
    progress->woken |= sample.awake.load > 0.0;
    shv_time_to_go_add(&progress->estimate, &sample);
    if (now - progress->shown >= line_every) show(progress, now);
}

void shv_progress_end(ShvProgress *progress)
{
    if (progress->terminal && !progress->quiet) fprintf(stderr, "\r\033[K");
}
