/* Camacho-Ortiz law in the form of Snozzi and Molinari: effective opening δ = √(⟨Δn⟩² + (β/κ)² Δt²), traction
   (Δn, (β²/κ) Δt) σ(δmax)/δmax with σ(δ) = σc (1 − δ/δc); see law.h for the meaning of the functions. */
#ifndef SHV_COHESIVE_CAMACHO_ORTIZ_H
#define SHV_COHESIVE_CAMACHO_ORTIZ_H

#include "cohesive/law.h"

double shv_camacho_ortiz_effective(const ShvLaw *law, double normal, double shear);
/* `other`: opening of the component that is held. */
ShvLawBranch shv_camacho_ortiz_branch(const ShvLaw *law, ShvHistory history, int component, double other);
double shv_camacho_ortiz_mean(const ShvLaw *law, int component, double other, double from, double to);
double shv_camacho_ortiz_peak(const ShvLaw *law, ShvHistory history);
double shv_camacho_ortiz_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear);
double shv_camacho_ortiz_damage(const ShvLaw *law, ShvHistory history);

#endif
