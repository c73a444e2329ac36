#include "evaluate/outcome.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/text.h"
#include "base/timer.h"
#include "evaluate/sampler.h"
#include "record/checkpoint.h"
#include "record/processor.h"

/* s of run time from one checkpoint to the next, and the share of that which goes there at most: one part in so many. */
static const double INTERVAL = 30.0, SHARE = 100.0;

/* A run under way. */
typedef struct Pull {
    const ShvRunOrder *order;
    ShvSceneDefinition scene;
    ShvOutcome *outcome;
    ShvSampler sampler;
    ShvSimulation *simulation; /* NULL: nothing to save yet */
    ShvError own;              /* the run's own failure */
    double seconds;            /* s of run time, of all frames so far */
    double begun, due;         /* s: shv_now as the advance under way began; of the next checkpoint */
    uint64_t sequence;         /* of the last one */
} Pull;

/* ---- checkpoints: the state of the simulation and, as a note, the outcome so far ---- */

static ShvCheckpointMark mark_of(const Pull *pull)
{
    return (ShvCheckpointMark){.program = shv_checkpoint_program(),
                               .scene = pull->order->key,
                               .geometry = shv_simulation_geometry_hash(pull->simulation),
                               .sequence = pull->sequence};
}

static ShvStatus save(Pull *pull, ShvError *error)
{
    char *note = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&note, &size);
    if (!stream) return shv_fail_memory(error, "a checkpoint", 0);
    shv_outcome_set(pull->outcome, "run.so_far", pull->seconds + shv_now() - pull->begun);
    shv_outcome_put(pull->outcome, stream);
    ShvStatus status = fclose(stream) == 0 ? SHV_OK : shv_fail_memory(error, "a checkpoint", size);
    ShvCheckpointMark mark = mark_of(pull);
    mark.sequence = ++pull->sequence;
    if (status == SHV_OK)
        status = shv_checkpoint_write(pull->order->checkpoint, pull->order->memory, pull->simulation, &mark, note, size,
                                      error);
    free(note);
    return status;
}

/* ShvSimulationOptions.stop: saves the run when it is time to or it stops. */
static bool ask(void *data)
{
    Pull *pull = data;
    const ShvRunOrder *order = pull->order;
    const bool stops = order->stop && order->stop(order->stop_data);
    if (!order->checkpoint || !pull->simulation || !shv_simulation_has_checkpoints(pull->simulation)) return stops;
    const double start = shv_now();
    if (pull->due == 0.0) pull->due = start + INTERVAL;
    if (!stops && start < pull->due) return false;
    ShvError ignored; /* the run is then begun anew, if it comes to that */
    (void)save(pull, &ignored);
    const double end = shv_now();
    pull->due = end + fmax(INTERVAL, SHARE * (end - start));
    return stops;
}

/* What was gathered until then takes the place of the first frame. */
static bool take_note(Pull *pull, const ShvCheckpoint *found)
{
    ShvOutcome before;
    ShvError ignored;
    if (shv_outcome_parse(&before, (const char *)found->note, found->note_size, "a checkpoint", pull->order->memory,
                          &ignored) != SHV_OK)
        return false;
    shv_outcome_release(pull->outcome);
    *pull->outcome = before;
    shv_processor_name(pull->outcome->processor, sizeof pull->outcome->processor);
    pull->seconds = shv_outcome_number(pull->outcome, "run.so_far");
    return true;
}

/* Loads the latest checkpoint into a simulation of which the first frame has been asked for. What does not fit is as good as
   none; after another failure the simulation can only be destroyed. */
static ShvStatus go_on(Pull *pull, ShvError *error)
{
    const ShvRunOrder *order = pull->order;
    if (!order->checkpoint || !shv_simulation_has_checkpoints(pull->simulation)) return SHV_OK;
    ShvCheckpoint found;
    ShvError ignored;
    const ShvCheckpointMark own = mark_of(pull);
    ShvStatus status = shv_checkpoint_find(&found, order->checkpoint, order->memory, &own, NULL, NULL, &ignored);
    if (status == SHV_OK && found.descriptor >= 0 && take_note(pull, &found)) {
        pull->sequence = found.mark.sequence;
        status = shv_simulation_load(pull->simulation, found.descriptor, found.size, error);
    } else {
        status = SHV_OK;
    }
    shv_checkpoint_close(&found);
    return status;
}

/* ---- simulations ---- */

static ShvStatus make(const ShvRunOrder *order, const ShvSceneDefinition *scene, Pull *asked,
                      ShvSimulation **simulation, ShvError *error)
{
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = order->folder;
    options.memory = order->memory;
    options.audit_wakes = order->audit_wakes;
    options.stop = asked ? ask : order->stop;
    options.stop_data = asked ? asked : order->stop_data;
    return shv_simulation_create(simulation, scene, &options, error);
}

