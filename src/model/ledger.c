#include "model/ledger.h"

#include <string.h>

void shv_ledger_begin_step(ShvLedger *ledger)
{
    memset(ledger->pending, 0, sizeof ledger->pending);
}
