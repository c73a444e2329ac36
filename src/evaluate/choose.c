/* What the runs of a comparison are compared with. */
#include <string.h>

#include "base/text.h"
#include "evaluate/compare.h"

double shv_compare_finest_step(const ShvCompareOptions *options)
{
    double step = options->steps[0];
    for (int32_t i = 1; i < options->step_count; i++) step = fmin(step, options->steps[i]);
    return step;
}

static int32_t find_run(const ShvComparison *comparison, ShvRigidEngine engine)
{
    const double step = shv_compare_finest_step(&comparison->options);
    for (int32_t i = 0; i < comparison->count; i++)
        if (comparison->runs[i].view.engine == engine && comparison->runs[i].view.step == step) return i;
    return -1;
}

/* Bodies that could meet need an engine in which they see each other. */
ShvStatus shv_compare_with_finest(ShvComparison *comparison, ShvError *error)
{
    const bool several = comparison->bodies.count > 1;
    int32_t run = find_run(comparison, several ? SHV_RIGID_BULLET : SHV_RIGID_ANALYTIC);
    if (run < 0) run = find_run(comparison, several ? SHV_RIGID_ANALYTIC : SHV_RIGID_BULLET);
    if (run < 0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the scene names no `reference`, and none of the engines can stand for it; add bullet or "
                        "analytic");
    comparison->finest_run = run;
    comparison->runs[run].view.is_reference = true;
    for (int32_t i = 0; i < comparison->bodies.count; i++) comparison->bodies.items[i].chosen = true;
    shv_format(comparison->reference, sizeof comparison->reference, "finest run (%s at %g s)",
               shv_rigid_engine_name(comparison->runs[run].view.engine), comparison->runs[run].view.step);
    return SHV_OK;
}

static ShvStatus choose_bodies(ShvComparison *comparison, const char *name, ShvError *error)
{
    bool any = false;
    for (int32_t i = 0; i < comparison->bodies.count; i++) {
        ShvBody *body = &comparison->bodies.items[i];
        body->chosen = !name || strcmp(body->name, name) == 0;
        any |= body->chosen;
    }
    if (any) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "reference.body must name an object or a free obstacle, not '%s'", name);
}

static void name_closed_form(ShvComparison *comparison)
{
    static const char *const laws[] = {"none", "flight", "bounce", "slide", "roll", "rest"};
    const ShvReferenceDefinition *reference = &comparison->scene->reference;
    shv_format(comparison->reference, sizeof comparison->reference, "closed form (%s of %.60s%s%.60s)",
               laws[reference->law], reference->body ? reference->body : "every body", reference->on ? " on " : "",
               reference->on ? reference->on : "");
}

ShvStatus shv_compare_with_closed_form(ShvComparison *comparison, const ShvSimulation *simulation, ShvError *error)
{
    const ShvSceneDefinition *scene = comparison->scene;
    const size_t count = (size_t)comparison->bodies.count;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    if (!scene->reference.body && scene->reference.law != SHV_REFERENCE_FLIGHT &&
        scene->reference.law != SHV_REFERENCE_REST)
        return shv_fail(error, SHV_BAD_INPUT, "this law of `reference` needs `body`");
    SHV_TRY(choose_bodies(comparison, scene->reference.body, error));
    comparison->forms = shv_allocate(comparison->memory, SHV_PART_RECORD, count, sizeof *comparison->forms);
    if (!comparison->forms) return shv_fail_memory(error, "closed forms", count * sizeof *comparison->forms);
    for (size_t i = 0; i < count; i++) {
        const ShvBody *body = &comparison->bodies.items[i];
        const ShvBodyState start = shv_body_state(body, shv_simulation_frame(simulation));
        if (body->chosen) SHV_TRY(shv_closed_form(&comparison->forms[i], scene, &mesh, body, &start, error));
    }
    name_closed_form(comparison);
    return SHV_OK;
}
