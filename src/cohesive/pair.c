#include "cohesive/pair.h"

/* One scalar equation, its sign at the ends of a bracket known. */
typedef struct Equation {
    const ShvLaw *law;
    ShvHistory history;
    ShvLawBranch branch;
    double other;  /* opening of the component that is held */
    double from;   /* opening at the start of the step */
    double stored; /* work of the linear branch still to come before the envelope, J/m² */
    double compliance;
    double free;        /* normal: opening without traction */
    ShvVec3 start, sum; /* shear: opening at the start; sum of it and the one without traction */
} Equation;

/* Illinois variant of regula falsi on f(low) < 0 ≤ f(high), kept safe by bisection. */
static double solve(const Equation *equation, double (*f)(const Equation *, double), double low, double high,
                    double at_low, double at_high)
{
    int side = 0; /* end that moved last */
    for (int i = 0; i < 100 && at_high != 0.0; i++) {
        const double secant = (low * at_high - high * at_low) / (at_high - at_low);
        const double x = i % 8 != 7 && secant > low && secant < high ? secant : 0.5 * (low + high);
        if (!(x > low && x < high) || high - low <= 4e-16 * high) break;
        const double value = f(equation, x);
        if (value < 0.0) {
            low = x;
            at_low = value;
            if (side < 0) at_high *= 0.5;
            side = -1;
        } else {
            high = x;
            at_high = value;
            if (side > 0) at_low *= 0.5;
            side = 1;
        }
    }
    return high;
}

/* ---- normal component ---- */

static double normal_chord(const Equation *e, double to)
{
    const double length = to - e->branch.limit;
    const double mean = length > 0.0 ? shv_law_normal_mean(e->law, e->history, e->other, e->branch.limit, to) : 0.0;
    const double path = to - e->from;
    return path > 0.0 ? (e->stored + mean * length) / path : e->branch.peak;
}

static double normal_balance(const Equation *e, double to)
{
    return to - e->free + e->compliance * normal_chord(e, to);
}

static double normal_envelope(Equation *e)
{
    const double limit = e->branch.limit, from = fmax(e->from, 0.0);
    if (limit > 0.0) e->stored = 0.5 * e->branch.peak * (limit - from) * ((limit + from) / limit);
    const double low = normal_balance(e, limit), high = normal_balance(e, e->free);
    if (!(low < 0.0)) return normal_chord(e, limit); /* by round-off still at the limit */
    return normal_chord(e, solve(e, normal_balance, limit, e->free, low, high));
}

/* From an opening that is closed already: no work before zero. */
static double normal_from_closed(Equation *e, double stiffness)
{
    if (!(e->free > 0.0)) return 0.0;
    if (stiffness > 0.0) {
        const double a = 1.0 + 0.5 * e->compliance * stiffness, b = e->free + e->from, p = e->free * e->from;
        const double root = sqrt(b * b - 4.0 * a * p);
        const double to = b > 0.0 ? (b + root) / (2.0 * a) : 2.0 * p / (b - root);
        if (to <= e->branch.limit) return 0.5 * stiffness * to * (to / (to - e->from));
    }
    return normal_envelope(e);
}

/* Share of the backward rule. An infinite stiffness asks for all of it. */
static double backward_share(double compliance, double stiffness)
{
    const double q = compliance * stiffness;
    return isfinite(q) ? q / (1.0 + q) : 1.0;
}

/* Opening at the next half step on the spring: traction k (ahead × to − behind), ahead = (1 − η)/2 + 2 η,
   behind = η now − (1 − η)/2 from. */
static double spring_opening(double stiffness, double share, double from, double now, double free, double compliance)
{
    const double ahead = 0.5 * (1.0 - share) + 2.0 * share, behind = share * now - 0.5 * (1.0 - share) * from;
    return (free + compliance * stiffness * behind) / (1.0 + compliance * stiffness * ahead);
}

/* Whether the spring answers the step, and takes no less than its energy grows by: (η (end − mean))·(to − from) ≥ 0. An
   opening that is closed at its start is left to the backward rule. */
static bool normal_on_spring(const Equation *e, double stiffness, double now, double *traction)
{
    const double share = e->from < 0.0 ? 1.0 : backward_share(e->compliance, stiffness);
    const double to = spring_opening(stiffness, share, e->from, now, e->free, e->compliance), end = 2.0 * to - now;
    if (!(to >= 0.0 && to <= e->branch.limit && end >= 0.0 && end <= e->branch.limit)) return false;
    if ((end - 0.5 * (e->from + to)) * (to - e->from) < 0.0) return false;
    *traction = fmax((e->free - to) / e->compliance, 0.0);
    return true;
}

/* By the chord alone, without damping. */
static double normal_by_chord(Equation *e, double stiffness)
{
    const double half = 0.5 * e->compliance * stiffness, from = e->from;
    const double to = (e->free - half * from) / (1.0 + half);
    if (to > e->branch.limit) return normal_envelope(e);
    if (to >= 0.0) return 0.5 * stiffness * (to + from);
    /* closes: all that is stored comes back over the path */
    const double stored = 0.5 * stiffness * from * from, gap = from - e->free;
    const double root = sqrt(gap * gap + 4.0 * e->compliance * stored);
    const double path = gap > 0.0 ? 0.5 * (gap + root) : 2.0 * e->compliance * stored / (root - gap);
    return path > 0.0 ? stored / path : 0.0;
}

