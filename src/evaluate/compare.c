#include "evaluate/compare.h"

#include "base/text.h"
#include "evaluate/digest.h"

static const struct {
    ShvRigidEngine engine;
    const char *name;
} engines[] = {{SHV_RIGID_BULLET, "bullet"},
               {SHV_RIGID_BULLET_PLAIN, "bullet_plain"},
               {SHV_RIGID_PBD, "pbd"},
               {SHV_RIGID_ANALYTIC, "analytic"}};

const char *shv_rigid_engine_name(ShvRigidEngine engine)
{
    for (size_t i = 0; i < sizeof engines / sizeof engines[0]; i++)
        if (engines[i].engine == engine) return engines[i].name;
    return "unknown";
}

ShvCompareOptions shv_compare_default(void)
{
    ShvCompareOptions options = {
        .cookie = SHV_DEFINITION_COOKIE, .engine_count = SHV_MOST_COMPARED_ENGINES, .steps = {1e-2, 1e-3, 1e-4}};
    options.step_count = 3;
    for (int i = 0; i < SHV_MOST_COMPARED_ENGINES; i++) options.engines[i] = engines[i].engine;
    return options;
}

/* ---- runs ---- */

static double coarsest_step(const ShvCompareOptions *options)
{
    double step = options->steps[0];
    for (int32_t i = 1; i < options->step_count; i++) step = fmax(step, options->steps[i]);
    return step;
}

/* Nothing wakes, whatever the scene says: rigid motion alone. Frames are the same in all runs, and no step is cut by one. */
static ShvSceneDefinition scene_of(const ShvComparison *comparison, ShvRigidEngine engine, double step)
{
    ShvSceneDefinition scene = *comparison->scene;
    scene.rigid.engine = engine;
    scene.rigid.time_step = step;
    scene.rigid.wake = SHV_WAKE_STRESS;
    scene.output.fracture_every = 0;
    scene.output.rate = fmin(scene.output.rate, 1.0 / coarsest_step(&comparison->options));
    return scene;
}

static ShvStatus make(const ShvComparison *comparison, const ShvSceneDefinition *scene, ShvSimulation **simulation,
                      ShvError *error)
{
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = comparison->options.folder;
    options.memory = comparison->memory;
    SHV_TRY(shv_simulation_create(simulation, scene, &options, error));
    const ShvStatus status = shv_simulation_advance(*simulation, error);
    if (status == SHV_OK) return SHV_OK;
    shv_simulation_destroy(*simulation);
    *simulation = NULL;
    return status;
}

/* The runner of studies does the run; of short ones the best of up to three times counts. */
static ShvStatus run_scene(const ShvComparison *comparison, const ShvComparedRun *view, ShvDigest *digest,
                           ShvError *error)
{
    enum { MOST_REPEATS = 3 };
    static const double short_run = 0.1;
    const ShvSceneDefinition scene = scene_of(comparison, view->engine, view->step);
    const ShvDigestOrder order = {.scene = &scene,
                                  .folder = comparison->options.folder,
                                  .memory = comparison->memory,
                                  .multiple = (double)NAN,
                                  .repeats = MOST_REPEATS,
                                  .repeat_below = short_run,
                                  .tracked = true};
    return shv_digest_run(digest, &order, error);
}

static ShvStatus follow(ShvComparison *comparison, const ShvDigest *digest, ShvComparedTrack *run, ShvError *error)
{
    shv_compare_rewind(comparison);
    for (int32_t i = 0; i < digest->frame_count; i++) {
        ShvTrackRow row;
        shv_compare_states(comparison, digest->states + (int64_t)i * digest->body_count, digest->times[i], i, &row);
        SHV_TRY(shv_track_add(&run->track, comparison->memory, &row, error));
    }
    return SHV_OK;
}

/* The states of the finest run stay. */
static void keep_finest(ShvComparison *comparison, ShvDigest *digest)
{
    comparison->finest = digest->states;
    comparison->finest_frames = digest->frame_count;
    digest->states = NULL;
}

static void take_times(const ShvComparison *comparison, const ShvDigest *digest, ShvComparedRun *view)
{
    view->seconds = digest->repeats > 0 ? digest->seconds[0] : 0.0;
    for (int32_t i = 1; i < digest->repeats; i++) view->seconds = fmin(view->seconds, digest->seconds[i]);
    view->seconds_per_step = view->seconds / ceil(comparison->scene->duration / view->step * (1.0 - 1e-9));
}

