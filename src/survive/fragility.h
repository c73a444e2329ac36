/* Fragility curves: the share of specimens that break up to a height, from specimens of which an interval is known that holds
   the height at which each of them begins to break. Heights are taken by their logarithm; a specimen that breaks at random, not
   from a height of its own on, counts by each of its shots.
   W. B. Nelson, Applied Life Data Analysis (1982), ch. 9 (interval censoring) and 12 (likelihood ratios). */
#ifndef SHV_SURVIVE_FRAGILITY_H
#define SHV_SURVIVE_FRAGILITY_H

#include "shiver/survive.h"

/* What is known of one specimen. */
typedef struct ShvSpecimen {
    double survived, broken;   /* highest it survived, lowest that broke it, m; 0, infinity: none */
    int32_t first_shot, shots; /* in the table */
    bool contradictory;        /* it survived a fall from above one that broke it */
} ShvSpecimen;

/* Groups shots by specimen, in the order in which specimens first appear; `specimens` has room for `count`. Returns how many. */
int32_t shv_specimens(const ShvShot *shots, int32_t count, ShvSpecimen *specimens);

typedef struct ShvFragilityData {
    const ShvShot *shots;
    const ShvSpecimen *specimens;
    int32_t specimen_count;
} ShvFragilityData;

typedef struct ShvFragilityFit {
    double location, scale; /* of ln height: its mean and standard deviation, or those of the law of extremes */
    double likelihood;      /* logarithm */
} ShvFragilityFit;

/* Largest likelihood. Without a specimen that survived from at least as high as another one broke from, the scale is at its
   least: data say nothing of it. */
ShvFragilityFit shv_fragility_fit(ShvFragilityLaw law, const ShvFragilityData *data);
/* Whether they do. */
bool shv_fragility_overlap(const ShvFragilityData *data);
/* Height from which the share p breaks. */
double shv_fragility_height(ShvFragilityLaw law, const ShvFragilityFit *fit, double share);
/* Share that breaks from a height. */
double shv_fragility_share(ShvFragilityLaw law, const ShvFragilityFit *fit, double height);
/* 95 % interval of that height by the likelihood ratio; 0 or infinity where the data set no bound. Few specimens widen it: the
   ratio is compared with the square of Student's t for their number. */
void shv_fragility_interval(ShvFragilityLaw law, const ShvFragilityData *data, double share, double *low, double *high);

/* Shares that break, by height, that never fall: the closest to the shots in the sense of least squares and of likelihood, without
   any law (pool adjacent violators). `order`: shots by height, filled; `shares` in that order. Both have room for `count`. */
void shv_fragility_isotonic(const ShvShot *shots, int32_t count, int32_t *order, double *shares);

#endif
