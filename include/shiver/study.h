/* Studies: the same scene run in several ways, with errors beside run times. */
#ifndef SHIVER_STUDY_H
#define SHIVER_STUDY_H

#include <stdio.h>

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- rigid engines compared ---- */

enum { SHV_MOST_COMPARED_STEPS = 16, SHV_MOST_COMPARED_ENGINES = 4 };

typedef struct ShvCompareOptions {
    uint32_t cookie;
    ShvRigidEngine engines[SHV_MOST_COMPARED_ENGINES];
    int32_t engine_count;
    double steps[SHV_MOST_COMPARED_STEPS]; /* of rigid flight, s */
    int32_t step_count;
    const char *folder;       /* what relative file names of the scene start from; NULL: working directory */
    struct ShvMemory *memory; /* may be NULL */
    void (*begins)(void *data, ShvRigidEngine engine, double step); /* told before every run; may be NULL */
    void *data;
} ShvCompareOptions;
/* Bullet, plain Bullet, position based dynamics and closed form ("analytic") at 10, 1 and 0.1 ms. */
ShvCompareOptions shv_compare_default(void);

/* One run. Errors are the largest over time and over the bodies compared; NaN where a figure has no meaning. */
typedef struct ShvComparedRun {
    ShvRigidEngine engine;
    double step;
    ShvStatus status;
    char message[256];            /* of a run that failed; its errors are those until then */
    bool is_reference;            /* what the others are compared with */
    double position, orientation; /* m, rad */
    double velocity;              /* m/s */
    double surface;               /* m: of a point of the body's surface, position and orientation together */
    double energy;           /* kinetic and potential of rigid motion, over the largest of the reference's energies */
    double energy_gain;      /* largest rise of the energy above an earlier value, over the same */
    double angular_momentum; /* of a body about its own centre, over the largest of the reference's */
    int32_t moments,
        reference_moments; /* impacts of a bounce, flips of a free flight: found, and to be found; at most 8 */
    double moment;         /* s: of their times, of those found */
    double apex;           /* of the heights between impacts, over their own: of those found */
    double seconds,
        seconds_per_step; /* of run time, without set-up; the best of up to three runs where they are short */
} ShvComparedRun;

typedef struct ShvComparison ShvComparison;
/* Runs the scene with each engine at each step; frames are as the scene's output.rate says, at most one a step. Errors are taken
   from the scene's `reference`, or, without one, from the finest run of the analytic engine (Bullet, where several bodies
   could meet). SHV_BAD_INPUT when something in the scene can break, when the reference does not fit the scene or no run can
   be one; a run that fails is part of the result, unless all do. The scene must outlive the comparison. */
ShvStatus shv_compare(ShvComparison **comparison, const ShvSceneDefinition *scene, const ShvCompareOptions *options,
                      ShvError *error);
void shv_comparison_destroy(ShvComparison *comparison);
/* Engine by engine, steps in the order given. */
int32_t shv_comparison_count(const ShvComparison *comparison);
const ShvComparedRun *shv_comparison_run(const ShvComparison *comparison, int32_t index);
/* What errors are taken from, in words: "closed form (bounce of ball on floor)", "finest run (bullet at 0.0001 s)". */
const char *shv_comparison_reference(const ShvComparison *comparison);
/* "bullet", "bullet_plain", "pbd", "analytic". */
const char *shv_rigid_engine_name(ShvRigidEngine engine);

/* PREFIX_compare.csv: every frame of every run: state of the first body compared, of its reference, errors, energies, momenta.
   PREFIX_compare.svg: largest error of a point of the surface against run time, a line an engine. SHV_BAD_INPUT when one of
   them exists and `force` is false: then none is written. */
ShvStatus shv_comparison_write(const ShvComparison *comparison, const char *prefix, bool force, ShvError *error);
/* Whether shv_comparison_write would find a file in its way; asked before long runs. */
ShvStatus shv_comparison_check_files(const char *prefix, bool force, ShvError *error);

/* ---- error against run time ---- */

