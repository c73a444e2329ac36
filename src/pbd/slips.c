#include "pbd/slips.h"

/* A moment later, the slips of this step are those of the one before; after a pause there was none. */
static void turn_over(ShvRelax *relax, const ShvState *state)
{
    if (!(state->time > relax->slip_time)) return;
    const ShvRelaxSlips past = relax->past;
    relax->past = relax->slips;
    relax->slips = past;
    relax->slips.count = 0;
    relax->slip_time = state->time;
    if (!(state->last_step > 0.0)) relax->past.count = 0;
}

void shv_slips_begin(ShvRelax *relax, const ShvState *state)
{
    turn_over(relax, state);
    const ShvVec3 unlisted = {(double)NAN, (double)NAN, (double)NAN};
    for (int32_t i = 0; i < relax->past.count; i++)
        shv_store3(relax->force + 3 * (int64_t)relax->past.items[i].node, unlisted);
}

ShvStatus shv_slips_start(ShvRelax *relax, const ShvState *state, const ShvRelaxStep *step, ShvError *error)
{
    ShvRelaxSlips *slips = &relax->slips;
    slips->count = 0;
    if (step->synchronous) return SHV_OK;
    if (relax->touch_count > slips->room) {
        const int32_t room = relax->touch_room;
        ShvRelaxSlip *items =
            shv_reallocate(relax->memory, SHV_PART_BARS, slips->items, (size_t)room, sizeof *slips->items);
        if (!items) return shv_fail_memory(error, "slips of nodes", (size_t)room * sizeof *items);
        slips->items = items;
        slips->room = room;
    }
    for (int32_t t = 0; t < relax->touch_count; t++) {
        const int32_t node = relax->touches[t].node;
        if (relax->first_touch[node] != t) continue;
        const ShvVec3 change =
            shv_sub(shv_load3(relax->shifts + 4 * (int64_t)node), shv_load3(relax->predicted + 3 * (int64_t)node));
        const ShvVec3 displacement = shv_madd(change, step->step, shv_load3(state->velocity + 3 * (int64_t)node));
        slips->items[slips->count++] = (ShvRelaxSlip){node, displacement};
    }
    return SHV_OK;
}

static void add_slip_work(const ShvRelax *relax, const ShvState *state, const ShvRelaxStep *step, ShvRelaxSlips *slips)
{
    slips->work = 0.0;
    for (int32_t i = 0; i < slips->count; i++) {
        const int64_t node = slips->items[i].node;
        const ShvVec3 force = shv_madd(shv_load3(relax->force + 3 * node), state->mass[node], shv_load3(step->gravity));
        if (shv_finite3(force)) slips->work -= 0.5 * shv_dot(force, slips->items[i].displacement);
    }
}

void shv_slips_finish(ShvRelax *relax, const ShvState *state, const ShvRelaxStep *step)
{
    ShvRelaxSlips *slips = &relax->slips;
    for (int32_t i = 0; i < slips->count; i++)
        slips->items[i].displacement = shv_madd(slips->items[i].displacement, -step->step,
                                                shv_load3(state->velocity + 3 * (int64_t)slips->items[i].node));
    add_slip_work(relax, state, step, slips);
    add_slip_work(relax, state, step, &relax->past);
}
