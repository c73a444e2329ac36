/* The energy ledger. Every force is booked as work as it acts; nothing is booked as a difference of energies, so that
   the residual measures the integrator and not the bookkeeping.

   Half-step velocities v₋ = v(n−1/2), v₊ = v(n+1/2): a force F at time n does the work F·v₋ dt₋/2 before and F·v₊ dt₊/2
   after n, and kinetic energy at n is Σ ½ m v₋·v₊ (constant step; ShvLedger keeps the general form). An impulse J does
   J·(v₋ + v₊)/2. `pending` holds the second halves of the present step: the ledger at time n is booked − pending. */
#ifndef SHV_MODEL_LEDGER_H
#define SHV_MODEL_LEDGER_H

#include "base/vector.h"

typedef enum ShvWork {
    SHV_WORK_TRACTION,   /* by imposed tractions */
    SHV_WORK_COHESIVE,   /* by cohesive tractions */
    SHV_WORK_CLOSURE,    /* by crack faces that close (≤ 0) */
    SHV_WORK_RUBBING,    /* by friction of crack faces (≤ 0) */
    SHV_WORK_CONTACT,    /* by normal contact impulses with obstacles, on the nodes */
    SHV_WORK_FRICTION,   /* by tangential contact impulses, on the nodes */
    SHV_WORK_CONSTRAINT, /* by supports and imposed velocities (signed) */
    SHV_WORK_BARS,       /* by position based projections (signed) */
    SHV_WORK_DAMPING,    /* by damping towards rigid motion */
    SHV_WORK_HANDOVER,   /* vibration and strain dropped or given at mode switches (signed, each one in /events) */
    SHV_WORK_EVENT,      /* by events of the time line */
    SHV_WORK_COUNT
} ShvWork;

typedef struct ShvLedger {
    double booked[SHV_WORK_COUNT];  /* J, up to and including the second halves of the present step */
    double pending[SHV_WORK_COUNT]; /* J, second halves of the present step */
    double released;                /* J, recoverable energy of cohesive zones that was let go at mode switches */
} ShvLedger;

const char *shv_work_name(ShvWork work);
/* Starts a step: clears `pending`. */
void shv_ledger_begin_step(ShvLedger *ledger);
/* Books the two halves of one force's work. */
static inline void shv_ledger_book(ShvLedger *ledger, ShvWork work, double first_half, double second_half)
{
    ledger->booked[work] += first_half + second_half;
    ledger->pending[work] += second_half;
}

#endif
