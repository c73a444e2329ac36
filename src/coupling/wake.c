/* Into fracture mode: which contacts wake a fragment, and its nodes get its rigid motion. Momentum and angular momentum pass
   unchanged, since both sides use the lumped inertia. */
#include "coupling/hybrid.h"

#include <string.h>

double shv_hybrid_rest_speed(const ShvHybrid *hybrid)
{
    return shv_norm(shv_load3(hybrid->gravity)) * hybrid->scene->rigid.time_step;
}

/* A touch from a gap, or one that closes faster than resting and rolling bodies do: a body that stands on one edge may slam on
   the other, and one may touch from the start. */
static bool is_impact(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    return contact->fresh || contact->closing_speed > 2.0 * shv_hybrid_rest_speed(hybrid);
}

/* What is held fast counts as ratio 1, since the estimate's factor K already holds for a rigid wall. */
double shv_hybrid_severity(double speed, double own_mass, double other_mass)
{
    return speed * (isfinite(other_mass) ? sqrt(fmax(1.0, other_mass / own_mass)) : 1.0);
}

static double severity(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    if (!is_impact(hybrid, contact)) return 0.0;
    return shv_hybrid_severity(contact->closing_speed, hybrid->fragments.items[contact->fragment].mass,
                               contact->other_mass);
}

/* Times the impact or load that a body has borne: what it takes to wake it again, above the scatter from step to step. */
static const double beyond_borne = 1.1;

/* Impact stress estimate K ρ c₀ × severity against the weakest facet. What it has borne once, without a facet inserted, does not
   wake it again. */
static bool wakes_by_impact(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
    const double speed = severity(hybrid, contact);
    if (!(speed > beyond_borne * fragment->borne_impact)) return false;
    const double stress = hybrid->scene->rigid.wake_factor * material->density * material->bar_speed * speed;
    return stress >= hybrid->scene->rigid.wake_fraction * fragment->strength;
}

/* F/A + F L/(4 W) of a simply supported beam: smallest section A = b h, W = b h²/6 of the box. */
double shv_hybrid_load_stress(const ShvFragment *fragment, double load)
{
    const double *sides = fragment->sides;
    const double area = sides[1] * sides[2], bending = area * sides[2] / 6.0;
    return load / area + load * sides[0] / (4.0 * bending);
}

/* A load that it has borne once does not wake it again. */
static bool wakes_under_load(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    if (!isfinite(fragment->strength) || !(contact->load > beyond_borne * fragment->borne)) return false;
    return shv_hybrid_load_stress(fragment, contact->load) >= hybrid->scene->rigid.wake_fraction * fragment->strength;
}

/* Centrifugal stress: 3 E/V of a thin rod about its middle (ρω²L²/8), a disc about its axis has half of that and a thin ring two
   thirds. A body that wakes is not stretched yet, and rings to twice the stress of a steady spin. */
double shv_hybrid_centrifugal_stress(const ShvFragment *fragment)
{
    return 3.0 * shv_fragment_rotational(fragment) / fragment->volume;
}

bool shv_hybrid_wakes_by_spin(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double least = hybrid->scene->rigid.wake_fraction * fragment->strength;
    const double speed = shv_norm(fragment->angular_velocity) * fragment->radius;
    if (!(1.5 * fragment->mass * speed * speed >= least * fragment->volume)) return false; /* a bound, soon found */
    const double stress = shv_hybrid_centrifugal_stress(fragment);
    return stress >= least && stress > beyond_borne * fragment->borne_spin;
}

/* The rule of the chapter is asked once a rigid step from the touch that woke a body, or from its last insertion. Beside what is awake
   intervals are a tenth of that (advance.c); asked in each of them, the larger pieces of a heap, which something touches at all
   times, would be awake at all times. */
static bool wakes_by_contact(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    const bool never_woke = fragment->wake_energy == 0.0;
    if (hybrid->coupling.mutual && !never_woke &&
        contact->time < fragment->last_insertion + hybrid->scene->rigid.time_step)
        return false;
    return is_impact(hybrid, contact) && (isfinite(fragment->strength) || !hybrid->scene->fracture.enabled);
}

/* What supports hold wakes before it is touched (supported.c). */
static bool is_approach(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    return hybrid->fragments.items[contact->fragment].fixed && contact->obstacle < 0 && contact->other < 0;
}

