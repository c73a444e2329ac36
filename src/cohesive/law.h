/* Extrinsic cohesive laws at a point: traction against opening, with history. All functions are pure.

   Opening (normal, shear ≥ 0) and tractions stand in the same frame; the shear traction opposes the slip direction. A
   negative normal opening counts as zero: closing faces are contact.

   Both laws are secant springs whose stiffness only ever falls. At given histories traction is linear in the opening; a
   component that passes its largest opening follows the envelope and moves the history. Unloading uses the largest
   openings of both components: using the present opening of the other one, as is sometimes done for PPR, gives
   unsymmetric tangents, and closed paths that yield energy.

   PPR resists slip of any size with its full shear traction, in a direction that is undefined at zero slip: facets of an
   almost plane crack that tilt by round-off then work against each other. `slip_share` ε bounds the stiffness of shear by
   1/ε times that of opening; it takes 2ε/3 of the work in pure opening (α = β = 2) and nothing in pure shear.

   A rigid start is the limit of this: at zero history the stiffness is infinite, and the traction is whatever holds the
   faces together, up to the peak. A solver starts instead from a history that is very small (shv_law_start), so that round-off
   does not decide whether a pair holds. */
#ifndef SHV_COHESIVE_LAW_H
#define SHV_COHESIVE_LAW_H

#include "model/material.h"

/* Parameters of one facet's law: the material's, with strengths scaled and energies kept. */
typedef struct ShvLaw {
    ShvCohesiveLaw kind;
    double energy[2];        /* φn, φt, J/m²; an infinite one counts as 1e60 */
    double strength[2];      /* σmax, τmax, Pa; an infinite one counts as 1e60 */
    double shape[2];         /* PPR: α, β */
    double final_opening[2]; /* δn, δt, m: infinite without strength, zero without energy */
    double
        slip_share; /* PPR, set after shv_law_make: opening by x counts as slip by slip_share × x δt/δn as well, so that
                                less slip than that meets a share of the shear traction only (below); 0: plain law */
    double ratio, weight; /* Camacho-Ortiz: κ = GII/GI; effective opening √(Δn² + weight² Δt²), weight = β/κ */
} ShvLaw;

typedef struct ShvOpening {
    double normal, shear; /* m */
} ShvOpening;

typedef struct ShvHistory {
    double normal, shear; /* largest openings so far, m (Camacho-Ortiz keeps its effective opening in `normal`) */
    double dissipated;    /* J/m² along the path so far */
} ShvHistory;

typedef struct ShvLawTraction {
    double normal, shear; /* Pa, ≥ 0 */
} ShvLawTraction;

/* One component's traction, the other component's opening held: linear up to `limit`, where it is `peak`; beyond it the
   envelope. With limit = 0 anything from 0 to `peak` at zero opening. */
typedef struct ShvLawBranch {
    double limit; /* m */
    double peak;  /* Pa */
} ShvLawBranch;

/* Of two numbers, the first where they do not compare: without the library's care for NaN, which costs a call. */
static inline double shv_larger(double a, double b)
{
    return a < b ? b : a;
}
static inline double shv_smaller(double a, double b)
{
    return a > b ? b : a;
}

/* Law of a material. Zero energy gives instant release (no traction), zero strength no traction of that component,
   infinite energy never softens. Never 0/0. */
ShvLaw shv_law_make(const ShvMaterial *material, double strength_scale);

/* History with which a new facet starts: 1e-8 of the final openings, or of the elastic displacement length × strength /
   modulus where that is less. The work of separation loses a share of that order. */
ShvHistory shv_law_start(const ShvLaw *law, double length, double modulus);

/* Potential Ψ of extrinsic PPR at an opening, J/m²: traction is its gradient in loading. */
double shv_ppr_potential(const ShvLaw *law, double normal, double shear);

ShvLawBranch shv_law_normal_branch(const ShvLaw *law, ShvHistory history, double shear);
ShvLawBranch shv_law_shear_branch(const ShvLaw *law, ShvHistory history, double normal);
/* A history, and the branches of both components as far as it alone tells: PPR's, which do not ask what the other one's
   opening is now. Of Camacho-Ortiz they are left empty. */
