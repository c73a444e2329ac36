/* Studies: the same scene run in several ways, with errors beside run times. */
#ifndef SHIVER_STUDY_H
#define SHIVER_STUDY_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- rigid engines compared ---- */

enum { SHV_MOST_COMPARED_STEPS = 16, SHV_MOST_COMPARED_ENGINES = 3 };

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
/* Bullet, position based dynamics and closed form ("analytic") at 10, 1 and 0.1 ms. */
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
/* "bullet", "pbd", "analytic". */
const char *shv_rigid_engine_name(ShvRigidEngine engine);

/* PREFIX_compare.csv: every frame of every run: state of the first body compared, of its reference, errors, energies, momenta.
   PREFIX_compare.svg: largest error of a point of the surface against run time, a line an engine. SHV_BAD_INPUT when one of
   them exists and `force` is false: then none is written. */
ShvStatus shv_comparison_write(const ShvComparison *comparison, const char *prefix, bool force, ShvError *error);
/* Whether shv_comparison_write would find a file in its way; asked before long runs. */
ShvStatus shv_comparison_check_files(const char *prefix, bool force, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
