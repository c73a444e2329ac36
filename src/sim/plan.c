#include "shiver/plan.h"

#include <stdio.h>
#include <string.h>

#include "sim/internal.h"

static void add_part(ShvPlan *plan, const char *name, bool on, size_t bytes, const char *reason)
{
    ShvPlanPart *part = &plan->parts[plan->part_count++];
    part->name = name;
    part->on = on;
    part->bytes = bytes;
    snprintf(part->reason, sizeof part->reason, "%s", reason);
}

static const char *why_no_fracture(const ShvHybrid *hybrid)
{
    if (!hybrid->scene->fracture.enabled) return "fracture.enabled is false";
    return "no material is breakable with a finite strength";
}

static const char *why_flight(const ShvHybrid *hybrid)
{
    switch (hybrid->scene->rigid.engine) {
    case SHV_RIGID_PBD:
        return "fragments; nodes that bars keep rigid";
    case SHV_RIGID_BULLET:
        return hybrid->coupling.mutual ? "fragments, convex pieces, contacts between them" : "fragments in free flight";
    case SHV_RIGID_BULLET_PLAIN:
        return "fragments, convex pieces in a Bullet world";
    case SHV_RIGID_ANALYTIC:
        break;
    }
    return "fragments, nodes of their surfaces against obstacles";
}

static const char *why_contact(const ShvHybrid *hybrid)
{
    const bool obstacles = hybrid->obstacles.count > 0, conditions = hybrid->scene->condition_count > 0;
    if (hybrid->coupling.mutual)
        return "in fracture mode, nodes against obstacles, surfaces against each other; conditions";
    if (obstacles)
        return conditions ? "nodes may meet obstacles in fracture mode; conditions"
                          : "nodes may meet obstacles in fracture mode";
    return conditions ? "nodes of supports, velocities or tractions" : "nothing to touch";
}

static void list_fracture(const ShvHybrid *hybrid, const size_t *bytes, ShvPlan *plan)
{
    const bool breaks = hybrid->model.can_break;
    const bool principal = breaks && hybrid->scene->fracture.criterion == SHV_CRITERION_PRINCIPAL;
    const char *because = breaks ? "a material can break" : why_no_fracture(hybrid);
    add_part(plan, "adjacency", breaks, bytes[SHV_PART_ADJACENCY], because);
    add_part(plan, "stress", breaks, bytes[SHV_PART_STRESS], because);
    add_part(plan, "nodal stress", principal, 0,
             principal ? "principal criterion; its bytes are among those of stress"
                       : "only the principal criterion averages at nodes");
    add_part(plan, "cohesive facets", breaks, bytes[SHV_PART_COHESIVE], because);
}

static void list_movers(const ShvHybrid *hybrid, const size_t *bytes, ShvPlan *plan)
{
    const bool pbd = hybrid->scene->rigid.engine == SHV_RIGID_PBD, bars = hybrid->stabiliser.active || pbd;
    const ShvRigidEngine engine = hybrid->scene->rigid.engine;
    const bool plain = engine == SHV_RIGID_BULLET_PLAIN;
    add_part(plan, "bars", bars, bytes[SHV_PART_BARS],
             pbd    ? "rigid.engine is pbd"
             : bars ? "fracture.stabiliser is bars"
                    : "neither rigid.engine is pbd nor fracture.stabiliser bars");
    add_part(plan, "bullet", hybrid->coupling.mutual || plain, 0,
             hybrid->coupling.mutual      ? "bodies may meet; Bullet's own memory is not counted"
             : plain                      ? "rigid.engine is bullet_plain; Bullet's own memory is not counted"
             : engine == SHV_RIGID_BULLET ? "nothing can meet anything"
                                          : "rigid.engine is not bullet");
}

void shv_plan_list(const ShvHybrid *hybrid, const size_t *bytes, ShvPlan *plan)
{
    const bool obstacles = hybrid->obstacles.count > 0, conditions = hybrid->scene->condition_count > 0;
    plan->part_count = 0;
    add_part(plan, "reference mesh", true, bytes[SHV_PART_MESH], "always");
    add_part(plan, "solver state", true, bytes[SHV_PART_STATE], "nodes and elements of all objects");
    list_fracture(hybrid, bytes, plan);
    add_part(plan, "obstacles", obstacles, bytes[SHV_PART_SHAPE],
             obstacles ? "the scene has obstacles" : "the scene has none");
    add_part(plan, "contact", obstacles || conditions || hybrid->coupling.mutual, bytes[SHV_PART_CONTACT],
             why_contact(hybrid));
    add_part(plan, "conditions", conditions, 0,
             conditions ? "supports, velocities or tractions; their bytes are among those of contact"
                        : "the scene has none");
    list_movers(hybrid, bytes, plan);
    add_part(plan, "rigid flight", true, bytes[SHV_PART_RIGID], why_flight(hybrid));
    add_part(plan, "reports", true, bytes[SHV_PART_RECORD],
             "views of a frame, events, probes; the run file's own buffers come on top");
    add_part(plan, "simulation", true, bytes[SHV_PART_GENERAL] + bytes[SHV_PART_SCENE], "always");
    plan->bytes = 0;
    for (int32_t i = 0; i < plan->part_count; i++) plan->bytes += plan->parts[i].bytes;
}

