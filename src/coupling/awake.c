#include "coupling/hybrid.h"

#include <string.h>

ShvStatus shv_awake_reserve(ShvHybrid *hybrid, ShvError *error)
{
    ShvAwake *awake = &hybrid->awake;
    SHV_RESERVE(hybrid->memory, SHV_PART_STATE, awake->flags, awake->flag_capacity, hybrid->fragments.capacity,
                "awake fragments", error);
    SHV_RESERVE(hybrid->memory, SHV_PART_STATE, awake->nodes, awake->node_capacity, hybrid->state.node_capacity,
                "awake nodes", error);
    return SHV_OK;
}

static void list_nodes(ShvHybrid *hybrid)
{
    ShvAwake *awake = &hybrid->awake;
    const ShvFragments *fragments = &hybrid->fragments;
    awake->count = awake->element_count = awake->node_count = 0;
    for (int32_t i = 0; i < fragments->count; i++) {
        const ShvFragment *fragment = &fragments->items[i];
        awake->flags[i] = fragment->mode == SHV_MODE_FRACTURE;
        if (!awake->flags[i]) continue;
        awake->count++;
        awake->element_count += fragment->element_count;
        memcpy(awake->nodes + awake->node_count, fragments->nodes + fragment->node_begin,
               (size_t)fragment->node_count * sizeof(int32_t));
        awake->node_count += fragment->node_count;
    }
}

static void mark_batches(ShvHybrid *hybrid)
{
    const int32_t *element_fragment = hybrid->state.element_fragment;
    memset(hybrid->solid.batch_active, 0, (size_t)hybrid->solid.batch_count);
    for (int32_t e = 0; e < hybrid->state.element_count; e++)
        if (hybrid->awake.flags[element_fragment[e]]) hybrid->solid.batch_active[e / SHV_LANES] = 1;
    shv_solid_follow_active(&hybrid->solid, element_fragment, hybrid->awake.flags);
    shv_solid_update_batch_steps(&hybrid->solid, element_fragment, hybrid->awake.flags);
}

ShvStatus shv_awake_refresh(ShvHybrid *hybrid, ShvError *error)
{
    if (!hybrid->awake.stale) return SHV_OK;
    SHV_TRY(shv_awake_reserve(hybrid, error));
    if (hybrid->coupling.bodies.count > 0) SHV_TRY(shv_coupled_bodies_reserve(hybrid, error));
    list_nodes(hybrid);
    mark_batches(hybrid);
    if (hybrid->model.can_break) shv_cohesive_watch(&hybrid->cohesive, &hybrid->state, hybrid->awake.flags);
    hybrid->stabiliser.stale = true;
    if (hybrid->awake.count > 0)
        hybrid->steps.bulk = shv_solid_stable_step(&hybrid->solid, NULL);
    else
        hybrid->steps.strained = HUGE_VAL;
    hybrid->awake.stale = false;
    return SHV_OK;
}

ShvStatus shv_awake_follow(ShvHybrid *hybrid, ShvError *error)
{
    if (hybrid->awake.stale) return shv_awake_refresh(hybrid, error);
    SHV_TRY(shv_awake_reserve(hybrid, error));
    if (hybrid->coupling.bodies.count > 0) SHV_TRY(shv_coupled_bodies_reserve(hybrid, error));
    list_nodes(hybrid);
    if (hybrid->scene->fracture.criterion == SHV_CRITERION_PRINCIPAL) /* whose nodes are other ones now */
        shv_cohesive_watch(&hybrid->cohesive, &hybrid->state, hybrid->awake.flags);
    hybrid->stabiliser.stale = true;
    return SHV_OK;
}
