#include "cohesive/camacho_ortiz.h"

#include <math.h>

/* Openings below this count as none: their squares would underflow. */
static const double least_opening = 1e-100;

double shv_camacho_ortiz_effective(const ShvLaw *law, double normal, double shear)
{
    const double n = fmax(normal, 0.0), s = law->weight * shear;
    const double effective = s == 0.0 ? n : sqrt(n * n + s * s);
    return effective < least_opening ? 0.0 : effective;
}

static double softened(const ShvLaw *law, double effective)
{
    const double end = law->final_opening[SHV_NORMAL];
    return effective < end ? law->strength[SHV_NORMAL] * (1.0 - effective / end) : 0.0;
}

/* Traction of a component is `stiffness_factor` × opening × σ(δmax)/δmax. */
static double stiffness_factor(const ShvLaw *law, int component)
{
    return component == SHV_NORMAL ? 1.0 : law->ratio * law->weight * law->weight;
}

/* Opening of one component per effective opening, the other held at zero; 0 where it does not count. */
static double weight_of(const ShvLaw *law, int component)
{
    return component == SHV_NORMAL ? 1.0 : law->weight;
}

static double held_part(const ShvLaw *law, int component, double other)
{
    return component == SHV_NORMAL ? law->weight * other : fmax(other, 0.0);
}

static double virgin_peak(const ShvLaw *law, int component)
{
    return law->final_opening[SHV_NORMAL] > 0.0 ? law->strength[component] : 0.0;
}

ShvLawBranch shv_camacho_ortiz_branch(const ShvLaw *law, ShvHistory history, int component, double other)
{
    const double held = held_part(law, component, other), weight = weight_of(law, component);
    const double effective = fmax(history.normal, held);
    if (weight == 0.0) return (ShvLawBranch){0.0, 0.0};
    if (effective < least_opening) return (ShvLawBranch){0.0, virgin_peak(law, component)};
    const double limit = sqrt(fmax((effective - held) * (effective + held), 0.0)) / weight;
    const double secant = softened(law, effective) / effective;
    return (ShvLawBranch){limit, stiffness_factor(law, component) * secant * limit};
}

/* ∫σ dδ over the path, times κ for shear, over its length: dδ/dΔ over a finite piece is
   weight² (Δ1 + Δ0)/(δ1 + δ0). */
double shv_camacho_ortiz_mean(const ShvLaw *law, int component, double other, double from, double to)
{
    const double held = held_part(law, component, other), weight = weight_of(law, component);
    const double end = law->final_opening[SHV_NORMAL];
    const double start = sqrt(held * held + weight * weight * from * from);
    if (weight == 0.0 || !(start < end)) return 0.0;
    double stop = sqrt(held * held + weight * weight * to * to), last = to;
    if (stop > end) {
        stop = end;
        last = sqrt((end - held) * (end + held)) / weight;
    }
    if (start + stop < least_opening) return virgin_peak(law, component);
    const double factor = component == SHV_NORMAL ? 1.0 : law->ratio;
    const double mean = factor * law->strength[SHV_NORMAL] * (1.0 - 0.5 * (start + stop) / end) * weight * weight *
                        (last + from) / (start + stop);
    return last < to ? mean * ((last - from) / (to - from)) : mean;
}

double shv_camacho_ortiz_peak(const ShvLaw *law, ShvHistory history)
{
    const double beta = law->ratio * law->weight;
    if (virgin_peak(law, SHV_NORMAL) == 0.0) return 0.0;
    return softened(law, history.normal) * fmax(1.0, beta);
}

double shv_camacho_ortiz_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    const double effective = history.normal, n = fmax(normal, 0.0);
    if (effective == 0.0) return 0.0;
    const double square = n * (n / effective) + stiffness_factor(law, SHV_SHEAR) * shear * (shear / effective);
    return 0.5 * softened(law, effective) * square;
}

double shv_camacho_ortiz_damage(const ShvLaw *law, ShvHistory history)
{
    const double end = law->final_opening[SHV_NORMAL];
    if (virgin_peak(law, SHV_NORMAL) == 0.0) return 1.0;
    return history.normal < end ? history.normal / end : 1.0;
}
