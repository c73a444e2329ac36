#include "cohesive/pair.h"

/* One scalar equation, its sign at the ends of a bracket known. */
typedef struct Equation {
    const ShvLaw *law;
    ShvHistory history;
    ShvLawBranch branch;
    double other;    /* opening of the component that is held */
    double from;     /* opening at the start of the step */
    double stored;   /* work of the linear branch still to come before the envelope, J/m² */
    double stiffest; /* shear: largest ratio of traction to the sum of both openings */
    double damped;   /* work of the damping on the way there, J/m² */
    double compliance;
    double free;        /* normal: opening without traction */
    ShvVec3 start, sum; /* shear: opening at the start; sum of it and the one without traction */
} Equation;

/* Illinois variant of regula falsi on f(low) < 0 ≤ f(high), kept safe by bisection. */
static double solve(const Equation *equation, double (*f)(const Equation *, double), double low, double high,
                    double at_low, double at_high, double small)
{
    int side = 0; /* end that moved last */
    for (int i = 0; i < 100 && at_high != 0.0; i++) {
        const double secant = (low * at_high - high * at_low) / (at_high - at_low);
        const double x = i % 8 != 7 && secant > low && secant < high ? secant : 0.5 * (low + high);
        if (!(x > low && x < high) || high - low <= 4e-16 * high) break;
        const double value = f(equation, x);
        if (fabs(value) <= small) return x;
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
    const double limit = e->branch.limit, from = shv_larger(e->from, 0.0);
    if (limit > 0.0) e->stored = 0.5 * e->branch.peak * (limit - from) * ((limit + from) / limit) + e->damped;
    const double low = normal_balance(e, limit), high = normal_balance(e, e->free);
    if (!(low < 0.0)) return normal_chord(e, limit); /* by round-off still at the limit */
    return normal_chord(e, solve(e, normal_balance, limit, e->free, low, high, 2e-16 * e->free));
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

/* Share of the backward rule, q²/(9 + q²): hardly any while the step resolves the spring (q = (ω step)²/2), nearly all where it
   does not. Between, the trapezoidal rule alone is stable, and costs no energy. An infinite stiffness asks for all of it. */
static double backward_share(double compliance, double stiffness)
{
    const double q = compliance * stiffness;
    return q < 1e100 ? q * q / (9.0 + q * q) : 1.0;
}

/* How the chord's opening `to` changes, and its traction with it, per damping traction: to −= yield × damping. */
static double damping_yield(double compliance, double stiffness)
{
    return compliance / (1.0 + 0.5 * compliance * stiffness);
}

/* What the backward rule would add to the chord's traction, η k (3/2 (to − from) − (now − from)) at the opening it leads to. */
static ShvVec3 backward_excess(double compliance, double stiffness, const ShvPairStep *step, ShvVec3 chord)
{
    const double pull = backward_share(compliance, stiffness) * stiffness;
    const ShvVec3 path = shv_sub(chord, step->from), drift = shv_sub(step->now, step->from);
    return shv_scale(shv_madd(shv_scale(drift, -1.0), 1.5, path),
                     pull / (1.0 + 1.5 * pull * damping_yield(compliance, stiffness)));
}

/* Damping to add to the traction of the chord, which leads to `chord`: the largest share of the backward rule's that takes no
   energy out of the spring, i.e. damping·(to − from) ≥ 0, and changes the traction by no more than k/2 × `room`, the way
   left on the spring. Both fade to nothing where the rule changes, so that the traction is continuous in what the
   neighbours do, and sweeps over them can settle. */
static ShvVec3 damping(double compliance, double stiffness, const ShvPairStep *step, ShvVec3 chord, double room)
{
    const ShvVec3 whole = backward_excess(compliance, stiffness, step, chord);
    const double size = shv_dot(whole, whole), path = shv_dot(whole, shv_sub(chord, step->from));
    if (!(size > 0.0 && path > 0.0 && room > 0.0)) return shv_vec3(0.0, 0.0, 0.0);
    const double yield = damping_yield(compliance, stiffness);
    const double share = shv_smaller(path / (yield * size), 0.5 * stiffness * room / sqrt(size));
    return shv_scale(whole, shv_smaller(share, 1.0));
}

static double normal_from_open(Equation *e, double stiffness, double now)
{
    const double half = 0.5 * e->compliance * stiffness, from = e->from;
    const double to = (e->free - half * from) / (1.0 + half);
    if (to >= 0.0) {
        const ShvPairStep line = {.from = {from, 0.0, 0.0}, .now = {now, 0.0, 0.0}};
        const double room = to > from ? e->branch.limit - from : to;
        const double damped = damping(e->compliance, stiffness, &line, shv_vec3(to, 0.0, 0.0), room).x;
        const double end = to - damping_yield(e->compliance, stiffness) * damped;
        if (end <= e->branch.limit) return shv_larger(0.5 * stiffness * (end + from) + damped, 0.0);
        e->damped = shv_larger(damped * (e->branch.limit - from), 0.0);
        return normal_envelope(e);
    }
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
    return from < 0.0 ? normal_from_closed(&e, stiffness) : normal_from_open(&e, stiffness, now);
}

/* ---- shear component ---- */

/* Discrete gradient of an energy E of |s|: (E(to) − E(from))/(|to|² − |from|²) × (to + from). With to + from = θ × sum
   and to = free − compliance × traction: θ (1 + compliance × factor) = 1. */
static double shear_factor(const Equation *e, double theta, double *radius)
{
    *radius = shv_norm(shv_sub(shv_scale(e->sum, theta), e->start));
    const double limit = e->branch.limit, length = *radius - limit;
    if (!(length > 0.0)) return limit > 0.0 ? e->stiffest : 0.0;
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
        e->stored = 0.5 * e->branch.peak * (limit - e->from) * ((limit + e->from) / limit) + e->damped;
        e->stiffest = 0.5 * e->branch.peak / limit;
        if (e->damped > 0.0) e->stiffest += e->damped / ((limit - e->from) * (limit + e->from));
        spring_theta = 1.0 / (1.0 + e->compliance * e->stiffest);
        low = shear_balance(e, spring_theta);
    }
    const double theta =
        low < 0.0 ? solve(e, shear_balance, spring_theta, 1.0, low, shear_balance(e, 1.0), 0.0) : spring_theta;
    return shv_scale(e->sum, shear_factor(e, theta, &radius) * theta);
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
                  .from = shv_smaller(shv_norm(step->from), limit),
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
    const ShvVec3 to = shv_sub(shv_scale(sum, theta), step->from);
    const ShvVec3 damped = damping(compliance, stiffness, step, to, limit - e.from);
    const ShvVec3 end = shv_madd(to, -damping_yield(compliance, stiffness), damped);
    if (shv_norm(end) <= limit) return shv_madd(damped, 0.5 * stiffness, shv_add(end, step->from));
    e.damped = shv_norm(damped) * (limit - e.from);
    return shear_envelope(&e, theta);
}

ShvVec3 shv_pair_traction(const ShvLaw *law, ShvHistory history, ShvVec3 normal, const ShvPairStep *step)
{
    const double from = shv_dot(step->from, normal), now = shv_dot(step->now, normal);
    const double open = shv_dot(step->free, normal), compliance = step->compliance;
    const ShvPairStep plane = {shv_madd(step->from, -from, normal), shv_madd(step->now, -now, normal),
                               shv_madd(step->free, -open, normal), compliance};
    const double slip = shv_norm(plane.from);
    const double tension = shv_pair_normal(law, history, slip, from, now, open, compliance);
    const double to = shv_larger(open - compliance * tension, 0.0);
    const ShvHistory grown = shv_law_grow(law, history, to, slip);
    return shv_madd(shv_pair_shear(law, grown, to, &plane), tension, normal);
}
