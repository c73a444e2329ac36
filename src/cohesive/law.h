/* Extrinsic cohesive laws at a point: traction against opening, with history. All functions are pure.

   Opening (normal ≥ 0, shear ≥ 0), tractions in the same frame; the shear traction opposes the slip direction. */
#ifndef SHV_COHESIVE_LAW_H
#define SHV_COHESIVE_LAW_H

#include "model/material.h"

/* Parameters of one facet's law: the material's, scaled to the facet's strength and activation. */
typedef struct ShvLaw {
    ShvCohesiveLaw kind;
    double energy[2];         /* φn, φt, J/m² */
    double strength[2];       /* σmax, τmax, Pa */
    double shape[2];          /* α, β */
    double final_opening[2];  /* δn, δt, m */
    double conjugate[2];      /* δn*, δt* (PPR), m */
    double regularisation;    /* ε: history openings below ε × final opening count as that */
} ShvLaw;

typedef struct ShvHistory {
    double normal, shear; /* largest openings so far, m (Camacho-Ortiz keeps its effective opening in `normal`) */
} ShvHistory;

typedef struct ShvLawTraction {
    double normal, shear; /* Pa, ≥ 0 */
} ShvLawTraction;

/* Law of a material; strength = 0 gives δ = ∞ handled as instant release when energy is 0 too; energy = 0 gives δ = 0:
   instant release; infinite energy never softens. Never 0/0. */
ShvLaw shv_law_make(const ShvMaterial *material, double strength_scale, double regularisation);

/* Potential Ψ of extrinsic PPR at an opening, J/m² (for tests and for dissipation). */
double shv_ppr_potential(const ShvLaw *law, double normal, double shear);
/* Traction at an opening given the largest openings so far (which the caller then updates by shv_law_advance).
   Unloading is linear to the origin and uncoupled (PPR) or along the effective opening (Camacho-Ortiz). A negative
   normal opening counts as zero here; closing faces are contact. */
ShvLawTraction shv_law_traction(const ShvLaw *law, ShvHistory history, double normal, double shear);
ShvHistory shv_law_advance(const ShvLaw *law, ShvHistory history, double normal, double shear);
/* Damage 0…1: share of the work of separation that is gone for good; ≥ 0.99 counts as opened. */
double shv_law_damage(const ShvLaw *law, ShvHistory history);
/* Energy per area that can still be recovered by unloading from this opening, and that has been dissipated, J/m². */
double shv_law_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear);
double shv_law_dissipated(const ShvLaw *law, ShvHistory history);
/* Largest secant or unloading stiffness the point can show next step, Pa/m. */
double shv_law_stiffness(const ShvLaw *law, ShvHistory history);

#endif
