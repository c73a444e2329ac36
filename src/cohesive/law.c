#include "cohesive/law.h"

#include <math.h>

#include "cohesive/camacho_ortiz.h"
#include "cohesive/ppr.h"

static const double practically_infinite = 1e60;

/* α φ/σ: no end without strength, at once without energy. */
static double final_opening(double shape, double energy, double strength)
{
    if (energy == 0.0) return 0.0;
    return strength > 0.0 ? shape * energy / strength : (double)INFINITY;
}

/* Without energy in one of the modes the effective opening has no measure: the whole law releases at once. */
static void make_camacho_ortiz(ShvLaw *law)
{
    const double *energy = law->energy, *strength = law->strength;
    const bool released = energy[SHV_NORMAL] == 0.0 || energy[SHV_SHEAR] == 0.0 || strength[SHV_NORMAL] == 0.0;
    law->ratio = released ? 1.0 : energy[SHV_SHEAR] / energy[SHV_NORMAL];
    law->weight = released ? 0.0 : strength[SHV_SHEAR] / strength[SHV_NORMAL] / law->ratio;
    for (int i = 0; i < 2; i++) law->final_opening[i] = released ? 0.0 : final_opening(2.0, energy[i], strength[i]);
}

ShvLaw shv_law_make(const ShvMaterial *material, double strength_scale)
{
    ShvLaw law = {.kind = material->law};
    for (int i = 0; i < 2; i++) {
        law.energy[i] = shv_smaller(material->fracture_energy[i], practically_infinite);
        law.strength[i] = shv_smaller(material->strength[i] * strength_scale, practically_infinite);
        law.shape[i] = material->shape[i];
        law.final_opening[i] = final_opening(law.shape[i], law.energy[i], law.strength[i]);
    }
    if (law.kind == SHV_CAMACHO_ORTIZ) make_camacho_ortiz(&law);
    return law;
}

/* Far above the round-off of displacements of metres, far below what a step opens that resolves the solid. */
static const double start_share = 1e-8;

static double start_opening(const ShvLaw *law, int component, double length, double modulus)
{
    return start_share * shv_smaller(law->final_opening[component], length * (law->strength[component] / modulus));
}

ShvHistory shv_law_start(const ShvLaw *law, double length, double modulus)
{
    const double normal = start_opening(law, SHV_NORMAL, length, modulus);
    const double shear = law->kind == SHV_PPR ? start_opening(law, SHV_SHEAR, length, modulus) : 0.0;
    return shv_law_grow(law, (ShvHistory){0}, normal, shear);
}

ShvLawBranch shv_law_normal_branch(const ShvLaw *law, ShvHistory history, double shear)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_branch(law, history, SHV_NORMAL, shear);
    return shv_ppr_branch(law, history, SHV_NORMAL);
}

ShvLawBranch shv_law_shear_branch(const ShvLaw *law, ShvHistory history, double normal)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_branch(law, history, SHV_SHEAR, normal);
    return shv_ppr_branch(law, history, SHV_SHEAR);
}

ShvLawSprings shv_law_springs(const ShvLaw *law, ShvHistory history)
{
    ShvLawSprings springs = {.history = history};
    for (int i = 0; law->kind == SHV_PPR && i < 2; i++) springs.branch[i] = shv_ppr_branch(law, history, i);
    return springs;
}

double shv_law_normal_mean(const ShvLaw *law, ShvHistory history, double shear, double from, double to)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_mean(law, SHV_NORMAL, shear, from, to);
    return shv_ppr_mean(law, history, SHV_NORMAL, from, to);
}

double shv_law_shear_mean(const ShvLaw *law, ShvHistory history, double normal, double from, double to)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_mean(law, SHV_SHEAR, normal, from, to);
    return shv_ppr_mean(law, history, SHV_SHEAR, from, to);
}

/* Of the larger strength: a steep envelope ((1 − x)^199 at shape 200) fades to numbers whose reciprocals overflow long before it
   ends. */
static const double nothing_left = 1e-12;

double shv_law_peak(const ShvLaw *law, ShvHistory history)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_peak(law, history);
    const double peak =
        shv_larger(shv_ppr_branch(law, history, SHV_NORMAL).peak, shv_ppr_branch(law, history, SHV_SHEAR).peak);
    const double strength = shv_larger(law->strength[SHV_NORMAL], law->strength[SHV_SHEAR]);
    return peak > nothing_left * strength ? peak : 0.0;
}

static double counted_slip(const ShvLaw *law, double opening)
{
    const double *end = law->final_opening;
    const bool finite = end[SHV_NORMAL] > 0.0 && isfinite(end[SHV_NORMAL]) && isfinite(end[SHV_SHEAR]);
    return law->slip_share > 0.0 && finite
               ? law->slip_share * shv_smaller(opening / end[SHV_NORMAL], 1.0) * end[SHV_SHEAR]
               : 0.0;
}

