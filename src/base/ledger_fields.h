/* What a ledger holds behind its time, in the order of its rows in a run file. */
#ifndef SHV_BASE_LEDGER_FIELDS_H
#define SHV_BASE_LEDGER_FIELDS_H

#include "shiver/simulation.h"

/* NUMBER(member) for each double and VECTOR(member) for each array of three in ShvLedgerView. */
#define SHV_LEDGER_FIELDS(NUMBER, VECTOR)                                                                              \
    NUMBER(kinetic)                                                                                                    \
    NUMBER(strain)                                                                                                     \
    NUMBER(gravity_potential)                                                                                          \
    NUMBER(cohesive_recoverable)                                                                                       \
    NUMBER(fracture_dissipation)                                                                                       \
    NUMBER(contact)                                                                                                    \
    NUMBER(friction)                                                                                                   \
    NUMBER(closure)                                                                                                    \
    NUMBER(constraint)                                                                                                 \
    NUMBER(traction)                                                                                                   \
    NUMBER(bars)                                                                                                       \
    NUMBER(damping)                                                                                                    \
    NUMBER(handover)                                                                                                   \
    NUMBER(event)                                                                                                      \
    NUMBER(cohesive)                                                                                                   \
    NUMBER(cohesive_released)                                                                                          \
    NUMBER(cohesive_defect)                                                                                            \
    NUMBER(failed_area)                                                                                                \
    NUMBER(inserted_area)                                                                                              \
    NUMBER(fracture_energy_area)                                                                                       \
    VECTOR(momentum)                                                                                                   \
    VECTOR(angular_momentum)                                                                                           \
    NUMBER(residual)                                                                                                   \
    NUMBER(largest)

#endif
