/* Which specimen falls next, and from where: first one specimen is dropped until its own height is known within a factor of two;
   then each specimen twice, at the estimated median and, as it survived or broke, above or below it. */
#ifndef SHV_SURVIVE_DESIGN_H
#define SHV_SURVIVE_DESIGN_H

#include "survive/fragility.h"

typedef struct ShvDesign {
    double first, lowest, highest; /* heights, m: of the first shot, and bounds */
    int32_t most_shots;
    double until;                   /* ends when the 95 % interval of h50 is at most this ratio wide; 0: never */
    uint64_t first_specimen, every; /* specimens are first, first + every, … */
} ShvDesign;

typedef struct ShvNextShot {
    bool done;
    uint64_t specimen;
    double height; /* m */
} ShvNextShot;

/* From the shots of this design so far, in their order, alone: a table that was broken off goes on as if it had not been.
   `specimens` is work space for `count`. */
ShvNextShot shv_design_next(const ShvDesign *design, const ShvShot *shots, int32_t count, ShvSpecimen *specimens);

/* The printed staircase: specimens 0, 1, … once each; down by `step` after one that broke, up after one that survived.
   ASTM D2463, procedure B. */
ShvNextShot shv_staircase_next(const ShvDesign *design, double step, const ShvShot *shots, int32_t count);
/* Its mean failure height and standard deviation, m (Dixon and Mood, J. Am. Stat. Assoc. 43 (1948) 109); NaN when nothing broke or
   nothing survived. */
void shv_staircase_mean(const ShvShot *shots, int32_t count, double step, double *mean, double *deviation);

#endif
