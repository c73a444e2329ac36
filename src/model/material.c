#include "model/material.h"

#include <math.h>

#include "base/deterministic.h"

static const double eighth_of_pi = 0.39269908169872415;

/* In compression faces slide and ride up over each other, as the rough ones of a mesh must: at 30°. With a flow rule of that
   angle and friction of φ besides, the direction of motion stands at 45° + (φ − 30°)/2 to the least compressive stress. */
static const double riding_cosine = 0.86602540378443865, riding_sine = 0.5;

static ShvStatus bad_value(ShvError *error, const char *material, const char *key, double value, const char *range)
{
    return shv_fail(error, SHV_BAD_INPUT, "material '%s': %s is %g; give %s", material, key, value, range);
}

static ShvStatus check_elasticity(const ShvMaterialDefinition *definition, ShvError *error)
{
    const char *name = definition->name;
    if (!(definition->density > 0.0 && isfinite(definition->density)))
        return bad_value(error, name, "density", definition->density, "a finite number above 0, in kg/m³");
    if (!(definition->youngs_modulus > 0.0 && isfinite(definition->youngs_modulus)))
        return bad_value(error, name, "youngs_modulus", definition->youngs_modulus, "a finite number above 0, in Pa");
    if (!(definition->poissons_ratio > -1.0 && definition->poissons_ratio < 0.5))
        return bad_value(error, name, "poissons_ratio", definition->poissons_ratio, "a number above -1 and below 0.5");
    if (!(definition->loss_factor >= 0.0 && definition->loss_factor <= 1.0))
        return bad_value(error, name, "loss_factor", definition->loss_factor,
                         "a number from 0 (no friction inside) to 1");
    if (definition->kinematics != SHV_GREEN_STRAIN && definition->kinematics != SHV_COROTATIONAL)
        return bad_value(error, name, "kinematics", (double)definition->kinematics,
                         "SHV_GREEN_STRAIN or SHV_COROTATIONAL");
    if (definition->smoothing != SHV_SMOOTHING_AUTO && definition->smoothing != SHV_SMOOTHING_NONE &&
        definition->smoothing != SHV_SMOOTHING_EDGES)
        return bad_value(error, name, "smoothing", (double)definition->smoothing, "one of ShvSmoothing");
    return SHV_OK;
}

/* A strength or an energy of separation: at least zero, infinite if one likes; NaN only where it may be left out. */
static ShvStatus check_separation(const char *material, const char *key, double value, bool optional, const char *unit,
                                  ShvError *error)
{
    if (value >= 0.0 || (optional && isnan(value))) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "material '%s': %s is %g; give a number of at least 0, in %s%s", material,
                    key, value, unit, optional ? "" : ", or make the material unbreakable");
}

static ShvStatus check_shape(const char *material, const char *key, double value, bool optional, ShvError *error)
{
    if ((value > 1.0 && isfinite(value)) || (optional && isnan(value))) return SHV_OK;
    return bad_value(error, material, key, value, "a finite number above 1 (2 softens linearly)");
}

