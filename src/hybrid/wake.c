/* Mode switches. Waking gives a fragment's nodes its rigid motion; sleeping fits a rigid motion to them. Momentum and
   angular momentum pass unchanged both ways, since both sides use the lumped inertia; the energy of vibration, strain and
   open cohesive zones that a rigid body cannot carry is dropped, booked and logged. */
#include "hybrid/hybrid.h"

#include <string.h>

/* Impact stress estimate K ρ c₀ v √max(1, m_other/m_own) against the weakest facet; what is held fast counts as ratio 1,
   since the estimate's factor K already holds for a rigid wall. */
static double impact_stress(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
    const double ratio = isfinite(contact->other_mass) ? fmax(1.0, contact->other_mass / fragment->mass) : 1.0;
    return hybrid->scene->rigid.wake_factor * material->density * material->bar_speed * contact->closing_speed *
           sqrt(ratio);
}

/* Sides of the solid box with the fragment's inertia, longest first: a² = 6 (I₂ + I₃ − I₁)/m. */
static void extents(const ShvFragment *fragment, double sides[3])
{
    double values[3];
    shv_symmetric_eigen(&fragment->inertia, values, NULL);
    const double trace = values[0] + values[1] + values[2];
    for (int i = 0; i < 3; i++) sides[i] = sqrt(fmax(0.0, 6.0 * (trace - 2.0 * values[i]) / fragment->mass));
}

/* Load estimate F/A + F L/(4 W) of a simply supported beam: smallest section A = b h, W = b h²/6 of the box. A load that it has
   borne once does not wake it again. */
static bool wakes_under_load(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    if (!isfinite(fragment->strength) || !(contact->load > 1.1 * fragment->borne)) return false;
    double sides[3];
    extents(fragment, sides);
    const double area = sides[1] * sides[2], bending = area * sides[2] / 6.0;
    const double stress = contact->load / area + contact->load * sides[0] / (4.0 * bending);
    return stress >= hybrid->scene->rigid.wake_fraction * fragment->strength;
}

bool shv_hybrid_judge(void *data, const ShvRigidContact *contact)
{
    const ShvHybrid *hybrid = data;
    const ShvRigidDefinition *rigid = &hybrid->scene->rigid;
    const double strength = hybrid->fragments.items[contact->fragment].strength;
    if (rigid->wake == SHV_WAKE_CONTACT)
        return contact->fresh && (isfinite(strength) || !hybrid->scene->fracture.enabled);
    if (contact->fresh && impact_stress(hybrid, contact) >= rigid->wake_fraction * strength) return true;
    return wakes_under_load(hybrid, contact);
}

/* The nodes of a rigid body without stress have gravity's acceleration alone: their velocities half a step ago, in time with
   those of what is awake already. */
static void step_back(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    for (int32_t k = 0; k < fragment->node_count; k++) {
        double *v = hybrid->state.velocity + 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k];
        shv_store3(v, shv_madd(shv_load3(v), -0.5 * hybrid->state.last_step, gravity));
    }
}

static double strain_energy(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double strain = 0.0;
    for (int32_t k = 0; k < fragment->element_count; k++)
        strain += shv_solid_element_energy(&hybrid->solid, &hybrid->state,
                                           hybrid->fragments.elements[fragment->element_begin + k]);
    return strain;
}

/* Momentum of the rigid motion. */
static void rigid_momentum(const ShvFragment *fragment, double momentum[3], double angular[3])
{
    const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
    const ShvVec3 linear = shv_scale(fragment->velocity, fragment->mass);
    shv_store3(momentum, linear);
    shv_store3(angular,
               shv_add(shv_apply(&inertia, fragment->angular_velocity), shv_cross(fragment->position, linear)));
}

/* A companion that wakes is still in the backend's list. */
static void leave_flight(ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    if (!hybrid->fragments.items[contact->fragment].companion) return;
    shv_companions_remove(hybrid, contact->fragment);
    hybrid->backend->functions->remove(hybrid->backend, contact->fragment);
}

