#include "cli/time_to_go.h"

#include <math.h>

const double shv_time_to_go_spread = 3.0;

/* What cost so much a while ago says less: it counts by the share of the run that has passed since. */
static void add_cost(ShvCostRate *rate, double kept, double processor, double work)
{
    rate->processor = kept * rate->processor + processor;
    rate->work = kept * rate->work + work;
}

/* Time in steps, not all of the time since the last sample: much of that may have been flown through. */
static double load_since(const ShvRunSample *last, const ShvRunSample *sample)
{
    const double in_steps = (double)(sample->summary.steps - last->summary.steps) * sample->awake.step;
    return in_steps * 0.5 * (last->awake.load + sample->awake.load);
}

void shv_time_to_go_add(ShvTimeToGo *estimate, const ShvRunSample *sample)
{
    const double memory = 0.5; /* of the run so far */
    if (!estimate->begun) {
        estimate->begun = true;
        estimate->start = sample->processor;
        estimate->last = *sample;
        return;
    }
    const double spent = sample->processor - estimate->last.processor, run = sample->processor - estimate->start;
    const double kept = exp(-spent / (memory * run + 1e-9)), load = load_since(&estimate->last, sample);
    if (load > 0.0)
        add_cost(&estimate->fracture, kept, spent, load);
    else
        add_cost(&estimate->flight, kept, spent, sample->summary.time - estimate->last.summary.time);
    estimate->load += load;
    estimate->last = *sample;
}

/* Cost of so much work; NaN where there is some and none has been seen. */
static double cost_of(const ShvCostRate *rate, double work)
{
    if (!(work > 0.0)) return 0.0;
    return rate->work > 0.0 ? work * rate->processor / rate->work : (double)NAN;
}

/* Pieces meet obstacles and each other, wake, and break on. Nothing at hand tells which will; what they come to is in proportion to what
   was done so far, and to the share of the simulated time that is left for it (docs/decisions.md). */
static double load_of_waking_again(const ShvTimeToGo *estimate)
{
    const double share = 0.8, now = estimate->last.summary.time;
    const double from = estimate->unbreakable ? fmax(now, estimate->last.awake.rest) : now;
    const double left = fmax(0.0, estimate->duration - from);
    return estimate->duration > 0.0 ? share * estimate->load * left / estimate->duration : 0.0;
}

/* Steps of what is awake until it rests, and of what wakes again; and flight from there, at no cost where none was seen since all
   began awake. */
double shv_time_to_go(const ShvTimeToGo *estimate)
{
    const ShvAwakeView *awake = &estimate->last.awake;
    if (!estimate->begun) return (double)NAN;
    const double flight = cost_of(&estimate->flight, estimate->duration - awake->rest);
    const double fracture = cost_of(&estimate->fracture, awake->ahead + load_of_waking_again(estimate));
    return fracture + (isnan(flight) && estimate->load > 0.0 ? 0.0 : flight);
}
