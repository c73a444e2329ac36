/* Bodies on supports. While they are struck, and until they have calmed down, they are in fracture mode; before and after that flight
   holds them, immovable, and what is slow lies on them and meets them as on any rigid body. */
#include <string.h>

#include "coupling/hybrid.h"
#include "coupling/near.h"

static bool is_of(const ShvConditionDefinition *condition, const char *object)
{
    return condition->object && strcmp(condition->object, object) == 0;
}

bool shv_hybrid_is_held(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return shv_imposed_holds(&hybrid->imposed, &hybrid->state, hybrid->fragments.nodes + fragment->node_begin,
                             fragment->node_count);
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

/* Probes want to see every step, and who does not ask for cracks wants to see vibration; bars move nodes by themselves. */
static bool flight_may_hold(const ShvHybrid *hybrid)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    return hybrid->imposed.count > 0 && hybrid->coupling.mutual && !hybrid->stabiliser.active &&
           scene->probe_count == 0 && scene->fracture.enabled;
}

/* By permanent supports alone, with its weight at its centre at the start. */
static ShvRestraint restraint_of(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    if (!flight_may_hold(hybrid) || !isfinite(fragment->strength) ||
        !is_supported(hybrid->scene, hybrid->model.objects[fragment->object].name))
        return SHV_UNRESTRAINED;
    return shv_imposed_restraint(&hybrid->imposed, &hybrid->state, hybrid->fragments.nodes + fragment->node_begin,
                                 fragment->node_count, shv_load3(hybrid->gravity), fragment->reference_centre);
}

bool shv_hybrid_can_fix(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return restraint_of(hybrid, fragment) == SHV_FULLY_RESTRAINED;
}

static bool is_still(const ShvPlacement *placement)
{
    return shv_norm(shv_load3(placement->velocity)) + shv_norm(shv_load3(placement->angular_velocity)) +
               shv_norm(shv_load3(placement->stretch_rate)) ==
           0.0;
}

/* Its weight comes on when it wakes: it must not be able to break it. What supports let slide or turn stays where it is until it is
   pushed. */
bool shv_hybrid_starts_fixed(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double weight = fragment->mass * shv_norm(shv_load3(hybrid->gravity));
    return is_still(&hybrid->scene->objects[fragment->object].placement) &&
           shv_hybrid_load_stress(fragment, weight) < hybrid->scene->rigid.wake_fraction * fragment->strength &&
           restraint_of(hybrid, fragment) != SHV_UNRESTRAINED;
}

/* Back to the start without the sag under its weight, whose potential is given. */
static void straighten(ShvHybrid *hybrid, ShvFragment *fragment)
{
    const ShvVec3 rise = shv_sub(fragment->reference_centre, fragment->position);
    hybrid->observer.ledger.booked[SHV_WORK_HANDOVER] -= fragment->mass * shv_dot(shv_load3(hybrid->gravity), rise);
    fragment->position = fragment->reference_centre;
    fragment->orientation = shv_quat_identity();
}

void shv_hybrid_fix(ShvHybrid *hybrid, ShvFragment *fragment, bool deformed)
{
    if (!deformed) straighten(hybrid, fragment);
    fragment->fixed = true;
    if (fragment->last_crack > -HUGE_VAL) fragment->approach_severity = 0.0; /* it is another body now */
}

/* ---- what approaches ---- */

/* Of the severity of the hardest blow: what wakes it, and what keeps it awake. A weaker one is met in flight, as by a body that has borne
   more; and what bounces on while it rings would keep it awake for long. */
static const double waking_share = 1.0 / 3.0, keeping_share = 0.9;

/* Of the radius that it had at the start: what deforms may reach a little farther. */
static const double largest_radius = 1.1;

/* A body that supports hold, in an interval. */
typedef struct Supported {
    const ShvHybrid *hybrid;
    ShvFragment *fragment;
    double interval; /* s */
    bool firm;       /* supports leave it no motion; or it is awake, and moves if they do */
    bool known;
    ShvNear near; /* once it is known: where its tets are */
} Supported;

typedef struct Approaching {
    ShvVec3 position;
    double radius, speed, mass; /* m, m/s, kg; infinite: moves by script */
} Approaching;

