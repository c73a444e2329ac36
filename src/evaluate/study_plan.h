/* A study file, read: which scenes to run, what with, and what to measure. */
#ifndef SHV_EVALUATE_STUDY_PLAN_H
#define SHV_EVALUATE_STUDY_PLAN_H

#include "evaluate/figures.h"
#include <math.h>

#include "scene/tree.h"
#include "shiver/study.h"

enum { SHV_STUDY_MOST_SETTINGS = 10000, SHV_STUDY_MOST_KEYS = 16, SHV_STUDY_LEAST_MEMBERS = 5 };

typedef enum ShvStudyReference {
    SHV_STUDY_CLOSED, /* the scene's `reference` */
    SHV_STUDY_SETTING /* a setting of its own */
} ShvStudyReference;

/* One combination of values of the keys that a study varies. */
typedef struct ShvStudySetting {
    const char *const *overrides; /* "a.b.c=value": keys of all runs first, then this setting's */
    int32_t override_count;
    double multiple;            /* fracture.time_step in stable steps; NaN: not varied */
    const char *const *values;  /* text by varied key; "": not varied in this block */
    const char *series, *label; /* what a plot calls its line and its point */
    const char *title, *name;   /* both together; "fracture.stabiliser=bars step=4" */
    int32_t line;               /* of the study file where its block begins */
} ShvStudySetting;

typedef struct ShvStudyPlan {
    ShvPool pool;
    const char *name;
    const char **keys; /* varied, as they first appear; "step" for multiples of the stable step */
    int32_t key_count;
    ShvStudySetting *settings; /* behind them the reference's own, where it is one */
    int32_t setting_count;
    ShvStudyReference reference;
    ShvMeasure measures[SHV_STUDY_MOST_MEASURES]; /* of our own, or formulas of the study, which have no sentence */
    int32_t measure_count;
    int32_t repeats; /* of each run, for its time */
    int32_t members; /* of an ensemble; 1: none */
    bool seeds;      /* members differ by their seeds; else objects are shifted */
    double shift;    /* m */
    int32_t audit_wakes;
} ShvStudyPlan;

/* `name` stands for the file in messages. `more` ("a.b.c=value") come after the study's own `set` and before what varies.
   The caller releases the plan; on failure it is empty. */
ShvStatus shv_study_plan_read(ShvStudyPlan *plan, const char *text, size_t length, const char *name,
                              const char *const *more, int32_t more_count, ShvMemory *memory, ShvError *error);
void shv_study_plan_release(ShvStudyPlan *plan);

#endif
