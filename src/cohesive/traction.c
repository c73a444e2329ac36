#include "cohesive/traction.h"

#include <math.h>

ShvFacetTraction shv_facet_traction(const double *stress, int32_t first, int32_t second, ShvVec3 normal)
{
    double s[6];
    for (int i = 0; i < 6; i++)
        s[i] = 0.5 * (stress[shv_cohesive_stress_slot(first, i)] + stress[shv_cohesive_stress_slot(second, i)]);
    const ShvMat3 mean = shv_from_voigt(s);
    const ShvVec3 t = shv_apply(&mean, normal);
    const double tension = shv_dot(t, normal);
    return (ShvFacetTraction){tension, shv_norm(shv_madd(t, -tension, normal))};
}

static double against(double value, double strength)
{
    return value > 0.0 ? value / strength : 0.0;
}

double shv_facet_overstress(const ShvMaterial *material, double strength, ShvFacetTraction traction)
{
    if (isinf(material->strength[SHV_NORMAL])) return 0.0;
    const double scale = material->strength[SHV_NORMAL] > 0.0 ? strength / material->strength[SHV_NORMAL] : 1.0;
    const double tension = against(traction.normal, strength);
    const double friction = material->friction * shv_larger(-traction.normal, 0.0);
    const double shear = against(traction.shear, scale * material->strength[SHV_SHEAR] + friction);
    return sqrt(tension * tension + shear * shear);
}

double shv_shear_ratio(const ShvMaterial *material)
{
    const double normal = material->strength[SHV_NORMAL];
    return normal > 0.0 && isfinite(normal) ? material->strength[SHV_SHEAR] / normal : 1.0;
}

/* Less than this of sin² θ is round-off, which shear of infinite strength would not forgive. */
static const double slight_shear = 1e-12;

double shv_strength_share(double cosine, double shear_ratio)
{
    const double normal = cosine * cosine, shear = 1.0 - normal;
    return sqrt(normal + (shear > slight_shear ? shear_ratio * shear_ratio * shear : 0.0));
}
