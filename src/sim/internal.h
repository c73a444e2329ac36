/* Inside of a simulation, for the files of this folder. */
#ifndef SHV_SIM_INTERNAL_H
#define SHV_SIM_INTERNAL_H

#include "hybrid/hybrid.h"
#include "shiver/simulation.h"

/* Views handed out, filled anew for every frame. */
typedef struct ShvViews {
    ShvFragmentView *fragments;
    int32_t fragment_capacity;
    ShvObstacleView *obstacles;
    ShvObjectView *objects;
    ShvCostView costs[SHV_COST_COUNT];
    ShvBytesView bytes[SHV_PART_COUNT];
} ShvViews;

struct ShvSimulation {
    ShvMemory *memory;
    bool owns_memory;
    const ShvSceneDefinition *scene;
    ShvHybrid hybrid;
    ShvViews views;
    ShvFrameView frame;
    int64_t animation_frame; /* frames of the animation grid given so far */
    int64_t fracture_steps;  /* substeps since the last frame of the fracture phase */
    bool started;
};

#endif