/* The stable step is that of the scene's own meshes, whatever step it asks for. */
static ShvStatus scale_step(Pull *pull, ShvError *error)
{
    ShvSceneDefinition scene = pull->scene;
    ShvSimulation *simulation = NULL;
    double stable = HUGE_VAL;
    if (isnan(pull->order->multiple)) return SHV_OK;
    scene.fracture.time_step = (double)NAN;
    SHV_TRY(make(pull->order, &scene, NULL, &simulation, error));
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < shv_simulation_object_count(simulation) && status == SHV_OK; i++) {
        ShvPreflight preflight;
        status = shv_simulation_preflight(simulation, i, &preflight, error);
        if (status == SHV_OK) stable = fmin(stable, preflight.stable_step);
    }
    shv_simulation_destroy(simulation);
    pull->scene.fracture.time_step = pull->order->multiple * stable;
    return status;
}

/* ---- the run ---- */

/* The next frame, its time and what is kept of it. */
static ShvStatus pull_frame(Pull *pull, ShvError *error)
{
    pull->begun = shv_now();
    const ShvStatus status = shv_simulation_advance(pull->simulation, &pull->own);
    const ShvFrameView *frame = shv_simulation_frame(pull->simulation);
    if (frame->steps > 0 || frame->time > 0.0) pull->seconds += shv_now() - pull->begun;
    if (status == SHV_INTERRUPTED || status == SHV_NO_MEMORY) return shv_fail(error, status, "%s", pull->own.message);
    pull->own.status = status;
    if (!pull->sampler.damage) SHV_TRY(shv_sample_start(&pull->sampler, pull->simulation, error));
    return shv_sample_frame(&pull->sampler, pull->simulation, error);
}

/* Frame by frame, or from a checkpoint on, to the end or to a failure. */
static ShvStatus pull_frames(Pull *pull, ShvError *error)
{
    SHV_TRY(pull_frame(pull, error));
    SHV_TRY(shv_sample_scene(&pull->sampler, pull->simulation, error));
    if (pull->own.status == SHV_OK) SHV_TRY(go_on(pull, error));
    while (pull->own.status == SHV_OK && !pull->order->look && !shv_simulation_finished(pull->simulation))
        SHV_TRY(pull_frame(pull, error));
    shv_outcome_add(pull->outcome, "run.seconds", SHV_CLOCK_NONE, pull->seconds);
    return shv_sample_end(&pull->sampler, pull->simulation, error);
}

static ShvStatus run_first(Pull *pull, ShvError *error)
{
    const double start = shv_now();
    ShvSimulation *simulation = NULL;
    ShvStatus status = scale_step(pull, &pull->own);
    if (status == SHV_OK) status = make(pull->order, &pull->scene, pull, &simulation, &pull->own);
    pull->simulation = simulation;
    pull->own.status = status;
    shv_outcome_set(pull->outcome, "run.setup", shv_now() - start);
    shv_outcome_set(pull->outcome, "run.begun", status == SHV_OK ? 1.0 : 0.0);
    if (status == SHV_NO_MEMORY) return shv_fail(error, status, "%s", pull->own.message);
    if (status != SHV_OK) return SHV_OK;
    status = pull_frames(pull, error);
    shv_pool_release(&pull->sampler.pool);
    shv_simulation_destroy(simulation);
    return status;
}

/* For its time alone. */
static ShvStatus repeat(Pull *pull, ShvError *error)
{
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(pull->order, &pull->scene, NULL, &simulation, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    const double start = shv_now();
    while (status == SHV_OK && !shv_simulation_finished(simulation)) status = shv_simulation_advance(simulation, error);
    shv_outcome_add(pull->outcome, "run.seconds", SHV_CLOCK_NONE, shv_now() - start);
    shv_simulation_destroy(simulation);
    return status;
}

static bool is_short(const ShvOutcome *outcome, double limit)
{
    const ShvOutcomeList *seconds = shv_outcome_find(outcome, "run.seconds");
    double sum = 0.0;
    for (int64_t i = 0; seconds && i < seconds->count; i++) sum += seconds->values[i];
    return limit == 0.0 || sum < limit;
}

ShvStatus shv_run_scene(ShvOutcome *outcome, const ShvRunOrder *order, ShvError *error)
{
    *outcome = (ShvOutcome){.memory = order->memory};
    Pull pull = {.order = order, .scene = *order->scene, .outcome = outcome, .own = {SHV_OK, ""}};
    pull.sampler = (ShvSampler){.outcome = outcome, .scene = order->scene, .pool = {.memory = order->memory}};
    shv_processor_name(outcome->processor, sizeof outcome->processor);
    SHV_TRY(run_first(&pull, error));
    outcome->key = order->key;
    outcome->status = pull.own.status;
    shv_format(outcome->message, sizeof outcome->message, "%.2047s", pull.own.message);
    for (int32_t i = 1; i < order->repeats && outcome->status == SHV_OK && is_short(outcome, order->repeat_below); i++)
        SHV_TRY(repeat(&pull, error));
    return outcome->failed ? shv_fail_memory(error, "what is kept of a run", 0) : SHV_OK;
}
