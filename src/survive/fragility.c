#include "survive/fragility.h"

#include <math.h>

/* Bounds of the scale of ln height that is looked for: a factor of 1.01 and one of 20 between height and height. */
static const double least_scale = 0.01, largest_scale = 3.0;
/* How far beyond the heights of the shots a quantile is looked for, in ln height. */
static const double reach = 4.0;
static const double root_half = 0.70710678118654752440, root_two_pi = 2.50662827463100050242;
enum { SCAN_STEPS = 12, SECTION_STEPS = 16, BISECTION_STEPS = 20 };

int32_t shv_specimens(const ShvShot *shots, int32_t count, ShvSpecimen *specimens)
{
    int32_t known = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t k = 0;
        while (k < known && shots[specimens[k].first_shot].specimen != shots[i].specimen) k++;
        if (k == known) specimens[known++] = (ShvSpecimen){.broken = HUGE_VAL, .first_shot = i};
        ShvSpecimen *specimen = &specimens[k];
        specimen->shots++;
        if (shots[i].broken)
            specimen->broken = fmin(specimen->broken, shots[i].height);
        else
            specimen->survived = fmax(specimen->survived, shots[i].height);
        specimen->contradictory = specimen->survived >= specimen->broken;
    }
    return known;
}

bool shv_fragility_overlap(const ShvFragilityData *data)
{
    double survived = 0.0, broken = HUGE_VAL;
    for (int32_t i = 0; i < data->specimen_count; i++) {
        survived = fmax(survived, data->specimens[i].survived);
        broken = fmin(broken, data->specimens[i].broken);
    }
    return survived >= broken;
}

/* ---- laws, of z = (ln height − location) / scale ---- */

/* Share of specimens between two z. */
static double share_between(ShvFragilityLaw law, double a, double b)
{
    if (law == SHV_FRAGILITY_WEIBULL) {
        const double from = a > -HUGE_VAL ? exp(a) : 0.0, to = exp(b);
        return exp(-from) * -expm1(from - to);
    }
    /* On the side of the tail that is small, so that no digits are lost. */
    if (a > 0.0) return 0.5 * (erfc(a * root_half) - erfc(b * root_half));
    return 0.5 * (erfc(-b * root_half) - erfc(-a * root_half));
}

/* z of a share. The normal one by Newton's method: it is convex on either side of the middle, so that it cannot miss. */
static double z_of(ShvFragilityLaw law, double share)
{
    if (law == SHV_FRAGILITY_WEIBULL) return log(-log1p(-share));
    double z = 0.0;
    for (int i = 0; i < 60; i++) {
        const double density = exp(-0.5 * z * z) / root_two_pi;
        z -= (0.5 * erfc(-z * root_half) - share) / density;
    }
    return z;
}

double shv_fragility_height(ShvFragilityLaw law, const ShvFragilityFit *fit, double share)
{
    return exp(fit->location + fit->scale * z_of(law, share));
}

double shv_fragility_share(ShvFragilityLaw law, const ShvFragilityFit *fit, double height)
{
    return share_between(law, -HUGE_VAL, (log(height) - fit->location) / fit->scale);
}

/* ---- likelihood ---- */

static double log_share(ShvFragilityLaw law, double location, double scale, double from, double to)
{
    const double a = from > 0.0 ? (log(from) - location) / scale : -HUGE_VAL;
    const double b = to < HUGE_VAL ? (log(to) - location) / scale : HUGE_VAL;
    const double least = 1e-300; /* so that what cannot be is worse than what hardly can, and still a number */
    return log(fmax(least, share_between(law, a, b)));
}

static double likelihood(ShvFragilityLaw law, const ShvFragilityData *data, double location, double scale)
{
    double sum = 0.0;
    for (int32_t i = 0; i < data->specimen_count; i++) {
        const ShvSpecimen *specimen = &data->specimens[i];
        if (!specimen->contradictory) {
            sum += log_share(law, location, scale, specimen->survived, specimen->broken);
            continue;
        }
        const uint64_t name = data->shots[specimen->first_shot].specimen;
        for (int32_t k = specimen->first_shot, seen = 0; seen < specimen->shots; k++) {
            const ShvShot *shot = &data->shots[k];
            if (shot->specimen != name) continue;
            seen++;
            sum += shot->broken ? log_share(law, location, scale, 0.0, shot->height)
                                : log_share(law, location, scale, shot->height, HUGE_VAL);
        }
    }
    return sum;
}

typedef struct Profile {
    ShvFragilityLaw law;
    const ShvFragilityData *data;
    double z; /* of the quantile that is held */
} Profile;

/* Of one more number `x`, with what is held in `held`. */
typedef double (*Curve)(const Profile *profile, double held, double x);

