/* Out of fracture mode: when a fragment may rest, and who takes it then. A rigid motion is fitted to its nodes; momentum and
   angular momentum pass unchanged, and the energy of vibration, strain and open cohesive zones that a rigid body cannot carry
   is dropped, booked and logged. */
#include "coupling/hybrid.h"

#include <string.h>

#include "fragment/residual_strength.h"

/* Damage that grows is activity when it takes more than this share of the energy with which the body woke in two transits of the
   bar wave. */
static const double growth_share = 1e-3;
/* What a rigid body cannot carry is small below this share. */
static const double carried_share = 0.05;
/* Cracks open wider than this share of an edge are not closed again by going to rest. */
static const double widest_closed = 0.01;

/* How long vibration needs: one transit of the longest extent by the bar wave, and by the slowest bending wave of a plate
   of the shortest extent (half the period of its free fundamental, f = 1.03 c₀ h/L²). */
void shv_hybrid_transit_times(const ShvHybrid *hybrid, const ShvFragment *fragment, double *bar, double *bending)
{
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
    const double longest = fragment->sides[0], shortest = fragment->sides[2];
    *bar = longest / material->bar_speed;
    *bending = shortest > 0.0 ? fmax(*bar, 0.5 * longest * longest / (1.03 * material->bar_speed * shortest)) : *bar;
}

/* When it cracked last or, if it has not since, was touched by what woke it. */
static double time_of_last_crack(const ShvFragment *fragment)
{
    return fmax(fragment->last_insertion, fragment->last_crack);
}

/* The same or, on supports, when something could strike it last, if that was later. */
static double last_change(const ShvFragment *fragment)
{
    return fmax(fragment->last_approach, time_of_last_crack(fragment));
}

/* How long a body may vibrate before it rests whatever it carries, in transits of the bending wave; and how many times as long
   where a crack that still holds has moved since it woke: such cracks go on, a little, for about a hundred transits. Those are of
   the piece itself, whose vibration moves them; but it bears the blow for as long as waves cross what woke, which those of the bar
   do most directly: so many transits of theirs, at least. */
static const double longest_transits = 20.0, cracked_window = 5.0;

double shv_hybrid_longest(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double bar, bending;
    if (hybrid->scene->fracture.longest > 0.0) return hybrid->scene->fracture.longest;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    return longest_transits * fmax(bending, fragment->woken_transit);
}

static double window(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double whole = shv_hybrid_longest(hybrid, fragment);
    const bool chosen = hybrid->scene->fracture.longest > 0.0;
    if (chosen || !hybrid->fragments.bonds || !(fragment->last_crack > -HUGE_VAL)) return whole;
    const bool held = shv_cohesive_holds_cracks(&hybrid->cohesive, hybrid->fragments.elements + fragment->element_begin,
                                                fragment->element_count);
    double bar, bending;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    return held ? fmax(cracked_window * longest_transits * bending, whole) : whole;
}

/* The energy against which what a body carries is small or not: that with which it woke and, where cracks have moved since,
   what its minimum cut would take. A bound by the energy of the impact alone would stop cracks that go on: a piece of a hard
   impact carries many times what its section costs, and one that hangs by a last bond comes off with next to nothing. */
static double reference_energy(const ShvFragment *fragment)
{
    const double wake = fragment->wake_energy * fragment->mass;
    return fragment->cut_time >= last_change(fragment) ? fmin(wake, fragment->cut_energy) : wake;
}

/* The minimum cut is looked for anew when something has cracked since; what woke it without moving a crack leaves too little for
   that. */
static ShvStatus find_minimum_cut(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[index];
    ShvResidual residual;
    if (!hybrid->model.can_break || !(fragment->last_crack > -HUGE_VAL) || fragment->cut_time >= last_change(fragment))
        return SHV_OK;
    SHV_TRY(
        shv_fragment_residual_strength(&hybrid->fragments, &hybrid->cohesive, &hybrid->state, index, &residual, error));
    fragment->cut_time = hybrid->state.time;
    fragment->cut_energy = residual.energy;
    return SHV_OK;
}

