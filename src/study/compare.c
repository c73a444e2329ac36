#include "study/compare.h"

#include "base/text.h"
#include "base/timer.h"

static const struct {
    ShvRigidEngine engine;
    const char *name;
} engines[] = {{SHV_RIGID_BULLET, "bullet"}, {SHV_RIGID_PBD, "pbd"}, {SHV_RIGID_ANALYTIC, "analytic"}};

const char *shv_rigid_engine_name(ShvRigidEngine engine)
{
    for (size_t i = 0; i < sizeof engines / sizeof engines[0]; i++)
        if (engines[i].engine == engine) return engines[i].name;
    return "unknown";
}

ShvCompareOptions shv_compare_default(void)
{
    ShvCompareOptions options = {.cookie = SHV_DEFINITION_COOKIE, .engine_count = 3, .steps = {1e-2, 1e-3, 1e-4}};
    options.step_count = 3;
    for (int i = 0; i < 3; i++) options.engines[i] = engines[i].engine;
    return options;
}

/* ---- runs ---- */

static double coarsest_step(const ShvCompareOptions *options)
{
    double step = options->steps[0];
    for (int32_t i = 1; i < options->step_count; i++) step = fmax(step, options->steps[i]);
    return step;
}

/* Each run goes through the closed forms from the start. */
static void rewind_forms(ShvComparison *comparison)
{
    for (int32_t i = 0; comparison->forms && i < comparison->bodies.count; i++)
        comparison->forms[i].top.time = comparison->forms[i].top.turned = 0.0;
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

static ShvStatus pull(ShvComparison *comparison, ShvSimulation *simulation, ShvComparedTrack *run, ShvError *error)
{
    double seconds = 0.0;
    for (int32_t index = 0;; index++) {
        ShvTrackRow row;
        SHV_TRY(shv_compare_row(comparison, shv_simulation_frame(simulation), index, &row, error));
        SHV_TRY(shv_track_add(&run->track, comparison->memory, &row, error));
        run->view.seconds = seconds;
        if (shv_simulation_finished(simulation)) return SHV_OK;
        const double start = shv_now();
        SHV_TRY(shv_simulation_advance(simulation, error));
        seconds += shv_now() - start;
    }
}

/* A short run again, for its time alone. */
static ShvStatus time_again(const ShvComparison *comparison, const ShvSceneDefinition *scene, ShvComparedTrack *run,
                            ShvError *error)
{
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(comparison, scene, &simulation, error));
    const double start = shv_now();
    ShvStatus status = SHV_OK;
    while (status == SHV_OK && !shv_simulation_finished(simulation)) status = shv_simulation_advance(simulation, error);
    run->view.seconds = fmin(run->view.seconds, shv_now() - start);
    shv_simulation_destroy(simulation);
    return status;
}

static ShvStatus run_all_of(ShvComparison *comparison, ShvComparedTrack *run, ShvError *error)
{
    static const double short_run = 0.1;
    const ShvSceneDefinition scene = scene_of(comparison, run->view.engine, run->view.step);
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(comparison, &scene, &simulation, error));
    ShvStatus status = pull(comparison, simulation, run, error);
    shv_simulation_destroy(simulation);
    for (int again = 0; again < 2 && status == SHV_OK && run->view.seconds < short_run; again++)
        status = time_again(comparison, &scene, run, error);
    return status;
}

/* A run that fails is a result, unless that is not its own fault. */
static ShvStatus do_run(ShvComparison *comparison, ShvComparedTrack *run, ShvError *error)
{
    ShvError own = {.message = ""};
    ShvComparedRun *view = &run->view;
    if (comparison->options.begins) comparison->options.begins(comparison->options.data, view->engine, view->step);
    rewind_forms(comparison);
    view->status = run_all_of(comparison, run, &own);
    if (view->status == SHV_NO_MEMORY) return shv_fail(error, view->status, "%s", own.message);
    if (view->status != SHV_OK) shv_format(view->message, sizeof view->message, "%.255s", own.message);
    view->seconds_per_step = view->seconds / ceil(comparison->scene->duration / view->step * (1.0 - 1e-9));
    shv_compare_summarise(comparison, run);
    return SHV_OK;
}

static ShvStatus do_finest(ShvComparison *comparison, ShvError *error)
{
    if (comparison->finest_run < 0) return SHV_OK;
    ShvComparedTrack *run = &comparison->runs[comparison->finest_run];
    comparison->keeping = true;
    SHV_TRY(do_run(comparison, run, error));
    comparison->keeping = false;
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
