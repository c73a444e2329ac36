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

static void list_parts(const ShvHybrid *hybrid, ShvPlan *plan)
{
    const ShvMemory *memory = hybrid->memory;
    const bool breaks = hybrid->model.can_break;
    const bool principal = breaks && hybrid->scene->fracture.criterion == SHV_CRITERION_PRINCIPAL;
    const char *because = breaks ? "a material can break" : why_no_fracture(hybrid);
    add_part(plan, "reference mesh", true, shv_memory_bytes(memory, SHV_PART_MESH), "always");
    add_part(plan, "solver state", true, shv_memory_bytes(memory, SHV_PART_STATE), "nodes and elements of all objects");
    add_part(plan, "adjacency", breaks, shv_memory_bytes(memory, SHV_PART_ADJACENCY), because);
    add_part(plan, "stress", breaks, shv_memory_bytes(memory, SHV_PART_STRESS), because);
    add_part(plan, "nodal stress", principal, 0,
             principal ? "principal criterion; grows at the first check"
                       : "only the principal criterion averages at nodes");
    add_part(plan, "cohesive facets", breaks, shv_memory_bytes(memory, SHV_PART_COHESIVE), because);
    add_part(plan, "obstacles", hybrid->obstacles.count > 0, shv_memory_bytes(memory, SHV_PART_SHAPE),
             hybrid->obstacles.count > 0 ? "the scene has obstacles" : "the scene has none");
    add_part(plan, "node contact", hybrid->obstacles.count > 0, shv_memory_bytes(memory, SHV_PART_CONTACT),
             hybrid->obstacles.count > 0 ? "nodes may meet obstacles in fracture mode" : "nothing to touch");
    add_part(plan, "conditions", hybrid->scene->condition_count > 0, 0,
             hybrid->scene->condition_count > 0 ? "supports, velocities or tractions" : "the scene has none");
    add_part(plan, "rigid flight", true, shv_memory_bytes(memory, SHV_PART_RIGID), "analytic backend, fragments");
    add_part(plan, "run file", true, shv_memory_bytes(memory, SHV_PART_RECORD), "buffers, once the run starts");
}

/* Bars are listed, and nodes relaxed, for the first time in the first step: what that will take, tried on bars that are put
   away again. */
static ShvStatus find_bars_to_come(const ShvHybrid *hybrid, size_t *bytes, ShvError *error)
{
    /* Bytes of a node's record in the relaxation, which keeps room for half as many again. */
    static const size_t relaxed_node = 205;
    const size_t users = (hybrid->relaxed ? 1u : 0u) + (hybrid->scene->rigid.engine == SHV_RIGID_PBD ? 1u : 0u);
    ShvBars bars;
    *bytes = 0;
    if (users == 0) return SHV_OK;
    SHV_TRY(shv_bars_create(&bars, &hybrid->model, hybrid->scene->pbd.form, error));
    const size_t before = shv_memory_bytes(hybrid->memory, SHV_PART_BARS);
    const ShvStatus status = shv_bars_update(&bars, &hybrid->state, NULL, error);
    const size_t listed = shv_memory_bytes(hybrid->memory, SHV_PART_BARS) - before;
    shv_bars_release(&bars);
    *bytes = users * (listed + 3 * (size_t)hybrid->state.node_count / 2 * relaxed_node);
    return status;
}

static void list_movers(const ShvHybrid *hybrid, size_t bars_to_come, ShvPlan *plan)
{
    const bool pbd = hybrid->scene->rigid.engine == SHV_RIGID_PBD, bars = hybrid->relaxed || pbd;
    const bool asked = hybrid->scene->rigid.engine == SHV_RIGID_BULLET;
    add_part(plan, "bars", bars, shv_memory_bytes(hybrid->memory, SHV_PART_BARS) + bars_to_come,
             pbd    ? "rigid.engine is pbd"
             : bars ? "fracture.stabiliser is bars"
                    : "neither rigid.engine is pbd nor fracture.stabiliser bars");
    add_part(plan, "bullet", hybrid->mutual, 0,
             hybrid->mutual ? "bodies may meet; Bullet's own memory is not counted"
             : asked        ? "nothing can meet anything"
                            : "rigid.engine is not bullet");
}

/* One internal force evaluation of everything, the bulk of a step; forces are scratch between steps. */
static double time_step_cost(ShvHybrid *hybrid)
{
    enum { REPEATS = 5 };
    uint8_t *active = hybrid->solid.batch_active;
    const size_t batches = (size_t)hybrid->solid.batch_count;
    double best = HUGE_VAL;
    memset(active, 1, batches);
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
            shv_solid_stress(&hybrid->solid, &hybrid->state, hybrid->stress);
            if (hybrid->scene->fracture.criterion == SHV_CRITERION_TRACTION) {
                shv_cohesive_watch(&hybrid->cohesive, &hybrid->state, NULL);
                shv_cohesive_candidates(&hybrid->cohesive, &hybrid->state, hybrid->stress, NULL, hybrid->candidates,
                                        hybrid->overstress, &count);
            }
            const int32_t every = hybrid->scene->fracture.check_every > 0 ? hybrid->scene->fracture.check_every : 5;
            check = (shv_now() - begin) / every;
        }
        best = fmin(best, force + check);
    }
    hybrid->awake.stale = true;
    return best;
}

/* Earliest moment at which a fragment's bounding sphere on its free path meets an obstacle at rest: by marching in rigid
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

ShvStatus shv_simulation_plan(ShvSimulation *simulation, ShvPlan *plan, ShvError *error)
{
    ShvHybrid *hybrid = &simulation->hybrid;
    const ShvSceneDefinition *scene = hybrid->scene;
    if (simulation->started)
        return shv_fail(error, SHV_BAD_INPUT, "a plan is made before the first frame; make it from a new simulation");
    size_t bars_to_come;
    SHV_TRY(find_bars_to_come(hybrid, &bars_to_come, error));
    *plan = (ShvPlan){.bytes = shv_memory_bytes(hybrid->memory, SHV_PART_COUNT) + bars_to_come};
    list_parts(hybrid, plan);
    list_movers(hybrid, bars_to_come, plan);
    plan->seconds_per_step = time_step_cost(hybrid);
    plan->step =
        isnan(scene->fracture.time_step) ? scene->fracture.safety * hybrid->stable_step : scene->fracture.time_step;
    plan->steps_per_millisecond = 1e-3 / plan->step;
    plan->first_contact = first_contact(hybrid);
    if (hybrid->awake.count > 0)
        plan->awake_time = scene->duration;
    else if (plan->first_contact <= scene->duration)
        plan->awake_time = fmin(shortest_window(hybrid, plan->step), scene->duration - plan->first_contact);
    plan->predicted_steps = plan->awake_time / plan->step;
    plan->predicted_seconds = plan->predicted_steps * plan->seconds_per_step;
    plan->frames = (int32_t)fmin(1e9, (double)shv_frame_intervals(scene)) + 1;
    return shv_awake_refresh(hybrid, error);
}
