#include "model/ledger.h"

#include <string.h>

const char *shv_work_name(ShvWork work)
{
    switch (work) {
    case SHV_WORK_TRACTION:
        return "traction";
    case SHV_WORK_COHESIVE:
        return "cohesive";
    case SHV_WORK_CLOSURE:
        return "closure";
    case SHV_WORK_RUBBING:
        return "rubbing";
    case SHV_WORK_CONTACT:
        return "contact";
    case SHV_WORK_FRICTION:
        return "friction";
    case SHV_WORK_CONSTRAINT:
        return "constraint";
    case SHV_WORK_BARS:
        return "bars";
    case SHV_WORK_DAMPING:
        return "damping";
    case SHV_WORK_HANDOVER:
        return "handover";
    case SHV_WORK_EVENT:
        return "event";
    case SHV_WORK_COUNT:
        break;
    }
    return "unknown work";
}

void shv_ledger_begin_step(ShvLedger *ledger)
{
    memset(ledger->pending, 0, sizeof ledger->pending);
}
