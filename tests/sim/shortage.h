/* Allocation failure at every place of making and running a simulation. */
#ifndef SHV_TESTS_SIM_SHORTAGE_H
#define SHV_TESTS_SIM_SHORTAGE_H

#include "sim/stage.h"

/* Sees the last frame of a run that had enough. */
typedef void (*Check)(const ShvFrameView *frame);

/* Makes and runs a scene with `allowed` allocations; how it ended. Nothing may stay behind. */
static inline ShvStatus run_with(const Stage *stage, int64_t allowed, Check check, int64_t *requests)
{
    ShvMemory *memory = shv_memory_create();
    assert_non_null(memory);
    shv_memory_fail_after(memory, allowed);
    ShvSimulationOptions options = shv_simulation_options_default();
    options.memory = memory;
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    ShvStatus status = shv_simulation_create(&simulation, &stage->scene, &options, &error);
    if (status != SHV_OK) assert_null(simulation);
    while (status == SHV_OK && !shv_simulation_finished(simulation))
        status = shv_simulation_advance(simulation, &error);
    if (status == SHV_OK && check) check(shv_simulation_frame(simulation));
    if (status != SHV_OK && !strstr(error.message, "out of memory")) fail_msg("message: %s", error.message);
    shv_simulation_destroy(simulation);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    *requests = shv_memory_requests(memory);
    shv_memory_destroy(memory);
    return status;
}

static inline void fail_everywhere(const Stage *stage, Check check)
{
    int64_t requests = 0, ignored;
    assert_int_equal(run_with(stage, -1, check, &requests), SHV_OK);
    assert_true(requests > 20);
    for (int64_t n = 0; n < requests; n++) assert_int_equal(run_with(stage, n, check, &ignored), SHV_NO_MEMORY);
    assert_int_equal(run_with(stage, requests, check, &ignored), SHV_OK);
}

#endif
