#include "survive/design.h"

#include <math.h>

/* From median to the second shot, in standard deviations of ln height: of all distances the one after which median and spread
   are known best (the least determinant of their covariance, by the information of the four outcomes). */
static const double second_shot = 1.38;
/* Factor between the shots that look for a height that breaks and one that does not, and within which the first specimen's own
   height is to be known. */
static const double bracket = 4.0, first_known = 2.0;
/* Standard deviation of ln height that is taken while the data say nothing of it, and what becomes of it with each specimen. */
static const double first_scale = 0.35, narrowing = 0.8;
/* Scales that are believed. */
static const double least_believed = 0.02, largest_believed = 1.0;
/* Every so many specimens one falls a third time, from where it should do what it did: does height decide at all? */
enum { CHECKED = 4 };
/* Fewer specimens than this do not end a search by the width of an interval. */
enum { FEWEST = 8 };

/* Between the bounds; what differs from one of them by rounding alone is that bound. */
static double within(const ShvDesign *design, double height)
{
    const double rounding = 1e-9;
    if (height <= design->lowest * (1.0 + rounding)) return design->lowest;
    return height >= design->highest * (1.0 - rounding) ? design->highest : height;
}

/* Median and scale to aim by, from what is complete. */
static void aim(const ShvDesign *design, const ShvFragilityData *data, double *median, double *scale)
{
    double survived = 0.0, broken = HUGE_VAL;
    for (int32_t i = 0; i < data->specimen_count; i++) {
        survived = fmax(survived, data->specimens[i].survived);
        broken = fmin(broken, data->specimens[i].broken);
    }
    if (survived >= broken) {
        const ShvFragilityFit fit = shv_fragility_fit(SHV_FRAGILITY_LOGNORMAL, data);
        *median = fit.location;
        *scale = fmin(largest_believed, fmax(least_believed, fit.scale));
        return;
    }
    *scale = fmax(least_believed, first_scale * pow(narrowing, data->specimen_count - 1));
    if (survived > 0.0 && broken < HUGE_VAL)
        *median = 0.5 * (log(survived) + log(broken));
    else
        *median = log(survived > 0.0 ? design->highest : design->lowest);
}

/* Of the first specimen; 0: enough is known. */
static double search(const ShvDesign *design, const ShvSpecimen *first)
{
    if (first->survived == 0.0) return first->broken > design->lowest ? within(design, first->broken / bracket) : 0.0;
    if (first->broken == HUGE_VAL)
        return first->survived < design->highest ? within(design, first->survived * bracket) : 0.0;
    return first->broken > first_known * first->survived ? sqrt(first->survived * first->broken) : 0.0;
}

/* Of a later specimen, with what is known of those before it; 0: none. */
static double shot_of(const ShvDesign *design, const ShvFragilityData *data, int32_t index, const ShvSpecimen *current)
{
    double median, scale;
    aim(design, data, &median, &scale);
    const int32_t taken = current ? current->shots : 0;
    const bool checked = index % CHECKED == 0;
    if (taken == 0) return within(design, exp(median));
    if (taken >= (checked ? 3 : 2)) return 0.0;
    const bool broke = data->shots[current->first_shot].broken;
    const double away = broke == (taken == 2) ? second_shot : -second_shot;
    const double height = within(design, exp(median + away * scale));
    return height == data->shots[current->first_shot].height ? 0.0 : height;
}

static bool is_known(const ShvDesign *design, const ShvFragilityData *data)
{
    double low, high;
    if (design->until <= 0.0 || data->specimen_count < FEWEST || !shv_fragility_overlap(data)) return false;
    shv_fragility_interval(SHV_FRAGILITY_LOGNORMAL, data, 0.5, &low, &high);
    return high <= design->until * low;
}

ShvNextShot shv_design_next(const ShvDesign *design, const ShvShot *shots, int32_t count, ShvSpecimen *specimens)
{
    const ShvNextShot done = {.done = true};
    if (count >= design->most_shots) return done;
    if (count == 0) return (ShvNextShot){.specimen = design->first_specimen, .height = within(design, design->first)};
    const int32_t known = shv_specimens(shots, count, specimens);
    const ShvSpecimen *last = &specimens[known - 1];
    const ShvFragilityData before = {.shots = shots, .specimens = specimens, .specimen_count = known - 1};
    const double again = known == 1 ? search(design, last) : shot_of(design, &before, known - 1, last);
    if (again > 0.0) return (ShvNextShot){.specimen = shots[last->first_shot].specimen, .height = again};
    const ShvFragilityData all = {.shots = shots, .specimens = specimens, .specimen_count = known};
    if (is_known(design, &all)) return done;
    return (ShvNextShot){.specimen = design->first_specimen + (uint64_t)known * design->every,
                         .height = shot_of(design, &all, known, NULL)};
}

/* ---- the printed staircase ---- */

ShvNextShot shv_staircase_next(const ShvDesign *design, double step, const ShvShot *shots, int32_t count)
{
    if (count >= design->most_shots) return (ShvNextShot){.done = true};
    const double last = count > 0 ? shots[count - 1].height : design->first;
    const double change = count == 0 ? 0.0 : shots[count - 1].broken ? -step : step;
    return (ShvNextShot){.specimen = design->first_specimen + (uint64_t)count * design->every,
                         .height = within(design, last + change)};
}

void shv_staircase_mean(const ShvShot *shots, int32_t count, double step, double *mean, double *deviation)
{
    int32_t broken = 0;
    for (int32_t i = 0; i < count; i++) broken += shots[i].broken;
    const bool of_broken = 2 * broken <= count; /* the rarer outcome is counted */
    double lowest = HUGE_VAL, number = 0.0, first = 0.0, second = 0.0;
    *mean = *deviation = (double)NAN;
    if (broken == 0 || broken == count) return;
    for (int32_t i = 0; i < count; i++)
        if (shots[i].broken == of_broken) lowest = fmin(lowest, shots[i].height);
    for (int32_t i = 0; i < count; i++) {
        if (shots[i].broken != of_broken) continue;
        const double level = (shots[i].height - lowest) / step;
        number += 1.0;
        first += level;
        second += level * level;
    }
    *mean = lowest + step * (first / number + (of_broken ? -0.5 : 0.5));
    *deviation = 1.62 * step * ((number * second - first * first) / (number * number) + 0.029);
}