static ShvStatus check_fracture(const ShvMaterialDefinition *definition, ShvError *error)
{
    const char *name = definition->name;
    const bool optional = !definition->breakable;
    if (definition->law != SHV_PPR && definition->law != SHV_CAMACHO_ORTIZ)
        return bad_value(error, name, "law", (double)definition->law, "SHV_PPR or SHV_CAMACHO_ORTIZ");
    SHV_TRY(check_separation(name, "fracture_energy", definition->fracture_energy, optional, "J/m²", error));
    SHV_TRY(check_separation(name, "cohesive_strength", definition->cohesive_strength, optional, "Pa", error));
    SHV_TRY(check_separation(name, "fracture_energy_shear", definition->fracture_energy_shear, true, "J/m²", error));
    SHV_TRY(check_separation(name, "cohesive_strength_shear", definition->cohesive_strength_shear, true, "Pa", error));
    SHV_TRY(check_shape(name, "ppr_shape", definition->ppr_shape, optional, error));
    SHV_TRY(check_shape(name, "ppr_shape_shear", definition->ppr_shape_shear, true, error));
    if (!(definition->weibull_modulus >= 0.0 && isfinite(definition->weibull_modulus)))
        return bad_value(error, name, "weibull_modulus", definition->weibull_modulus,
                         "a finite number of at least 0 (0: no spread)");
    if (!(definition->weibull_volume >= 0.0 && isfinite(definition->weibull_volume)))
        return bad_value(error, name, "weibull_volume", definition->weibull_volume,
                         "a finite number of at least 0, in m³ (0: facets of any size scatter alike)");
    if (!(definition->weibull_area >= 0.0 && isfinite(definition->weibull_area)))
        return bad_value(error, name, "weibull_area", definition->weibull_area, "a finite number of at least 0, in m²");
    if (definition->weibull_area > 0.0 && definition->weibull_volume > 0.0)
        return bad_value(error, name, "weibull_area", definition->weibull_area,
                         "0 where there is a weibull_volume: flaws are inside or on the surface");
    if (!(definition->face_restitution >= 0.0 && definition->face_restitution <= 1.0))
        return bad_value(error, name, "face_restitution", definition->face_restitution,
                         "a number from 0 (faces that meet stay together) to 1 (they give back all)");
    if (!(definition->friction_angle_degrees >= 0.0 && definition->friction_angle_degrees < 90.0))
        return bad_value(error, name, "friction_angle", definition->friction_angle_degrees,
                         "a number of at least 0 and below 90 degrees");
    if (definition->unresolved != SHV_UNRESOLVED_KEEP && definition->unresolved != SHV_UNRESOLVED_SCALE_STRENGTH &&
        definition->unresolved != SHV_UNRESOLVED_SCALE_ENERGY && definition->unresolved != SHV_UNRESOLVED_TIP_STRENGTH)
        return bad_value(error, name, "unresolved", (double)definition->unresolved, "one of ShvUnresolved");
    if (!(definition->zone_edges >= 1.0 && isfinite(definition->zone_edges)))
        return bad_value(error, name, "zone_edges", definition->zone_edges, "a finite number of at least 1");
    if (definition->unresolved != SHV_UNRESOLVED_KEEP && definition->fracture_energy <= 0.0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "material '%s': without fracture_energy there is no cohesive zone to scale; give an energy, or "
                        "'unresolved: keep'",
                        name);
    return SHV_OK;
}

static double or_else(double value, double otherwise)
{
    return isnan(value) ? otherwise : value;
}

static void derive_elasticity(ShvMaterial *material)
{
    const double modulus = material->youngs_modulus, ratio = material->poissons_ratio;
    material->mu = modulus / (2.0 * (1.0 + ratio));
    material->lambda = modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio));
    material->dilatational_speed = sqrt((material->lambda + 2.0 * material->mu) / material->density);
    material->bar_speed = sqrt(modulus / material->density);
    material->shear_speed = sqrt(material->mu / material->density);
}

static void derive_friction(ShvMaterial *material, double degrees)
{
    const double angle = SHV_DEGREE * degrees, cosine = shv_cos(0.5 * angle), sine = shv_sin(0.5 * angle);
    material->friction = shv_sin(angle) / shv_cos(angle);
    material->riding[0] = riding_cosine * cosine - riding_sine * sine;
    material->riding[1] = riding_sine * cosine + riding_cosine * sine;
}

/* What an unbreakable material leaves out counts as never opening and never softening. */
static void derive_fracture(ShvMaterial *material, const ShvMaterialDefinition *definition)
{
    const double infinite = (double)INFINITY;
    material->fracture_energy[SHV_NORMAL] = or_else(definition->fracture_energy, infinite);
    material->fracture_energy[SHV_SHEAR] =
        or_else(definition->fracture_energy_shear, material->fracture_energy[SHV_NORMAL]);
    material->strength[SHV_NORMAL] = or_else(definition->cohesive_strength, infinite);
    material->strength[SHV_SHEAR] = or_else(definition->cohesive_strength_shear, material->strength[SHV_NORMAL]);
    material->shape[SHV_NORMAL] = or_else(definition->ppr_shape, 2.0);
    material->shape[SHV_SHEAR] = or_else(definition->ppr_shape_shear, material->shape[SHV_NORMAL]);
    material->nominal_energy = material->fracture_energy[SHV_NORMAL];
    material->nominal_strength = material->strength[SHV_NORMAL];
}

static bool is_smoothed(const ShvMaterialDefinition *definition)
{
    const bool coarse = definition->breakable && definition->unresolved == SHV_UNRESOLVED_TIP_STRENGTH;
    return definition->smoothing == SHV_SMOOTHING_EDGES || (definition->smoothing == SHV_SMOOTHING_AUTO && coarse);
}

