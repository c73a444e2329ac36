/* A plan's trial: the simulation itself runs for a while, in memory. What it holds before the first crack and what its steps cost
   depend on what meets what and on how much breaks, which nothing short of running it tells. */
#include <string.h>

#include "sim/internal.h"

enum { SAMPLES = 128 };

typedef struct Sample {
    double awake;     /* s simulated with something awake, since the trial began */
    double processor; /* s since then */
    int32_t inserted; /* facets */
} Sample;

typedef struct Watch {
    ShvHybrid *hybrid;
    bool (*stop)(void *data); /* the simulation's own */
    void *stop_data;
    bool interrupted; /* by that */
    double limit;     /* s of processor time; of run time a few times that */
    double start, processor_start;
    ShvTrial trial;
    size_t bytes[SHV_PART_COUNT]; /* at the last time before the first crack */
    double last_time;             /* s: simulated, when last noted */
    bool was_awake;
    double last_processor;
    double flown, flight; /* s simulated with nothing awake, and the processor time of that */
    double flight_before; /* s: cost of flight when something woke first */
    /* Of what is awake without a break until now, about evenly over processor time. */
    Sample samples[SAMPLES];
    int32_t count;
    double spacing; /* s of processor time */
} Watch;

static bool has_cracked(const ShvHybrid *hybrid)
{
    return hybrid->model.can_break && hybrid->cohesive.count > 0;
}

/* When there is no more room every second sample goes. */
static void take_sample(Watch *watch, double processor)
{
    if (watch->count > 0 && processor < watch->samples[watch->count - 1].processor + watch->spacing) return;
    if (watch->count == SAMPLES) {
        for (int32_t i = 0; i < SAMPLES / 2; i++) watch->samples[i] = watch->samples[2 * i];
        watch->count = SAMPLES / 2;
        watch->spacing = fmax(2.0 * watch->spacing, (processor - watch->samples[0].processor) / SAMPLES);
    }
    watch->samples[watch->count++] =
        (Sample){watch->trial.awake, processor, has_cracked(watch->hybrid) ? watch->hybrid->cohesive.count : 0};
}

static void note_time(Watch *watch)
{
    const ShvHybrid *hybrid = watch->hybrid;
    const double processor = shv_processor_now() - watch->processor_start;
    const double time = hybrid->state.time - watch->last_time, cost = processor - watch->last_processor;
    const bool awake = hybrid->awake.count > 0;
    watch->last_time = hybrid->state.time;
    watch->last_processor = processor;
    if (watch->was_awake) {
        watch->trial.awake += time;
    } else {
        watch->flown += time;
        watch->flight += cost;
    }
    if (!awake) watch->count = 0;
    if (awake) take_sample(watch, processor);
    if (awake && isnan(watch->trial.first_wake)) {
        watch->trial.first_wake = hybrid->state.time;
        watch->flight_before = hybrid->costs.seconds[SHV_COST_FLIGHT];
    }
    watch->was_awake = awake;
}

static void note_progress(Watch *watch)
{
    const ShvHybrid *hybrid = watch->hybrid;
    note_time(watch);
    if (!isnan(watch->trial.first_crack)) return;
    if (has_cracked(hybrid)) {
        watch->trial.first_crack = hybrid->state.time;
        return;
    }
    for (int i = 0; i < SHV_PART_COUNT; i++) watch->bytes[i] = shv_memory_bytes(hybrid->memory, (ShvPart)i);
}

/* Where others use the machine too the trial takes longer than its processor time, but not for ever. */
static bool is_over(const Watch *watch)
{
    return shv_processor_now() - watch->processor_start >= watch->limit ||
           shv_now() - watch->start >= 4.0 * watch->limit;
}

static bool note_and_stop(void *data)
{
    Watch *watch = data;
    note_progress(watch);
    watch->interrupted = watch->stop && watch->stop(watch->stop_data);
    return watch->interrupted || is_over(watch);
}

/* ---- what is to come ---- */

