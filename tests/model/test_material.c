#include "check.h"

#include "model/material.h"

static ShvMaterialDefinition glass(void)
{
    ShvMaterialDefinition definition = shv_material_default();
    definition.name = "glass";
    definition.density = 2500.0;
    definition.youngs_modulus = 70e9;
    definition.poissons_ratio = 0.25;
    definition.fracture_energy = 8.0;
    definition.cohesive_strength = 40e6;
    return definition;
}

static void constants_follow_from_the_definition(void **state)
{
    (void)state;
    const ShvMaterialDefinition definition = glass();
    ShvMaterial material;
    ShvError error;
    check_ok(shv_material_make(&material, &definition, &error), error);
    /* ν = ¼: λ = µ = 0.4 E, λ + 2µ = 1.2 E. */
    check_near(material.lambda / 28e9, 1.0, 1e-15);
    check_near(material.mu / 28e9, 1.0, 1e-15);
    check_near(material.dilatational_speed, sqrt(84e9 / 2500.0), 1e-11);
    check_near(material.bar_speed, sqrt(70e9 / 2500.0), 1e-11);
    check_near(material.shear_speed, sqrt(28e9 / 2500.0), 1e-11);
    assert_true(material.fracture_energy[SHV_SHEAR] == 8.0);
    assert_true(material.strength[SHV_SHEAR] == 40e6);
    assert_true(material.shape[SHV_SHEAR] == 2.0);
    /* R = (π/8) E/(1−ν²) G/σ²: 3.1416/8 × 74.667e9 × 5e-15; 2EG/σ²; 2G/σ. */
    check_near(shv_material_cohesive_zone(&material), 3.141592653589793 / 8.0 * 70e9 / 0.9375 * 5e-15, 1e-18);
    check_near(shv_material_snap_back(&material), 7e-4, 1e-18);
    check_near(shv_material_final_opening(&material), 4e-7, 1e-21);
}

static void shear_values_and_shape_are_kept(void **state)
{
    (void)state;
    ShvMaterialDefinition definition = glass();
    definition.fracture_energy_shear = 16.0;
    definition.cohesive_strength_shear = 30e6;
    definition.ppr_shape = 3.0;
    definition.ppr_shape_shear = 1.5;
    ShvMaterial material;
    ShvError error;
    check_ok(shv_material_make(&material, &definition, &error), error);
    assert_true(material.fracture_energy[SHV_SHEAR] == 16.0 && material.strength[SHV_SHEAR] == 30e6);
    assert_true(material.shape[SHV_NORMAL] == 3.0 && material.shape[SHV_SHEAR] == 1.5);
    check_near(shv_material_final_opening(&material), 6e-7, 1e-21);
    definition.law = SHV_CAMACHO_ORTIZ;
    check_ok(shv_material_make(&material, &definition, &error), error);
    check_near(shv_material_final_opening(&material), 4e-7, 1e-21);
}

