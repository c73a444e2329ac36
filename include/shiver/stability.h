/* How far time steps may go: the largest stable step of a scene's bodies with and without bars, and what is wrong at each step. */
#ifndef SHIVER_STABILITY_H
#define SHIVER_STABILITY_H

#include <stdio.h>

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SHV_MOST_STABILITY_VALUES = 16, SHV_MOST_STABILITY_POINTS = 12 };

typedef struct ShvStabilityValues {
    double values[SHV_MOST_STABILITY_VALUES];
    int32_t count;
} ShvStabilityValues;

typedef enum ShvStabilityClass {
    SHV_STABLE,   /* energy bounded for all steps */
    SHV_GROWING,  /* energy above its bound, or still rising at the end */
    SHV_OVERFLOW, /* numbers that are not finite */
    SHV_REFUSED   /* the program does not begin: without bars, a step above the computed stable one */
} ShvStabilityClass;
const char *shv_stability_class_name(ShvStabilityClass outcome);

/* The product of all stiffnesses, numbers of iterations and moduli is measured, and each modulus without bars. */
typedef struct ShvStabilityOptions {
    uint32_t cookie;
    ShvStabilityValues stiffness;  /* k of a bar, 0…1 */
    ShvStabilityValues iterations; /* whole numbers */
    ShvStabilityValues moduli;     /* Young's moduli of all materials, Pa; none: the scene's own */
    ShvStabilityValues
        multiples;            /* where errors are measured, in stable steps, if stable there; and at the limit; at most
                                      SHV_MOST_STABILITY_POINTS − 1 */
    int32_t steps;            /* that a stable step must last; ≥ 100 */
    double most;              /* largest multiple tried */
    uint64_t seed;            /* of the velocities at the start */
    const char *folder;       /* what relative file names of the scene start from */
    struct ShvMemory *memory; /* may be NULL */
    /* Told before every setting; iterations 0: no bars. May be NULL. */
    void (*begins)(void *data, double modulus, double stiffness, int32_t iterations);
    void *data;
} ShvStabilityOptions;
/* k 1, 0.5, 0.1; 1, 4, 10 iterations; own modulus; errors at 0.5, 1, 2, 5, 10 and 20 stable steps; 10,000 steps; up to 60. */
ShvStabilityOptions shv_stability_default(void);

/* Errors at one step. The first body of the scene is stretched along its longest principal axis; q is the stretch,
   Σ m u·s / Σ m s·s with s = a (a·(x − c)). All are compared with the same body without bars at a quarter of the stable step. */
typedef struct ShvStabilityPoint {
    double multiple; /* of the computed stable step */
    ShvStabilityClass outcome;
    double stiffness; /* static: q under a steady load without bars over that with them; NaN where it does not settle */
    double closed_form;  /* the same if every bar were alone (docs/stability.md); infinity at k = 1 */
    double frequency;    /* of free vibration from a stretching velocity, over that of the reference; NaN: no swing */
    double displacement; /* largest error of q in the reference's first period, over its largest q */
    double energy_kept;  /* energy after that period over that at the start */
} ShvStabilityPoint;

typedef struct ShvStabilityRow {
    double modulus; /* Pa, of the first body */
    double stiffness;
    int32_t iterations; /* 0: no bars */
    double stable_step; /* s, computed: what multiples count */
    double limit;       /* largest multiple found that is stable for all steps; 0: none */
    double failed;      /* next larger multiple tried, which is not; infinity: the largest one tried is stable */
    ShvStabilityClass beyond, far; /* at `failed`, and at three times that */
    double over_mesh;              /* limit over that without bars */
    bool monotone;                 /* no step was found unstable below the limit, nor stable above `failed` */
    double unstable_below;         /* multiple; NaN: none */
    double stable_again;           /* multiple; NaN: none */
    double refused_above;          /* without bars: multiple above which the program does not begin; else NaN */
    ShvStabilityPoint points[SHV_MOST_STABILITY_POINTS];
    int32_t point_count;
} ShvStabilityRow;

typedef struct ShvStability ShvStability;
/* Bodies of the scene alone: without obstacles, conditions, gravity and cracks, all awake. The stated load of the limits: every
   component of a node's velocity is drawn evenly from ±½ × 1e-6 bar speeds and rigid motion taken out. Stable: kinetic and
   strain energy stay below 100 times the start for all `steps`, and a line through their logarithm over the last third
   rises by at most 5 %; or all but 1e-15 of the energy is gone before. Kinetic energy is Σ ½ m v₋·v₊, with the velocities around the
   time. */
ShvStatus shv_stability(ShvStability **stability, const ShvSceneDefinition *scene, const ShvStabilityOptions *options,
                        ShvError *error);
void shv_stability_destroy(ShvStability *stability);
/* Modulus by modulus: without bars, then k by k, iterations by iterations. */
int32_t shv_stability_count(const ShvStability *stability);
const ShvStabilityRow *shv_stability_row(const ShvStability *stability, int32_t index);

/* As `shiver stability` prints it, and with --json. */
void shv_stability_print(const ShvStability *stability, FILE *stream);
void shv_stability_print_json(const ShvStability *stability, FILE *stream);
/* `csv` (NULL: none): a row a point. `svg` (NULL: none): PREFIX_limit.svg: largest step against iterations, a line a k;
   PREFIX_stiffness.svg and PREFIX_error.svg: static stiffness and displacement error against the step, for some settings:
   without bars, the first four k with the middle number of iterations of the list, the first with the last; of the first modulus.
   SHV_BAD_INPUT when a file exists and `force` is false. */
ShvStatus shv_stability_write(const ShvStability *stability, const char *csv, const char *svg, bool force,
                              ShvError *error);
ShvStatus shv_stability_check_files(const char *csv, const char *svg, bool force, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