/* What it has met, if that is rigid still, goes along with it. */
static ShvStatus take_partner(ShvHybrid *hybrid, const ShvRigidContact *contact, ShvError *error)
{
    if (!hybrid->mutual || contact->other < 0) return SHV_OK;
    const ShvFragment *other = &hybrid->fragments.items[contact->other];
    bool flies = other->mode == SHV_MODE_FLIGHT && !other->companion;
    for (int32_t i = hybrid->wake_next; i < hybrid->wake_count; i++) /* its own turn is to come */
        flies = flies && hybrid->wakes[i].fragment != contact->other;
    return flies ? shv_companions_add(hybrid, contact->other, error) : SHV_OK;
}

ShvStatus shv_hybrid_wake(ShvHybrid *hybrid, const ShvRigidContact *contact, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    const double start = shv_now();
    const bool nodes = hybrid->backend->keeps_nodes;
    leave_flight(hybrid, contact);
    if (!nodes) shv_fragment_scatter(fragment, &hybrid->fragments, &hybrid->state);
    fragment->mode = SHV_MODE_FRACTURE;
    fragment->last_insertion = fmax(hybrid->state.time, contact->expected);
    fragment->quiet = 0;
    hybrid->awake.stale = true;
    shv_check_clock_start(&hybrid->clock);
    ShvEventView event = {.time = hybrid->state.time,
                          .kind = SHV_RUN_WAKE,
                          .fragment = contact->fragment,
                          .obstacle = contact->obstacle,
                          .value = contact->closing_speed};
    ShvVec3 momentum, angular;
    shv_fragment_momentum(fragment, &hybrid->fragments, &hybrid->state, &momentum, &angular, &event.kinetic_after);
    event.kinetic_before = nodes ? event.kinetic_after : shv_fragment_kinetic(fragment);
    rigid_momentum(fragment, event.momentum_before, event.angular_before);
    /* Nodes that flew on their own may be deformed: their elastic energy counts again from here. */
    if (nodes) event.strain_after = strain_energy(hybrid, fragment);
    hybrid->ledger.booked[SHV_WORK_HANDOVER] += event.strain_after;
    fragment->wake_energy = event.kinetic_after / fragment->mass;
    fragment->load = contact->load;
    shv_store3(event.momentum_after, momentum);
    shv_store3(event.angular_after, angular);
    step_back(hybrid, fragment);
    SHV_TRY(take_partner(hybrid, contact, error));
    shv_costs_add(&hybrid->costs, SHV_COST_HANDOVER, start);
    return shv_hybrid_log(hybrid, &event, error);
}

/* How long vibration needs: one transit of the longest extent by the bar wave, and by the slowest bending wave of a plate
   of the shortest extent (half the period of its free fundamental, f = 1.03 c₀ h/L²). */
static void transit_times(const ShvHybrid *hybrid, const ShvFragment *fragment, double *bar, double *bending)
{
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
    double sides[3];
    extents(fragment, sides);
    const double longest = sides[0], shortest = sides[2];
    *bar = longest / material->bar_speed;
    *bending = shortest > 0.0 ? fmax(*bar, 0.5 * longest * longest / (1.03 * material->bar_speed * shortest)) : *bar;
}

/* A fragment may rest when nothing has broken in it for the scene's number of checks and for two transits of the bar wave,
   and what a rigid body cannot carry (which bounds its stress) is small against the energy it woke with; or when the
   longest window is over. */
static bool is_quiet(const ShvHybrid *hybrid, const ShvFragment *fragment, double dropped)
{
    double bar, bending;
    transit_times(hybrid, fragment, &bar, &bending);
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    const double age = hybrid->state.time - fragment->last_insertion;
    const double longest = fracture->longest > 0.0 ? fracture->longest : 20.0 * bending;
    if (age >= longest) return true;
    const bool checked = fragment->quiet >= fracture->quiet_checks;
    /* The chapter's rule: a number of checks without insertion is enough, touching or not. */
    if (hybrid->scene->rigid.wake == SHV_WAKE_CONTACT) return checked;
    return checked && age >= 2.0 * bar && dropped <= 0.05 * fragment->wake_energy * fragment->mass;
}

/* Nothing that the cheap half of the rule forbids; only then is the motion brought to the present moment. */
static bool may_be_quiet(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    if (fragment->mode != SHV_MODE_FRACTURE || !is_quiet(hybrid, fragment, 0.0)) return false;
    return !shv_imposed_holds(&hybrid->imposed, hybrid->model.objects[fragment->object].name, hybrid->state.time);
}

