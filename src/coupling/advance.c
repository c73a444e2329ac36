#include "coupling/hybrid.h"

#include <stdlib.h>
#include <string.h>

static bool interrupted(const ShvHybrid *hybrid)
{
    return hybrid->stop && hybrid->stop(hybrid->stop_data);
}

static int by_time(const void *a, const void *b)
{
    const ShvRigidContact *first = a, *second = b;
    if (first->time != second->time) return first->time < second->time ? -1 : 1;
    return (first->fragment > second->fragment) - (first->fragment < second->fragment);
}

static ShvStatus reserve_wakes(ShvHybrid *hybrid, ShvError *error)
{
    SHV_RESERVE(hybrid->memory, SHV_PART_RIGID, hybrid->wakes.items, hybrid->wakes.capacity, hybrid->fragments.alive,
                "impacts", error);
    return SHV_OK;
}

/* Flight of the present interval, of all that has not flown in it yet. */
static ShvStatus fly(ShvHybrid *hybrid, ShvError *error)
{
    const double now = hybrid->state.time, start = shv_now(), by_bars = hybrid->backend->bars_work;
    SHV_TRY(hybrid->backend->functions->advance(hybrid->backend, now, hybrid->interval_end - now, hybrid->gravity,
                                                shv_hybrid_judge, hybrid, hybrid->wakes.items, &hybrid->wakes.count,
                                                error));
    hybrid->stabiliser.bars_turnover += fabs(hybrid->backend->bars_work - by_bars);
    shv_costs_add(&hybrid->costs, SHV_COST_FLIGHT, start);
    qsort(hybrid->wakes.items, (size_t)hybrid->wakes.count, sizeof(ShvRigidContact), by_time);
    return SHV_OK;
}

/* Beside what is awake: what flies learns of what happens there from one interval to the next, so that they are a tenth as long;
   but there is no use in less than a few steps of fracture mode. */
static double longest_interval(const ShvHybrid *hybrid)
{
    enum { LEAST_STEPS = 16 };
    const double share = 0.1, flight = hybrid->scene->rigid.time_step;
    if (hybrid->awake.count == 0 || !hybrid->coupling.mutual) return flight;
    return fmin(flight, fmax(share * flight, LEAST_STEPS * hybrid->steps.last));
}

/* Of an interval, and of a step: rounding of times, which must make no interval or step more. */
static const double rounding_of_interval = 1e-9, rounding_of_step = 1e-6;

/* Rigid interval from the present time: a whole number of equal ones make up what is left until `until`, ending no later than the
   next event of the time line. All flight of the interval happens here. */
static ShvStatus begin_interval(ShvHybrid *hybrid, double until, ShvError *error)
{
    const double now = hybrid->state.time;
    const double end = fmin(until, shv_hybrid_next_event_time(hybrid));
    const double steps = ceil((end - now) / longest_interval(hybrid) * (1.0 - rounding_of_interval));
    const double step = (end - now) / fmax(1.0, steps);
    hybrid->interval_end = steps > 1.0 ? now + step : end;
    SHV_TRY(reserve_wakes(hybrid, error));
    hybrid->wakes.count = 0;
    hybrid->wakes.next = 0;
    shv_hybrid_hold_waiting(hybrid);
    SHV_TRY(shv_hybrid_wake_spinning(hybrid, error));
    shv_obstacles_script_step(&hybrid->obstacles, now, hybrid->interval_end - now);
    SHV_TRY(shv_hybrid_wake_approached(hybrid, error));
    SHV_TRY(shv_hybrid_wake_squeezed(hybrid, error));
    SHV_TRY(shv_coupled_bodies_choose(hybrid, hybrid->interval_end - now, error));
    shv_coupled_bodies_to_flight(hybrid);
    SHV_TRY(fly(hybrid, error));
    shv_coupled_bodies_from_flight(hybrid);
    return SHV_OK;
}

/* Fragments that awoke in this interval may come to rest before its end, and fly the rest of it. */
static ShvStatus rest_early(ShvHybrid *hybrid, ShvError *error)
{
    const int32_t awake = hybrid->awake.count;
    SHV_TRY(shv_hybrid_sleep_quiet(hybrid, error));
    if (hybrid->awake.count == awake) return SHV_OK;
    hybrid->wakes.count -= hybrid->wakes.next;
    memmove(hybrid->wakes.items, hybrid->wakes.items + hybrid->wakes.next,
            (size_t)hybrid->wakes.count * sizeof *hybrid->wakes.items);
    hybrid->wakes.next = 0;
    SHV_TRY(reserve_wakes(hybrid, error));
    return fly(hybrid, error);
}

bool shv_hybrid_is_alone(const ShvHybrid *hybrid)
{
    bool alone = hybrid->fragments.alive == 1 && hybrid->cohesive.count == 0;
    for (int32_t i = 0; i < hybrid->obstacles.count && alone; i++)
        alone = hybrid->obstacles.items[i].motion == SHV_OBSTACLE_FIXED;
    return alone;
}

