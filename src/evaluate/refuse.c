#include <math.h>
#include <string.h>

#include "evaluate/compare.h"

static ShvStatus check_steps(const ShvSceneDefinition *scene, const ShvCompareOptions *options, ShvError *error)
{
    if (options->step_count < 1 || options->step_count > SHV_MOST_COMPARED_STEPS)
        return shv_fail(error, SHV_BAD_INPUT, "a comparison takes 1 to %d time steps, not %d", SHV_MOST_COMPARED_STEPS,
                        (int)options->step_count);
    for (int32_t i = 0; i < options->step_count; i++) {
        const double step = options->steps[i];
        if (!(step > 0.0) || !(step <= scene->duration))
            return shv_fail(error, SHV_BAD_INPUT,
                            "a time step must be above 0 and at most the duration of %g s, not %g", scene->duration,
                            step);
        for (int32_t k = 0; k < i; k++)
            if (options->steps[k] == step)
                return shv_fail(error, SHV_BAD_INPUT, "the time step %g s is given twice", step);
    }
    return SHV_OK;
}

static ShvStatus check_engines(const ShvCompareOptions *options, ShvError *error)
{
    if (options->engine_count < 1 || options->engine_count > SHV_MOST_COMPARED_ENGINES)
        return shv_fail(error, SHV_BAD_INPUT, "a comparison takes 1 to %d engines, not %d", SHV_MOST_COMPARED_ENGINES,
                        (int)options->engine_count);
    for (int32_t i = 0; i < options->engine_count; i++)
        for (int32_t k = 0; k < i; k++)
            if (options->engines[k] == options->engines[i])
                return shv_fail(error, SHV_BAD_INPUT, "the engine %s is given twice",
                                shv_rigid_engine_name(options->engines[i]));
    return SHV_OK;
}

static const ShvMaterialDefinition *material_of(const ShvSceneDefinition *scene, const ShvObjectDefinition *object)
{
    for (int32_t i = 0; i < scene->material_count; i++)
        if (object->material && scene->materials[i].name && strcmp(scene->materials[i].name, object->material) == 0)
            return &scene->materials[i];
    return NULL;
}

static ShvStatus check_unbreakable(const ShvSceneDefinition *scene, ShvError *error)
{
    if (!scene->fracture.enabled) return SHV_OK;
    for (int32_t i = 0; i < scene->object_count; i++) {
        const ShvMaterialDefinition *material = material_of(scene, &scene->objects[i]);
        if (!material || !material->breakable || isinf(material->cohesive_strength)) continue;
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%s' can break, and a comparison is of rigid motion; set fracture.enabled to false or its "
                        "material's breakable to false",
                        scene->objects[i].name);
    }
    return SHV_OK;
}

static ShvStatus check_events(const ShvSceneDefinition *scene, ShvError *error)
{
    for (int32_t i = 0; i < scene->event_count; i++)
        if (scene->events[i].kind == SHV_EVENT_GRAVITY)
            return shv_fail(error, SHV_BAD_INPUT,
                            "gravity changes during the run, and energies could not be compared; remove that event");
    return SHV_OK;
}

ShvStatus shv_compare_check(const ShvSceneDefinition *scene, const ShvCompareOptions *options, ShvError *error)
{
    if (!scene || scene->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the scene definition did not start from shv_scene_default()");
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_compare_default()");
    SHV_TRY(check_engines(options, error));
    SHV_TRY(check_steps(scene, options, error));
    SHV_TRY(check_events(scene, error));
    return check_unbreakable(scene, error);
}
