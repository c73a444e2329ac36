/* Bodies on supports that nothing has touched yet. They are awake, since flight cannot hold them; but as long as nothing comes near,
   nothing happens in them, and time jumps from one rigid interval to the next. Their weight comes on when they stir, as it does
   at the start of a run: only a body whose weight could not wake it in flight may be dormant. */
#include <string.h>

#include "coupling/hybrid.h"

static bool is_of(const ShvConditionDefinition *condition, const char *object)
{
    return condition->object && strcmp(condition->object, object) == 0;
}

/* By supports alone, from start to end. */
static bool is_supported(const ShvSceneDefinition *scene, const char *object)
{
    for (int32_t i = 0; i < scene->condition_count; i++) {
        const ShvConditionDefinition *condition = &scene->conditions[i];
        if (!is_of(condition, object)) continue;
        if (condition->kind != SHV_CONDITION_SUPPORT || condition->start > 0.0 || !isinf(condition->end)) return false;
    }
    return true;
}

static bool is_still(const ShvPlacement *placement)
{
    return shv_norm(shv_load3(placement->velocity)) + shv_norm(shv_load3(placement->angular_velocity)) +
               shv_norm(shv_load3(placement->stretch_rate)) ==
           0.0;
}

static bool may_be_dormant(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const ShvObject *object = &hybrid->model.objects[fragment->object];
    const double weight = fragment->mass * shv_norm(shv_load3(hybrid->gravity));
    return isfinite(fragment->strength) && is_supported(hybrid->scene, object->name) &&
           is_still(&hybrid->scene->objects[fragment->object].placement) &&
           shv_hybrid_load_stress(fragment, weight) < hybrid->scene->rigid.wake_fraction * fragment->strength;
}

/* Probes want to see every step; bars move nodes by themselves. */
void shv_hybrid_make_dormant(ShvHybrid *hybrid)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    hybrid->awake.dormant = hybrid->awake.count > 0 && hybrid->coupling.mutual && !hybrid->stabiliser.active &&
                            scene->probe_count == 0 && scene->fracture.enabled;
    for (int32_t i = 0; i < hybrid->fragments.count && hybrid->awake.dormant; i++)
        if (hybrid->fragments.items[i].mode == SHV_MODE_FRACTURE)
            hybrid->awake.dormant = may_be_dormant(hybrid, &hybrid->fragments.items[i]);
}

/* Distance of a point from the box of a body that has not moved, m. */
static double distance_from(const ShvFragment *fragment, ShvVec3 point)
{
    const ShvVec3 x = shv_sub(point, fragment->reference_centre);
    const ShvVec3 out = {fmax(0.0, fmax(fragment->low.x - x.x, x.x - fragment->high.x)),
                         fmax(0.0, fmax(fragment->low.y - x.y, x.y - fragment->high.y)),
                         fmax(0.0, fmax(fragment->low.z - x.z, x.z - fragment->high.z))};
    return shv_norm(out);
}

/* Whether what is at a place, with a radius about it, may meet the body within an interval. */
static bool comes_near(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvVec3 position, double radius,
                       double speed, double interval)
{
    const double gained = shv_norm(shv_load3(hybrid->gravity)) * interval;
    return !(distance_from(fragment, position) >
             radius + 2.0 * (speed + gained) * interval); /* 2: for rounding, and more */
}

static bool is_visited(const ShvHybrid *hybrid, const ShvFragment *fragment, double interval)
{
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        const ShvObstacle *o = &hybrid->obstacles.items[i];
        const double speed = shv_norm(o->velocity) + shv_norm(o->angular_velocity) * o->bounding_radius;
        if (o->motion != SHV_OBSTACLE_FIXED &&
            comes_near(hybrid, fragment, o->position, o->bounding_radius, speed, interval))
            return true;
    }
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *f = &hybrid->fragments.items[i];
        const double speed = shv_norm(f->velocity) + shv_norm(f->angular_velocity) * f->radius;
        if (f->mode == SHV_MODE_FLIGHT && comes_near(hybrid, fragment, f->position, f->radius, speed, interval))
            return true;
    }
    return false;
}

void shv_hybrid_end_dormancy(ShvHybrid *hybrid)
{
    const double interval = hybrid->interval_end - hybrid->state.time;
    for (int32_t i = 0; i < hybrid->fragments.count && hybrid->awake.dormant; i++)
        if (hybrid->fragments.items[i].mode == SHV_MODE_FRACTURE)
            hybrid->awake.dormant = !is_visited(hybrid, &hybrid->fragments.items[i], interval);
}