static bool may_reach(Supported *supported, const Approaching *body)
{
    const double fall = shv_norm(shv_load3(supported->hybrid->gravity)) * supported->interval;
    const double reach =
        body->radius + 2.0 * (body->speed + fall) * supported->interval; /* 2: for rounding, and more */
    const double distance = shv_norm(shv_sub(body->position, supported->fragment->position));
    if (distance > largest_radius * supported->fragment->radius + reach) return false;
    if (!supported->known) shv_near_find(supported->hybrid, supported->fragment, &supported->near);
    supported->known = true;
    return shv_near_meets(&supported->near, body->position, reach);
}

/* Whether a blow may come that is not met in flight; notes its severity, by the rule of impacts (wake.c). What is slower than bodies at
   rest seem in flight lies on the body, or pushes it where supports let it. */
static bool may_be_struck(Supported *supported, const Approaching *body)
{
    ShvFragment *fragment = supported->fragment;
    const double severity = shv_hybrid_severity(body->speed, fragment->mass, body->mass);
    const double share = fragment->fixed ? waking_share : keeping_share;
    const bool weak = !(severity > share * fragment->approach_severity) ||
                      !(body->speed > 2.0 * shv_hybrid_rest_speed(supported->hybrid));
    if ((weak && supported->firm) || !may_reach(supported, body)) return false;
    fragment->approach_severity = fmax(fragment->approach_severity, severity);
    return true;
}

static bool is_approached(const ShvHybrid *hybrid, ShvFragment *fragment, double interval)
{
    Supported supported = {.hybrid = hybrid, .fragment = fragment, .interval = interval};
    supported.firm = !fragment->fixed || shv_hybrid_can_fix(hybrid, fragment);
    bool approached = false;
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        const ShvObstacle *o = &hybrid->obstacles.items[i];
        const Approaching body = {o->position, o->bounding_radius,
                                  shv_norm(o->velocity) + shv_norm(o->angular_velocity) * o->bounding_radius,
                                  o->motion == SHV_OBSTACLE_FREE ? o->mass : HUGE_VAL};
        if (o->motion != SHV_OBSTACLE_FIXED) approached |= may_be_struck(&supported, &body);
    }
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *f = &hybrid->fragments.items[i];
        const Approaching body = {f->position, f->radius,
                                  shv_norm(f->velocity) + shv_norm(f->angular_velocity) * f->radius, f->mass};
        if (f->mode == SHV_MODE_FLIGHT && !f->fixed) approached |= may_be_struck(&supported, &body);
    }
    return approached;
}

ShvStatus shv_hybrid_wake_approached(ShvHybrid *hybrid, ShvError *error)
{
    if (!flight_may_hold(hybrid)) return SHV_OK;
    const double interval = hybrid->interval_end - hybrid->state.time;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        const bool held =
            fragment->fixed || (fragment->mode == SHV_MODE_FRACTURE && shv_hybrid_is_held(hybrid, fragment));
        if (!held || (fragment->fixed && fragment->dust) || !is_approached(hybrid, fragment, interval)) continue;
        if (fragment->fixed) SHV_TRY(shv_hybrid_wake_alone(hybrid, i, error));
        fragment->last_approach = hybrid->interval_end;
    }
    return shv_awake_refresh(hybrid, error);
}

/* Of its weight: what presses harder on another body than it may by lying on it strikes it. */
static const double most_weights = 3.0;

bool shv_hybrid_is_struck(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double weights = most_weights * shv_norm(shv_load3(hybrid->gravity)) * hybrid->state.last_step;
    bool struck = false;
    for (int32_t k = 0; k < hybrid->coupling.surface.pair_count && !struck; k++) {
        const ShvFacetPair *pair = &hybrid->coupling.surface.pairs[k];
        const int own = pair->fragments[0] == fragment->id ? 0 : 1;
        const bool obstacle = pair->element < 0;
        if (pair->fragments[own] != fragment->id || (obstacle && own != 0)) continue;
        const double mass = obstacle ? hybrid->obstacles.items[-1 - pair->element].mass
                                     : hybrid->fragments.items[pair->fragments[!own]].mass;
        struck = pair->normal_impulse > weights * mass; /* never of an obstacle that does not move freely */
    }
    return struck;
}

ShvStatus shv_hybrid_wake_fixed(ShvHybrid *hybrid, ShvError *error)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].fixed) SHV_TRY(shv_hybrid_wake_alone(hybrid, i, error));
    return shv_awake_refresh(hybrid, error);
}
