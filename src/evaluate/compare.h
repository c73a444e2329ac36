/* Inside of a comparison, for the files of this folder. */
#ifndef SHV_EVALUATE_COMPARE_H
#define SHV_EVALUATE_COMPARE_H

#include "evaluate/closed_form.h"
#include "evaluate/track.h"
#include "shiver/study.h"

typedef struct ShvComparedTrack {
    ShvComparedRun view;
    ShvTrack track;
} ShvComparedTrack;

struct ShvComparison {
    const ShvSceneDefinition *scene;
    ShvCompareOptions options;
    ShvMemory *memory;
    ShvComparedTrack *runs;
    int32_t count;
    ShvBodies bodies;
    ShvClosedForm *forms; /* one a body that is chosen and NULL without a closed form */
    ShvBodyState *finest; /* without one: frame by frame, all bodies of the finest run */
    int32_t finest_frames;
    int32_t finest_run; /* −1 with a closed form */
    char reference[200];
};

/* refuse.c: what a comparison cannot be made of. */
ShvStatus shv_compare_check(const ShvSceneDefinition *scene, const ShvCompareOptions *options, ShvError *error);
/* choose.c: what the runs are compared with, from the first frame; which bodies are chosen. */
double shv_compare_finest_step(const ShvCompareOptions *options);
ShvStatus shv_compare_with_finest(ShvComparison *comparison, ShvError *error);
ShvStatus shv_compare_with_closed_form(ShvComparison *comparison, const ShvSimulation *simulation, ShvError *error);
/* measure.c: the row of frame number `index` from the states of all bodies; and the figures of a run from its rows. */
void shv_compare_states(ShvComparison *comparison, const ShvBodyState *states, double time, int32_t index,
                        ShvTrackRow *row);
/* Before each run: closed forms start anew. */
void shv_compare_rewind(ShvComparison *comparison);
void shv_compare_summarise(const ShvComparison *comparison, ShvComparedTrack *run);

#endif