static double dissipated(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return shv_cohesive_dissipated(&hybrid->cohesive, hybrid->fragments.elements + fragment->element_begin,
                                   fragment->element_count);
}

void shv_hybrid_begin_growth(const ShvHybrid *hybrid, ShvFragment *fragment)
{
    fragment->growth_time = fragment->last_insertion;
    fragment->last_crack = fragment->cut_time = fragment->last_pressed = -HUGE_VAL;
    fragment->growth_sum = fragment->cracked && hybrid->fragments.bonds ? dissipated(hybrid, fragment) : 0.0;
}

void shv_hybrid_note_damage(const ShvHybrid *hybrid, ShvFragment *fragment)
{
    fragment->growth_time = hybrid->state.time;
    fragment->growth_sum = dissipated(hybrid, fragment);
}

/* Whether damage has grown little since it was looked at last, two transits of the bar wave ago or earlier. */
static bool damage_rests(const ShvHybrid *hybrid, const ShvFragment *fragment, double bar)
{
    if (!fragment->cracked || !hybrid->fragments.bonds) return true;
    if (!(hybrid->state.time - fragment->growth_time >= 2.0 * bar)) return false;
    return dissipated(hybrid, fragment) - fragment->growth_sum <= growth_share * fragment->wake_energy * fragment->mass;
}

/* Notes the damage of fragments in which something has been inserted since it was noted last, or whose damage has grown: from now
   on they are to be quiet. */
static void track_damage(ShvHybrid *hybrid)
{
    const double now = hybrid->state.time;
    for (int32_t i = 0; i < hybrid->fragments.count && hybrid->fragments.bonds; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[i];
        double bar, bending;
        if (fragment->mode != SHV_MODE_FRACTURE || !fragment->cracked || fragment->last_insertion > now) continue;
        shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
        const bool inserted = fragment->last_insertion > fragment->growth_time;
        const bool grown = now - fragment->growth_time >= 2.0 * bar && !damage_rests(hybrid, fragment, bar);
        if (!inserted && !grown) continue;
        if (grown) fragment->last_crack = now;
        shv_hybrid_note_damage(hybrid, fragment);
    }
}

static bool window_is_over(const ShvHybrid *hybrid, const ShvFragment *fragment, double begun)
{
    const double age = hybrid->state.time - begun;
    return age >= shv_hybrid_longest(hybrid, fragment) && age >= window(hybrid, fragment);
}

/* A fragment may rest when nothing has broken in it for the scene's number of checks and for two transits of the bar wave, no
   damage grows, the contact that woke it is over, and what a rigid body cannot carry (which bounds its stress) is small
   against the energy it woke with; or when the longest window is over. */
static ShvSwitchReason reason_to_rest(const ShvHybrid *hybrid, const ShvFragment *fragment, double carried)
{
    double bar, bending;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    if (window_is_over(hybrid, fragment, last_change(fragment))) return SHV_REASON_LONGEST;
    if (fragment->quiet < fracture->quiet_checks) return SHV_REASON_NONE;
    /* The chapter's rule: a number of checks without insertion is enough, touching or not. */
    if (hybrid->scene->rigid.wake == SHV_WAKE_CONTACT) return SHV_REASON_CHECKS;
    const double age = hybrid->state.time - last_change(fragment);
    if (age < 2.0 * bar || !shv_waking_contact_is_over(hybrid, fragment, bar)) return SHV_REASON_NONE;
    const bool little = carried <= carried_share * reference_energy(fragment);
    return little && damage_rests(hybrid, fragment, bar) ? SHV_REASON_QUIET : SHV_REASON_NONE;
}

/* Until when a body does not rest since obstacles that move have pressed it: its motion against theirs tells so between vibrations only. */
static double end_of_pressure(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return isfinite(fragment->strength) ? fragment->last_pressed + shv_hybrid_longest(hybrid, fragment) : -HUGE_VAL;
}

