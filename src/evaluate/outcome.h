/* What is kept of one run: lists of numbers by name, how it ended, and the file that holds them. Every figure of a case, a study, a
   comparison or a suite is a formula over these names; scenes/verification/README.md tells them.

   A list is one number, a series over frames (times: "frame.time") or over samples of probes ("probe.time"), or any other list. */
#ifndef SHV_EVALUATE_OUTCOME_H
#define SHV_EVALUATE_OUTCOME_H

#include <stdio.h>

#include "base/memory.h"
#include "shiver/run_file.h"

typedef enum ShvClock { SHV_CLOCK_NONE, SHV_CLOCK_FRAME, SHV_CLOCK_PROBE } ShvClock;

typedef struct ShvOutcomeList {
    char name[96];
    ShvClock clock;
    double *values;
    int64_t count, capacity;
} ShvOutcomeList;

typedef struct ShvOutcome {
    ShvMemory *memory;
    uint64_t key;                       /* hash of all that the run follows from */
    ShvStatus status;                   /* of the run, which failed by its own fault; */
    char message[2048], processor[128]; /* how; where it ran */
    char no_motion[512];                /* why there is no way of bodies, or no closed form of it */
    bool shared;                        /* other runs went on at the same time: run times say little */
    ShvOutcomeList *lists;
    int32_t list_count, list_capacity, cursor;
    bool failed; /* out of memory: sticks, so that it is asked for once a frame */
} ShvOutcome;

void shv_outcome_release(ShvOutcome *outcome);

/* NULL: none of that name. */
const ShvOutcomeList *shv_outcome_find(const ShvOutcome *outcome, const char *name);
/* The times of a list's clock; NULL without one. */
const double *shv_outcome_times(const ShvOutcome *outcome, const ShvOutcomeList *list);
/* The last entry; NaN: none. */
double shv_outcome_number(const ShvOutcome *outcome, const char *name);
/* Adds to the end of a list, which is made where it is missing. Quick where lists are added to in the same order again. */
void shv_outcome_add(ShvOutcome *outcome, const char *name, ShvClock clock, double value);
void shv_outcome_add_all(ShvOutcome *outcome, const char *name, ShvClock clock, const void *values, int64_t count);
/* The same with the values left to the caller; NULL when memory is out. */
double *shv_outcome_room(ShvOutcome *outcome, const char *name, ShvClock clock, int64_t count);
/* A list of this one number. */
void shv_outcome_set(ShvOutcome *outcome, const char *name, double value);
/* "name.x" and so on. */
void shv_outcome_add_vector(ShvOutcome *outcome, const char *name, ShvClock clock, const double value[3]);

/* `data`: an outcome */
void shv_outcome_put(const void *data, FILE *stream);
/* Writes whole or not at all. */
ShvStatus shv_outcome_save(const ShvOutcome *outcome, const char *path, ShvError *error);
/* SHV_BAD_INPUT for what is not whole; `name` stands for it in messages. On failure nothing is owned. */
ShvStatus shv_outcome_parse(ShvOutcome *outcome, const char *data, size_t size, const char *name, ShvMemory *memory,
                            ShvError *error);
ShvStatus shv_outcome_load(ShvOutcome *outcome, const char *path, ShvMemory *memory, ShvError *error);

/* run.c: one run of a scene, and what is kept of it. */
typedef struct ShvRunOrder {
    const ShvSceneDefinition *scene;
    const char *folder;
    ShvMemory *memory;
    double multiple;     /* fracture.time_step in stable steps; NaN: as the scene says */
    int32_t repeats;     /* for the run time alone, the first one counted; ≥ 1 */
    double repeat_below; /* s: no further repeats once the run times add up to this; 0: all */
    int32_t audit_wakes;
    bool look; /* only the first frame */
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
