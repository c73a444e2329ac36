/* Extrinsic Park-Paulino-Roesler law (general φn, φt, α, β); see law.h for the meaning of the functions.

   With u = 1 − Δn/δn, v = 1 − Δt/δt and φ = max(φn, φt), the gradient of the potential is
   Tn = σmax u^(α−1) (φ v^β − ⟨φt−φn⟩)/φn,  Tt = τmax v^(β−1) (φ u^α − ⟨φn−φt⟩)/φt,
   both cut off where the bracket turns negative: that is the conjugate opening. */
#ifndef SHV_COHESIVE_PPR_H
#define SHV_COHESIVE_PPR_H

#include "cohesive/law.h"

ShvLawBranch shv_ppr_branch(const ShvLaw *law, ShvHistory history, int component);
double shv_ppr_mean(const ShvLaw *law, ShvHistory history, int component, double from, double to);
double shv_ppr_recoverable(const ShvLaw *law, ShvHistory history, double normal, double shear);
double shv_ppr_damage(const ShvLaw *law, ShvHistory history);

#endif