ShvStatus shv_material_make(ShvMaterial *material, const ShvMaterialDefinition *definition, ShvError *error)
{
    *material = (ShvMaterial){0};
    if (definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT,
                        "a material was not started from shv_material_default(); start it there, then fill it in");
    if (!definition->name || !definition->name[0])
        return shv_fail(error, SHV_BAD_INPUT, "a material has no name; give it one");
    SHV_TRY(check_elasticity(definition, error));
    SHV_TRY(check_fracture(definition, error));
    *material = (ShvMaterial){.name = definition->name,
                              .density = definition->density,
                              .youngs_modulus = definition->youngs_modulus,
                              .poissons_ratio = definition->poissons_ratio,
                              .kinematics = definition->kinematics,
                              .smoothed = is_smoothed(definition),
                              .breakable = definition->breakable,
                              .law = definition->law,
                              .weibull_modulus = definition->weibull_modulus,
                              .weibull_volume = definition->weibull_volume,
                              .weibull_area = definition->weibull_area,
                              .face_restitution = definition->face_restitution,
                              .loss_factor = definition->loss_factor,
                              .unresolved = definition->unresolved,
                              .zone_edges = definition->zone_edges};
    derive_elasticity(material);
    derive_fracture(material, definition);
    derive_friction(material, definition->friction_angle_degrees);
    if (!isfinite(material->dilatational_speed))
        return shv_fail(error, SHV_BAD_INPUT,
                        "material '%s': youngs_modulus %g, poissons_ratio %.17g and density %g give no finite speed of "
                        "sound; lower the modulus or the ratio, or raise the density",
                        material->name, material->youngs_modulus, material->poissons_ratio, material->density);
    return SHV_OK;
}

/* G/σ², with the limits in which nothing softens: no strength to lose, or never reaching it. */
static double energy_over_squared_strength(const ShvMaterial *material)
{
    const double strength = material->strength[SHV_NORMAL];
    if (!shv_material_can_open(material) || strength == 0.0) return (double)INFINITY;
    return material->fracture_energy[SHV_NORMAL] / strength / strength;
}

double shv_material_cohesive_zone(const ShvMaterial *material)
{
    const double ratio = material->poissons_ratio;
    return eighth_of_pi * material->youngs_modulus / (1.0 - ratio * ratio) * energy_over_squared_strength(material);
}

double shv_material_snap_back(const ShvMaterial *material)
{
    return 2.0 * material->youngs_modulus * energy_over_squared_strength(material);
}

double shv_material_compressive_strength(const ShvMaterial *material)
{
    const double tangent = sqrt(1.0 + material->friction * material->friction) + material->friction;
    return 2.0 * material->strength[SHV_SHEAR] * tangent;
}

double shv_material_final_opening(const ShvMaterial *material)
{
    const double energy = material->fracture_energy[SHV_NORMAL], strength = material->strength[SHV_NORMAL];
    if (energy == 0.0) return 0.0;
    if (strength == 0.0 || isinf(energy)) return (double)INFINITY;
    return (material->law == SHV_PPR ? material->shape[SHV_NORMAL] : 2.0) * energy / strength;
}

void shv_material_resolve(ShvMaterial *material, double edge)
{
    material->mesh_edge = edge;
    const double share = shv_material_cohesive_zone(material) / (material->zone_edges * edge);
    const bool scales =
        material->unresolved == SHV_UNRESOLVED_SCALE_STRENGTH || material->unresolved == SHV_UNRESOLVED_SCALE_ENERGY;
    if (!scales || !(share < 1.0)) return;
    /* A strength that the mesh decides is not that of some volume or surface. */
    if (material->unresolved == SHV_UNRESOLVED_SCALE_STRENGTH) material->weibull_volume = material->weibull_area = 0.0;
    for (int mode = 0; mode < 2; mode++) {
        if (material->unresolved == SHV_UNRESOLVED_SCALE_STRENGTH)
            material->strength[mode] *= sqrt(share);
        else
            material->fracture_energy[mode] /= share;
    }
}

double shv_material_resolved_edge(const ShvMaterial *material)
{
    ShvMaterial nominal = *material;
    nominal.fracture_energy[SHV_NORMAL] = material->nominal_energy;
    nominal.strength[SHV_NORMAL] = material->nominal_strength;
    return shv_material_cohesive_zone(&nominal) / material->zone_edges;
}

double shv_material_tip_strength(const ShvMaterial *material, double edge)
{
    const double share = material->smoothed ? 0.62 : 0.55; /* slits go on at Griffith's load (docs/glass.md) */
    return share * sqrt(material->youngs_modulus * material->fracture_energy[SHV_NORMAL] / edge);
}

double shv_material_tip_toughness(const ShvMaterial *material, double edge)
{
    const double squared_pi = 9.8696044010893586;
    return fmax(1.0, 0.125 * squared_pi * edge / shv_material_cohesive_zone(material));
}