void shv_hybrid_rest_between(const ShvHybrid *hybrid, const ShvFragment *fragment, double *soonest, double *latest)
{
    double bar, bending;
    const double now = hybrid->state.time;
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    *soonest = *latest = HUGE_VAL;
    if (shv_hybrid_can_fix(hybrid, fragment)) *latest = fmax(now, last_change(fragment) + window(hybrid, fragment));
    if (shv_hybrid_is_held(hybrid, fragment)) return;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    const int32_t checks = fracture->quiet_checks - fragment->quiet;
    const double counted = now + (checks > 0 ? checks : 0) * hybrid->check.clock.due * hybrid->steps.last;
    const bool by_checks = hybrid->scene->rigid.wake == SHV_WAKE_CONTACT;
    *soonest = by_checks ? counted : fmax(counted, last_change(fragment) + 2.0 * bar);
    *latest = fmax(now, last_change(fragment) + window(hybrid, fragment));
    if (by_checks) *latest = fmin(*latest, counted);
    *latest = fmax(*latest, end_of_pressure(hybrid, fragment));
    *soonest = fmax(fmin(*soonest, *latest), end_of_pressure(hybrid, fragment));
}

/* Nothing that the cheap half of the rule forbids; only then is the motion brought to the present time. What is held rests when all that
   is awake can: neighbours, as shards in a frame, would wake each other. */
static bool may_be_quiet(const ShvHybrid *hybrid, const ShvFragment *fragment, bool all_can_be_fixed)
{
    if (fragment->mode != SHV_MODE_FRACTURE || reason_to_rest(hybrid, fragment, 0.0) == SHV_REASON_NONE) return false;
    if (hybrid->state.time < end_of_pressure(hybrid, fragment)) return false;
    return all_can_be_fixed || !shv_hybrid_is_held(hybrid, fragment);
}

/* What a fragment carries in the terms of the ledger, without the others' impulses (shv_hybrid_velocities_without_impulses): kinetic energy
   ½ m v₋·v₊ with v₊ = 2 v − v₋, and strain. */
static void carried_energy(const ShvHybrid *hybrid, const ShvFragment *fragment, double *kinetic, double *strain)
{
    const ShvState *state = &hybrid->state;
    *kinetic = 0.0;
    *strain = shv_audit_strain(hybrid, fragment);
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int64_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const ShvVec3 v = shv_load3(state->velocity + 3 * node),
                      before = shv_load3(hybrid->observer.ghost.before + 3 * node);
        *kinetic += 0.5 * state->mass[node] * shv_dot(before, shv_sub(shv_scale(v, 2.0), before));
    }
}

/* ---- who takes it ---- */

typedef enum Taker {
    TAKER_RIGID, /* the rigid engine */
    TAKER_NODES, /* one that keeps nodes as they are, with the velocities of now */
    TAKER_KEPT,  /* the rigid engine; the nodes keep their deformation until they wake */
    TAKER_BIN    /* nobody */
} Taker;

static bool is_dust(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return hybrid->scene->rigid.dust != SHV_DUST_KEEP && 2.0 * fragment->radius < hybrid->scene->rigid.dust_size;
}

static Taker taker_of(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const bool dust = is_dust(hybrid, fragment);
    if (dust && hybrid->scene->rigid.dust == SHV_DUST_BIN) return TAKER_BIN;
    if (hybrid->backend->keeps_nodes) return TAKER_NODES;
    if (dust) return TAKER_RIGID; /* which never wakes */
    if (hybrid->scene->fracture.deformation == SHV_DEFORMATION_KEEP) return TAKER_KEPT;
    if (!fragment->cracked || !hybrid->fragments.bonds) return TAKER_RIGID;
    const double widest =
        shv_cohesive_widest(&hybrid->cohesive, &hybrid->state, hybrid->fragments.elements + fragment->element_begin,
                            fragment->element_count);
    return widest > widest_closed ? TAKER_KEPT : TAKER_RIGID;
}

