/* The energy ledger. Every force is booked as work as it acts; nothing is booked as a difference of energies, so that
   the residual measures the integrator and not the bookkeeping.

   Half-step velocities v₋ = v(n−1/2), v₊ = v(n+1/2): a force F at time n does the work F·v₋ dt₋/2 before and F·v₊ dt₊/2
   after n, and kinetic energy at n is Σ ½ m v₋·v₊ (constant step; ShvLedger keeps the general form). An impulse J does
   J·(v₋ + v₊)/2. `pending` holds the second halves of the present step: the ledger at time n is booked − pending. */
#ifndef SHV_MODEL_LEDGER_H
#define SHV_MODEL_LEDGER_H

#include "shiver/simulation.h"

#define SHV_NO_WORK(member, unit)
#define SHV_NAME_OF_WORK(member, name) SHV_WORK_##name,
/* As in the columns of the ledger, whose balance they are part of. */
typedef enum ShvWork {
    SHV_LEDGER_COLUMNS(SHV_NO_WORK, SHV_NAME_OF_WORK, SHV_NO_WORK) SHV_WORK_COHESIVE, /* by cohesive tractions */
    SHV_WORK_COUNT
} ShvWork;
#undef SHV_NO_WORK
#undef SHV_NAME_OF_WORK

typedef struct ShvLedger {
    double booked[SHV_WORK_COUNT];  /* J, up to and including the second halves of the present step */
    double pending[SHV_WORK_COUNT]; /* J, second halves of the present step */
    double released;                /* J, recoverable energy of cohesive zones that was let go at mode switches */
} ShvLedger;

/* Starts a step: clears `pending`. */
void shv_ledger_begin_step(ShvLedger *ledger);
/* Books the two halves of one force's work. */
static inline void shv_ledger_book(ShvLedger *ledger, ShvWork work, double first_half, double second_half)
{
    ledger->booked[work] += first_half + second_half;
    ledger->pending[work] += second_half;
}

#endif
