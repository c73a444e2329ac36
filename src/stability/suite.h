/* Inside of a suite, for the files of this folder. */
#ifndef SHV_STABILITY_SUITE_H
#define SHV_STABILITY_SUITE_H

#include "base/memory.h"
#include "shiver/scene.h"
#include "shiver/suite.h"

enum { SHV_MOST_EXPECTATIONS = 10 };

/* X(name, start): what is read from a run; `start` before the first frame. */
#define SHV_MEASURES(X)                                                                                                \
    X(time, 0.0)      /* s: of the end */                                                                              \
    X(frames, 0.0)    /* of the animation grid, that came */                                                           \
    X(steps, 0.0)     /* of fracture mode */                                                                           \
    X(courant, 0.0)   /* largest */                                                                                    \
    X(fragments, 0.0) /* living at the end */                                                                          \
    X(inserted, 0.0)  /* cohesive facets at the end */                                                                 \
    X(failed, 0.0)                                                                                                     \
    X(overshoot, 0.0) /* worst criterion over strength at an insertion */                                              \
    X(wakes, 0.0)                                                                                                      \
    X(rests, 0.0)                                                                                                      \
    X(inversions, 0.0) /* events */                                                                                    \
    X(squeezes, 0.0)   /* events */                                                                                    \
    X(first_wake, NAN) /* s */                                                                                         \
    X(residual, 0.0)   /* largest |residual of the ledger| over its largest energy */                                  \
    X(gain, 0.0)       /* largest rise of kinetic, strain and potential energy above the start, likewise */            \
    X(kept, NAN)       /* kinetic and strain energy at the end over the start */                                       \
    X(momentum, 0.0)   /* largest |P − P0| over the largest Σ m|v| */                                               \
    X(angular, 0.0)    /* largest |L − L0| about the origin over the largest |L| */                                  \
    X(x, NAN)          /* m: centre of mass of the largest living fragment at the end */                               \
    X(y, NAN)                                                                                                          \
    X(z, NAN)                                                                                                          \
    X(vx, NAN) /* m/s */                                                                                               \
    X(vy, NAN)                                                                                                         \
    X(vz, NAN)                                                                                                         \
    X(spin, NAN)           /* rad/s: |ω| of the same */                                                               \
    X(share, NAN)          /* its mass over all */                                                                     \
    X(lowest, HUGE_VAL)    /* m: least z of any corner in any frame */                                                 \
    X(highest, -HUGE_VAL)  /* m */                                                                                     \
    X(swelling, 0.0)       /* largest distance of a corner from its fragment's centre over that at the start, − 1 */ \
    X(edge_strain, 0.0)    /* largest |length/rest − 1| where bars are used */                                       \
    X(bar_work, 0.0)       /* share of bars in all work */                                                             \
    X(cohesive_bytes, 0.0) /* of adjacency, stress and cohesive facets */

enum {
#define SHV_NUMBER_MEASURE(name, start) SHV_MEASURE_##name,
    SHV_MEASURES(SHV_NUMBER_MEASURE)
#undef SHV_NUMBER_MEASURE
        SHV_MEASURE_COUNT
};

typedef struct ShvSuiteFound {
    ShvStatus status;
    bool begun; /* the simulation was made */
    bool finite;
    char message[2048]; /* of the failure; all faults of a scene */
    double values[SHV_MEASURE_COUNT];
    uint64_t hash;
    double seconds;
} ShvSuiteFound;

typedef struct ShvSuiteCase {
    ShvSuiteRow row;
    char path[1024];
    char expectations[SHV_MOST_EXPECTATIONS][192];
    int expectation_count;
    int32_t first; /* of the file */
    bool is_long, has_run;
    ShvSuiteFound found;
} ShvSuiteCase;

struct ShvSuite {
    ShvSuiteOptions options;
    char folder[768];
    ShvSuiteCase *cases;
    int32_t count, capacity;
};

/* suite_read.c */
ShvStatus shv_suite_read(ShvSuite *suite, ShvError *error);
/* suite_measure.c: runs one scene to its end. */
ShvStatus shv_suite_measure(ShvSuiteFound *found, const char *path, const char *overrides,
                            const ShvSuiteOptions *options, ShvError *error);
int shv_suite_measure_number(const char *name, size_t length); /* −1: none */
/* suite_judge.c: expected, found and verdict of a row. */
ShvStatus shv_suite_judge(ShvSuite *suite, int32_t index, ShvError *error);

#endif