double shv_pair_normal(const ShvLaw *law, ShvHistory history, double shear, double from, double now, double free,
                       double compliance)
{
    const ShvLawBranch branch = shv_law_normal_branch(law, history, shear);
    Equation e = {.law = law,
                  .history = history,
                  .branch = branch,
                  .other = shear,
                  .from = from,
                  .compliance = compliance,
                  .free = free};
    if (branch.limit == 0.0) {
        if (!(free > 0.0)) return 0.0;
        return from >= 0.0 && free <= compliance * branch.peak ? free / compliance : normal_envelope(&e);
    }
    const double stiffness = branch.peak / branch.limit;
    double traction;
    if (stiffness > 0.0 && normal_on_spring(&e, stiffness, now, &traction)) return traction;
    return from < 0.0 ? normal_from_closed(&e, stiffness) : normal_by_chord(&e, stiffness);
}

/* ---- shear component ---- */

/* Discrete gradient of an energy E of |s|: (E(to) − E(from))/(|to|² − |from|²) × (to + from). With to + from = θ × sum
   and to = free − compliance × traction: θ (1 + compliance × factor) = 1. */
static double shear_factor(const Equation *e, double theta, double *radius)
{
    *radius = shv_norm(shv_sub(shv_scale(e->sum, theta), e->start));
    const double limit = e->branch.limit, length = *radius - limit;
    if (!(length > 0.0)) return limit > 0.0 ? 0.5 * e->branch.peak / limit : 0.0;
    const double mean = shv_law_shear_mean(e->law, e->history, e->other, limit, *radius);
    return (e->stored + mean * length) / ((*radius - e->from) * (*radius + e->from));
}

/* Sign chosen so that it rises from the spring's θ to 1. */
static double shear_balance(const Equation *e, double theta)
{
    double radius;
    return theta * (1.0 + e->compliance * shear_factor(e, theta, &radius)) - 1.0;
}

static ShvVec3 shear_envelope(Equation *e, double spring_theta)
{
    const double limit = e->branch.limit;
    double radius, low = -1.0 + e->compliance * e->branch.peak / shv_norm(e->sum);
    if (limit > 0.0) {
        e->stored = 0.5 * e->branch.peak * (limit - e->from) * ((limit + e->from) / limit);
        low = shear_balance(e, spring_theta);
    }
    const double theta =
        low < 0.0 ? solve(e, shear_balance, spring_theta, 1.0, low, shear_balance(e, 1.0)) : spring_theta;
    return shv_scale(e->sum, shear_factor(e, theta, &radius) * theta);
}

/* As for the normal component, along the vectors. */
static bool shear_on_spring(const Equation *e, double stiffness, const ShvPairStep *step, ShvVec3 *traction)
{
    const double share = backward_share(e->compliance, stiffness), q = e->compliance * stiffness;
    const double ahead = 0.5 * (1.0 - share) + 2.0 * share;
    const ShvVec3 behind = shv_sub(shv_scale(step->now, share), shv_scale(step->from, 0.5 * (1.0 - share)));
    const ShvVec3 to = shv_scale(shv_madd(step->free, q, behind), 1.0 / (1.0 + q * ahead));
    const ShvVec3 end = shv_sub(shv_scale(to, 2.0), step->now);
    if (!(shv_norm(to) <= e->branch.limit && shv_norm(end) <= e->branch.limit)) return false;
    const ShvVec3 path = shv_sub(to, step->from), mean = shv_scale(shv_add(to, step->from), 0.5);
    if (shv_dot(shv_sub(end, mean), path) < 0.0) return false;
    *traction = shv_scale(shv_sub(step->free, to), 1.0 / e->compliance);
    return true;
}

ShvVec3 shv_pair_shear(const ShvLaw *law, ShvHistory history, double normal, const ShvPairStep *step)
{
    const ShvLawBranch branch = shv_law_shear_branch(law, history, normal);
    const ShvVec3 sum = shv_add(step->free, step->from);
    const double limit = branch.limit, compliance = step->compliance;
    Equation e = {.law = law,
                  .history = history,
                  .branch = branch,
                  .other = normal,
                  .compliance = compliance,
                  .from = fmin(shv_norm(step->from), limit),
                  .start = step->from,
                  .sum = sum};
    if (!(branch.peak > 0.0)) {
        if (limit > 0.0 || shv_norm(sum) == 0.0) return shv_vec3(0.0, 0.0, 0.0);
        return shear_envelope(&e, 0.0);
    }
    if (limit == 0.0) {
        if (shv_norm(sum) <= compliance * branch.peak) return shv_scale(sum, 1.0 / compliance);
        return shear_envelope(&e, 0.0);
    }
    const double stiffness = branch.peak / limit, theta = 1.0 / (1.0 + 0.5 * compliance * stiffness);
    ShvVec3 traction;
    if (shear_on_spring(&e, stiffness, step, &traction)) return traction;
    if (shv_norm(shv_sub(shv_scale(sum, theta), step->from)) > limit) return shear_envelope(&e, theta);
    return shv_scale(sum, 0.5 * stiffness * theta);
}

ShvVec3 shv_pair_traction(const ShvLaw *law, ShvHistory history, ShvVec3 normal, const ShvPairStep *step)
{
    const double from = shv_dot(step->from, normal), now = shv_dot(step->now, normal);
    const double open = shv_dot(step->free, normal), compliance = step->compliance;
    const ShvPairStep plane = {shv_madd(step->from, -from, normal), shv_madd(step->now, -now, normal),
                               shv_madd(step->free, -open, normal), compliance};
    const double slip = shv_norm(plane.from);
    const double tension = shv_pair_normal(law, history, slip, from, now, open, compliance);
    const double to = fmax(open - compliance * tension, 0.0);
    const ShvHistory grown = shv_law_grow(law, history, to, slip);
    return shv_madd(shv_pair_shear(law, grown, to, &plane), tension, normal);
}