/* Bars are listed, and nodes relaxed, for the first time in the first step: what one user of them will take, tried on bars
   and a relaxation that are put away again. */
static ShvStatus try_bars(const ShvHybrid *hybrid, size_t *bytes, ShvError *error)
{
    ShvBars bars = {0};
    ShvRelax relax = {0};
    SHV_TRY(shv_bars_create(&bars, &hybrid->model, hybrid->scene->pbd.form, error));
    ShvStatus status = shv_relax_create(&relax, &hybrid->model, &hybrid->obstacles, error);
    const size_t before = shv_memory_bytes(hybrid->memory, SHV_PART_BARS);
    if (status == SHV_OK) status = shv_bars_update(&bars, &hybrid->state, NULL, error);
    if (status == SHV_OK) status = shv_relax_begin(&relax, &hybrid->state, NULL, 0, error);
    *bytes = shv_memory_bytes(hybrid->memory, SHV_PART_BARS) - before;
    shv_relax_release(&relax);
    shv_bars_release(&bars);
    return status;
}

static bool something_flies(const ShvHybrid *hybrid)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].mode == SHV_MODE_FLIGHT) return true;
    return false;
}

static ShvStatus find_bars_to_come(const ShvHybrid *hybrid, size_t *bytes, ShvError *error)
{
    const bool flies = hybrid->scene->rigid.engine == SHV_RIGID_PBD && something_flies(hybrid);
    const size_t users = (hybrid->stabiliser.active ? 1u : 0u) + (flies ? 1u : 0u);
    *bytes = 0;
    if (users == 0) return SHV_OK;
    SHV_TRY(try_bars(hybrid, bytes, error));
    *bytes *= users;
    return SHV_OK;
}

/* One internal force evaluation of everything, the bulk of a step; forces are scratch between steps. */
static double time_step_cost(ShvHybrid *hybrid)
{
    enum { REPEATS = 5 };
    uint8_t *active = hybrid->solid.batch_active;
    const size_t batches = (size_t)hybrid->solid.batch_count;
    double best = HUGE_VAL;
    memset(active, 1, batches);
    shv_solid_follow_active(&hybrid->solid, NULL, NULL);
    for (int i = 0; i < REPEATS; i++) {
        const double start = shv_now();
        shv_motion_clear_force(&hybrid->state, NULL, hybrid->state.node_count, hybrid->model.threads);
        shv_solid_add_internal_force(&hybrid->solid, &hybrid->state);
        shv_motion_kick(&hybrid->state, NULL, hybrid->state.node_count, 0.0, hybrid->gravity, hybrid->model.threads);
        shv_motion_drift(&hybrid->state, NULL, hybrid->state.node_count, 0.0, hybrid->model.threads);
        const double force = shv_now() - start;
        /* A check now and then: counted at the rate of the scene, or every fifth step when automatic. */
        double check = 0.0;
        if (hybrid->model.can_break) {
            const double begin = shv_now();
            int32_t count = 0;
            shv_solid_stress(&hybrid->solid, &hybrid->state, hybrid->check.stress);
            if (hybrid->scene->fracture.criterion != SHV_CRITERION_PRINCIPAL) {
                shv_cohesive_watch(&hybrid->cohesive, &hybrid->state, NULL);
                shv_cohesive_candidates(&hybrid->cohesive, &hybrid->state, hybrid->check.stress, NULL,
                                        hybrid->check.candidates, hybrid->check.overstress, &count);
            }
            const int32_t every = hybrid->scene->fracture.check_every > 0 ? hybrid->scene->fracture.check_every : 5;
            check = (shv_now() - begin) / every;
        }
        best = fmin(best, force + check);
    }
    hybrid->awake.stale = true;
    return best;
}

/* Earliest time at which a fragment's bounding sphere on its free path meets an obstacle at rest: by marching in rigid
   steps, or coarser ones where a plan could not afford them. */
