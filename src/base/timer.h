/* Monotonic wall clock, and the cost of each part of a run. */
#ifndef SHV_BASE_TIMER_H
#define SHV_BASE_TIMER_H

#include <stdint.h>

/* Seconds since an arbitrary fixed time. */
double shv_now(void);
/* Seconds of processor time that the calling thread has had. */
double shv_processor_now(void);

typedef enum ShvCost {
    SHV_COST_FORCE,    /* internal force */
    SHV_COST_STRESS,   /* nodal or facet stress and the criterion */
    SHV_COST_INSERT,   /* insertion and node duplication */
    SHV_COST_PARTS,    /* bonds that fail, and the pieces that come apart */
    SHV_COST_COHESIVE, /* cohesive tractions and crack closure */
    SHV_COST_MOTION,   /* kick, drift, supports */
    SHV_COST_BARS,     /* projections and damping */
    SHV_COST_CONTACT,  /* obstacles and fragments */
    SHV_COST_FLIGHT,   /* rigid backend */
    SHV_COST_HANDOVER, /* mass properties, poses */
    SHV_COST_RECORD,   /* run file */
    SHV_COST_COUNT
} ShvCost;

typedef struct ShvCosts {
    double seconds[SHV_COST_COUNT];
    int64_t calls[SHV_COST_COUNT];
} ShvCosts;

const char *shv_cost_name(ShvCost cost);
/* Adds now − start to a part and returns now, so that parts chain without gaps. */
double shv_costs_add(ShvCosts *costs, ShvCost cost, double start);

#endif
