#include "cohesive/ppr.h"

#include <math.h>

#include "base/deterministic.h"

/* The usual exponents without a call. */
static double power(double x, double a)
{
    return a == 2.0 ? x * x : a == 1.0 ? x : shv_power(x, a);
}

/* Δ/δ cut at 1; an opening of any size passes a final opening of zero. */
static double share(double opening, double final_opening)
{
    if (!(opening > 0.0)) return 0.0;
    return opening < final_opening ? opening / final_opening : 1.0;
}

static double larger(const ShvLaw *law)
{
    return shv_larger(law->energy[SHV_NORMAL], law->energy[SHV_SHEAR]);
}

/* (φ v^β − ⟨φt−φn⟩)/φn for the normal component, and by symmetry: what the other component's opening leaves. */
static double left_by_other(const ShvLaw *law, int component, double other)
{
    const int across = 1 - component;
    const double gap = shv_larger(law->energy[across] - law->energy[component], 0.0);
    const double rest = 1.0 - share(other, law->final_opening[across]);
    return shv_larger((larger(law) * power(rest, law->shape[across]) - gap) / law->energy[component], 0.0);
}

static double envelope(const ShvLaw *law, int component, double opening, double other)
{
    if (law->energy[component] == 0.0) return 0.0;
    const double rest = 1.0 - share(opening, law->final_opening[component]);
    return law->strength[component] * power(rest, law->shape[component] - 1.0) * left_by_other(law, component, other);
}

static double largest(ShvHistory history, int component)
{
    return component == SHV_NORMAL ? history.normal : history.shear;
}

double shv_ppr_potential(const ShvLaw *law, double normal, double shear)
{
    const double phi_n = law->energy[SHV_NORMAL], phi_t = law->energy[SHV_SHEAR];
    const double gamma_n = phi_n < phi_t ? 1.0 : -phi_n, gamma_t = phi_n < phi_t ? -phi_t : 1.0;
    const double u = power(1.0 - share(normal, law->final_opening[SHV_NORMAL]), law->shape[SHV_NORMAL]);
    const double v = power(1.0 - share(shear, law->final_opening[SHV_SHEAR]), law->shape[SHV_SHEAR]);
    return shv_smaller(phi_n, phi_t) +
           (gamma_n * u + shv_larger(phi_n - phi_t, 0.0)) * (gamma_t * v + shv_larger(phi_t - phi_n, 0.0));
}

ShvLawBranch shv_ppr_branch(const ShvLaw *law, ShvHistory history, int component)
{
    const double limit = largest(history, component);
    return (ShvLawBranch){limit, envelope(law, component, limit, largest(history, 1 - component))};
}

/* Mean of a u^(a−1) over u0 ≥ u ≥ u1, i.e. (u0^a − u1^a)/(u0 − u1). Where the difference would lose digits, Simpson's
   rule; its relative error is of the order of (width/u)^4 ≤ 1e-16. */
static double mean_power(double u0, double u1, double width, double a)
{
    if (width > 1e-4 * u0) return (power(u0, a) - power(u1, a)) / width;
    const double middle = 0.5 * (u0 + u1);
    return a * (power(u0, a - 1.0) + 4.0 * power(middle, a - 1.0) + power(u1, a - 1.0)) / 6.0;
}

double shv_ppr_mean(const ShvLaw *law, ShvHistory history, int component, double from, double to)
{
    const double final_opening = law->final_opening[component], a = law->shape[component];
    if (law->energy[component] == 0.0 || !(from < final_opening)) return 0.0;
    const double end = shv_smaller(to, final_opening);
    const double scale = law->strength[component] * left_by_other(law, component, largest(history, 1 - component)) / a;
    const double u0 = 1.0 - from / final_opening, u1 = 1.0 - end / final_opening;
    const double mean = scale * mean_power(u0, u1, (end - from) / final_opening, a);
    return end < to ? mean * ((end - from) / (to - from)) : mean;
}

static double spring_energy(const ShvLaw *law, ShvHistory history, int component, double opening)
{
    return shv_branch_energy(shv_ppr_branch(law, history, component), opening);
}

double shv_ppr_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    return spring_energy(law, history, SHV_NORMAL, normal) + spring_energy(law, history, SHV_SHEAR, shear);
}

static double work_left(const ShvLaw *law, ShvHistory history, int component)
{
    const double from = largest(history, component), to = law->final_opening[component];
    if (!(from < to)) return 0.0;
    if (isinf(to)) return 0.0; /* no strength */
    return shv_ppr_mean(law, history, component, from, to) * (to - from);
}

double shv_ppr_damage(const ShvLaw *law, ShvHistory history)
{
    const ShvLawBranch normal = shv_ppr_branch(law, history, SHV_NORMAL);
    const ShvLawBranch shear = shv_ppr_branch(law, history, SHV_SHEAR);
    if (normal.peak == 0.0 && shear.peak == 0.0) return 1.0;
    const double left = 0.5 * normal.peak * normal.limit + 0.5 * shear.peak * shear.limit +
                        shv_larger(work_left(law, history, SHV_NORMAL), work_left(law, history, SHV_SHEAR));
    return left > 0.0 ? history.dissipated / (history.dissipated + left) : 1.0;
}