/* The place of the largest value between two bounds: the best of a few points, and golden sections around it. */
static double largest(Curve curve, const Profile *profile, double held, double low, double high)
{
    const double step = (high - low) / SCAN_STEPS, golden = 0.5 * (sqrt(5.0) - 1.0);
    double best = low, most = -HUGE_VAL;
    for (int i = 0; i <= SCAN_STEPS; i++) {
        const double x = low + i * step, value = curve(profile, held, x);
        if (value > most) {
            most = value;
            best = x;
        }
    }
    double a = fmax(low, best - step), b = fmin(high, best + step);
    double c = b - golden * (b - a), d = a + golden * (b - a);
    double at_c = curve(profile, held, c), at_d = curve(profile, held, d);
    for (int i = 0; i < SECTION_STEPS; i++) {
        if (at_c >= at_d) {
            b = d;
            d = c;
            at_d = at_c;
            c = b - golden * (b - a);
            at_c = curve(profile, held, c);
        } else {
            a = c;
            c = d;
            at_c = at_d;
            d = a + golden * (b - a);
            at_d = curve(profile, held, d);
        }
    }
    return 0.5 * (a + b);
}

static double of_scale(const Profile *profile, double quantile, double log_scale)
{
    const double scale = exp(log_scale);
    return likelihood(profile->law, profile->data, quantile - profile->z * scale, scale);
}

static double best_scale(const Profile *profile, double quantile)
{
    return exp(largest(of_scale, profile, quantile, log(least_scale), log(largest_scale)));
}

static double of_quantile(const Profile *profile, double unused, double quantile)
{
    (void)unused;
    return of_scale(profile, quantile, log(best_scale(profile, quantile)));
}

/* ln of the heights that matter. */
static void bounds(const ShvFragilityData *data, double *low, double *high)
{
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int32_t i = 0; i < data->specimen_count; i++) {
        const ShvSpecimen *specimen = &data->specimens[i];
        if (specimen->survived > 0.0) *low = fmin(*low, log(specimen->survived));
        if (specimen->survived > 0.0) *high = fmax(*high, log(specimen->survived));
        if (specimen->broken < HUGE_VAL) *low = fmin(*low, log(specimen->broken));
        if (specimen->broken < HUGE_VAL) *high = fmax(*high, log(specimen->broken));
    }
}

ShvFragilityFit shv_fragility_fit(ShvFragilityLaw law, const ShvFragilityData *data)
{
    double low, high;
    bounds(data, &low, &high);
    const Profile profile = {.law = law, .data = data, .z = z_of(law, 0.5)};
    const double median = largest(of_quantile, &profile, 0.0, low - 1.0, high + 1.0);
    const double scale = best_scale(&profile, median);
    return (ShvFragilityFit){
        .location = median - profile.z * scale, .scale = scale, .likelihood = of_scale(&profile, median, log(scale))};
}

/* The 97.5 % quantile of Student's t by the first terms of its series in 1/n (Abramowitz and Stegun 26.7.5). */
static double student(double n)
{
    const double z = 1.959963985, cube = z * z * z, fifth = cube * z * z;
    return z + (cube + z) / (4.0 * n) + (5.0 * fifth + 16.0 * cube + 3.0 * z) / (96.0 * n * n);
}

/* Where the profile falls to `limit` between a place above it and `end`; infinite when it never does. */
static double crossing(const Profile *profile, double inside, double end, double limit)
{
    if (of_quantile(profile, 0.0, end) >= limit) return end < inside ? -HUGE_VAL : HUGE_VAL;
    for (int i = 0; i < BISECTION_STEPS; i++) {
        const double middle = 0.5 * (inside + end);
        if (of_quantile(profile, 0.0, middle) >= limit)
            inside = middle;
        else
            end = middle;
    }
    return 0.5 * (inside + end);
}

void shv_fragility_interval(ShvFragilityLaw law, const ShvFragilityData *data, double share, double *low, double *high)
{
    double from, to;
    bounds(data, &from, &to);
    const Profile profile = {.law = law, .data = data, .z = z_of(law, share)};
    const double best = largest(of_quantile, &profile, 0.0, from - reach, to + reach);
    const double t = student(data->specimen_count > 4 ? data->specimen_count - 2 : 2);
    const double limit = of_quantile(&profile, 0.0, best) - 0.5 * t * t;
    *low = exp(crossing(&profile, best, from - reach, limit));
    *high = exp(crossing(&profile, best, to + reach, limit));
}

/* ---- without a law ---- */

static bool before(const ShvShot *shots, int32_t a, int32_t b)
{
    return shots[a].height < shots[b].height || (shots[a].height == shots[b].height && a < b);
}

void shv_fragility_isotonic(const ShvShot *shots, int32_t count, int32_t *order, double *shares)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t k = i;
        for (; k > 0 && before(shots, i, order[k - 1]); k--) order[k] = order[k - 1];
        order[k] = i;
    }
    /* Blocks of equal shares end where the next block's share is larger; the start of each block is found backwards. */
    for (int32_t i = 0; i < count; i++) {
        double sum = shots[order[i]].broken ? 1.0 : 0.0;
        int32_t begin = i;
        while (begin > 0 && (shares[begin - 1] >= sum / (i - begin + 1) ||
                             shots[order[begin - 1]].height == shots[order[begin]].height)) {
            const double share = shares[begin - 1];
            int32_t first = begin - 1;
            while (first > 0 && shares[first - 1] == share) first--;
            sum += share * (begin - first);
            begin = first;
        }
        for (int32_t k = begin; k <= i; k++) shares[k] = sum / (i - begin + 1);
    }
}
