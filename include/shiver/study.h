/* Studies: the same scene run in several ways, with errors beside run times. */
#ifndef SHIVER_STUDY_H
#define SHIVER_STUDY_H

#include <stdio.h>

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvStudyOptions {
    uint32_t cookie;
    const char *output;           /* folder of results; made if it is missing, its parent must be there */
    const char *const *overrides; /* "a.b.c=value", on top of the study's own `set` */
    int32_t override_count;
    bool force;             /* run again what has been run */
    bool shared;            /* other runs go on at the same time: run times are marked invalid */
    int32_t task, tasks;    /* run only share `task` (from 1) of `tasks`; 0 of 0: all */
    const char *scene_text; /* of the scene, where it has been read already; may be NULL */
    const char *plan;       /* text of the study, where there is no file of it; may be NULL */
    double
        repeat_below; /* s: a run is not repeated once its run times add up to this; 0: all repeats that the study asks for */
    const char *command; /* shown in the report; may be NULL */
    struct ShvMemory *memory;
    void (*begins)(void *data, const char *setting); /* told before every run; may be NULL */
    void *begins_data;
    bool (*stop)(void *data); /* as in ShvSimulationOptions */
    void *stop_data;
} ShvStudyOptions;
ShvStudyOptions shv_study_default(void);

enum { SHV_STUDY_MOST_MEASURES = 32, SHV_STUDY_MOST_COSTS = 16 };

/* A setting of a study beside the others. Arrays are by measure. */
typedef struct ShvStudyRow {
    const char *name;           /* "fracture.stabiliser=bars step=4" */
    const char *series, *label; /* of its line and point in plots */
    ShvStatus status;           /* of its first run that failed */
    char message[256];          /* why */
    bool is_reference;
    double seconds;                         /* run time of one run: median of repeats and members, without set-up */
    double seconds_low, seconds_high;       /* least and most of them */
    double values[SHV_STUDY_MOST_MEASURES]; /* median over the members of an ensemble; NaN: has none */
    double errors[SHV_STUDY_MOST_MEASURES]; /* likewise; NaN where it cannot be said */
    double errors_low[SHV_STUDY_MOST_MEASURES], errors_high[SHV_STUDY_MOST_MEASURES]; /* least, most of the members */
    bool on_front
        [SHV_STUDY_MOST_MEASURES]; /* nothing cheaper is as good: an error is only smaller by more than the scatter */
    double stable_step, step, courant;  /* s, s, –; of the first member */
    double costs[SHV_STUDY_MOST_COSTS]; /* s by part, of the first member, as ShvFrameView.costs */
} ShvStudyRow;

/* What came out of a study; no rows before it has been measured. */
typedef struct ShvStudyView {
    const ShvStudyRow *rows;
    int32_t row_count, measure_count;
    const char *measures[SHV_STUDY_MOST_MEASURES];
    const char *error_units[SHV_STUDY_MOST_MEASURES]; /* "m", "J"; "" of shares and counts */
    double scatter
        [SHV_STUDY_MOST_MEASURES]; /* errors of the members of the reference's ensemble against each other, median of
                                                all pairs; 0 without an ensemble */
    char reference[256];           /* what errors are taken from, in words */
    bool timings_valid;            /* run times can be compared: one run at a time, all on processors of one kind */
} ShvStudyView;

typedef struct ShvStudy ShvStudy;
/* Reads scene and study, and all scenes that the study makes of them. SHV_BAD_INPUT says file and line. docs/study.md tells
   what a study holds. */
ShvStatus shv_study_open(ShvStudy **study, const char *scene, const char *file, const ShvStudyOptions *options,
                         ShvError *error);
void shv_study_close(ShvStudy *study);
/* Runs what is missing (of the task, if one is given); each finished run is a file of its own at once. SHV_INTERRUPTED when it
   was told to stop: going on later begins where it ended. */
ShvStatus shv_study_run(ShvStudy *study, ShvError *error);
/* Measures all runs. SHV_BAD_INPUT when one is missing or no reference can be found. */
ShvStatus shv_study_measure(ShvStudy *study, ShvError *error);
/* After measuring: report.html, study.json, results.csv, timings.csv, table.md and figures (.svg) into the folder. */
ShvStatus shv_study_write(const ShvStudy *study, ShvError *error);
/* The table as `shiver study` prints it; the content of study.json. */
void shv_study_print(const ShvStudy *study, FILE *stream);
void shv_study_print_json(const ShvStudy *study, FILE *stream);

const ShvStudyView *shv_study_view(const ShvStudy *study);
/* Index of the cheapest row whose error in that measure is at most `error`, −1 if there is none. Not the reference. */
int32_t shv_study_pick(const ShvStudy *study, int32_t measure, double largest);

#ifdef __cplusplus
}
#endif
#endif