static void keep_velocities(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int64_t i = 3 * (int64_t)hybrid->fragments.nodes[fragment->node_begin + k];
        memcpy(hybrid->observer.ghost.before + i, hybrid->state.velocity + i, 3 * sizeof(double));
    }
}

/* Its momentum stays in the sums. */
static void bin(ShvHybrid *hybrid, ShvFragment *fragment, const ShvEventView *event)
{
    shv_add_to3(hybrid->binned.momentum, shv_load3(event->momentum_after));
    shv_add_to3(hybrid->binned.angular, shv_load3(event->angular_after));
    fragment->velocity = fragment->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
    fragment->mode = SHV_MODE_BINNED;
}

void shv_hybrid_scatter(ShvHybrid *hybrid, const ShvFragment *fragment)
{
    shv_fragment_scatter(fragment, &hybrid->fragments, &hybrid->state);
    shv_solid_reset_offsets(&hybrid->solid, hybrid->fragments.elements + fragment->element_begin,
                            fragment->element_count);
}

/* Of the fitted record; a rigid body has it from here on. */
static void hand_over(ShvHybrid *hybrid, ShvFragment *fragment, Taker taker, ShvEventView *event)
{
    if (taker == TAKER_NODES)
        keep_velocities(hybrid, fragment);
    else if (taker == TAKER_KEPT)
        shv_audit_rigid(fragment, event->momentum_after, event->angular_after);
    else
        shv_hybrid_scatter(hybrid, fragment);
    if (taker != TAKER_KEPT) shv_audit_nodes(hybrid, fragment, event->momentum_after, event->angular_after, NULL);
    fragment->mode = SHV_MODE_FLIGHT;
    double bar, bending;
    shv_hybrid_transit_times(hybrid, fragment, &bar, &bending);
    if (shv_waking_contact_is_over(hybrid, fragment, bar)) {
        fragment->borne = fmax(fragment->borne, fragment->load);
        fragment->borne_impact = fmax(fragment->borne_impact, fragment->impact);
    }
    fragment->borne_spin = shv_hybrid_centrifugal_stress(fragment);
    fragment->deformed = taker == TAKER_KEPT;
    fragment->strain = event->strain_after;
    fragment->rest_position = fragment->position;
    fragment->rest_orientation = fragment->orientation;
    fragment->dust = is_dust(hybrid, fragment);
    fragment->audited = false;
    fragment->hulls = 0;
    fragment->hull_outside = fragment->hull_missing = 0.0;
    if (taker == TAKER_BIN) bin(hybrid, fragment, event);
    shv_surface_contact_invalidate(&hybrid->coupling.surface);
    hybrid->awake.stale = true;
}

/* The energies of a time without the others' impulses, before and after; the record is fitted. */
static void rest_energies(const ShvHybrid *hybrid, const ShvFragment *fragment, Taker taker, ShvEventView *event)
{
    ShvVec3 momentum, angular;
    double of_nodes;
    shv_fragment_momentum(fragment, &hybrid->fragments, &hybrid->state, &momentum, &angular, &of_nodes);
    carried_energy(hybrid, fragment, &event->kinetic_before, &event->strain_before);
    event->cohesive_before = shv_audit_cohesive(hybrid, fragment);
    if (taker != TAKER_BIN) event->kinetic_after = taker == TAKER_NODES ? of_nodes : shv_fragment_kinetic(fragment);
    if (taker == TAKER_KEPT) event->strain_after = event->strain_before;
    event->value = event->kinetic_before + event->strain_before - event->kinetic_after - event->strain_after;
}

/* It comes apart in the next step, perhaps. */
static bool loses_a_bond(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    return fragment->cracked && hybrid->fragments.bonds &&
           shv_cohesive_is_failing(&hybrid->cohesive, &hybrid->state,
                                   hybrid->fragments.elements + fragment->element_begin, fragment->element_count);
}

static ShvStatus note_strength(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    ShvResidual residual;
    SHV_TRY(
        shv_fragment_residual_strength(&hybrid->fragments, &hybrid->cohesive, &hybrid->state, index, &residual, error));
    hybrid->fragments.items[index].strength = residual.strength;
    hybrid->fragments.items[index].cut_energy = residual.energy;
    return SHV_OK;
}