static ShvSwitchReason reason_by_stress(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    if (wakes_by_impact(hybrid, contact)) return SHV_REASON_IMPACT;
    if (wakes_under_load(hybrid, contact)) return SHV_REASON_LOAD;
    return shv_hybrid_wakes_by_spin(hybrid, &hybrid->fragments.items[contact->fragment]) ? SHV_REASON_SPIN
                                                                                         : SHV_REASON_NONE;
}

static bool is_audited(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    return hybrid->wake_audit.audited < hybrid->wake_audit.wakes && contact->fresh &&
           contact->closing_speed > shv_hybrid_rest_speed(hybrid) &&
           isfinite(hybrid->fragments.items[contact->fragment].strength);
}

static ShvSwitchReason reason_to_wake(const ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    const ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    const bool by_contact = hybrid->scene->rigid.wake == SHV_WAKE_CONTACT;
    if (fragment->dust) return SHV_REASON_NONE;
    if (is_approach(hybrid, contact) || (by_contact && wakes_by_contact(hybrid, contact))) return SHV_REASON_CONTACT;
    const ShvSwitchReason reason = by_contact ? SHV_REASON_NONE : reason_by_stress(hybrid, contact);
    if (reason != SHV_REASON_NONE) return reason;
    if (shv_hybrid_is_squeezed(hybrid, fragment, hybrid->interval_end - hybrid->state.time)) return SHV_REASON_LOAD;
    return !by_contact && is_audited(hybrid, contact) ? SHV_REASON_AUDIT : SHV_REASON_NONE;
}

bool shv_hybrid_judge(void *hybrid, const ShvRigidContact *contact)
{
    return reason_to_wake(hybrid, contact) != SHV_REASON_NONE;
}

static ShvRigidContact no_contact(const ShvHybrid *hybrid, int32_t index)
{
    return (ShvRigidContact){.fragment = index, .obstacle = -1, .other = -1, .time = hybrid->state.time};
}

ShvStatus shv_hybrid_wake_alone(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    const ShvRigidContact none = no_contact(hybrid, index);
    if (hybrid->awake.count == 0) hybrid->state.last_step = 0.0; /* velocities are those of now */
    if (!hybrid->fragments.items[index].coupled) hybrid->backend->functions->remove(hybrid->backend, index);
    return shv_hybrid_wake(hybrid, &none, error);
}

ShvStatus shv_hybrid_wake_spinning(ShvHybrid *hybrid, ShvError *error)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        const ShvRigidContact none = no_contact(hybrid, i);
        if (fragment->mode != SHV_MODE_FLIGHT || fragment->coupled) continue;
        if (reason_to_wake(hybrid, &none) == SHV_REASON_SPIN) SHV_TRY(shv_hybrid_wake_alone(hybrid, i, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* The nodes of a rigid body without stress have gravity's acceleration alone: their velocities half a step ago, in time with
   those of what is awake already. Under a stress that was kept they are taken the same: rigid motion and internal forces have
   no power together, so that ½ m v₋·v₊ starts as the energy that the body had. */
static void step_back(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    for (int32_t k = 0; k < fragment->node_count; k++) {
        double *v = hybrid->state.velocity + 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k];
        shv_store3(v, shv_madd(shv_load3(v), -0.5 * hybrid->state.last_step, gravity));
    }
}

/* A coupled body that wakes is still in the backend's list. */
static void leave_flight(ShvHybrid *hybrid, const ShvRigidContact *contact)
{
    if (!hybrid->fragments.items[contact->fragment].coupled) return;
    shv_coupled_bodies_remove(hybrid, contact->fragment);
    hybrid->backend->functions->remove(hybrid->backend, contact->fragment);
}

/* Its record is that of the impact, less than a step from now: it flies as far, or back. */
static void bring_to_now(const ShvHybrid *hybrid, ShvFragment *fragment, double time)
{
    const double elapsed = hybrid->state.time - time;
    if (elapsed == 0.0 || hybrid->backend->keeps_nodes || fragment->fixed) return;
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    const ShvVec3 spin = shv_free_rotation_momentum(&rotation, fragment->orientation, fragment->angular_velocity);
    fragment->position =
        shv_madd(shv_madd(fragment->position, elapsed, fragment->velocity), 0.5 * elapsed * elapsed, gravity);
    fragment->velocity = shv_madd(fragment->velocity, elapsed, gravity);
    /* Backwards is forwards with the momentum reversed. */
    fragment->orientation = shv_free_rotation_advance(&rotation, fragment->orientation,
                                                      elapsed > 0.0 ? spin : shv_scale(spin, -1.0), fabs(elapsed));
    fragment->angular_velocity = shv_free_rotation_velocity(&rotation, fragment->orientation, spin);
}

/* What it has met, if that is rigid still, goes along with it. */
static ShvStatus take_partner(ShvHybrid *hybrid, const ShvRigidContact *contact, ShvError *error)
{
    if (!hybrid->coupling.mutual || contact->other < 0) return SHV_OK;
    ShvFragment *other = &hybrid->fragments.items[contact->other];
    bool flies = other->mode == SHV_MODE_FLIGHT && !other->coupled;
    for (int32_t i = hybrid->wakes.next; i < hybrid->wakes.count; i++) /* its own turn is to come */
        flies = flies && hybrid->wakes.items[i].fragment != contact->other;
    if (!flies) return SHV_OK;
    bring_to_now(hybrid, other, contact->time);
    return shv_coupled_bodies_add(hybrid, contact->other, error);
}

/* Whether a fragment wakes in its shape at the start, though its nodes flew on their own. Bars hold lengths to about 1e-3, edge by
   edge. That is nothing to see; but in a stiff solid it is energy out of nothing (½ E ε², 35 kJ/m³ in glass, which moves at
   5 m/s with as much), in modes near the limit of stability, of which central difference loses a share up to (ω Δt)²/4 in its
   first step. Bars in fracture mode take the deformation as it is. */
static bool straightens(const ShvHybrid *hybrid)
{
    return hybrid->backend->keeps_nodes && !hybrid->stabiliser.active;
}

/* What flight held stands as it should, to the last bit, and has no motion. */
static void stand_still(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    for (int32_t k = 0; k < fragment->node_count; k++)
        memset(hybrid->state.velocity + 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k], 0,
               3 * sizeof(double));
}

