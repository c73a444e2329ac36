#include "check.h"

#include "model/ledger.h"

/* A force of constant power over three steps: at time n the work done so far leaves out the second half of step n. */
static void second_halves_wait_for_the_next_step(void **state)
{
    (void)state;
    ShvLedger ledger = {{0.0}, {0.0}, 0.0};
    for (int step = 0; step < 3; step++) {
        shv_ledger_begin_step(&ledger);
        shv_ledger_book(&ledger, SHV_WORK_CONTACT, 1.0, 2.0);
        shv_ledger_book(&ledger, SHV_WORK_CONTACT, 0.25, 0.5);
        shv_ledger_book(&ledger, SHV_WORK_FRICTION, -1.0, -1.0);
    }
    assert_true(ledger.booked[SHV_WORK_CONTACT] == 3 * 3.75);
    assert_true(ledger.pending[SHV_WORK_CONTACT] == 2.5);
    assert_true(ledger.booked[SHV_WORK_FRICTION] == -6.0);
    assert_true(ledger.pending[SHV_WORK_FRICTION] == -1.0);
    assert_true(ledger.booked[SHV_WORK_EVENT] == 0.0);
    shv_ledger_begin_step(&ledger);
    for (int i = 0; i < SHV_WORK_COUNT; i++) assert_true(ledger.pending[i] == 0.0);
    assert_true(ledger.booked[SHV_WORK_CONTACT] == 3 * 3.75);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(second_halves_wait_for_the_next_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