/* σ = 0, G = 0, σ = ∞, G = ∞, unbreakable: lengths are limits, never 0/0. */
static void limits_have_lengths(void **state)
{
    (void)state;
    const double infinite = (double)INFINITY;
    const struct {
        bool breakable;
        double strength, energy, zone, opening;
        bool opens;
    } cases[] = {
        {true, 0.0, 8.0, infinite, infinite, true},
        {true, 0.0, 0.0, infinite, 0.0, true},
        {true, 40e6, 0.0, 0.0, 0.0, true},
        {true, infinite, 8.0, infinite, 0.0, false},
        {true, 40e6, infinite, infinite, infinite, true},
        {true, infinite, infinite, infinite, infinite, false},
        {false, 40e6, 8.0, infinite, 4e-7, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ShvMaterialDefinition definition = glass();
        definition.breakable = cases[i].breakable;
        definition.cohesive_strength = cases[i].strength;
        definition.fracture_energy = cases[i].energy;
        ShvMaterial material;
        ShvError error;
        check_ok(shv_material_make(&material, &definition, &error), error);
        assert_true(shv_material_can_open(&material) == cases[i].opens);
        assert_true(shv_material_cohesive_zone(&material) == cases[i].zone);
        assert_true(shv_material_snap_back(&material) == cases[i].zone);
        assert_true(shv_material_final_opening(&material) == cases[i].opening);
    }
}

static void unbreakable_material_needs_no_fracture_data(void **state)
{
    (void)state;
    ShvMaterialDefinition definition = shv_material_default();
    definition.name = "steel";
    definition.density = 7800.0;
    definition.youngs_modulus = 210e9;
    definition.poissons_ratio = 0.3;
    definition.breakable = false;
    ShvMaterial material;
    ShvError error;
    check_ok(shv_material_make(&material, &definition, &error), error);
    assert_true(isinf(material.strength[SHV_NORMAL]) && isinf(material.strength[SHV_SHEAR]));
    assert_false(shv_material_can_open(&material));
}

static void impossible_values_are_refused_by_name(void **state)
{
    (void)state;
    const double nan = (double)NAN, infinite = (double)INFINITY;
    ShvMaterialDefinition d;
    ShvMaterial material;
    ShvError error;
#define REFUSES(assignment, part)                                                                                      \
    do {                                                                                                               \
        d = glass();                                                                                                   \
        assignment;                                                                                                    \
        check_fails(shv_material_make(&material, &d, &error), SHV_BAD_INPUT, error, "glass");                          \
        assert_non_null(strstr(error.message, part));                                                                  \
    } while (0)
    REFUSES(d.density = 0.0, "density");
    REFUSES(d.density = nan, "density");
    REFUSES(d.density = infinite, "density");
    REFUSES(d.youngs_modulus = -1.0, "youngs_modulus");
    REFUSES(d.youngs_modulus = infinite, "youngs_modulus");
    REFUSES(d.poissons_ratio = 0.5, "poissons_ratio");
    REFUSES(d.poissons_ratio = -1.0, "poissons_ratio");
    REFUSES(d.poissons_ratio = nan, "poissons_ratio");
    REFUSES(d.kinematics = (ShvKinematics)7, "kinematics");
    REFUSES(d.law = (ShvCohesiveLaw)7, "law");
    REFUSES(d.fracture_energy = nan, "fracture_energy");
    REFUSES(d.fracture_energy = -8.0, "fracture_energy");
    REFUSES(d.cohesive_strength = nan, "cohesive_strength");
    REFUSES(d.fracture_energy_shear = -1.0, "fracture_energy_shear");
    REFUSES(d.cohesive_strength_shear = -1.0, "cohesive_strength_shear");
    REFUSES(d.ppr_shape = 1.0, "ppr_shape");
    REFUSES(d.ppr_shape_shear = infinite, "ppr_shape_shear");
    REFUSES(d.weibull_modulus = -1.0, "weibull_modulus");
    REFUSES(d.weibull_volume = nan, "weibull_volume");
    REFUSES(d.weibull_area = -1.0, "weibull_area");
    REFUSES((d.weibull_area = 1.0, d.weibull_volume = 1.0), "flaws are inside or on the surface");
    REFUSES(d.loss_factor = -0.1, "loss_factor");
    REFUSES(d.loss_factor = 1.1, "loss_factor");
    REFUSES(d.loss_factor = nan, "loss_factor");
    REFUSES(d.face_restitution = -0.1, "face_restitution");
    REFUSES(d.face_restitution = 1.1, "face_restitution");
    REFUSES(d.face_restitution = nan, "face_restitution");
    REFUSES(d.friction_angle_degrees = -1.0, "friction_angle");
    REFUSES(d.friction_angle_degrees = 90.0, "friction_angle");
    REFUSES(d.friction_angle_degrees = nan, "friction_angle");
    REFUSES((d.youngs_modulus = 1e300, d.density = 1e-300), "speed of sound");
#undef REFUSES
    d = (ShvMaterialDefinition){0};
    check_fails(shv_material_make(&material, &d, &error), SHV_BAD_INPUT, error, "shv_material_default");
    d = glass();
    d.name = NULL;
    check_fails(shv_material_make(&material, &d, &error), SHV_BAD_INPUT, error, "no name");
}

/* With φ motion stands at 45° + (φ − 30°)/2 to the least compression. */
static void friction_follows_from_its_angle(void **state)
{
    (void)state;
    const double angles[] = {0.0, 35.0, 89.0}, degree = 0.017453292519943295;
    for (int i = 0; i < 3; i++) {
        ShvMaterialDefinition definition = glass();
        definition.friction_angle_degrees = angles[i];
        ShvMaterial material;
        ShvError error;
        check_ok(shv_material_make(&material, &definition, &error), error);
        check_near(material.friction, tan(degree * angles[i]), 1e-12 * tan(degree * angles[i]));
        check_near(material.riding[0], cos(degree * (30.0 + 0.5 * angles[i])), 1e-14);
        check_near(material.riding[1], sin(degree * (30.0 + 0.5 * angles[i])), 1e-14);
    }
}

static void nearly_incompressible_is_finite(void **state)
{
    (void)state;
    ShvMaterialDefinition definition = glass();
    definition.poissons_ratio = 0.4999;
    ShvMaterial material;
    ShvError error;
    check_ok(shv_material_make(&material, &definition, &error), error);
    /* c_d √(ρ/E) = √((1−ν)/((1+ν)(1−2ν))) = 40.83. */
    check_near(material.dilatational_speed / material.bar_speed, 40.83, 0.01);
}

/* Both ways make the zone zone_edges × edge long; each keeps the other number; resolved ones stay as they are. */
static void unresolved_zones_are_scaled(void **state)
{
    (void)state;
    ShvError error;
    for (int way = SHV_UNRESOLVED_KEEP; way <= SHV_UNRESOLVED_SCALE_ENERGY; way++)
        for (int fine = 0; fine < 2; fine++) {
            ShvMaterialDefinition d = glass();
            d.fracture_energy_shear = 16.0;
            d.cohesive_strength_shear = 30e6;
            d.unresolved = (ShvUnresolved)way;
            d.zone_edges = 4.0;
            ShvMaterial m;
            check_ok(shv_material_make(&m, &d, &error), error);
            const double zone = shv_material_cohesive_zone(&m), edge = zone / 4.0 * (fine ? 0.9 : 25.0);
            shv_material_resolve(&m, edge);
            const bool scaled = !fine && way != SHV_UNRESOLVED_KEEP;
            check_near(shv_material_cohesive_zone(&m) / (scaled ? 4.0 * edge : zone), 1.0, 1e-14);
            check_near(m.strength[0], scaled && way == SHV_UNRESOLVED_SCALE_STRENGTH ? 8e6 : 40e6, 1e-7);
            check_near(m.strength[1], scaled && way == SHV_UNRESOLVED_SCALE_STRENGTH ? 6e6 : 30e6, 1e-7);
            check_near(m.fracture_energy[0], scaled && way == SHV_UNRESOLVED_SCALE_ENERGY ? 200.0 : 8.0, 1e-12);
            check_near(m.fracture_energy[1], scaled && way == SHV_UNRESOLVED_SCALE_ENERGY ? 400.0 : 16.0, 1e-12);
            check_near(shv_material_resolved_edge(&m) / (zone / 4.0), 1.0, 1e-14);
            assert_true(m.nominal_strength == 40e6 && m.nominal_energy == 8.0 && m.mesh_edge == edge);
        }
}

/* K = σ √(π h) reaches the strength half an edge ahead of the tip: its K²(1−ν²)/E over G. */
static void coarse_tips_are_tough(void **state)
{
    (void)state;
    const ShvMaterialDefinition d = glass();
    ShvMaterial m;
    ShvError error;
    check_ok(shv_material_make(&m, &d, &error), error);
    check_near(shv_material_tip_toughness(&m, 3e-3), 3.141592653589793 * 3e-3 * 1.6e15 * 0.9375 / 70e9 / 8.0, 1e-12);
    check_near(shv_material_tip_toughness(&m, 1e-6), 1.0, 0.0);
}

static void nothing_to_scale_is_refused(void **state)
{
    (void)state;
    ShvMaterialDefinition d = glass();
    ShvMaterial m;
    ShvError error;
    d.unresolved = SHV_UNRESOLVED_SCALE_STRENGTH;
    d.fracture_energy = 0.0;
    check_fails(shv_material_make(&m, &d, &error), SHV_BAD_INPUT, error, "unresolved: keep");
    d = glass();
    d.zone_edges = 0.5;
    check_fails(shv_material_make(&m, &d, &error), SHV_BAD_INPUT, error, "zone_edges");
    /* Never opens, or opens at once: no length to scale. */
    d = glass();
    d.unresolved = SHV_UNRESOLVED_SCALE_ENERGY;
    d.cohesive_strength = 0.0;
    check_ok(shv_material_make(&m, &d, &error), error);
    shv_material_resolve(&m, 1.0);
    assert_true(m.strength[0] == 0.0 && m.fracture_energy[0] == 8.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constants_follow_from_the_definition),
        cmocka_unit_test(shear_values_and_shape_are_kept),
        cmocka_unit_test(limits_have_lengths),
        cmocka_unit_test(unbreakable_material_needs_no_fracture_data),
        cmocka_unit_test(impossible_values_are_refused_by_name),
        cmocka_unit_test(friction_follows_from_its_angle),
        cmocka_unit_test(nearly_incompressible_is_finite),
        cmocka_unit_test(unresolved_zones_are_scaled),
        cmocka_unit_test(coarse_tips_are_tough),
        cmocka_unit_test(nothing_to_scale_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
