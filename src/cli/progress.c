#include "cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

#include "base/timer.h"
#include "shiver/plan.h"

ShvProgress shv_progress_start(double duration, bool quiet)
{
    const double now = shv_now();
    return (ShvProgress){.duration = duration,
                         .quiet = quiet,
                         .terminal = isatty(STDERR_FILENO) == 1,
                         .start = now,
                         .shown = now,
                         .looked = now};
}

/* ---- time to go ---- */

/* Work of the last stretch to the pace of the mode that it was in. What cost so much a while ago says less: it counts by the
   share of the run that has passed since. */
static void measure(ShvProgress *progress, const ShvMomentView *view, double now)
{
    const double memory = 0.25; /* of the run so far */
    const double stretch = now - progress->looked, run = now - progress->start;
    ShvPace *pace = &progress->pace[view->fracture];
    const double kept = exp(-stretch / (memory * run + 1e-9));
    pace->wall = kept * pace->wall + stretch;
    pace->time = kept * pace->time + (view->time - progress->looked_time);
    progress->looked = now;
    progress->looked_time = view->time;
    progress->woken |= view->fracture;
}

/* Run time of a simulated second; in flight, before that has been seen, nothing. */
static double rate(const ShvPace *pace)
{
    return pace->time > 0.0 ? pace->wall / pace->time : 0.0;
}

/* From what is awake until it may rest, at the pace of that, and flight from there. */
static double time_to_go(const ShvProgress *progress, const ShvMomentView *view)
{
    const double rest = view->fracture ? shv_simulation_awake_until(progress->simulation) : view->time;
    const double awake = fmax(0.0, fmin(rest, progress->duration) - view->time);
    const double flight = fmax(0.0, progress->duration - view->time - awake);
    return awake * rate(&progress->pace[1]) + flight * rate(&progress->pace[0]);
}

/* ---- the line ---- */

static void show(ShvProgress *progress, const ShvMomentView *view, double now)
{
    const double wall = now - progress->start;
    const double steps = (double)(view->steps - progress->shown_steps) / (now - progress->shown);
    fprintf(stderr, "%st = %.6f of %.6g s, %s, %d fragments, %.0f steps/s, %.0f s run, about %.0f s to go%s%s",
            progress->terminal ? "\r\033[K" : "", view->time, progress->duration,
            view->fracture ? "fracture mode" : "in flight", (int)view->alive_count, steps, wall,
            time_to_go(progress, view), progress->woken ? "" : " if nothing breaks", progress->terminal ? "" : "\n");
    fflush(stderr);
    progress->shown = now;
    progress->shown_steps = view->steps;
}

void shv_progress_tick(ShvProgress *progress)
{
    const double look_every = 0.05, line_every = progress->terminal ? 0.2 : 5.0; /* s */
    if (progress->quiet || !progress->simulation) return;
    const double now = shv_now();
    if (now - progress->looked < look_every) return;
    const ShvMomentView view = shv_simulation_moment(progress->simulation);
    measure(progress, &view, now);
    if (now - progress->shown >= line_every) show(progress, &view, now);
}

void shv_progress_end(ShvProgress *progress)
{
    if (progress->terminal && !progress->quiet) fprintf(stderr, "\r\033[K");
}
