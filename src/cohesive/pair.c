#include "cohesive/spring.h"

/* Traction on the envelope of one component, its sign at the ends of a bracket known. */
typedef struct Equation {
    const ShvLaw *law;
    ShvHistory history;
    ShvLawBranch branch;
    double other;    /* opening of the component that is held */
    double from;     /* opening at the start of the step */
    double stored;   /* work of the linear branch still to come before the envelope, J/m² */
    double left;     /* from the largest opening to the final one where the envelope falls in a line, m; otherwise 0 */
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

/* PPR with an exponent of 2 falls in a line from the largest opening to the final one. */
static double line_left(const ShvLaw *law, ShvHistory history, int component)
{
    if (law->kind != SHV_PPR || law->shape[component] != 2.0) return 0.0;
    const double largest = component == SHV_NORMAL ? history.normal : history.shear;
    return shv_larger(law->final_opening[component] - largest, 0.0);
}

static double line_work(const Equation *e, double length)
{
    return length < e->left ? e->branch.peak * length * (1.0 - 0.5 * (length / e->left))
                            : 0.5 * e->branch.peak * e->left;
}

/* ---- springs ---- */

/* Share of the backward rule, q²/(9 + q²): hardly any while the step resolves the spring (q = (ω step)²/2), nearly all where it
   does not. Between, the trapezoidal rule alone is stable, and costs no energy. An infinite stiffness asks for all of it. */
static double backward_share(double compliance, double stiffness)
{
    const double q = compliance * stiffness;
    return q < 1e100 ? q * q / (9.0 + q * q) : 1.0;
}

/* `yield`: how the chord's opening `to` changes, and its traction with it, per damping traction, to −= yield × damping.
   `excess`: what the backward rule would add to the chord's traction, η k (3/2 (to − from) − (now − from)) at the opening it
   leads to, per what stands in the brackets. */
static ShvPairSpring make_spring(ShvLawBranch branch, double compliance)
{
    ShvPairSpring spring = {.branch = branch, .stiffness = (double)INFINITY};
    if (!(branch.limit > 0.0)) return spring;
    spring.stiffness = branch.peak / branch.limit;
    spring.share = 1.0 / (1.0 + 0.5 * compliance * spring.stiffness);
    const double pull = backward_share(compliance, spring.stiffness) * spring.stiffness;
    spring.yield = compliance * spring.share;
    spring.excess = pull / (1.0 + 1.5 * pull * spring.yield);
    return spring;
}

/* ---- normal component ---- */

static double normal_chord(const Equation *e, double to)
{
    const double length = to - e->branch.limit, path = to - e->from;
    if (!(path > 0.0)) return e->branch.peak;
    if (!(length > 0.0)) return e->stored / path;
    const double work = e->left > 0.0 ? line_work(e, length)
                                      : length * shv_law_normal_mean(e->law, e->history, e->other, e->branch.limit, to);
    return (e->stored + work) / path;
}

static double normal_balance(const Equation *e, double to)
{
    return to - e->free + e->compliance * normal_chord(e, to);
}

/* Larger root of a x² + b x + c with a > 0 ≥ c. */
static double larger_root(double a, double b, double c)
{
    const double root = sqrt(shv_larger(b * b - 4.0 * a * c, 0.0));
    return b > 0.0 ? -2.0 * c / (b + root) : (root - b) / (2.0 * a);
}

/* Where the envelope is a line, and less steep than inertia, the balance times the path is one quadratic up to the final
   opening and another beyond. `steepness`: half of compliance × slope, < 1. */
static double normal_line(const Equation *e, double steepness)
{
    const double limit = e->branch.limit, free = e->free - limit, before = limit - e->from;
    const double pull = e->compliance * e->branch.peak, stored = e->compliance * e->stored;
    double length = larger_root(1.0 - steepness, before - free + pull, stored - free * before);
    if (length > e->left) length = larger_root(1.0, before - free, stored + 0.5 * pull * e->left - free * before);
    return normal_chord(e, limit + length);
}

static double normal_envelope(const ShvPair *pair, double free, double damped)
{
    const double limit = pair->spring[SHV_NORMAL].branch.limit, from = shv_larger(pair->from, 0.0);
    Equation e = {.law = pair->law,
                  .history = pair->history,
                  .branch = pair->spring[SHV_NORMAL].branch,
                  .other = pair->slip,
                  .from = pair->from,
                  .left = line_left(pair->law, pair->history, SHV_NORMAL),
                  .compliance = pair->compliance,
                  .free = free};
    if (limit > 0.0) e.stored = 0.5 * e.branch.peak * (limit - from) * ((limit + from) / limit) + damped;
    const double low = normal_balance(&e, limit);
    if (!(low < 0.0)) return normal_chord(&e, limit); /* by round-off still at the limit */
    const double steepness = e.left > 0.0 ? 0.5 * e.compliance * (e.branch.peak / e.left) : 1.0;
    if (steepness < 1.0) return normal_line(&e, steepness);
    return normal_chord(&e, solve(&e, normal_balance, limit, free, low, normal_balance(&e, free), 2e-16 * free));
}

static double normal_traction(const ShvPair *pair, double free)
{
    const ShvLawBranch branch = pair->spring[SHV_NORMAL].branch;
    const double from = pair->from;
    if (branch.limit == 0.0) {
        if (!(free > 0.0)) return 0.0;
        const bool held = from >= 0.0 && free <= pair->compliance * branch.peak;
        return held ? free / pair->compliance : normal_envelope(pair, free, 0.0);
    }
    double traction, damped;
    if (shv_spring_stays(pair, free, &traction, &damped)) return traction;
    return normal_envelope(pair, free, from < 0.0 ? 0.0 : shv_larger(damped * (branch.limit - from), 0.0));
}

/* ---- shear component ---- */

/* Discrete gradient of an energy E of |s|: (E(to) − E(from))/(|to|² − |from|²) × (to + from). With to + from = θ × sum
   and to = free − compliance × traction: θ (1 + compliance × factor) = 1. */
static double shear_factor(const Equation *e, double theta)
{
    const double radius = shv_norm(shv_sub(shv_scale(e->sum, theta), e->start));
    const double limit = e->branch.limit, length = radius - limit;
    if (!(length > 0.0)) return limit > 0.0 ? e->stiffest : 0.0;
    const double work =
        e->left > 0.0 ? line_work(e, length) : length * shv_law_shear_mean(e->law, e->history, e->other, limit, radius);
    return (e->stored + work) / ((radius - e->from) * (radius + e->from));
}

/* Sign chosen so that it rises from the spring's θ to 1. */
static double shear_balance(const Equation *e, double theta)
{
    return theta * (1.0 + e->compliance * shear_factor(e, theta)) - 1.0;
}

/* shear_balance where the envelope is a line, with its slope. */
static double line_balance(const Equation *e, double theta, double *slope)
{
    const ShvVec3 to = shv_sub(shv_scale(e->sum, theta), e->start);
    const double radius = shv_norm(to), length = radius - e->branch.limit;
    double factor = e->stiffest, change = 0.0;
    if (length > 0.0) {
        const double square = (radius - e->from) * (radius + e->from);
        const double rise = length < e->left ? e->branch.peak * (1.0 - length / e->left) : 0.0;
        factor = (e->stored + line_work(e, length)) / square;
        change = (rise / radius - 2.0 * factor) * (shv_dot(to, e->sum) / square);
    }
    *slope = 1.0 + e->compliance * (factor + theta * change);
    return theta * (1.0 + e->compliance * factor) - 1.0;
}

/* Newton steps from the spring's end of the bracket, kept safe by bisection: nearly a parabola, it takes four or five. */
static double line_theta(const Equation *e, double low)
{
    double high = 1.0, theta = low;
    for (int i = 0; i < 100; i++) {
        double slope;
        const double value = line_balance(e, theta, &slope);
        if (fabs(value) <= 4e-16) break;
        if (value < 0.0)
            low = theta;
        else
            high = theta;
        const double next = theta - value / slope;
        const bool inside = i % 8 != 7 && slope > 0.0 && next > low && next < high;
        const double x = inside ? next : 0.5 * (low + high);
        if (x == theta || high - low <= 4e-16 * high) break;
        theta = x;
    }
    return theta;
}

static ShvVec3 shear_envelope(Equation *e, double spring_theta)
{
    const double limit = e->branch.limit;
    double low = -1.0 + e->compliance * e->branch.peak / shv_norm(e->sum);
    e->left = line_left(e->law, e->history, SHV_SHEAR);
    if (limit > 0.0) {
        e->stored = 0.5 * e->branch.peak * (limit - e->from) * ((limit + e->from) / limit) + e->damped;
        e->stiffest = 0.5 * e->branch.peak / limit;
        if (e->damped > 0.0) e->stiffest += e->damped / ((limit - e->from) * (limit + e->from));
        spring_theta = 1.0 / (1.0 + e->compliance * e->stiffest);
        low = shear_balance(e, spring_theta);
    }
    /* the balance, a number near 1 less 1, is not known better than 4e-16 */
    double theta = spring_theta;
    if (low < 0.0 && limit > 0.0 && e->left > 0.0)
        theta = line_theta(e, spring_theta);
    else if (low < 0.0)
        theta = solve(e, shear_balance, spring_theta, 1.0, low, shear_balance(e, 1.0), 4e-16);
    return shv_scale(e->sum, shear_factor(e, theta) * theta);
}

/* The normal opening held at `to`; all vectors in the plane. */
static ShvVec3 shear_traction(const ShvPair *pair, const ShvPairSpring *spring, ShvHistory history, double to,
                              ShvVec3 free)
{
    const ShvVec3 sum = shv_add(free, pair->start);
    const double limit = spring->branch.limit, peak = spring->branch.peak, compliance = pair->compliance;
    const double from = shv_smaller(pair->slip, limit);
    double theta = 0.0, damped_work = 0.0;
    if (!(peak > 0.0)) {
        if (limit > 0.0 || shv_norm(sum) == 0.0) return shv_vec3(0.0, 0.0, 0.0);
    } else if (limit == 0.0) {
        if (shv_norm(sum) <= compliance * peak) return shv_scale(sum, 1.0 / compliance);
    } else {
        ShvVec3 traction, damped;
        if (shv_spring_shear(pair, spring, sum, &traction, &damped)) return traction;
        theta = spring->share;
        damped_work = shv_norm(damped) * (limit - from);
    }
    Equation e = {.law = pair->law,
                  .history = history,
                  .branch = spring->branch,
                  .other = to,
                  .compliance = compliance,
                  .from = from,
                  .damped = damped_work,
                  .start = pair->start,
                  .sum = sum};
    return shear_envelope(&e, theta);
}

/* ---- both ---- */

/* In PPR a normal opening below its largest leaves the spring of shear as it is, once the slip at the start is counted. */
static double still_below(const ShvLaw *law, ShvHistory history, double slip)
{
    if (law->kind != SHV_PPR) return -1.0;
    return shv_law_grow(law, history, history.normal, slip).shear == history.shear ? history.normal : -1.0;
}

ShvPair shv_pair_make(const ShvLaw *law, const ShvLawSprings *springs, ShvVec3 normal, ShvVec3 from, ShvVec3 now,
                      double compliance)
{
    const ShvHistory history = springs->history;
    ShvPair pair = {.law = law, .history = history, .compliance = compliance, .normal = normal};
    const double at = shv_dot(now, normal);
    pair.from = shv_dot(from, normal);
    pair.drift = at - pair.from;
    pair.start = shv_madd(from, -pair.from, normal);
    pair.sideways = shv_sub(shv_madd(now, -at, normal), pair.start);
    pair.slip = shv_norm(pair.start);
    pair.still = still_below(law, history, pair.slip);
    const ShvLawBranch normal_branch =
        law->kind == SHV_PPR ? springs->branch[SHV_NORMAL] : shv_law_normal_branch(law, history, pair.slip);
    pair.spring[SHV_NORMAL] = make_spring(normal_branch, compliance);
    /* beyond its spring by round-off only; a path to the envelope that is negative by round-off would have no traction */
    pair.from = shv_smaller(pair.from, pair.spring[SHV_NORMAL].branch.limit);
    if (pair.still >= 0.0) pair.spring[SHV_SHEAR] = make_spring(springs->branch[SHV_SHEAR], compliance);
    return pair;
}

ShvVec3 shv_pair_traction(const ShvPair *pair, ShvVec3 free)
{
    const double open = shv_dot(free, pair->normal), tension = normal_traction(pair, open);
    const double to = shv_larger(open - pair->compliance * tension, 0.0);
    const ShvVec3 plane = shv_madd(free, -open, pair->normal);
    ShvVec3 shear;
    if (to <= pair->still) {
        shear = shear_traction(pair, &pair->spring[SHV_SHEAR], pair->history, to, plane);
    } else {
        const ShvHistory grown = shv_law_grow(pair->law, pair->history, to, pair->slip);
        const ShvPairSpring spring = make_spring(shv_law_shear_branch(pair->law, grown, to), pair->compliance);
        shear = shear_traction(pair, &spring, grown, to, plane);
    }
    return shv_madd(shear, tension, pair->normal);
}