/* A run that fails is a result, unless that is not its own fault. */
static ShvStatus do_run(ShvComparison *comparison, ShvComparedTrack *run, ShvError *error)
{
    ShvComparedRun *view = &run->view;
    ShvDigest digest = {.memory = comparison->memory};
    if (comparison->options.begins) comparison->options.begins(comparison->options.data, view->engine, view->step);
    ShvStatus status = run_scene(comparison, view, &digest, error);
    if (status == SHV_OK) {
        view->status = digest.status;
        shv_format(view->message, sizeof view->message, "%s", digest.message);
        take_times(comparison, &digest, view);
        status = follow(comparison, &digest, run, error);
    }
    if (status == SHV_OK) {
        shv_compare_summarise(comparison, run);
        if (view->is_reference) keep_finest(comparison, &digest);
    }
    shv_digest_release(&digest);
    return status;
}

static ShvStatus do_finest(ShvComparison *comparison, ShvError *error)
{
    if (comparison->finest_run < 0) return SHV_OK;
    ShvComparedTrack *run = &comparison->runs[comparison->finest_run];
    SHV_TRY(do_run(comparison, run, error));
    if (run->view.status == SHV_OK) return SHV_OK;
    return shv_fail(error, run->view.status, "the run that the others are to be compared with failed: %s",
                    run->view.message);
}

static ShvStatus do_others(ShvComparison *comparison, ShvError *error)
{
    bool any = false;
    for (int32_t i = 0; i < comparison->count; i++) {
        if (i != comparison->finest_run) SHV_TRY(do_run(comparison, &comparison->runs[i], error));
        any |= comparison->runs[i].view.status == SHV_OK;
    }
    const ShvComparedRun *first = &comparison->runs[0].view;
    return any ? SHV_OK : shv_fail(error, first->status, "every run failed; the first: %s", first->message);
}

/* Bodies and reference come from a simulation that only shows its first frame. */
static ShvStatus look_at_start(ShvComparison *comparison, ShvError *error)
{
    const ShvSceneDefinition scene =
        scene_of(comparison, comparison->options.engines[0], shv_compare_finest_step(&comparison->options));
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(comparison, &scene, &simulation, error));
    ShvStatus status = shv_bodies_create(&comparison->bodies, comparison->scene, shv_simulation_frame(simulation),
                                         comparison->memory, error);
    if (status == SHV_OK)
        status = comparison->scene->reference.law == SHV_REFERENCE_NONE
                     ? shv_compare_with_finest(comparison, error)
                     : shv_compare_with_closed_form(comparison, simulation, error);
    shv_simulation_destroy(simulation);
    return status;
}

static ShvStatus list_runs(ShvComparison *comparison, ShvError *error)
{
    const ShvCompareOptions *options = &comparison->options;
    const size_t count = (size_t)options->engine_count * (size_t)options->step_count;
    comparison->runs = shv_allocate(comparison->memory, SHV_PART_RECORD, count, sizeof *comparison->runs);
    if (!comparison->runs) return shv_fail_memory(error, "the list of runs", count * sizeof *comparison->runs);
    for (int32_t e = 0; e < options->engine_count; e++)
        for (int32_t s = 0; s < options->step_count; s++) {
            ShvComparedRun *view = &comparison->runs[comparison->count++].view;
            view->engine = options->engines[e];
            view->step = options->steps[s];
        }
    return SHV_OK;
}

ShvStatus shv_compare(ShvComparison **comparison, const ShvSceneDefinition *scene, const ShvCompareOptions *given,
                      ShvError *error)
{
    *comparison = NULL;
    const ShvCompareOptions options = given ? *given : shv_compare_default();
    SHV_TRY(shv_compare_check(scene, &options, error));
    ShvComparison *made = shv_allocate(options.memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the comparison", sizeof *made);
    made->scene = scene;
    made->options = options;
    made->memory = options.memory;
    made->finest_run = -1;
    ShvStatus status = list_runs(made, error);
    if (status == SHV_OK) status = look_at_start(made, error);
    if (status == SHV_OK) status = do_finest(made, error);
    if (status == SHV_OK) status = do_others(made, error);
    if (status != SHV_OK) {
        shv_comparison_destroy(made);
        return status;
    }
    *comparison = made;
    return SHV_OK;
}

void shv_comparison_destroy(ShvComparison *comparison)
{
    if (!comparison) return;
    for (int32_t i = 0; i < comparison->count; i++) shv_track_release(&comparison->runs[i].track);
    shv_release(comparison->runs);
    shv_bodies_release(&comparison->bodies);
    shv_release(comparison->forms);
    shv_release(comparison->finest);
    shv_release(comparison);
}

int32_t shv_comparison_count(const ShvComparison *comparison)
{
    return comparison->count;
}

const ShvComparedRun *shv_comparison_run(const ShvComparison *comparison, int32_t index)
{
    return &comparison->runs[index].view;
}

const char *shv_comparison_reference(const ShvComparison *comparison)
{
    return comparison->reference;
}