static ShvStatus try_to_sleep(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const Taker taker = taker_of(hybrid, fragment);
    ShvEventView event = shv_audit_event(hybrid, taker == TAKER_BIN ? SHV_RUN_BIN : SHV_RUN_SLEEP, index);
    const bool held = shv_hybrid_is_held(hybrid, fragment);
    shv_fragment_fit(fragment, &hybrid->fragments, &hybrid->state);
    if (held) fragment->velocity = fragment->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
    rest_energies(hybrid, fragment, taker, &event);
    const double rigid = taker == TAKER_NODES ? event.kinetic_after : shv_fragment_kinetic(fragment);
    const double carried = event.kinetic_before - rigid + event.strain_before + event.cohesive_before;
    if (reason_to_rest(hybrid, fragment, carried) == SHV_REASON_NONE) return SHV_OK;
    SHV_TRY(find_minimum_cut(hybrid, index, error));
    event.reason = reason_to_rest(hybrid, fragment, carried);
    if (event.reason == SHV_REASON_NONE || loses_a_bond(hybrid, fragment)) return SHV_OK;

    /* Supports take the momentum of what they hold. */
    if (!held) shv_audit_nodes(hybrid, fragment, event.momentum_before, event.angular_before, &event);
    if (hybrid->model.can_break) shv_cohesive_settle(&hybrid->cohesive, &hybrid->state, index);
    if (hybrid->model.can_break) SHV_TRY(note_strength(hybrid, index, error));
    if (held && taker != TAKER_BIN) shv_hybrid_fix(hybrid, fragment, taker == TAKER_KEPT);
    hand_over(hybrid, fragment, taker, &event);
    event.cohesive_after = shv_audit_cohesive(hybrid, fragment);
    if (taker != TAKER_BIN) SHV_TRY(hybrid->backend->functions->add(hybrid->backend, index, error));
    shv_audit_hulls(fragment, &event);
    return shv_audit_close(hybrid, &event, error);
}

/* Their longest window over, for others might stay and wake them again; and no blow that they bear just now, for it would lose its rebound. */
static bool can_all_be_fixed(const ShvHybrid *hybrid)
{
    bool can = hybrid->imposed.count > 0;
    for (int32_t i = 0; i < hybrid->fragments.count && can; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FRACTURE) continue;
        can = window_is_over(hybrid, fragment, last_change(fragment)) && !loses_a_bond(hybrid, fragment) &&
              !shv_hybrid_is_struck(hybrid, fragment) && shv_hybrid_can_fix(hybrid, fragment);
    }
    return can;
}

/* Pieces that supports hold by nodes alone, so that they are mechanisms, come off when they should have calmed down: they would swing to
   the end. Neighbours, which come near them all the time, do not count. */
static void release_unrestrained(ShvHybrid *hybrid)
{
    const ShvFragments *fragments = &hybrid->fragments;
    if (!hybrid->model.can_break || hybrid->imposed.count == 0) return;
    for (int32_t i = 0; i < fragments->count; i++) {
        const ShvFragment *fragment = &fragments->items[i];
        const int32_t *nodes = fragments->nodes + fragment->node_begin;
        if (fragment->mode == SHV_MODE_FRACTURE && window_is_over(hybrid, fragment, time_of_last_crack(fragment)) &&
            shv_imposed_restraint(&hybrid->imposed, &hybrid->state, nodes, fragment->node_count,
                                  shv_load3(hybrid->gravity), fragment->position) == SHV_UNRESTRAINED)
            shv_imposed_release_nodes(&hybrid->imposed, &hybrid->state, nodes, fragment->node_count);
    }
}