static double first_contact(const ShvHybrid *hybrid)
{
    enum { MOST_STEPS = 100000 };
    const double step = fmax(hybrid->scene->rigid.time_step, hybrid->scene->duration / MOST_STEPS);
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    for (double t = 0.0; t <= hybrid->scene->duration; t += step) {
        for (int32_t k = 0; k < hybrid->fragments.count; k++) {
            const ShvFragment *fragment = &hybrid->fragments.items[k];
            const ShvVec3 x = shv_madd(shv_madd(fragment->position, t, fragment->velocity), 0.5 * t * t, gravity);
            for (int32_t i = 0; i < hybrid->obstacles.count; i++)
                if (shv_obstacle_closest(&hybrid->obstacles.items[i], x, 2.0 * fragment->radius).gap <=
                    fragment->radius)
                    return t;
        }
    }
    return HUGE_VAL;
}

static double shortest_window(const ShvHybrid *hybrid, double step)
{
    double window = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count && hybrid->scene->rigid.wake != SHV_WAKE_CONTACT; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[fragment->object].material];
        window = fmax(window, 4.0 * fragment->radius / material->bar_speed);
    }
    const int32_t every = hybrid->scene->fracture.check_every > 0 ? hybrid->scene->fracture.check_every : 10;
    window = fmax(window, step * every * hybrid->scene->fracture.quiet_checks);
    return fmax(window, hybrid->scene->rigid.time_step);
}

static double longest_window(const ShvHybrid *hybrid)
{
    double window = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (isfinite(fragment->strength)) window = fmax(window, shv_hybrid_longest(hybrid, fragment));
    }
    return window;
}

ShvStatus shv_simulation_plan(ShvSimulation *simulation, ShvPlan *plan, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const ShvSceneDefinition *scene = hybrid->scene;
    if (simulation->started)
        return shv_fail(error, SHV_BAD_INPUT, "a plan is made before the first frame; make it from a new simulation");
    size_t bars_to_come, bytes[SHV_PART_COUNT];
    SHV_TRY(find_bars_to_come(hybrid, &bars_to_come, error));
    for (int i = 0; i < SHV_PART_COUNT; i++) bytes[i] = shv_memory_bytes(hybrid->memory, (ShvPart)i);
    bytes[SHV_PART_BARS] += bars_to_come;
    *plan = (ShvPlan){.bars = bytes[SHV_PART_BARS], .trial = {.first_wake = (double)NAN, .first_crack = (double)NAN}};
    shv_plan_list(hybrid, bytes, plan);
    plan->seconds_per_step = time_step_cost(hybrid);
    plan->step =
        isnan(scene->fracture.time_step) ? scene->fracture.safety * hybrid->steps.stable : scene->fracture.time_step;
    plan->steps_per_millisecond = 1e-3 / plan->step;
    plan->first_contact = first_contact(hybrid);
    if (hybrid->awake.count > 0)
        plan->awake_time = scene->duration;
    else if (plan->first_contact <= scene->duration)
        plan->awake_time = fmin(shortest_window(hybrid, plan->step), scene->duration - plan->first_contact);
    plan->longest_window = longest_window(hybrid);
    plan->predicted_steps = plan->awake_time / plan->step;
    plan->predicted_seconds = plan->predicted_steps * plan->seconds_per_step;
    plan->frames = (int32_t)fmin(1e9, (double)shv_frame_intervals(scene)) + 1;
    return shv_awake_refresh(hybrid, error);
}

/* Bodies in which a crack has moved rest when their vibration has decayed, others between the bounds, at the geometric mean, and
   seldom at once. Cracks go on and contacts last: a share of what is left of the window is always reckoned with. What is small
   costs little, and has its whole window. */
static double expected_rest(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    const double now = hybrid->state.time, shortest = 0.01, shortest_cracked = 0.3; /* of the longest */
    const double small = 0.02;                                                      /* of all tets */
    double soonest, latest;
    shv_hybrid_rest_between(hybrid, fragment, &soonest, &latest);
    const bool held = latest == HUGE_VAL;
    const double most = fmax(0.0, fmin(latest, hybrid->scene->duration) - now);
    if (fragment->last_crack > -HUGE_VAL) {
        if (held || fragment->element_count < small * hybrid->state.element_count) return now + most;
        return now + fmin(most, fmax(shortest_cracked * most, shv_hybrid_time_to_decay(hybrid, fragment)));
    }
    const double least = fmin(most, fmax(shortest * most, soonest - now));
    return now + sqrt(least * most);
}

ShvAwakeView shv_simulation_awake(const ShvSimulation *simulation)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    const double now = hybrid->state.time, always = 0.1 * hybrid->state.element_count;
    ShvAwakeView view = {.rest = now, .step = hybrid->steps.last};
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FRACTURE) continue;
        const double rest = expected_rest(hybrid, fragment);
        view.load += fragment->element_count;
        view.ahead += fragment->element_count * (rest - now);
        view.rest = fmax(view.rest, rest);
    }
    if (view.load > 0.0) view.load += always;
    view.ahead += always * (view.rest - now);
    return view;
}
