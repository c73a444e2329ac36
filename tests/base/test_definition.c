#include "check.h"

#include "shiver/definition.h"

static void materials_leave_required_numbers_unset(void **state)
{
    (void)state;
    const ShvMaterialDefinition m = shv_material_default();
    assert_int_equal(m.cookie, SHV_DEFINITION_COOKIE);
    assert_null(m.name);
    assert_true(isnan(m.density) && isnan(m.youngs_modulus) && isnan(m.poissons_ratio));
    assert_true(isnan(m.fracture_energy) && isnan(m.cohesive_strength));
    assert_true(isnan(m.fracture_energy_shear) && isnan(m.cohesive_strength_shear) && isnan(m.ppr_shape_shear));
    assert_int_equal(m.kinematics, SHV_GREEN_STRAIN);
    assert_int_equal(m.law, SHV_PPR);
    assert_true(m.breakable);
    check_near(m.ppr_shape, 2.0, 0.0);
    check_near(m.weibull_modulus, 0.0, 0.0);
    check_near(m.weibull_volume, 0.0, 0.0);
    check_near(m.weibull_area, 0.0, 0.0);
}

static void meshes_and_objects_stand_at_the_origin(void **state)
{
    (void)state;
    const ShvObjectDefinition o = shv_object_default();
    assert_int_equal(o.cookie, SHV_DEFINITION_COOKIE);
    assert_int_equal(o.mesh.cookie, SHV_DEFINITION_COOKIE);
    assert_int_equal(o.mesh.kind, SHV_MESH_BOX);
    check_near(o.mesh.scale, 1.0, 0.0);
    assert_int_equal(o.mesh.layers, 1);
    assert_int_equal(o.mesh.refine_to, 0);
    assert_null(o.mesh.file);
    for (int i = 0; i < 3; i++) {
        check_near(o.placement.position[i], 0.0, 0.0);
        check_near(o.placement.velocity[i], 0.0, 0.0);
        check_near(o.placement.angular_velocity[i], 0.0, 0.0);
    }
    check_near(o.placement.rotation_degrees, 0.0, 0.0);
}

static void conditions_last_and_obstacles_are_fixed(void **state)
{
    (void)state;
    const ShvConditionDefinition c = shv_condition_default();
    assert_int_equal(c.cookie, SHV_DEFINITION_COOKIE);
    assert_int_equal(c.kind, SHV_CONDITION_SUPPORT);
    check_near(c.start, 0.0, 0.0);
    assert_true(isinf(c.end) && c.end > 0.0);
    const ShvObstacleDefinition o = shv_obstacle_default();
    assert_int_equal(o.cookie, SHV_DEFINITION_COOKIE);
    assert_int_equal(o.motion, SHV_OBSTACLE_FIXED);
    check_near(o.scale, 1.0, 0.0);
    check_near(o.friction, 0.0, 0.0);
    check_near(o.restitution, 0.0, 0.0);
    assert_int_equal(shv_event_default().cookie, SHV_DEFINITION_COOKIE);
}

static void scenes_have_the_documented_defaults(void **state)
{
    (void)state;
    const ShvSceneDefinition s = shv_scene_default();
    assert_int_equal(s.cookie, SHV_DEFINITION_COOKIE);
    assert_null(s.objects);
    check_near(s.gravity[0], 0.0, 0.0);
    check_near(s.gravity[2], -9.81, 0.0);
    assert_true(isnan(s.duration));
    assert_int_equal(s.overlaps, SHV_OVERLAPS_REFUSE);
    assert_int_equal(s.threads, 0);
    assert_int_equal(s.seed, 0);
    assert_int_equal(s.rigid.engine, SHV_RIGID_BULLET);
    assert_int_equal(s.rigid.wake, SHV_WAKE_STRESS);
    check_near(s.rigid.time_step, 1e-3, 0.0);
    check_near(s.rigid.wake_fraction, 0.5, 0.0);
    check_near(s.rigid.wake_factor, 6.0, 0.0);
    check_near(s.output.rate, 240.0, 0.0);
    assert_null(s.output.file);
    assert_false(s.output.nodes);
}

static void fracture_has_the_documented_defaults(void **state)
{
    (void)state;
    const ShvFractureDefinition f = shv_scene_default().fracture;
    assert_true(f.enabled);
    assert_true(isnan(f.time_step));
    assert_int_equal(f.check_every, 0);
    assert_int_equal(f.criterion, SHV_CRITERION_FORCE);
    assert_int_equal(f.activation, SHV_ACTIVATION_TRACTION);
    assert_int_equal(f.quiet_checks, 20);
    check_near(f.safety, 0.9, 0.0);
    check_near(f.threshold, 1.0, 0.0);
    check_near(f.regularisation, 0.005, 0.0);
    check_near(f.longest, 0.0, 0.0);
    check_near(f.energy_bound, 0.05, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_leave_required_numbers_unset),
        cmocka_unit_test(meshes_and_objects_stand_at_the_origin),
        cmocka_unit_test(conditions_last_and_obstacles_are_fixed),
        cmocka_unit_test(scenes_have_the_documented_defaults),
        cmocka_unit_test(fracture_has_the_documented_defaults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