static ShvStatus rest_quiet_ones(ShvHybrid *hybrid, ShvError *error)
{
    bool any = false;
    track_damage(hybrid);
    release_unrestrained(hybrid);
    shv_hybrid_find_pressed(hybrid);
    const bool all_can_be_fixed = can_all_be_fixed(hybrid);
    for (int32_t i = 0; i < hybrid->fragments.count && !any; i++)
        any = may_be_quiet(hybrid, &hybrid->fragments.items[i], all_can_be_fixed);
    if (!any) return SHV_OK;
    SHV_TRY(shv_hybrid_velocities_without_impulses(hybrid, error));
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (may_be_quiet(hybrid, &hybrid->fragments.items[i], all_can_be_fixed))
            SHV_TRY(try_to_sleep(hybrid, i, error));
    shv_hybrid_resume(hybrid);
    return shv_awake_refresh(hybrid, error);
}

/* Of all its energy, what a fragment carries beside its rigid motion, J. */
static double carried_beside(const ShvHybrid *hybrid, const ShvFragment *fragment, double kinetic, double strain)
{
    ShvFragment fitted = *fragment;
    shv_fragment_fit(&fitted, &hybrid->fragments, &hybrid->state);
    return kinetic - shv_fragment_kinetic(&fitted) + strain + shv_audit_cohesive(hybrid, fragment);
}

/* Whether what a fragment carries beside its rigid motion would let it rest now; velocities as shv_hybrid_velocities_without_impulses leaves
   them. */
static bool carries_little(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    double kinetic, strain;
    carried_energy(hybrid, fragment, &kinetic, &strain);
    return carried_beside(hybrid, fragment, kinetic, strain) <= carried_share * reference_energy(fragment);
}

/* Velocities as they stand, those of half a step ago: near enough for an estimate, and nothing has to be moved for it. */
double shv_hybrid_time_to_decay(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    ShvVec3 momentum, angular;
    double kinetic;
    shv_fragment_momentum(fragment, &hybrid->fragments, &hybrid->state, &momentum, &angular, &kinetic);
    const double carried = carried_beside(hybrid, fragment, kinetic, shv_audit_strain(hybrid, fragment));
    const double little = carried_share * reference_energy(fragment);
    return carried > little ? shv_hybrid_longest(hybrid, fragment) * log(carried / little) : 0.0;
}

/* Of the longest time: the shortest that an estimate of the rest reckons with. */
static const double least_expected = 0.01;

/* For how long a fragment stays awake, s. What carries little goes to rest unless it breaks again or is met again, which puts it
   off: between the bounds, at their geometric mean. */
static double expected_time(const ShvHybrid *hybrid, const ShvFragment *fragment, double until)
{
    double soonest, latest;
    shv_hybrid_rest_between(hybrid, fragment, &soonest, &latest);
    const double most = fmax(0.0, fmin(until, latest) - hybrid->state.time);
    const double least = fmin(most, fmax(0.0, soonest - hybrid->state.time));
    return carries_little(hybrid, fragment) ? sqrt(fmax(least, least_expected * most) * most) : most;
}

ShvStatus shv_hybrid_expect_rest(ShvHybrid *hybrid, double until, double *time, ShvError *error)
{
    double sum = 0.0, elements = 0.0;
    *time = 0.0;
    SHV_TRY(shv_hybrid_velocities_without_impulses(hybrid, error));
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FRACTURE) continue;
        sum += fragment->element_count * expected_time(hybrid, fragment, until);
        elements += fragment->element_count;
    }
    shv_hybrid_resume(hybrid);
    if (elements > 0.0) *time = sum / elements;
    return SHV_OK;
}

ShvStatus shv_hybrid_sleep_quiet(ShvHybrid *hybrid, ShvError *error)
{
    hybrid->check.since_rest = 0;
    if (hybrid->awake.count == 0) return SHV_OK;
    const double start = shv_now();
    SHV_TRY(rest_quiet_ones(hybrid, error));
    if (hybrid->awake.count == 0) SHV_TRY(shv_coupled_bodies_choose(hybrid, 0.0, error));
    shv_costs_add(&hybrid->costs, SHV_COST_HANDOVER, start);
    return SHV_OK;
}