/* Processor time of a simulated second, over the last quarter of what is awake now, and how it has grown since the quarter
   before, s/s². */
static double rate_of(const Watch *watch, double *growth)
{
    const int32_t last = watch->count - 1, quarter = watch->count / 4;
    *growth = 0.0;
    if (quarter < 1) return (double)NAN;
    const Sample *end = &watch->samples[last], *middle = end - quarter, *begin = middle - quarter;
    const double late = end->awake - middle->awake, early = middle->awake - begin->awake;
    if (!(late > 0.0)) return (double)NAN;
    const double rate = (end->processor - middle->processor) / late;
    if (early > 0.0 && middle->inserted > 0) {
        const double before = (middle->processor - begin->processor) / early;
        /* No faster than facets come: what is left of a difference is the machine's. */
        const double facets = (double)(end->inserted - middle->inserted) / middle->inserted / late;
        *growth = fmin(rate * facets, fmax(0.0, (rate - before) / (0.5 * (late + early))));
    }
    return rate;
}

/* Seconds for which something stays awake from now on: at least and at most, if nothing more breaks. */
static void time_to_rest(const ShvHybrid *hybrid, double *least, double *most)
{
    double soonest = hybrid->state.time, latest = hybrid->state.time;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FRACTURE) continue;
        double from, to;
        shv_hybrid_rest_between(hybrid, fragment, &from, &to);
        soonest = fmax(soonest, from);
        latest = fmax(latest, to);
    }
    *least = fmin(soonest, hybrid->scene->duration) - hybrid->state.time;
    *most = fmin(latest, hybrid->scene->duration) - hybrid->state.time;
}

/* What flies beside the awake, once it has broken, costs more than what flew before. */
static double rate_of_pieces(const Watch *watch, double flight_rate)
{
    const double beside = watch->hybrid->costs.seconds[SHV_COST_FLIGHT] - watch->flight_before;
    return watch->trial.awake > 0.0 ? fmax(flight_rate, beside / watch->trial.awake) : flight_rate;
}

/* Pieces meet each other and obstacles again, wake, and break on: of seven scenes that crack, four took longer than what was awake
   at the end of their trials came to at most, up to 3.7 times as long (scenes/studies/time_to_go.py). */
static const double waking_again = 5.0;

/* Steps are dearest while cracks spread, and cheaper again when pieces part and rest: what they cost on the whole until now is the
   guess for what is to come, and the growth of late the upper bound. */
static ShvStatus predict_awake(Watch *watch, double flight_rate, ShvError *error)
{
    ShvHybrid *hybrid = watch->hybrid;
    ShvTrial *trial = &watch->trial;
    double least, most, expected, growth;
    time_to_rest(hybrid, &least, &most);
    SHV_TRY(shv_hybrid_expect_rest(hybrid, hybrid->scene->duration, &expected, error));
    double rate = rate_of(watch, &growth);
    const double mean = trial->awake > 0.0 ? (trial->processor - watch->flight) / trial->awake : 0.0;
    if (isnan(rate)) rate = mean;
    const double left = hybrid->scene->duration - hybrid->state.time, pieces = rate_of_pieces(watch, flight_rate);
    trial->predicted = trial->processor + mean * expected + pieces * (left - expected);
    trial->low = fmin(trial->predicted, trial->processor + fmin(rate, mean) * least + flight_rate * (left - least));
    trial->high =
        fmax(trial->predicted, trial->processor + (rate + 0.5 * growth * most) * most + pieces * (left - most));
    if (has_cracked(hybrid)) trial->high *= waking_again;
    return SHV_OK;
}

/* A second of flight costs up to so many times what it did, or as little of it: piles gather, and go to sleep. */
static const double uneven_flight = 1.5;

