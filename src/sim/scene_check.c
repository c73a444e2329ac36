/* What a scene made in C may get wrong where no part of the solver would notice: numbers and names that only steer the run. Parts
   check what they build from: materials, meshes, obstacles and conditions. */
#include <stdio.h>
#include <string.h>

#include "sim/internal.h"

typedef struct NumberRule {
    const char *name;
    double value, least, most;
    bool above; /* more than `least`, not equal to it */
} NumberRule;

static ShvStatus check_number(const NumberRule *rule, ShvError *error)
{
    const bool enough = rule->above ? rule->value > rule->least : rule->value >= rule->least;
    if (enough && rule->value <= rule->most && isfinite(rule->value)) return SHV_OK;
    if (isfinite(rule->most))
        return shv_fail(error, SHV_BAD_INPUT, "%s must be a number %s %g and at most %g, not %g", rule->name,
                        rule->above ? "above" : "of at least", rule->least, rule->most, rule->value);
    return shv_fail(error, SHV_BAD_INPUT, "%s must be a finite number %s %g, not %g", rule->name,
                    rule->above ? "above" : "of at least", rule->least, rule->value);
}

static double bound_or_none(double bound)
{
    return isinf(bound) && bound > 0.0 ? 1.0 : bound;
}

static ShvStatus check_numbers(const ShvSceneDefinition *scene, ShvError *error)
{
    const ShvFractureDefinition *fracture = &scene->fracture;
    const ShvAuditDefinition *audit = &scene->audit;
    const double any = (double)INFINITY;
    const NumberRule rules[] = {
        {"duration", scene->duration, 0.0, any, false},
        {"output.rate", scene->output.rate, 0.0, any, true},
        {"output.fracture_every", (double)scene->output.fracture_every, 0.0, any, false},
        {"output.probe_every", (double)scene->output.probe_every, 1.0, any, false},
        {"output.probe_interval", scene->output.probe_interval, 0.0, any, false},
        {"output.nodes_within.from", scene->output.nodes_within.from, 0.0, any, false},
        {"output.nodes_within.every", (double)scene->output.nodes_within.every, 1.0, any, false},
        {"gravity x", scene->gravity[0], -any, any, false},
        {"gravity y", scene->gravity[1], -any, any, false},
        {"gravity z", scene->gravity[2], -any, any, false},
        {"rigid.time_step", scene->rigid.time_step, 0.0, any, true},
        {"rigid.wake_fraction", scene->rigid.wake_fraction, 0.0, any, true},
        {"rigid.wake_factor", scene->rigid.wake_factor, 0.0, any, true},
        {"rigid.friction", scene->rigid.friction, 0.0, any, false},
        {"rigid.restitution", scene->rigid.restitution, 0.0, 1.0, false},
        {"rigid.dust_size", scene->rigid.dust_size, 0.0, any, scene->rigid.dust != SHV_DUST_KEEP},
        {"audit.momentum", bound_or_none(audit->momentum), 0.0, any, true},
        {"audit.dropped_share", bound_or_none(audit->dropped_share), 0.0, any, true},
        {"audit.hull_error", bound_or_none(audit->hull_error), 0.0, any, true},
        {"fracture.time_step", isnan(fracture->time_step) ? 1.0 : fracture->time_step, 0.0, any, true},
        {"fracture.safety", fracture->safety, 0.0, 1.0, true},
        {"fracture.check_every", fracture->check_every, 0.0, any, false},
        {"fracture.threshold", fracture->threshold, 0.0, 1.0, true},
        {"fracture.regularisation", fracture->regularisation, 0.0, 1.0, true},
        {"fracture.quiet_checks", fracture->quiet_checks, 1.0, any, false},
        {"fracture.longest", fracture->longest, 0.0, any, false},
        {"fracture.energy_bound", fracture->energy_bound, 0.0, any, true},
        {"pbd.stiffness", scene->pbd.stiffness, 0.0, 1.0, false},
        {"pbd.iterations", scene->pbd.iterations, 1.0, any, false},
        {"pbd.damping", scene->pbd.damping, 0.0, 1.0, false},
        {"bullet_plain.unit", scene->bullet_plain.unit, 0.0, any, true},
        {"bullet_plain.margin", scene->bullet_plain.margin, 0.0, any, false},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++) SHV_TRY(check_number(&rules[i], error));
    return SHV_OK;
}

