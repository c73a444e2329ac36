#include "coupling/hybrid.h"

#include <string.h>

double shv_hybrid_next_event_time(const ShvHybrid *hybrid)
{
    const bool any = hybrid->next_event < hybrid->scene->event_count;
    return any ? hybrid->scene->events[hybrid->next_event].time : HUGE_VAL;
}

static bool of_object(const ShvHybrid *hybrid, const ShvFragment *fragment, const char *name)
{
    return shv_fragment_is_present(fragment) && strcmp(hybrid->model.objects[fragment->object].name, name) == 0;
}

static double mass_of_object(const ShvHybrid *hybrid, const char *name)
{
    double mass = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (of_object(hybrid, &hybrid->fragments.items[i], name)) mass += hybrid->fragments.items[i].mass;
    return mass;
}

/* ---- changes of motion ----
   Awake nodes and coupled bodies have velocities of n − 1/2, and of the kick from there to n + 1/2 all is booked when it comes but what
   potentials do, gravity and elasticity: a change acts on velocities of n as these alone make them, and the energy given is what it
   does there. Elastic forces do nothing in a rigid change. */

static ShvVec3 fall_of_half_step(const ShvHybrid *hybrid)
{
    return shv_scale(shv_load3(hybrid->gravity), 0.5 * hybrid->state.last_step);
}

/* `fall`: what velocities of nodes lack of those that the energy is of. */
static double change_nodes(ShvHybrid *hybrid, const ShvFragment *fragment, ShvVec3 linear, ShvVec3 angular,
                           ShvVec3 fall)
{
    /* what state.velocity is again when steps go on */
    double *velocities = hybrid->awake.count > 0 ? hybrid->observer.ghost.before : hybrid->state.velocity;
    double given = 0.0;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        double *v = velocities + 3 * (int64_t)node;
        const ShvVec3 arm = shv_sub(shv_state_position(&hybrid->state, node), fragment->position);
        const ShvVec3 change = shv_velocity_at(linear, angular, arm), old = shv_add(shv_load3(v), fall);
        given += hybrid->state.mass[node] * shv_dot(change, shv_madd(old, 0.5, change));
        shv_add_to3(v, change);
    }
    return given;
}

static double change_coupled(ShvHybrid *hybrid, const ShvFragment *fragment, ShvVec3 linear, ShvVec3 angular)
{
    ShvCoupledBody *body = hybrid->coupling.bodies.by_fragment[fragment->id];
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 old = shv_add(body->velocity, fall_of_half_step(hybrid)), spin = body->angular_velocity;
    body->velocity = shv_add(body->velocity, linear);
    body->angular_velocity = shv_add(spin, angular);
    return fragment->mass * shv_dot(linear, shv_madd(old, 0.5, linear)) +
           shv_dot(angular, shv_apply(&inertia, shv_madd(spin, 0.5, angular)));
}

/* Adds a rigid velocity change to a fragment, awake or in flight; returns the energy given. Its record, of the present time, changes
   as well. */
static double change_motion(ShvHybrid *hybrid, ShvFragment *fragment, ShvVec3 linear, ShvVec3 angular)
{
    const double before = shv_fragment_kinetic(fragment);
    fragment->velocity = shv_add(fragment->velocity, linear);
    fragment->angular_velocity = shv_add(fragment->angular_velocity, angular);
    if (fragment->mode == SHV_MODE_FRACTURE)
        return change_nodes(hybrid, fragment, linear, angular, fall_of_half_step(hybrid));
    if (hybrid->backend->keeps_nodes) return change_nodes(hybrid, fragment, linear, angular, shv_vec3(0.0, 0.0, 0.0));
    if (fragment->coupled) return change_coupled(hybrid, fragment, linear, angular);
    return shv_fragment_kinetic(fragment) - before;
}

static double event_on_fragments(ShvHybrid *hybrid, const ShvEventDefinition *event)
{
    double given = 0.0;
    const double mass = mass_of_object(hybrid, event->target);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        if (!of_object(hybrid, fragment, event->target)) continue;
        if (event->kind == SHV_EVENT_IMPULSE)
            given += change_motion(hybrid, fragment, shv_scale(shv_load3(event->value), 1.0 / mass), shv_vec3(0, 0, 0));
        else
            given += change_motion(hybrid, fragment, shv_sub(shv_load3(event->value), fragment->velocity),
                                   shv_sub(shv_load3(event->angular), fragment->angular_velocity));
    }
    return given;
}

static double event_on_obstacle(ShvHybrid *hybrid, const ShvEventDefinition *event)
{
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        ShvObstacle *obstacle = &hybrid->obstacles.items[i];
        if (shv_hybrid_waits(hybrid, i) || strcmp(obstacle->name, event->target) != 0) continue;
        const double before = shv_obstacle_kinetic(obstacle);
        if (event->kind == SHV_EVENT_IMPULSE) {
            shv_obstacle_impulse(obstacle, obstacle->position, shv_load3(event->value));
        } else {
            obstacle->velocity = shv_load3(event->value);
            obstacle->angular_velocity = shv_load3(event->angular);
        }
        return shv_obstacle_kinetic(obstacle) - before;
    }
    return 0.0;
}

