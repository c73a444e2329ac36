/* Materials as the solver sees them: definitions checked once, derived constants beside them. */
#ifndef SHV_MODEL_MATERIAL_H
#define SHV_MODEL_MATERIAL_H

#include <math.h>

#include "base/memory.h"
#include "shiver/definition.h"

enum { SHV_NORMAL = 0, SHV_SHEAR = 1 };

typedef struct ShvMaterial {
    const char *name;
    double density, youngs_modulus, poissons_ratio;
    double lambda, mu;         /* Lamé constants, Pa */
    double dilatational_speed; /* √((λ+2µ)/ρ), m/s */
    double bar_speed;          /* √(E/ρ), m/s */
    double shear_speed;        /* √(µ/ρ), m/s */
    ShvKinematics kinematics;
    bool breakable;
    ShvCohesiveLaw law;
    double fracture_energy[2]; /* normal, shear, J/m² */
    double strength[2];        /* normal, shear, Pa */
    double shape[2];           /* PPR α, β */
    double weibull_modulus, weibull_volume;
} ShvMaterial;

/* Checks a definition (cookie, ranges; the message names the material and key) and derives the rest. */
ShvStatus shv_material_make(ShvMaterial *material, const ShvMaterialDefinition *definition, ShvError *error);

/* Whether any facet of it can ever open: breakable, and of finite strength. */
static inline bool shv_material_can_open(const ShvMaterial *material)
{
    return material->breakable && isfinite(material->strength[SHV_NORMAL]);
}

/* Length over which a crack tip softens, R = (π/8) E/(1−ν²) G/σ², m (physics of cohesive zones; 5-10 elements resolve
   it), and the length 2 E G/σ² above which one element in series with a crack snaps back. Infinite when σ = 0 and
   where nothing can open. */
double shv_material_cohesive_zone(const ShvMaterial *material);
double shv_material_snap_back(const ShvMaterial *material);
/* Final normal opening α G/σ (PPR) or 2 G/σ (Camacho-Ortiz), m. */
double shv_material_final_opening(const ShvMaterial *material);

#endif