/* What a fragment carries in the terms of the ledger, without the others' impulses (shv_hybrid_part_ways): kinetic energy
   ½ m v₋·v₊ with v₊ = 2 v − v₋, and strain. */
static void carried_energy(const ShvHybrid *hybrid, const ShvFragment *fragment, double *kinetic, double *strain)
{
    const ShvState *state = &hybrid->state;
    *kinetic = 0.0;
    *strain = strain_energy(hybrid, fragment);
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int64_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const ShvVec3 v = shv_load3(state->velocity + 3 * node), before = shv_load3(hybrid->ghost.before + 3 * node);
        *kinetic += 0.5 * state->mass[node] * shv_dot(before, shv_sub(shv_scale(v, 2.0), before));
    }
}

/* A backend that keeps nodes takes them as they are, with the velocities of now; any other gets a rigid body. */
static void hand_nodes_over(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    if (!hybrid->backend->keeps_nodes) {
        shv_fragment_scatter(fragment, &hybrid->fragments, &hybrid->state);
        return;
    }
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int64_t i = 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k];
        memcpy(hybrid->ghost.before + i, hybrid->state.velocity + i, 3 * sizeof(double));
    }
}

static ShvStatus try_to_sleep(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const ShvFragments *fragments = &hybrid->fragments;
    ShvEventView event = {.time = hybrid->state.time, .kind = SHV_RUN_SLEEP, .fragment = index, .obstacle = -1};
    ShvVec3 momentum, angular;
    double kinetic;
    shv_fragment_fit(fragment, fragments, &hybrid->state);
    shv_fragment_momentum(fragment, fragments, &hybrid->state, &momentum, &angular, &kinetic);
    carried_energy(hybrid, fragment, &event.kinetic_before, &event.strain_before);
    event.kinetic_after = hybrid->backend->keeps_nodes ? kinetic : shv_fragment_kinetic(fragment);
    event.value = event.kinetic_before + event.strain_before - event.kinetic_after;
    double released = 0.0;
    if (hybrid->model.can_break) released = shv_cohesive_recoverable_of(&hybrid->cohesive, &hybrid->state, index);
    if (!is_quiet(hybrid, fragment, event.value + released)) return SHV_OK;

    shv_store3(event.momentum_before, momentum);
    shv_store3(event.angular_before, angular);
    if (hybrid->model.can_break) shv_cohesive_settle(&hybrid->cohesive, &hybrid->state, index);
    hand_nodes_over(hybrid, fragment);
    shv_fragment_momentum(fragment, fragments, &hybrid->state, &momentum, &angular, &kinetic);
    shv_store3(event.momentum_after, momentum);
    shv_store3(event.angular_after, angular);
    hybrid->ledger.booked[SHV_WORK_HANDOVER] -= event.value;
    hybrid->ledger.released += released;
    fragment->mode = SHV_MODE_FLIGHT;
    fragment->borne = fmax(fragment->borne, fragment->load);
    hybrid->awake.stale = true;
    SHV_TRY(hybrid->backend->functions->add(hybrid->backend, index, error));
    return shv_hybrid_log(hybrid, &event, error);
}

ShvStatus shv_hybrid_sleep_quiet(ShvHybrid *hybrid, ShvError *error)
{
    hybrid->quiet_looks = 0;
    if (hybrid->awake.count == 0) return SHV_OK;
    const double start = shv_now();
    bool any = false;
    for (int32_t i = 0; i < hybrid->fragments.count && !any; i++)
        any = may_be_quiet(hybrid, &hybrid->fragments.items[i]);
    if (!any) return SHV_OK;
    SHV_TRY(shv_hybrid_part_ways(hybrid, error));
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (may_be_quiet(hybrid, &hybrid->fragments.items[i])) SHV_TRY(try_to_sleep(hybrid, i, error));
    shv_hybrid_resume(hybrid);
    SHV_TRY(shv_awake_refresh(hybrid, error));
    if (hybrid->awake.count == 0) SHV_TRY(shv_companions_choose(hybrid, 0.0, error));
    shv_costs_add(&hybrid->costs, SHV_COST_HANDOVER, start);
    return SHV_OK;
}