ShvHistory shv_law_grow_beyond(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) {
        history.normal = shv_larger(history.normal, shv_camacho_ortiz_effective(law, normal, shear));
    } else if (normal > history.normal || shear > history.shear) {
        history.normal = shv_larger(history.normal, normal);
        history.shear = shv_larger(history.shear, shv_larger(shear, counted_slip(law, history.normal)));
    }
    return history;
}

static double on_branch(ShvLawBranch branch, double opening)
{
    return branch.limit > 0.0 ? branch.peak * shv_smaller(opening / branch.limit, 1.0) : branch.peak;
}

ShvLawTraction shv_law_traction(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    const double n = shv_larger(normal, 0.0);
    const ShvHistory grown = shv_law_grow(law, history, n, shear);
    return (ShvLawTraction){on_branch(shv_law_normal_branch(law, grown, shear), n),
                            on_branch(shv_law_shear_branch(law, grown, n), shear)};
}

double shv_law_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    if (law->kind == SHV_CAMACHO_ORTIZ) return shv_camacho_ortiz_recoverable(law, history, normal, shear);
    return shv_ppr_recoverable(law, history, normal, shear);
}

/* Work on the linear part of a branch, from zero to `opening` (cut at the limit). */
static double linear_work(ShvLawBranch branch, double opening)
{
    const double x = shv_smaller(shv_larger(opening, 0.0), branch.limit);
    return branch.limit > 0.0 ? 0.5 * branch.peak * (x / branch.limit) * x : 0.0;
}

static ShvHistory advance_normal(const ShvLaw *law, ShvHistory history, double shear, double from, double to)
{
    const ShvLawBranch branch = shv_law_normal_branch(law, history, shear);
    if (!(to > branch.limit)) return history;
    const double work = linear_work(branch, to) - linear_work(branch, from) +
                        shv_law_normal_mean(law, history, shear, branch.limit, to) * (to - branch.limit);
    ShvHistory next = shv_law_grow(law, history, to, shear);
    const double stored = shv_law_recoverable(law, next, to, shear) - shv_law_recoverable(law, history, from, shear);
    next.dissipated += shv_larger(work - stored, 0.0);
    return next;
}

static ShvHistory advance_shear(const ShvLaw *law, ShvHistory history, double normal, double from, double to)
{
    const ShvLawBranch branch = shv_law_shear_branch(law, history, normal);
    if (!(to > branch.limit)) return history;
    const double work = linear_work(branch, to) - linear_work(branch, from) +
                        shv_law_shear_mean(law, history, normal, branch.limit, to) * (to - branch.limit);
    ShvHistory next = shv_law_grow(law, history, normal, to);
    const double stored = shv_law_recoverable(law, next, normal, to) - shv_law_recoverable(law, history, normal, from);
    next.dissipated += shv_larger(work - stored, 0.0);
    return next;
}

ShvHistory shv_law_advance_beyond(const ShvLaw *law, ShvHistory history, ShvOpening from, ShvOpening to)
{
    const double start = shv_larger(from.normal, 0.0), end = shv_larger(to.normal, 0.0);
    const ShvHistory reached = shv_law_grow(law, shv_law_grow(law, history, end, from.shear), end, to.shear);
    if (reached.normal == history.normal && reached.shear == history.shear) return history;
    const ShvHistory opened = advance_normal(law, history, from.shear, start, end);
    return advance_shear(law, opened, end, from.shear, to.shear);
}

double shv_law_residual(const ShvLaw *law, ShvHistory history)
{
    const double strength = law->strength[SHV_NORMAL];
    return strength > 0.0 ? shv_law_normal_branch(law, history, 0.0).peak / strength : 0.0;
}

double shv_law_remaining(const ShvLaw *law, ShvHistory history)
{
    const ShvLawBranch branch = shv_law_normal_branch(law, history, 0.0);
    const double last = law->final_opening[SHV_NORMAL];
    if (!isfinite(last)) return (double)INFINITY;
    const double open = last > branch.limit ? last - branch.limit : 0.0;
    return 0.5 * branch.peak * branch.limit + shv_law_normal_mean(law, history, 0.0, branch.limit, last) * open;
}

ShvHistory shv_law_tear(const ShvLaw *law, ShvHistory history)
{
    return shv_law_grow(law, history, law->final_opening[SHV_NORMAL], law->final_opening[SHV_SHEAR]);
}

double shv_law_damage(const ShvLaw *law, ShvHistory history)
{
    return law->kind == SHV_CAMACHO_ORTIZ ? shv_camacho_ortiz_damage(law, history) : shv_ppr_damage(law, history);
}
