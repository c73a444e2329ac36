/* Traction of a facet in the solid, against its strength. */
#ifndef SHV_COHESIVE_TRACTION_H
#define SHV_COHESIVE_TRACTION_H

#include "cohesive/cohesive.h"

/* Stress of an element as shv_solid_stress leaves it: component-major within a batch of SHV_LANES. */
static inline int64_t shv_cohesive_stress_slot(int32_t element, int component)
{
    return (int64_t)(element / SHV_LANES) * (6 * SHV_LANES) + component * SHV_LANES + element % SHV_LANES;
}

typedef struct ShvFacetTraction {
    double normal, shear; /* Pa; normal positive in tension */
} ShvFacetTraction;

/* Mean of the stresses of two elements on a unit normal. */
ShvFacetTraction shv_facet_traction(const double *stress, int32_t first, int32_t second, ShvVec3 normal);
/* √(⟨tn⟩² + (tt/β)²) / strength, β the material's shear/normal strength; any traction exceeds a strength of zero. In
   compression tt / (β strength + |tn| tan φ): what softens and what rubs together. */
double shv_facet_overstress(const ShvMaterial *material, double strength, ShvFacetTraction traction);
/* β, the shear strength as a multiple of the normal one. */
double shv_shear_ratio(const ShvMaterial *material);
/* What a facet holds in the direction of an opening, as a share of its normal strength: √(cos² θ + β² sin² θ), from the
   cosine of the angle θ between the direction and its normal. */
double shv_strength_share(double cosine, double shear_ratio);

#endif
