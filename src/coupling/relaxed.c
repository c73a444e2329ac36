/* Fracture mode with bars: between kick and time n + 1, position based projections hold edges near their rest length and
   nodes out of obstacles. They take the place of node contact and of the drift. */
#include <string.h>

#include "coupling/hybrid.h"

ShvStatus shv_hybrid_create_bars(ShvHybrid *hybrid, ShvError *error)
{
    SHV_TRY(shv_bars_create(&hybrid->stabiliser.bars, &hybrid->model, hybrid->scene->pbd.form, error));
    return shv_relax_create(&hybrid->stabiliser.relax, &hybrid->model, &hybrid->obstacles, error);
}

/* Bits of the components that conditions hold, which neither bars nor obstacles may change. */
static ShvStatus mark_fixed(ShvHybrid *hybrid, ShvError *error)
{
    const ShvImposed *imposed = &hybrid->imposed;
    if (imposed->count == 0) return SHV_OK;
    if (hybrid->stabiliser.fixed_capacity < hybrid->state.node_capacity) {
        const size_t count = (size_t)hybrid->state.node_capacity;
        SHV_RESIZE(hybrid->memory, SHV_PART_BARS, hybrid->stabiliser.fixed, count, "imposed components", count, error);
        hybrid->stabiliser.fixed_capacity = hybrid->state.node_capacity;
    }
    memset(hybrid->stabiliser.fixed, 0, (size_t)hybrid->state.node_count);
    for (int32_t i = 0; i < imposed->count; i++) {
        const ShvImposedCondition *item = &imposed->items[i];
        if (!shv_imposed_in_force(item, hybrid->state.time)) continue;
        const bool *axes = item->definition->axes;
        const uint8_t bits = (uint8_t)((axes[0] ? 1 : 0) | (axes[1] ? 2 : 0) | (axes[2] ? 4 : 0));
        for (int32_t k = 0; k < item->node_count; k++) hybrid->stabiliser.fixed[item->nodes[k]] |= bits;
    }
    return SHV_OK;
}

static ShvStatus refresh_bars(ShvHybrid *hybrid, ShvError *error)
{
    if (!hybrid->stabiliser.stale) return SHV_OK;
    hybrid->stabiliser.stale = false;
    return shv_bars_update(&hybrid->stabiliser.bars, &hybrid->state, hybrid->awake.flags, error);
}

static ShvRelaxStep settings_of(const ShvHybrid *hybrid, double step)
{
    const ShvPbdDefinition *pbd = &hybrid->scene->pbd;
    ShvRelaxStep settings = {.step = step,
                             .stiffness = pbd->stiffness,
                             .iterations = pbd->iterations,
                             .rest_speed = 2.0 * step * shv_norm(shv_load3(hybrid->gravity)),
                             .fixed = hybrid->imposed.count > 0 ? hybrid->stabiliser.fixed : NULL};
    memcpy(settings.gravity, hybrid->gravity, sizeof settings.gravity);
    return settings;
}

static ShvStatus relax(ShvHybrid *hybrid, const ShvRelaxStep *step, ShvError *error)
{
    const ShvAwake *awake = &hybrid->awake;
    shv_relax_predict(&hybrid->stabiliser.relax, &hybrid->state, awake->nodes, awake->node_count, step->step);
    SHV_TRY(shv_relax_detect(&hybrid->stabiliser.relax, &hybrid->state, &hybrid->obstacles, awake->nodes,
                             awake->node_count, step, error));
    return shv_relax_run(&hybrid->stabiliser.relax, &hybrid->stabiliser.bars, &hybrid->state, &hybrid->obstacles,
                         awake->nodes, awake->node_count, step, error);
}

/* What went wrong with a step too long for the bars can only be judged by its Courant number. */
static ShvStatus relax_or_explain(ShvHybrid *hybrid, const ShvRelaxStep *step, ShvError *error)
{
    const ShvStatus status = relax(hybrid, step, error);
    if (status != SHV_DIVERGED) return status;
    return shv_fail_within(
        error, status, "step %lld, t = %.9g s, Courant number %.3g (fracture.time_step over the stable step %.3g s)",
        (long long)hybrid->state.step, hybrid->state.time, step->step / hybrid->steps.bulk, hybrid->steps.bulk);
}

ShvStatus shv_hybrid_kick_relaxed(ShvHybrid *hybrid, double before, double after, ShvError *error)
{
    ShvState *state = &hybrid->state;
    const ShvAwake *awake = &hybrid->awake;
    const double kick = 0.5 * (before + after), start = shv_now();
    shv_ledger_begin_step(&hybrid->observer.ledger);
    SHV_TRY(refresh_bars(hybrid, error));
    SHV_TRY(mark_fixed(hybrid, error));
    SHV_TRY(shv_relax_begin(&hybrid->stabiliser.relax, state, awake->nodes, awake->node_count, error));
    const ShvSurfaceBodies bodies = shv_hybrid_bodies(hybrid);
    SHV_TRY(shv_surface_contact_begin(&hybrid->coupling.surface, &bodies, after, error));
    SHV_TRY(shv_vibration_damping_add_force(hybrid, before, after, error));
    shv_motion_kick(state, awake->nodes, awake->node_count, kick, hybrid->gravity, hybrid->model.threads);
    shv_coupled_bodies_kick(hybrid, kick);
    shv_hybrid_pull_and_close(hybrid, kick, after);
    SHV_TRY(shv_surface_contact_apply(&hybrid->coupling.surface, &bodies, after, error));
    shv_imposed_apply(&hybrid->imposed, state, before, after);
    const ShvRelaxStep step = settings_of(hybrid, after);
    SHV_TRY(relax_or_explain(hybrid, &step, error));
    shv_imposed_book(&hybrid->imposed, state, before, after);
    shv_hybrid_book_forces(hybrid, after);
    shv_relax_book(&hybrid->stabiliser.relax, &hybrid->observer.ledger);
    shv_ledger_book(&hybrid->observer.ledger, SHV_WORK_CONTACT, 0.5 * hybrid->stabiliser.relax.obstacle_work,
                    0.5 * hybrid->stabiliser.relax.obstacle_work);
    shv_costs_add(&hybrid->costs, SHV_COST_BARS, start);
    return SHV_OK;
}

static double length(const double *positions, int32_t a, int32_t b)
{
    return shv_norm(shv_sub(shv_load3(positions + 3 * (int64_t)a), shv_load3(positions + 3 * (int64_t)b)));
}

double shv_hybrid_edge_strain(const ShvHybrid *hybrid)
{
    static const int ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    const ShvState *state = &hybrid->state;
    double largest = 0.0;
    for (int32_t e = 0; e < state->element_count; e++)
        for (int i = 0; i < 6; i++) {
            const int32_t a = shv_state_node(state, e, ends[i][0]), b = shv_state_node(state, e, ends[i][1]);
            const double rest = length(state->reference, a, b);
            const double now = shv_norm(shv_sub(shv_state_position(state, a), shv_state_position(state, b)));
            largest = fmax(largest, fabs(now / rest - 1.0));
        }
    return largest;
}