/* Whether fragments are asked, within an interval, if they may rest. Where they meet one another flight takes intervals whole, and
   they wait for the end of this one; but a whole body alone, for which nobody has flown, flies the rest of it. */
static bool rest_is_due(const ShvHybrid *hybrid)
{
    return hybrid->check.since_rest >= hybrid->scene->fracture.quiet_checks &&
           (!hybrid->coupling.mutual || shv_hybrid_is_alone(hybrid));
}

/* Scripted obstacles are placed, free ones moved, up to a time. */
static void move_obstacles(ShvHybrid *hybrid, double time)
{
    if (time <= hybrid->obstacle_time) return;
    const double start = shv_now();
    if (!hybrid->backend->moves_obstacles || hybrid->backend->leaves_obstacles)
        hybrid->observer.ledger.booked[SHV_WORK_CONTACT] +=
            shv_obstacles_advance(&hybrid->obstacles, time - hybrid->obstacle_time, hybrid->gravity);
    shv_obstacles_script(&hybrid->obstacles, time);
    hybrid->obstacle_time = time;
    shv_costs_add(&hybrid->costs, SHV_COST_CONTACT, start);
}

static double next_wake_time(const ShvHybrid *hybrid)
{
    return hybrid->wakes.next < hybrid->wakes.count ? hybrid->wakes.items[hybrid->wakes.next].time : HUGE_VAL;
}

/* Up to which impacts count as of now. Beside what is awake they do so at the nearest step: to fit steps to every impact would
   make them long and short by turns, which vibration near the stable step does not bear. */
static double end_of_now(const ShvHybrid *hybrid)
{
    const double left = hybrid->interval_end - hybrid->state.time;
    if (hybrid->awake.count == 0 || !(left > 0.0)) return hybrid->state.time;
    return hybrid->state.time + 0.5 * shv_hybrid_choose_step(hybrid, left);
}

/* Fragments whose time of impact has come enter fracture mode. */
static ShvStatus wake_due(ShvHybrid *hybrid, ShvError *error)
{
    const double now = end_of_now(hybrid);
    if (next_wake_time(hybrid) > now) return SHV_OK;
    if (hybrid->awake.count == 0) hybrid->state.last_step = 0.0; /* velocities are those of now */
    while (next_wake_time(hybrid) <= now) {
        const ShvRigidContact *wake = &hybrid->wakes.items[hybrid->wakes.next++];
        SHV_TRY(shv_hybrid_wake(hybrid, wake, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* Nothing is awake: time jumps to the next impact or the end of the interval. */
static void jump(ShvHybrid *hybrid)
{
    const double to = fmin(next_wake_time(hybrid), hybrid->interval_end);
    move_obstacles(hybrid, to);
    hybrid->state.time = to;
    hybrid->state.last_step = 0.0;
}

/* A substep towards the end of the interval; steps of equal length fill what is left, so that no sliver of a step remains. */
static ShvStatus creep(ShvHybrid *hybrid, ShvError *error)
{
    const double to = hybrid->interval_end;
    SHV_TRY(shv_hybrid_substep(hybrid, to - hybrid->state.time, error));
    /* The last step lands on the time itself, not on a rounded neighbour of it. */
    if (to - hybrid->state.time < rounding_of_step * hybrid->steps.last) hybrid->state.time = to;
    move_obstacles(hybrid, hybrid->state.time);
    return SHV_OK;
}

ShvStatus shv_hybrid_advance(ShvHybrid *hybrid, double until, int64_t steps, int64_t *taken, ShvError *error)
{
    *taken = 0;
    while (hybrid->state.time < until) {
        if (interrupted(hybrid)) return shv_fail(error, SHV_INTERRUPTED, "stopped at %.9g s", hybrid->state.time);
        if (hybrid->interval_end <= hybrid->state.time) {
            SHV_TRY(shv_hybrid_time_line(hybrid, error));
            SHV_TRY(begin_interval(hybrid, until, error));
        }
        SHV_TRY(wake_due(hybrid, error));
        if (hybrid->awake.count > 0) {
            SHV_TRY(creep(hybrid, error));
            ++*taken;
        } else {
            jump(hybrid);
        }
        if (hybrid->interval_end <= hybrid->state.time) {
            SHV_TRY(wake_due(hybrid, error)); /* of its last half step */
            SHV_TRY(shv_hybrid_find_squeeze(hybrid, error));
            SHV_TRY(shv_hybrid_sleep_quiet(hybrid, error));
        } else if (rest_is_due(hybrid)) {
            SHV_TRY(rest_early(hybrid, error));
        }
        if (steps > 0 && *taken == steps) break;
    }
    return SHV_OK;
}