/* Nodes get the rigid motion, on top of the deformation that was kept. */
static void give_motion(ShvHybrid *hybrid, ShvFragment *fragment)
{
    if (hybrid->backend->keeps_nodes && !straightens(hybrid)) return;
    if (fragment->fixed && !fragment->deformed)
        stand_still(hybrid, fragment);
    else if (fragment->deformed)
        shv_fragment_unfold(fragment, &hybrid->fragments, &hybrid->state);
    else
        shv_hybrid_scatter(hybrid, fragment);
}

/* Where a fragment's nodes stand deepest in an obstacle; the way out of it. */
static ShvVec3 find_way_out(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double deepest = 0.0;
    ShvVec3 way_out = {0.0, 0.0, 0.0};
    for (int32_t o = 0; o < hybrid->obstacles.count; o++)
        for (int32_t k = 0; k < fragment->node_count; k++) {
            const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
            const ShvSurfacePoint at =
                shv_obstacle_closest(&hybrid->obstacles.items[o], shv_state_position(&hybrid->state, node), 0.0);
            if (!(at.gap < deepest)) continue;
            deepest = at.gap;
            way_out = shv_scale(at.normal, -at.gap);
        }
    return way_out;
}

/* Bars push out what is inside an obstacle, at once and with all the energy that takes; those of rigid mode when the body has
   come to rest. Its nodes can be, by what its convex pieces leave out, or since they are back in its shape at the start: it
   is moved out as a whole, and the potential energy of that is booked. */
static void stand_outside(ShvHybrid *hybrid, ShvFragment *fragment)
{
    const double largest_share = 0.1; /* of the radius; deeper overlaps are the scene's */
    if (hybrid->stabiliser.active == hybrid->backend->keeps_nodes) return;
    const ShvVec3 way_out = find_way_out(hybrid, fragment);
    if (!(shv_norm(way_out) > 0.0) || shv_norm(way_out) > largest_share * fragment->radius) return;
    for (int32_t k = 0; k < fragment->node_count; k++)
        shv_add_to3(hybrid->state.displacement + 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k],
                    way_out);
    fragment->position = shv_add(fragment->position, way_out);
    hybrid->observer.ledger.booked[SHV_WORK_CONTACT] -= fragment->mass * shv_dot(shv_load3(hybrid->gravity), way_out);
}

double shv_hybrid_kinetic_in_flight(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    ShvVec3 momentum, angular;
    double kinetic;
    if (!hybrid->backend->keeps_nodes) return shv_fragment_kinetic(fragment);
    shv_fragment_momentum(fragment, &hybrid->fragments, &hybrid->state, &momentum, &angular, &kinetic);
    return kinetic;
}

