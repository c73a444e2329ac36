/* What a study measures of a run: figures, and their errors against a reference. docs/study.md has the formulas. */
#ifndef SHV_EVALUATE_MEASURES_H
#define SHV_EVALUATE_MEASURES_H

#include "evaluate/compare.h"
#include "evaluate/digest.h"

typedef enum ShvMeasureKind {
    SHV_MEASURE_POSITION,
    SHV_MEASURE_ORIENTATION,
    SHV_MEASURE_VELOCITY,
    SHV_MEASURE_SURFACE,
    SHV_MEASURE_ENERGY,
    SHV_MEASURE_ENERGY_GAIN,
    SHV_MEASURE_LINEAR_MOMENTUM,
    SHV_MEASURE_ANGULAR_MOMENTUM,
    SHV_MEASURE_MOMENT,
    SHV_MEASURE_APEX,
    SHV_MEASURE_FAILED_OVERLAP,
    SHV_MEASURE_CRACK_DISTANCE,
    SHV_MEASURE_CRACK_MEAN_DISTANCE,
    SHV_MEASURE_FAILED_AREA,
    SHV_MEASURE_DISSIPATED,
    SHV_MEASURE_FRAGMENTS,
    SHV_MEASURE_LARGEST_MASS,
    SHV_MEASURE_MASSES,
    SHV_MEASURE_MOMENTUM,
    SHV_MEASURE_CENTRE_VELOCITY,
    SHV_MEASURE_IMPULSE,
    SHV_MEASURE_CONTACT_TIME,
    SHV_MEASURE_IMPACT_TIME,
    SHV_MEASURE_BARS_GIVEN,
    SHV_MEASURE_BARS_TAKEN,
    SHV_MEASURE_BAR_SHARE,
    SHV_MEASURE_RESIDUAL,
    SHV_MEASURE_MISSED_FRACTURE,
    SHV_MEASURE_COUNT
} ShvMeasureKind;

typedef struct ShvStudyMeasure {
    const char *name, *unit, *error_unit; /* units "" for shares and counts; unit NULL: has no value of its own */
    bool track;                           /* needs the way of the bodies */
    bool own;                             /* the value is the error: no reference is needed */
    const char *sentence;                 /* what the error is */
} ShvStudyMeasure;
const ShvStudyMeasure *shv_study_measure_of(ShvMeasureKind kind);
/* Its kind; SHV_MEASURE_COUNT for an unknown name. */
ShvMeasureKind shv_study_measure_find(const char *name);

/* Kolmogorov and Smirnov: largest difference of the shares of pieces that are lighter than m, over all m, where m is in shares
   of all mass; masses ascending. 1 where one has no pieces, 0 where both have none. */
double shv_masses_distance(const double *a, int32_t a_count, const double *b, int32_t b_count);

/* The figure of a run by itself; NaN where it has none. */
double shv_study_measure_value(ShvMeasureKind kind, const ShvDigest *digest);
/* Errors of figures of the last frame; `reference` may be NULL for those that are `own`. NaN where it cannot be said. */
double shv_study_measure_error(ShvMeasureKind kind, const ShvDigest *digest, const ShvDigest *reference);

/* Errors of the way of bodies, by kind; others are left as they are. `comparison` holds bodies, and closed forms or the states
   of the reference run. */
ShvStatus shv_study_measure_way(double errors[SHV_MEASURE_COUNT], ShvComparison *comparison, const ShvDigest *digest,
                                ShvError *error);

#endif
