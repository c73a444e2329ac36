#include "coupling/hybrid.h"

ShvStatus shv_hybrid_forces(ShvHybrid *hybrid, ShvError *error)
{
    ShvState *state = &hybrid->state;
    const ShvAwake *awake = &hybrid->awake;
    double start = shv_now();
    if (!hybrid->check.forces_begun) {
        shv_motion_clear_force(state, awake->nodes, awake->node_count, hybrid->model.threads);
        shv_solid_add_internal_force(&hybrid->solid, state);
    }
    hybrid->check.forces_begun = false;
    start = shv_costs_add(&hybrid->costs, SHV_COST_FORCE, start);
    if (hybrid->stabiliser.active)
        hybrid->stabiliser.elastic_turnover +=
            state->last_step *
            fabs(shv_motion_power(state, state->force, awake->nodes, awake->node_count, hybrid->model.threads));
    SHV_TRY(shv_imposed_add_force(&hybrid->imposed, state, error));
    if (hybrid->model.can_break) {
        shv_cohesive_begin(&hybrid->cohesive, state, awake->flags);
        shv_costs_add(&hybrid->costs, SHV_COST_COHESIVE, start);
    }
    return SHV_OK;
}

void shv_hybrid_book_forces(ShvHybrid *hybrid, double after)
{
    const ShvImposed *imposed = &hybrid->imposed;
    ShvLedger *ledger = &hybrid->observer.ledger;
    if (hybrid->model.can_break) shv_cohesive_book(&hybrid->cohesive, &hybrid->state, after, ledger);
    shv_vibration_damping_book(hybrid, after);
    const ShvSurfaceBodies bodies = shv_hybrid_bodies(hybrid);
    shv_surface_contact_book(&hybrid->coupling.surface, &bodies);
    shv_surface_contact_book_ledger(&hybrid->coupling.surface, ledger);
    shv_ledger_book(ledger, SHV_WORK_CONSTRAINT, imposed->constraint_work[0], imposed->constraint_work[1]);
    shv_ledger_book(ledger, SHV_WORK_TRACTION, imposed->traction_work[0], imposed->traction_work[1]);
}

void shv_hybrid_pull_and_close(ShvHybrid *hybrid, double kick, double after)
{
    if (!hybrid->model.can_break) return;
    shv_cohesive_pull(&hybrid->cohesive, &hybrid->state, kick, after);
    shv_cohesive_close(&hybrid->cohesive, &hybrid->state, kick, after);
}

ShvStatus shv_hybrid_kick(ShvHybrid *hybrid, double before, double after, ShvError *error)
{
    if (hybrid->stabiliser.active) return shv_hybrid_kick_relaxed(hybrid, before, after, error);
    ShvState *state = &hybrid->state;
    const ShvAwake *awake = &hybrid->awake;
    const double kick = 0.5 * (before + after);
    shv_ledger_begin_step(&hybrid->observer.ledger);
    double start = shv_now();
    const ShvSurfaceBodies bodies = shv_hybrid_bodies(hybrid);
    SHV_TRY(shv_surface_contact_begin(&hybrid->coupling.surface, &bodies, after, error));
    start = shv_costs_add(&hybrid->costs, SHV_COST_CONTACT, start);
    SHV_TRY(shv_vibration_damping_add_force(hybrid, before, after, error));
    shv_motion_kick(state, awake->nodes, awake->node_count, kick, hybrid->gravity, hybrid->model.threads);
    shv_coupled_bodies_kick(hybrid, kick);
    start = shv_costs_add(&hybrid->costs, SHV_COST_MOTION, start);
    shv_hybrid_pull_and_close(hybrid, kick, after);
    start = shv_costs_add(&hybrid->costs, SHV_COST_COHESIVE, start);
    SHV_TRY(shv_surface_contact_apply(&hybrid->coupling.surface, &bodies, after, error));
    start = shv_costs_add(&hybrid->costs, SHV_COST_CONTACT, start);
    /* What closing and contact changed, the law must answer: its work is that of the openings that really come. */
    if (hybrid->model.can_break) shv_cohesive_pull(&hybrid->cohesive, state, kick, after);
    shv_costs_add(&hybrid->costs, SHV_COST_COHESIVE, start);
    shv_imposed_apply(&hybrid->imposed, state, before, after);
    shv_hybrid_book_forces(hybrid, after);
    return SHV_OK;
}

/* Of the number of steps: rounding of a quotient, which must make no step more. */
static const double rounding_of_steps = 1e-12;

/* Steps that follow strain become shorter at once and longer by no more than this share each: what vibrates strains up and down, and steps
   that did so with it would feed it. */
static const double growth_of_steps = 1e-3;

/* Of the stable step at rest: a shorter one is of tets stretched twentyfold, which nothing solid bears. */
static const double least_strained = 0.05;