/* Nothing is awake: flight to the end, and pieces may wake again; before the first impact also the least that the static plan expects after it. */
static void predict_flight(Watch *watch, const ShvPlan *plan, double flight_rate)
{
    ShvTrial *trial = &watch->trial;
    const double left = watch->hybrid->scene->duration - watch->hybrid->state.time;
    const double flight = rate_of_pieces(watch, flight_rate) * left;
    const double awake = isnan(trial->first_wake) ? plan->predicted_seconds : 0.0;
    trial->low = trial->processor + flight / uneven_flight;
    trial->predicted = trial->processor + flight + awake;
    trial->high = trial->processor + flight * uneven_flight + awake;
    if (has_cracked(watch->hybrid)) trial->high *= waking_again;
}

static ShvStatus predict(Watch *watch, const ShvPlan *plan, ShvError *error)
{
    ShvTrial *trial = &watch->trial;
    const double flight_rate = watch->flown > 0.0 ? watch->flight / watch->flown : 0.0;
    trial->low = trial->predicted = trial->high = trial->processor;
    if (trial->finished) return SHV_OK;
    if (watch->hybrid->awake.count > 0) return predict_awake(watch, flight_rate, error);
    predict_flight(watch, plan, flight_rate);
    return SHV_OK;
}

/* ---- the trial ---- */

/* Bytes of the plan: what was held before the first crack, where the trial got there or to the end; else at least what was
   planned. */
static void take_bytes(const Watch *watch, ShvPlan *plan)
{
    const size_t planned_bars = plan->bars;
    size_t bytes[SHV_PART_COUNT];
    memcpy(bytes, watch->bytes, sizeof bytes);
    if (isnan(watch->trial.first_crack) && !watch->trial.finished && bytes[SHV_PART_BARS] < planned_bars)
        bytes[SHV_PART_BARS] = planned_bars;
    shv_plan_list(watch->hybrid, bytes, plan);
}

static ShvStatus run(ShvSimulation *simulation, Watch *watch, ShvError *error)
{
    ShvStatus status = SHV_OK;
    while (status == SHV_OK && !shv_simulation_finished(simulation)) {
        status = shv_simulation_advance(simulation, error);
        note_progress(watch);
        if (is_over(watch)) break;
    }
    return status == SHV_INTERRUPTED && !watch->interrupted ? SHV_OK : status;
}

static int32_t count_untouched(const ShvHybrid *hybrid)
{
    int32_t count = 0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        count += fragment->parent < 0 && fragment->mode == SHV_MODE_FLIGHT && fragment->wake_energy == 0.0 &&
                 isfinite(fragment->strength);
    }
    return count;
}

ShvStatus shv_simulation_try(ShvSimulation *simulation, double seconds, ShvPlan *plan, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    Watch watch = {.hybrid = hybrid,
                   .stop = hybrid->stop,
                   .stop_data = hybrid->stop_data,
                   .limit = seconds,
                   .start = shv_now(),
                   .processor_start = shv_processor_now(),
                   .last_time = hybrid->state.time,
                   .was_awake = hybrid->awake.count > 0,
                   .trial = {.first_wake = (double)NAN, .first_crack = (double)NAN}};
    if (!(seconds > 0.0)) return SHV_OK;
    note_progress(&watch);
    hybrid->stop = note_and_stop;
    hybrid->stop_data = &watch;
    ShvStatus status = run(simulation, &watch, error);
    hybrid->stop = watch.stop;
    hybrid->stop_data = watch.stop_data;
    ShvTrial *trial = &watch.trial;
    trial->seconds = shv_now() - watch.start;
    trial->processor = shv_processor_now() - watch.processor_start;
    trial->time = hybrid->state.time;
    trial->finished = shv_simulation_finished(simulation);
    trial->steps = hybrid->state.step;
    trial->inserted = hybrid->model.can_break ? hybrid->cohesive.count : 0;
    trial->fragments = hybrid->fragments.alive;
    trial->untouched = count_untouched(hybrid);
    if (status == SHV_OK) status = predict(&watch, plan, error);
    plan->trial = *trial;
    take_bytes(&watch, plan);
    return status;
}