typedef struct ShvLawSprings {
    ShvHistory history;
    ShvLawBranch branch[2];
} ShvLawSprings;

ShvLawSprings shv_law_springs(const ShvLaw *law, ShvHistory history);
/* Springs that were found before, at a history that has moved or not. */
static inline const ShvLawSprings *shv_law_follow(const ShvLaw *law, ShvHistory history, ShvLawSprings *springs)
{
    if (springs->history.normal != history.normal || springs->history.shear != history.shear)
        *springs = shv_law_springs(law, history);
    return springs;
}
/* Mean traction of the envelope over limit ≤ from < to: exact in closed form, without loss of digits. */
double shv_law_normal_mean(const ShvLaw *law, ShvHistory history, double shear, double from, double to);
double shv_law_shear_mean(const ShvLaw *law, ShvHistory history, double normal, double from, double to);

/* Traction at an opening given the largest openings so far. Where a component's opening and history are both zero, the
   peak. */
ShvLawTraction shv_law_traction(const ShvLaw *law, ShvHistory history, double normal, double shear);
/* Largest traction of either component still to come, Pa; 0 exactly when nothing (or 1e-12 of the strength) is left. */
double shv_law_peak(const ShvLaw *law, ShvHistory history);
/* Largest openings after one more opening; nothing is dissipated here. */
ShvHistory shv_law_grow_beyond(const ShvLaw *law, ShvHistory history, double normal, double shear);
static inline ShvHistory shv_law_grow(const ShvLaw *law, ShvHistory history, double normal, double shear)
{
    const bool below = law->kind == SHV_PPR && !(normal > history.normal || shear > history.shear);
    return below ? history : shv_law_grow_beyond(law, history, normal, shear);
}
ShvHistory shv_law_advance_beyond(const ShvLaw *law, ShvHistory history, ShvOpening from, ShvOpening to);
/* History after the path `from` → `to` (first the normal, then the shear component). The work done on the point is
   exactly what `recoverable` and `dissipated` grow by; `dissipated` never falls. */
static inline ShvHistory shv_law_advance(const ShvLaw *law, ShvHistory history, ShvOpening from, ShvOpening to)
{
    const bool below =
        law->kind == SHV_PPR && !(to.normal > history.normal || from.shear > history.shear || to.shear > history.shear);
    return below ? history : shv_law_advance_beyond(law, history, from, to);
}
/* Energy per area that comes back by unloading from an opening, J/m². */
double shv_law_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear);
/* Energy of one component's spring, J/m². */
static inline double shv_branch_energy(ShvLawBranch branch, double opening)
{
    if (!(opening > 0.0) || branch.limit == 0.0) return 0.0;
    const double x = shv_smaller(opening, branch.limit);
    return 0.5 * branch.peak * (x / branch.limit) * x;
}
/* shv_law_recoverable at the history of the springs. */
static inline double shv_springs_recoverable(const ShvLaw *law, const ShvLawSprings *springs, ShvOpening at)
{
    if (law->kind != SHV_PPR) return shv_law_recoverable(law, springs->history, at.normal, at.shear);
    return shv_branch_energy(springs->branch[SHV_NORMAL], at.normal) +
           shv_branch_energy(springs->branch[SHV_SHEAR], at.shear);
}
/* Share of the normal strength that is left at zero slip, 0…1: what still joins the two sides. Unlike damage it falls with the
   largest slip at any ratio of the energies; 0 for a law without strength or energy. */
double shv_law_residual(const ShvLaw *law, ShvHistory history);
/* Work that it would take to open the point from closed, without slip, J/m². */
double shv_law_remaining(const ShvLaw *law, ShvHistory history);
/* History of a point that can carry nothing any more, whatever it was; nothing is dissipated. */
ShvHistory shv_law_tear(const ShvLaw *law, ShvHistory history);
/* Share of the work of separation that is gone for good, 0…1; exactly 1 when no traction is left. */
double shv_law_damage(const ShvLaw *law, ShvHistory history);

#endif