typedef struct ShvStudyOptions {
    uint32_t cookie;
    const char *output;           /* folder of results; made if it is missing, its parent must be there */
    const char *const *overrides; /* "a.b.c=value", on top of the study's own `set` */
    int32_t override_count;
    bool force;          /* run again what has been run */
    bool shared;         /* other runs go on at the same time: run times are marked invalid */
    int32_t task, tasks; /* run only share `task` (from 1) of `tasks`; 0 of 0: all */
    const char *command; /* shown in the report; may be NULL */
    struct ShvMemory *memory;
    void (*begins)(void *data, const char *setting); /* told before every run; may be NULL */
    void *begins_data;
    bool (*stop)(void *data); /* as in ShvSimulationOptions */
    void *stop_data;
} ShvStudyOptions;
ShvStudyOptions shv_study_default(void);

/* A setting of a study beside the others. Arrays are by measure, shv_study_measure_count of them. */
typedef struct ShvStudyRow {
    const char *name;           /* "fracture.stabiliser=bars step=4" */
    const char *series, *label; /* of its line and point in plots */
    ShvStatus status;           /* of its first run that failed */
    char message[256];          /* why */
    bool is_reference;
    double seconds;                         /* run time of one run: median of repeats and members, without set-up */
    double seconds_low, seconds_high;       /* least and most of them */
    const double *values;                   /* median over the members of an ensemble; NaN: has none */
    const double *errors;                   /* likewise; NaN where it cannot be said */
    const double *errors_low, *errors_high; /* least and most of the members */
    const bool *on_front; /* nothing cheaper is as good: an error is only smaller by more than the scatter */
    double stable_step, step, courant; /* s, s, –; of the first member */
    const double *costs;               /* s by part, of the first member: shv_study_cost_name */
} ShvStudyRow;

typedef struct ShvStudy ShvStudy;
/* Reads scene and study, and all scenes that the study makes of them. SHV_BAD_INPUT says file and line. docs/study.md tells
   what a study holds. */
ShvStatus shv_study_open(ShvStudy **study, const char *scene, const char *file, const ShvStudyOptions *options,
                         ShvError *error);
void shv_study_close(ShvStudy *study);
/* Runs of all settings and members; and those that are missing in the folder. */
int32_t shv_study_run_count(const ShvStudy *study);
int32_t shv_study_missing(const ShvStudy *study);
/* Runs what is missing (of the task, if one is given); each finished run is a file of its own at once. SHV_INTERRUPTED when it
   was told to stop: going on later begins where it ended. */
ShvStatus shv_study_run(ShvStudy *study, ShvError *error);
/* Measures all runs. SHV_BAD_INPUT when one is missing or no reference can be found. */
ShvStatus shv_study_measure(ShvStudy *study, ShvError *error);
/* After measuring: report.html, study.json, results.csv, timings.csv, table.md and figures (.svg) into the folder. */
ShvStatus shv_study_write(const ShvStudy *study, ShvError *error);
/* The content of study.json. */
void shv_study_print_json(const ShvStudy *study, FILE *stream);

int32_t shv_study_row_count(const ShvStudy *study);
const ShvStudyRow *shv_study_row(const ShvStudy *study, int32_t index);
const char *shv_study_name(const ShvStudy *study);
/* What errors are taken from, in words. */
const char *shv_study_reference(const ShvStudy *study);
const char *shv_study_processor(const ShvStudy *study);
/* Whether run times can be compared: one run at a time, all on processors of one kind. */
bool shv_study_timings_valid(const ShvStudy *study);
int32_t shv_study_measure_count(const ShvStudy *study);
const char *shv_study_measure_name(const ShvStudy *study, int32_t measure);
/* "m", "J"; "" of shares and counts. */
const char *shv_study_error_unit(const ShvStudy *study, int32_t measure);
/* Errors of the members of the reference's ensemble against each other, median of all pairs; 0 without an ensemble. */
double shv_study_scatter(const ShvStudy *study, int32_t measure);
/* Index of the cheapest row whose error in that measure is at most `error`, −1 if there is none. Not the reference. */
int32_t shv_study_pick(const ShvStudy *study, int32_t measure, double largest);
int32_t shv_study_cost_count(void);
const char *shv_study_cost_name(int32_t cost);

#ifdef __cplusplus
}
#endif
#endif
