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
                         .sampled_at = now};
}

/* ---- time to go ---- */

/* Work of the last stretch to the pace of the mode that it was in. What cost so much a while ago says less: it counts by the
   share of the run that has passed since. */
static void measure(ShvProgress *progress, const ShvSimulationSummary *view, double load, double now)
{
    const double memory = 0.25; /* of the run so far */
    const double stretch = now - progress->sampled_at, run = now - progress->start,
                 time = view->time - progress->sampled_time;
    const bool awake = view->fracture && progress->sampled_load > 0.0;
    ShvCostRate *rate_of = &progress->rate_of[awake];
    const double kept = exp(-stretch / (memory * run + 1e-9));
    rate_of->wall = kept * rate_of->wall + stretch;
    rate_of->work = kept * rate_of->work + time * (awake ? 0.5 * (load + progress->sampled_load) : 1.0);
    progress->sampled_at = now;
    progress->sampled_time = view->time;
    progress->sampled_load = load;
    progress->woken |= view->fracture;
}

/* Run time of a second of flight or of load; in flight, before that has been seen, nothing. */
static double rate(const ShvCostRate *rate_of)
{
    return rate_of->work > 0.0 ? rate_of->wall / rate_of->work : 0.0;
}

/* Steps of what is awake until it may rest, and flight from there. */
static double time_to_go(const ShvProgress *progress, const ShvAwakeView *awake)
{
    return awake->ahead * rate(&progress->rate_of[1]) +
           fmax(0.0, progress->duration - awake->rest) * rate(&progress->rate_of[0]);
}

/* Where there is no more room every second guess goes. */
static void keep_guess(ShvProgress *progress, double wall, double to_go)
{
    ShvGuess *guesses = progress->guesses;
    if (progress->guess_count > 0 && wall < guesses[progress->guess_count - 1].wall + progress->guess_spacing) return;
    if (progress->guess_count == SHV_PROGRESS_GUESSES) {
        progress->guess_count /= 2;
        for (int32_t i = 0; i < progress->guess_count; i++) guesses[i] = guesses[2 * i];
        progress->guess_spacing = wall / progress->guess_count / 2.0;
    }
    guesses[progress->guess_count++] = (ShvGuess){wall, to_go};
}

/* A guess is told while those since half of the run so far would have been right, had this one been the truth: cracks that
   spread and pieces that wake again make all of them wrong. */
static bool is_told(const ShvProgress *progress, double wall, double to_go)
{
    const double trusted = 1.25; /* times */
    bool told = false;
    for (int32_t i = 0; i < progress->guess_count; i++) {
        const ShvGuess *guess = &progress->guesses[i];
        if (guess->wall < 0.5 * wall) continue;
        const double truth = wall + to_go - guess->wall;
        if (guess->to_go > trusted * truth || truth > trusted * guess->to_go) return false;
        told = true;
    }
    return told;
}

/* ---- the line ---- */

static void show(ShvProgress *progress, const ShvSimulationSummary *view, double to_go, double now)
{
    const double wall = now - progress->start;
    const double steps = (double)(view->steps - progress->shown_steps) / (now - progress->shown);
    const bool told = is_told(progress, wall, to_go);
    fprintf(stderr, "%st = %.6f of %.6g s, %s, %d fragments, %.0f steps/s, %.0f s run, ",
            progress->terminal ? "\r\033[K" : "", view->time, progress->duration,
            view->fracture ? "fracture mode" : "in flight", (int)view->alive_count, steps, wall);
    if (told)
        fprintf(stderr, "about %.3g s to go%s", to_go, progress->woken ? "" : " if nothing breaks");
    else
        fprintf(stderr, "time to go: cannot tell yet");
    if (!progress->terminal) fprintf(stderr, "\n");
    fflush(stderr);
    progress->shown = now;
    progress->shown_steps = view->steps;
}

void shv_progress_tick(ShvProgress *progress)
{
    const double sample_every = 0.05, line_every = progress->terminal ? 0.2 : 5.0; /* s */
    if (progress->quiet || !progress->simulation) return;
    const double now = shv_now();
    if (now - progress->sampled_at < sample_every) return;
    const ShvSimulationSummary view = shv_simulation_summary(progress->simulation);
    const ShvAwakeView awake = shv_simulation_awake(progress->simulation);
    measure(progress, &view, awake.load, now);
    const double to_go = time_to_go(progress, &awake);
    keep_guess(progress, now - progress->start, to_go);
    if (now - progress->shown >= line_every) show(progress, &view, to_go, now);
}

void shv_progress_end(ShvProgress *progress)
{
    if (progress->terminal && !progress->quiet) fprintf(stderr, "\r\033[K");
}
