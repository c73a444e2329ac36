/* Simulations in the threads of a program's own loop: each runs as it would by itself. */
#include "sim/stage.h"

#include <omp.h>

enum { RUNS = 3 };

/* From 6 to 7 m/s, so that each breaks in its own way. */
static void make(Stage *stage, int run, int32_t threads)
{
    stage_make_breaking_bar(stage);
    stage->objects[0].placement.velocity[2] = -6.0 - 0.5 * run;
    stage->scene.rigid.engine = SHV_RIGID_BULLET;
    stage->scene.duration = 0.002;
    stage->scene.threads = threads;
}

static void loops_of_a_program(void **state)
{
    (void)state;
    Stage stages[RUNS];
    uint64_t alone[RUNS], together[RUNS] = {0};
    for (int i = 0; i < RUNS; i++) {
        make(&stages[i], i, 1);
        alone[i] = stage_hash(&stages[i]);
    }
    assert_true(alone[0] != alone[1] && alone[1] != alone[2]);
    for (int32_t threads = 1; threads <= 2; threads++) {
        int most = 0;
        for (int i = 0; i < RUNS; i++) make(&stages[i], i, threads);
#pragma omp parallel for schedule(static, 1) num_threads(RUNS) reduction(max : most)
        for (int i = 0; i < RUNS; i++) {
            together[i] = stage_hash(&stages[i]);
            most = omp_get_thread_num();
        }
        assert_int_equal(most, RUNS - 1);
        for (int i = 0; i < RUNS; i++) assert_true(together[i] == alone[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loops_of_a_program),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