static bool is_object(const ShvSceneDefinition *scene, const char *name)
{
    for (int32_t i = 0; i < scene->object_count; i++)
        if (scene->objects[i].name && strcmp(scene->objects[i].name, name) == 0) return true;
    return false;
}

static bool is_free_obstacle(const ShvSceneDefinition *scene, const char *name)
{
    for (int32_t i = 0; i < scene->obstacle_count; i++) {
        const ShvObstacleDefinition *obstacle = &scene->obstacles[i];
        if (obstacle->name && obstacle->motion == SHV_OBSTACLE_FREE && strcmp(obstacle->name, name) == 0) return true;
    }
    return false;
}

static bool is_condition(const ShvSceneDefinition *scene, const char *name)
{
    for (int32_t i = 0; i < scene->condition_count; i++)
        if (scene->conditions[i].name && strcmp(scene->conditions[i].name, name) == 0) return true;
    return false;
}

static ShvStatus check_target(const ShvSceneDefinition *scene, const ShvEventDefinition *event, const char *what,
                              ShvError *error)
{
    if (event->kind == SHV_EVENT_GRAVITY) return SHV_OK;
    const char *name = event->target ? event->target : "";
    if (event->kind == SHV_EVENT_RELEASE)
        return is_condition(scene, name)
                   ? SHV_OK
                   : shv_fail(error, SHV_BAD_INPUT, "%s releases '%s', which is no condition", what, name);
    if (is_object(scene, name) || is_free_obstacle(scene, name)) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "%s acts on '%s', which is neither an object nor a free obstacle", what,
                    name);
}

ShvStatus shv_simulation_check_event(const ShvSceneDefinition *scene, const ShvEventDefinition *event, const char *what,
                                     ShvError *error)
{
    if (event->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "%s did not start from shv_event_default()", what);
    if (!(event->time >= 0.0) || !isfinite(event->time))
        return shv_fail(error, SHV_BAD_INPUT, "%s needs a time of 0 or more, not %g s", what, event->time);
    if (!shv_finite3(shv_load3(event->value)) || !shv_finite3(shv_load3(event->angular)))
        return shv_fail(error, SHV_BAD_INPUT, "%s needs finite numbers", what);
    return check_target(scene, event, what, error);
}

static ShvStatus check_events(const ShvSceneDefinition *scene, ShvError *error)
{
    for (int32_t i = 0; i < scene->event_count; i++) {
        char what[32];
        snprintf(what, sizeof what, "event %d", (int)i);
        SHV_TRY(shv_simulation_check_event(scene, &scene->events[i], what, error));
        if (i > 0 && scene->events[i].time < scene->events[i - 1].time)
            return shv_fail(error, SHV_BAD_INPUT,
                            "event %d at %g s comes after one at %g s; give events by increasing time", (int)i,
                            scene->events[i].time, scene->events[i - 1].time);
    }
    return SHV_OK;
}

/* What is not in the scene at the start can neither be held nor stretch there. */
static ShvStatus check_waiting(const ShvSceneDefinition *scene, ShvError *error)
{
    for (int32_t i = 0; i < scene->object_count; i++) {
        const ShvObjectDefinition *object = &scene->objects[i];
        if (!object->waits || !object->name) continue;
        for (int32_t k = 0; k < scene->condition_count; k++)
            if (scene->conditions[k].object && strcmp(scene->conditions[k].object, object->name) == 0)
                return shv_fail(error, SHV_BAD_INPUT, "'%s' waits outside of the scene and cannot be held by '%s'",
                                object->name, scene->conditions[k].name);
        if (shv_norm(shv_load3(object->placement.stretch_rate)) > 0.0)
            return shv_fail(error, SHV_BAD_INPUT, "'%s' waits outside of the scene and cannot start stretching",
                            object->name);
    }
    for (int32_t i = 0; i < scene->obstacle_count; i++)
        if (scene->obstacles[i].waits && scene->obstacles[i].motion != SHV_OBSTACLE_FREE)
            return shv_fail(error, SHV_BAD_INPUT, "the obstacle '%s' waits, but only free ones can: give it a mass",
                            scene->obstacles[i].name ? scene->obstacles[i].name : "");
    return SHV_OK;
}

ShvStatus shv_simulation_check_scene(const ShvSceneDefinition *scene, ShvError *error)
{
    if (!scene || scene->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the scene definition did not start from shv_scene_default()");
    SHV_TRY(check_numbers(scene, error));
    SHV_TRY(check_events(scene, error));
    return check_waiting(scene, error);
}
