/* What a mode switch did, and whether the scene allows it. */
#include "coupling/hybrid.h"

ShvStatus shv_hybrid_log(ShvHybrid *hybrid, const ShvEventView *event, ShvError *error)
{
    ShvEventLog *log = &hybrid->log;
    SHV_GROW(hybrid->memory, SHV_PART_RECORD, log->items, log->capacity, log->count, "the event log", error);
    log->items[log->count++] = *event;
    return SHV_OK;
}

void shv_audit_hulls(const ShvFragment *fragment, ShvEventView *event)
{
    event->hulls = fragment->hulls;
    event->hull_outside = fragment->hull_outside / fragment->volume;
    event->hull_missing = fragment->hull_missing / fragment->volume;
}

ShvEventView shv_audit_event(const ShvHybrid *hybrid, ShvRunEvent kind, int32_t index)
{
    const ShvFragment *fragment = &hybrid->fragments.items[index];
    ShvEventView event = {
        .time = hybrid->state.time, .kind = kind, .fragment = index, .obstacle = -1, .mass = fragment->mass};
    shv_audit_hulls(fragment, &event);
    return event;
}

double shv_audit_strain(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return shv_solid_energy_of(&hybrid->solid, &hybrid->state, hybrid->fragments.elements + fragment->element_begin,
                               fragment->element_count);
}

double shv_audit_cohesive(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    if (!hybrid->model.can_break) return 0.0;
    return shv_cohesive_recoverable_of(&hybrid->cohesive, &hybrid->state, fragment->id);
}

void shv_audit_rigid(const ShvFragment *fragment, double momentum[3], double angular[3])
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 linear = shv_scale(fragment->velocity, fragment->mass);
    shv_store3(momentum, linear);
    shv_store3(angular,
               shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_cross(fragment->position, linear)));
}

void shv_audit_nodes(const ShvHybrid *hybrid, const ShvFragment *fragment, double momentum[3], double angular[3],
                     ShvEventView *scales)
{
    const ShvState *state = &hybrid->state;
    ShvVec3 linear, turning;
    double kinetic;
    shv_fragment_momentum(fragment, &hybrid->fragments, state, &linear, &turning, &kinetic);
    shv_store3(momentum, linear);
    shv_store3(angular, turning);
    if (!scales) return;
    scales->momentum_scale = scales->angular_scale = 0.0;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const double p = state->mass[node] * shv_norm(shv_load3(state->velocity + 3 * (int64_t)node));
        scales->momentum_scale += p;
        scales->angular_scale += p * shv_norm(shv_state_position(state, node));
    }
}

/* ---- bounds ---- */

static double share(double part, double whole)
{
    return whole > 0.0 ? part / whole : 0.0;
}

static double change(const double before[3], const double after[3])
{
    return shv_norm(shv_sub(shv_load3(after), shv_load3(before)));
}

static const char *switch_name(ShvRunEvent kind)
{
    return kind == SHV_RUN_WAKE ? "woke" : kind == SHV_RUN_BIN ? "was put away as dust" : "went to rest";
}

typedef struct Figure {
    const char *name, *key;
    double value, bound;
    const char *remedy;
} Figure;

static ShvStatus judge(const ShvEventView *event, const Figure *figure, ShvError *error)
{
    if (figure->value <= figure->bound) return SHV_OK;
    return shv_fail(error, SHV_DIVERGED,
                    "fragment %d (%.3g kg, %d hulls) %s at t = %.9g s and %s %.3g, more than audit.%s "
                    "%g; %s",
                    (int)event->fragment, event->mass, (int)event->hulls, switch_name(event->kind), event->time,
                    figure->name, figure->value, figure->key, figure->bound, figure->remedy);
}

/* Share of what it carried, or of what it woke with, if that was more: a fragment that rings under a load carries nothing else. */
static double dropped_share(const ShvHybrid *hybrid, const ShvEventView *event)
{
    if (event->kind != SHV_RUN_SLEEP) return 0.0;
    const ShvFragment *fragment = &hybrid->fragments.items[event->fragment];
    const double carried = event->kinetic_before + event->strain_before + event->cohesive_before;
    return share(event->dropped_vibration + event->dropped_strain + event->dropped_cohesive,
                 fmax(carried, fragment->wake_energy * fragment->mass));
}

static ShvStatus judge_switch(const ShvHybrid *hybrid, const ShvEventView *event, ShvError *error)
{
    const ShvAuditDefinition *audit = &hybrid->scene->audit;
    const Figure figures[] = {
        {"changed its momentum by a share of", "momentum",
         share(change(event->momentum_before, event->momentum_after), event->momentum_scale), audit->momentum,
         "shares below 1e-12 are rounding: give a larger bound"},
        {"changed its angular momentum about the origin by a share of", "momentum",
         share(change(event->angular_before, event->angular_after), event->angular_scale), audit->momentum,
         "give a larger bound, or a finer mesh: a fragment of one line of nodes cannot carry all angular momentum"},
        {"dropped of its energy a share of", "dropped_share", dropped_share(hybrid, event), audit->dropped_share,
         "give a larger fracture.longest or more fracture.quiet_checks so that it calms down first, 'fracture: "
         "{deformation: keep}', or a larger bound"},
        {"is off its convex pieces by a share of its volume of", "hull_error",
         event->hull_outside + event->hull_missing, audit->hull_error,
         "give a finer mesh, 'rigid: {dust: particles}' for small pieces, or a larger bound"}};
    for (size_t i = 0; i < sizeof figures / sizeof figures[0]; i++) SHV_TRY(judge(event, &figures[i], error));
    return SHV_OK;
}

ShvStatus shv_audit_close(ShvHybrid *hybrid, ShvEventView *event, ShvError *error)
{
    event->dropped_vibration = event->kinetic_before - event->kinetic_after;
    event->dropped_strain = event->strain_before - event->strain_after;
    event->dropped_cohesive = event->cohesive_before - event->cohesive_after;
    hybrid->observer.ledger.booked[SHV_WORK_HANDOVER] -= event->dropped_vibration + event->dropped_strain;
    hybrid->observer.ledger.released += event->dropped_cohesive;
    SHV_TRY(shv_hybrid_log(hybrid, event, error));
    return judge_switch(hybrid, event, error);
}
