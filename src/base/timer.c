#include "base/timer.h"

#include <time.h>

static double read_clock(clockid_t clock)
{
    struct timespec now = {0, 0};
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double shv_now(void)
{
    return read_clock(CLOCK_MONOTONIC);
}

double shv_processor_now(void)
{
    return read_clock(CLOCK_THREAD_CPUTIME_ID);
}

const char *shv_cost_name(ShvCost cost)
{
    switch (cost) {
    case SHV_COST_FORCE:
        return "force";
    case SHV_COST_STRESS:
        return "stress";
    case SHV_COST_INSERT:
        return "insert";
    case SHV_COST_PARTS:
        return "parts";
    case SHV_COST_COHESIVE:
        return "cohesive";
    case SHV_COST_MOTION:
        return "motion";
    case SHV_COST_BARS:
        return "bars";
    case SHV_COST_CONTACT:
        return "contact";
    case SHV_COST_FLIGHT:
        return "flight";
    case SHV_COST_HANDOVER:
        return "handover";
    case SHV_COST_RECORD:
        return "record";
    case SHV_COST_COUNT:
        return "total";
    }
    return "unknown cost";
}

double shv_costs_add(ShvCosts *costs, ShvCost cost, double start)
{
    const double now = shv_now();
    costs->seconds[cost] += now - start;
    costs->calls[cost] += 1;
    return now;
}
