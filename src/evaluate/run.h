/* One run of a scene, and what is kept of it. */
#ifndef SHV_EVALUATE_RUN_H
#define SHV_EVALUATE_RUN_H

#include "evaluate/outcome.h"

typedef struct ShvRunOrder {
    const ShvSceneDefinition *scene;
    const char *folder;
    ShvMemory *memory;
    double multiple;     /* fracture.time_step in stable steps; NaN: as the scene says */
    int32_t repeats;     /* for the run time alone, the first one counted; ≥ 1 */
    double repeat_below; /* s: no further repeats once the run times add up to this; 0: all */
    int32_t audit_wakes;
    bool tracked; /* also the way of all bodies */
    /* Checkpoints: "CHECKPOINT.checkpoint-1" and "-2", of a run with this key. NULL: none. */
    const char *checkpoint;
    uint64_t key;
    bool (*stop)(void *data);
    void *stop_data;
} ShvRunOrder;

/* A run that fails by its own fault is an outcome with that status and the frames until then; returned are SHV_INTERRUPTED and
   SHV_NO_MEMORY. The caller releases the outcome in every case. */
ShvStatus shv_run_scene(ShvOutcome *outcome, const ShvRunOrder *order, ShvError *error);

#endif