/* New gravity changes the potential of everything at once: that change is the event's work. */
static double change_gravity(ShvHybrid *hybrid, const double gravity[3])
{
    const ShvVec3 change = shv_sub(shv_load3(gravity), shv_load3(hybrid->gravity));
    double given = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_DEAD) given -= fragment->mass * shv_dot(change, fragment->position);
    }
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        const ShvObstacle *obstacle = &hybrid->obstacles.items[i];
        if (obstacle->motion == SHV_OBSTACLE_FREE && !shv_hybrid_waits(hybrid, i))
            given -= obstacle->mass * shv_dot(change, obstacle->position);
    }
    /* The step to come gives half of its new gravity to the half step that is past: velocities of now stay. */
    const double half = 0.5 * hybrid->state.last_step;
    for (int32_t k = 0; k < hybrid->awake.node_count; k++) {
        double *before = hybrid->observer.ghost.before + 3 * (int64_t)hybrid->awake.nodes[k];
        shv_store3(before, shv_madd(shv_load3(before), -half, change));
    }
    for (int32_t i = 0; i < hybrid->coupling.bodies.count; i++) {
        ShvCoupledBody *body = &hybrid->coupling.bodies.items[i];
        body->velocity = shv_madd(body->velocity, -half, change);
    }
    memcpy(hybrid->gravity, gravity, sizeof hybrid->gravity);
    return given;
}

static double happen(ShvHybrid *hybrid, const ShvEventDefinition *event)
{
    switch (event->kind) {
    case SHV_EVENT_RELEASE:
        shv_imposed_release_condition(&hybrid->imposed, event->target);
        return 0.0;
    case SHV_EVENT_GRAVITY:
        return change_gravity(hybrid, event->value);
    case SHV_EVENT_SET_VELOCITY:
    case SHV_EVENT_IMPULSE:
        break;
    }
    return event_on_fragments(hybrid, event) + event_on_obstacle(hybrid, event);
}

/* Records and nodes of the present time, for changes from outside. */
static ShvStatus synchronise_now(ShvHybrid *hybrid, ShvError *error)
{
    SHV_TRY(shv_hybrid_wake_fixed(hybrid, error));
    SHV_TRY(shv_hybrid_observe(hybrid, error));
    return hybrid->awake.count > 0 ? shv_hybrid_synchronise(hybrid, error) : SHV_OK;
}

static void resume_now(ShvHybrid *hybrid)
{
    if (hybrid->awake.count > 0) shv_hybrid_resume(hybrid);
    shv_surface_contact_invalidate(&hybrid->coupling.surface);
}

/* `value`: as the log tells it. */
static ShvStatus carry_out(ShvHybrid *hybrid, const ShvEventDefinition *event, double value, ShvError *error)
{
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] += happen(hybrid, event);
    const ShvEventView entry = {
        .time = hybrid->state.time, .kind = SHV_RUN_SCENE, .fragment = -1, .obstacle = -1, .value = value};
    return shv_hybrid_log(hybrid, &entry, error);
}

ShvStatus shv_hybrid_time_line(ShvHybrid *hybrid, ShvError *error)
{
    if (shv_hybrid_next_event_time(hybrid) > hybrid->state.time) return SHV_OK;
    SHV_TRY(synchronise_now(hybrid, error));
    while (shv_hybrid_next_event_time(hybrid) <= hybrid->state.time) {
        const int32_t index = hybrid->next_event++;
        SHV_TRY(carry_out(hybrid, &hybrid->scene->events[index], index, error));
    }
    resume_now(hybrid);
    return SHV_OK;
}

ShvStatus shv_hybrid_apply(ShvHybrid *hybrid, const ShvEventDefinition *event, ShvError *error)
{
    SHV_TRY(synchronise_now(hybrid, error));
    const ShvStatus status = carry_out(hybrid, event, -1.0, error);
    resume_now(hybrid);
    return status;
}

ShvStatus shv_hybrid_push(ShvHybrid *hybrid, int32_t index, ShvVec3 impulse, ShvVec3 point, ShvError *error)
{
    SHV_TRY(synchronise_now(hybrid, error));
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 torque = shv_cross(shv_sub(point, fragment->position), impulse);
    ShvMat3 inverse;
    const ShvVec3 spin = shv_invert(&inertia, &inverse) ? shv_apply(&inverse, torque) : shv_vec3(0.0, 0.0, 0.0);
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] +=
        change_motion(hybrid, fragment, shv_scale(impulse, 1.0 / fragment->mass), spin);
    resume_now(hybrid);
    return SHV_OK;
}
