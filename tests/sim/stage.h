/* Runs of the small scenes. */
#ifndef SHV_TESTS_SIM_STAGE_H
#define SHV_TESTS_SIM_STAGE_H

#include "coupling/stage.h"

#include "base/memory.h"
#include "shiver/plan.h"
#include "shiver/simulation.h"

static inline ShvSimulation *stage_start(const Stage *stage)
{
    ShvSimulation *simulation = NULL;
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_create(&simulation, &stage->scene, NULL, &error), error);
    return simulation;
}

/* The next frame, which must come. */
static inline const ShvFrameView *stage_next(ShvSimulation *simulation)
{
    ShvError error = {SHV_OK, ""};
    check_ok(shv_simulation_advance(simulation, &error), error);
    return shv_simulation_frame(simulation);
}

/* To the end of the scene; the last frame. */
static inline const ShvFrameView *stage_finish(ShvSimulation *simulation)
{
    while (!shv_simulation_finished(simulation)) stage_next(simulation);
    return shv_simulation_frame(simulation);
}

/* Runs a scene and returns the hash of its final state. */
static inline uint64_t stage_hash(const Stage *stage)
{
    ShvSimulation *simulation = stage_start(stage);
    stage_finish(simulation);
    const uint64_t hash = shv_simulation_hash(simulation);
    shv_simulation_destroy(simulation);
    return hash;
}

#endif
