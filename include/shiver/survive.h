/* From what height does it break? Shots at a scene's body, one specimen (seed of strengths, and orientation where that scatters)
   after another, and the curve of the share that breaks by height. docs/survive.md tells how heights are chosen. */
#ifndef SHIVER_SURVIVE_H
#define SHIVER_SURVIVE_H

#include <stdio.h>

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Pieces of a shot whose masses are kept. */
enum { SHV_SHOT_PIECES = 5 };

/* One fall of one specimen that was whole. */
typedef struct ShvShot {
    uint64_t specimen; /* added to the scene's seed */
    double height;     /* m: v²/2g of the speed at the start, g = 9.80665 m/s² */
    bool broken;       /* largest piece below the scene's survival.broken of the body's mass */
    int32_t pieces;
    double shares[SHV_SHOT_PIECES]; /* of the mass, largest first; 0 where there are fewer pieces */
    double origin[3]; /* m, in the body as the scene places it: where the first crack began; NaN: nowhere */
} ShvShot;

/* Distributions of the height from which specimens break. */
typedef enum ShvFragilityLaw { SHV_FRAGILITY_LOGNORMAL, SHV_FRAGILITY_WEIBULL, SHV_FRAGILITY_LAWS } ShvFragilityLaw;

typedef struct ShvSurviveOptions {
    uint32_t cookie;
    const char *output; /* folder of the tables and the report; made if it is missing, its parent must be there */
    const char *const *overrides; /* of the scene: "a.b.c=value" */
    int32_t override_count;
    double first, lowest, highest; /* m: of the first shot, and bounds; 1, 0.001, 1000 */
    int32_t most_shots;            /* 40; of this task */
    double until;     /* ends when the 95 % interval of h50 spans at most this factor; 0: by most_shots alone */
    double staircase; /* m: step of the printed staircase of ASTM D2463, procedure B, in place of the design; 0: off */
    bool force;       /* begin anew */
    int32_t task, tasks; /* specimens task − 1, task − 1 + tasks, …; 1 of 1 */
    const char *command; /* shown in the report; may be NULL */
    struct ShvMemory *memory;
    void (*tell)(void *data, const ShvShot *shot); /* of every shot once it is known; may be NULL */
    void *tell_data;
    bool (*stop)(void *data); /* as in ShvSimulationOptions */
    void *stop_data;
} ShvSurviveOptions;
ShvSurviveOptions shv_survive_default(void);

typedef struct ShvSurvive ShvSurvive;
/* Reads the scene, and the shots of this task that its table in the folder has: an interrupted task goes on. SHV_BAD_INPUT for a
   scene without a body that falls or with several (survival.object names one), and for a table of another scene or version. */
ShvStatus shv_survive_open(ShvSurvive **survive, const char *scene, const ShvSurviveOptions *options, ShvError *error);
void shv_survive_close(ShvSurvive *survive);
/* Shoots until enough is known; each shot is a line of the table at once. SHV_INTERRUPTED when it was told to stop. */
ShvStatus shv_survive_run(ShvSurvive *survive, ShvError *error);
/* Takes the shots of all tasks in the folder together, in place of those of this task. */
ShvStatus shv_survive_merge(ShvSurvive *survive, ShvError *error);

typedef struct ShvFragilityView {
    double location, scale, likelihood; /* of ln height; logarithm */
    double h50, h50_low, h50_high;      /* m, with the 95 % interval; 0, infinity: no bound */
    double h10, h10_low, h10_high;
} ShvFragilityView;

typedef struct ShvSurviveView {
    const ShvShot *shots; /* valid until the next call that shoots or merges */
    int32_t shot_count, specimens, broken;
    bool overlap;    /* some specimen survived from where another one broke: else nothing is known of the spread */
    int32_t checked; /* specimens that were also dropped from where the outcome was thought to be known */
    int32_t contradictory;    /* specimens that survived a fall from above one that broke them */
    double all_survived_from; /* m: when nothing broke, the highest height that was survived; else NaN */
    double all_broke_from;    /* m: when nothing survived, the lowest height; else NaN */
    double bound;             /* of the share that breaks (survives) there, with 95 % confidence; else NaN */
    ShvFragilityView laws[SHV_FRAGILITY_LAWS];  /* NaN when nothing broke or nothing survived */
    double staircase_mean, staircase_deviation; /* m: of the printed staircase; else NaN */
} ShvSurviveView;
ShvSurviveView shv_survive_view(const ShvSurvive *survive);
const char *shv_fragility_law_name(ShvFragilityLaw law);

/* report.html, shots.csv, survive.json and curve.svg into the folder, and up to three of the shots again as pictures. */
ShvStatus shv_survive_write(ShvSurvive *survive, ShvError *error);
/* The content of survive.json. */
void shv_survive_print_json(const ShvSurvive *survive, FILE *stream);

#ifdef __cplusplus
}
#endif
#endif