/* What the switch gives is the elastic energy of nodes that flew on their own and keep their places, or what they had beside a
   rigid motion where they do not, and what the deformation that was kept does to the inertia. */
static void wake_energies(ShvHybrid *hybrid, ShvFragment *fragment, ShvEventView *event)
{
    const bool nodes = hybrid->backend->keeps_nodes;
    shv_audit_nodes(hybrid, fragment, event->momentum_after, event->angular_after, event);
    ShvVec3 momentum, angular;
    shv_fragment_momentum(fragment, &hybrid->fragments, &hybrid->state, &momentum, &angular, &event->kinetic_after);
    shv_audit_rigid(fragment, event->momentum_before, event->angular_before);
    event->strain_before = fragment->strain;
    if (fragment->deformed || (nodes && !straightens(hybrid))) event->strain_after = shv_audit_strain(hybrid, fragment);
    if (fragment->deformed || straightens(hybrid)) event->cohesive_after = shv_audit_cohesive(hybrid, fragment);
}

/* What the closing of a contact has to spend: ½ v² over the mobilities of both sides at the point, along the normal; of a coupled
   body no point is known, and it counts as met at its centre. A body at rest that is struck has no other energy to wake with. How
   much of that it takes is not known yet: of a body that has rested no more counts than opens its minimum cut. */
static double energy_of_blow(const ShvFragment *fragment, const ShvRigidContact *contact)
{
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    const ShvCoupledBody body = {.mass = fragment->mass,
                                 .position = fragment->position,
                                 .inverse_inertia = shv_free_rotation_world_inverse(&rotation, fragment->orientation)};
    const double own = shv_coupled_body_inverse_mass(&body, contact->point, contact->normal);
    const double blow = 0.5 * contact->closing_speed * contact->closing_speed / (own + 1.0 / contact->other_mass);
    return fragment->wake_energy > 0.0 ? fmin(blow, fragment->cut_energy) : blow;
}

ShvStatus shv_hybrid_wake(ShvHybrid *hybrid, const ShvRigidContact *contact, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[contact->fragment];
    /* a coupled body may have been woken by another touch before */
    if (fragment->mode != SHV_MODE_FLIGHT) return take_partner(hybrid, contact, error);
    const double start = shv_now();
    double bending;
    ShvEventView event = shv_audit_event(hybrid, SHV_RUN_WAKE, contact->fragment);
    event.obstacle = contact->obstacle;
    event.value = contact->closing_speed;
    event.reason = reason_to_wake(hybrid, contact);
    fragment->audited = event.reason == SHV_REASON_AUDIT;
    hybrid->wake_audit.audited += fragment->audited;
    if (!fragment->coupled) shv_surface_contact_invalidate(&hybrid->coupling.surface);
    const bool was_coupled_body = fragment->coupled;
    leave_flight(hybrid, contact);
    if (fragment->deformed || straightens(hybrid)) event.cohesive_before = shv_audit_cohesive(hybrid, fragment);
    if (!was_coupled_body) bring_to_now(hybrid, fragment, contact->time);
    event.kinetic_before = shv_hybrid_kinetic_in_flight(hybrid, fragment);
    give_motion(hybrid, fragment);
    stand_outside(hybrid, fragment);
    wake_energies(hybrid, fragment, &event);
    fragment->mode = SHV_MODE_FRACTURE;
    fragment->quiet = 0;
    fragment->strain = 0.0;
    fragment->deformed = fragment->fixed = false;
    fragment->wake_energy = fmax(event.kinetic_after, energy_of_blow(fragment, contact)) / fragment->mass;
    fragment->load = contact->load;
    fragment->impact = severity(hybrid, contact);
    shv_hybrid_transit_times(hybrid, fragment, &fragment->woken_transit, &bending);
    shv_waking_contact_begin(hybrid, fragment, contact);
    shv_hybrid_begin_growth(hybrid, fragment);
    hybrid->awake.stale = true;
    shv_check_clock_start(&hybrid->check.clock);
    step_back(hybrid, fragment);
    SHV_TRY(take_partner(hybrid, contact, error));
    shv_costs_add(&hybrid->costs, SHV_COST_HANDOVER, start);
    return shv_audit_close(hybrid, &event, error);
}