static ShvStatus follow_strain(ShvHybrid *hybrid, ShvError *error)
{
    ShvSteps *steps = &hybrid->steps;
    steps->strained = fmin(shv_solid_strained_step(&hybrid->solid), (1.0 + growth_of_steps) * steps->strained);
    const bool chosen = !isnan(hybrid->scene->fracture.time_step); /* which strain does not change */
    if (chosen || !(steps->strained < least_strained * steps->bulk)) return SHV_OK;
    return shv_fail(
        error, SHV_DIVERGED,
        "at %g s strain has made the stable step %.3g times as long as at rest: tets are stretched beyond what a "
        "solid bears, or the motion has become unstable; look for speeds out of all proportion, or give a smaller "
        "fracture.safety",
        hybrid->state.time, steps->strained / steps->bulk);
}

static double longest_step(const ShvHybrid *hybrid)
{
    const ShvFractureDefinition *fracture = &hybrid->scene->fracture;
    if (!isnan(fracture->time_step)) return fracture->time_step;
    return fracture->safety * fmin(hybrid->steps.bulk, hybrid->steps.strained);
}

/* No longer than the stable one, of the shape at rest and of the strained one. */
double shv_hybrid_choose_step(const ShvHybrid *hybrid, double limit)
{
    const double longest = longest_step(hybrid);
    return limit / fmax(1.0, ceil(limit / longest * (1.0 - rounding_of_steps)));
}

/* A diverging run is caught between frames too. */
static ShvStatus observe_now_and_then(ShvHybrid *hybrid, ShvError *error)
{
    enum { STEPS = 1000 };
    if (++hybrid->observer.steps_since < STEPS) return SHV_OK;
    hybrid->observer.steps_since = 0;
    return shv_hybrid_observe(hybrid, error);
}

/* Whether obstacles pushed nodes in the step just kicked, and with what impulse. */
static bool pushed_by_obstacles(const ShvHybrid *hybrid, ShvVec3 *impulse)
{
    *impulse = hybrid->coupling.surface.push;
    if (!hybrid->stabiliser.active) return hybrid->coupling.surface.pushed > 0;
    const ShvRelax *relax = &hybrid->stabiliser.relax;
    for (int32_t i = 0; i < relax->touch_count; i++)
        if (relax->touches[i].push > 0.0)
            *impulse = shv_add(*impulse, shv_add(relax->touches[i].impulse, relax->touches[i].friction));
    return relax->touching > 0;
}

static void count_contact(ShvHybrid *hybrid, double step)
{
    ShvVec3 impulse;
    if (!pushed_by_obstacles(hybrid, &impulse)) return;
    if (hybrid->obstacle_contact.steps++ == 0) hybrid->obstacle_contact.first = hybrid->state.time;
    hybrid->obstacle_contact.impulse = shv_add(hybrid->obstacle_contact.impulse, impulse);
    hybrid->obstacle_contact.time += step;
    hybrid->obstacle_contact.last = hybrid->state.time + step;
}

static ShvStatus sampled_kick(ShvHybrid *hybrid, double step, ShvError *error)
{
    const double before = hybrid->state.last_step;
    const ShvProbeScene scene = {&hybrid->solid, &hybrid->state, &hybrid->fragments, &hybrid->obstacles};
    const bool due = shv_probes_due(&hybrid->probes, &hybrid->state);
    if (due) SHV_TRY(shv_probes_begin(&hybrid->probes, &scene, hybrid->awake.flags, error));
    SHV_TRY(shv_hybrid_begin_step_change(hybrid, before, step, error));
    SHV_TRY(shv_hybrid_kick(hybrid, before, step, error));
    shv_hybrid_book_step_change(hybrid, before, step);
    const ShvRelax *relax = hybrid->stabiliser.active ? &hybrid->stabiliser.relax : NULL;
    if (due) shv_probes_end(&hybrid->probes, &scene, before, step, &hybrid->coupling.surface, relax, &hybrid->imposed);
    return SHV_OK;
}

ShvStatus shv_hybrid_substep(ShvHybrid *hybrid, double limit, ShvError *error)
{
    ShvState *state = &hybrid->state;
    shv_hybrid_choose_threads(hybrid);
    SHV_TRY(observe_now_and_then(hybrid, error));
    SHV_TRY(shv_hybrid_check(hybrid, error));
    SHV_TRY(shv_hybrid_forces(hybrid, error));
    SHV_TRY(shv_hybrid_split(hybrid, error));
    SHV_TRY(follow_strain(hybrid, error));
    const double step = shv_hybrid_choose_step(hybrid, limit);
    shv_obstacles_script_step(&hybrid->obstacles, state->time, step);
    SHV_TRY(sampled_kick(hybrid, step, error));
    count_contact(hybrid, step);
    shv_waking_contact_follow(hybrid);
    const double start = shv_now();
    if (hybrid->stabiliser.active)
        hybrid->stabiliser.bars_turnover +=
            fabs(hybrid->stabiliser.relax.work.bars[0] + hybrid->stabiliser.relax.work.bars[1]);
    else
        shv_motion_drift(state, hybrid->awake.nodes, hybrid->awake.node_count, step, hybrid->model.threads);
    shv_coupled_bodies_drift(hybrid, step);
    shv_costs_add(&hybrid->costs, SHV_COST_MOTION, start);
    state->time += step;
    state->last_step = step;
    state->step++;
    hybrid->steps.last = step;
    return shv_coupled_bodies_judge(hybrid, error);
}
