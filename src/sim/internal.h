/* Inside of a simulation, for the files of this folder. */
#ifndef SHV_SIM_INTERNAL_H
#define SHV_SIM_INTERNAL_H

#include "coupling/hybrid.h"
#include "shiver/live.h"
#include "shiver/plan.h"
#include "shiver/simulation.h"

/* Views handed out, filled anew for every frame. */
typedef struct ShvViews {
    ShvFragmentView *fragments;
    int32_t fragment_capacity;
    ShvObstacleView *obstacles;
    ShvObjectView *objects;
    ShvProbeView *probes;
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
    int64_t fracture_steps;  /* substeps since the last frame of the fracture phase, but for */
    int64_t taken;           /* those of the advance that is under way */
    bool started;
    ShvListener listener;
    void *listener_data;
    bool under_way; /* an advance has begun and not led to its frame: events and samples since the last one are there */
};

/* Refuses what would steer a run wrongly (scene_check.c). */
ShvStatus shv_simulation_check_scene(const ShvSceneDefinition *scene, ShvError *error);
/* Cookie, numbers and target of an event; `what` names it in messages. */
ShvStatus shv_simulation_check_event(const ShvSceneDefinition *scene, const ShvEventDefinition *event, const char *what,
                                     ShvError *error);

/* The frame view of the present time; and the animation grid passes over the frames that the present time has left behind
   (simulation.c). */
ShvStatus shv_simulation_fill(ShvSimulation *simulation, bool animation, ShvError *error);
void shv_simulation_pass_frames(ShvSimulation *simulation);
/* Events and samples have been looked at: the next ones follow. */
void shv_simulation_forget_told(ShvSimulation *simulation);

/* Refuses a simulation whose objects overlap at the start, unless its scene keeps that (overlap.c). */
ShvStatus shv_simulation_refuse_overlaps(const ShvSimulation *simulation, ShvError *error);

/* Where an object is expected to break, and the edges there; `part` is its part of the mesh (breaking.c). */
ShvStatus shv_find_breaking(ShvPreflight *preflight, const ShvHybrid *hybrid, const ShvMesh *part, int32_t node_begin,
                            ShvError *error);

/* The list of parts, with the bytes of each (SHV_PART_COUNT of them), and their sum (plan.c). */
void shv_plan_list(const ShvHybrid *hybrid, const size_t *bytes, ShvPlan *plan);

/* Intervals of the animation grid in the scene's duration, the last one perhaps shorter; what is left over by rounding alone
   makes none of its own. */
static inline int64_t shv_frame_intervals(const ShvSceneDefinition *scene)
{
    return (int64_t)fmin(ceil(scene->duration * scene->output.rate * (1.0 - 1e-12)), 9e18);
}

#endif
