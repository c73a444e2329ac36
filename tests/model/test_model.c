#include "scene.h"

static ShvStatus build(ShvModel *model, const Scene *scene, ShvError *error)
{
    return shv_model_build(model, NULL, &scene->definition, NULL, error);
}

static void objects_stand_one_after_another(void **state)
{
    (void)state;
    Scene scene;
    ShvModel model;
    ShvError error;
    scene_make(&scene);
    check_ok(build(&model, &scene, &error), error);
    assert_int_equal(model.object_count, 2);
    assert_int_equal(model.objects[0].element_begin, 0);
    assert_int_equal(model.objects[0].element_end, model.objects[1].element_begin);
    assert_int_equal(model.objects[0].node_end, model.objects[1].node_begin);
    assert_int_equal(model.objects[1].element_end, model.mesh.element_count);
    assert_int_equal(model.objects[1].node_end, model.mesh.node_count);
    double volumes[2] = {0.0};
    for (int32_t e = 0; e < model.mesh.element_count; e++) {
        const int32_t object = e >= model.objects[1].element_begin;
        assert_string_equal(shv_model_material(&model, e)->name, object ? "steel" : "glass");
        for (int32_t corner = 0; corner < 4; corner++) {
            const int32_t node = model.mesh.elements[4 * (int64_t)e + corner];
            assert_in_range(node, model.objects[object].node_begin, model.objects[object].node_end - 1);
        }
        assert_true(shv_mesh_element_volume(&model.mesh, e) > 0.0);
        volumes[object] += shv_mesh_element_volume(&model.mesh, e);
    }
    check_near(volumes[0], 4.0, 1e-12);
    check_near(volumes[1], 2.0, 1e-12);
    assert_true(model.seed == 99);
    assert_true(model.threads >= 1);
    shv_model_release(&model);
}

/* All tets of the file are of the physical volume "block". */
static void groups_are_of_their_material(void **state)
{
    (void)state;
    Scene scene;
    ShvModel model;
    ShvError error;
    const ShvGroupDefinition groups[2] = {{"block", "steel"}, {"blok", "steel"}};
    scene_make(&scene);
    ShvObjectDefinition *plate = &scene.objects[0];
    plate->mesh.kind = SHV_MESH_GMSH;
    plate->mesh.file = "data/block_41.msh";
    plate->groups = groups;
    plate->group_count = 1;
    check_ok(build(&model, &scene, &error), error);
    for (int32_t e = 0; e < model.objects[0].element_end; e++)
        assert_string_equal(shv_model_material(&model, e)->name, "steel");
    assert_string_equal(model.objects[0].materials, "glass + steel");
    assert_false(model.can_break);
    shv_model_release(&model);
    plate->groups = groups + 1;
    check_fails(build(&model, &scene, &error), SHV_BAD_INPUT, error,
                "object 'plate': its mesh has no physical volume 'blok'; it has 'block'");
    plate->mesh.kind = SHV_MESH_BOX;
    check_fails(build(&model, &scene, &error), SHV_BAD_INPUT, error, "only gmsh files that define physical volumes");
}

/* The block of 1 × 2 × 1, turned a quarter about z, spans 2 × 1 × 1 about its position. */
static void placement_turns_then_shifts(void **state)
{
    (void)state;
    static const double middle[3] = {10.0, 20.0, 30.0}, half[3] = {1.0, 0.5, 0.5};
    Scene scene;
    ShvModel model;
    ShvError error;
    scene_make(&scene);
    check_ok(build(&model, &scene, &error), error);
    for (int c = 0; c < 3; c++) {
        double low = 1e9, high = -1e9;
        for (int32_t i = model.objects[1].node_begin; i < model.objects[1].node_end; i++) {
            low = fmin(low, model.mesh.positions[3 * (int64_t)i + c]);
            high = fmax(high, model.mesh.positions[3 * (int64_t)i + c]);
        }
        check_near(low, middle[c] - half[c], 1e-14 * 30.0);
        check_near(high, middle[c] + half[c], 1e-14 * 30.0);
    }
    shv_model_release(&model);
}

static void adjacency_is_made_only_where_something_can_break(void **state)
{
    (void)state;
    for (int i = 0; i < 5; i++) {
        Scene scene;
        ShvModel model;
        ShvError error;
        scene_make(&scene);
        if (i == 1) scene.definition.fracture.enabled = false;
        if (i == 2) scene.materials[0].breakable = false;
        if (i == 3) scene.materials[0].cohesive_strength = (double)INFINITY;
        /* A breakable material that no object uses. */
        if (i == 4) scene.objects[0].material = "steel";
        check_ok(build(&model, &scene, &error), error);
        assert_int_equal(model.can_break, i == 0);
        if (i == 0) {
            assert_non_null(model.adjacency.corners);
            assert_true(model.adjacency.interior_count > 0);
        } else {
            assert_null(model.adjacency.corners);
            assert_int_equal(model.adjacency.facet_count, 0);
        }
        shv_model_release(&model);
    }
}

static void bad_scenes_are_refused_with_a_name(void **state)
{
    (void)state;
    const double nan = (double)NAN;
    Scene s;
    ShvModel model;
    ShvError error;
#define REFUSES(assignment, part)                                                                                      \
    do {                                                                                                               \
        scene_make(&s);                                                                                                \
        assignment;                                                                                                    \
        check_fails(build(&model, &s, &error), SHV_BAD_INPUT, error, part);                                            \
        assert_null(model.mesh.positions);                                                                             \
        assert_null(model.materials);                                                                                  \
    } while (0)
    REFUSES(s.definition = (ShvSceneDefinition){0}, "default");
    REFUSES(s.materials[1] = (ShvMaterialDefinition){0}, "shv_material_default");
    REFUSES(s.objects[1] = (ShvObjectDefinition){0}, "object 1");
    REFUSES(s.objects[0].mesh = (ShvMeshDefinition){0}, "object 0");
    REFUSES(s.definition.object_count = 0, "no objects");
    REFUSES(s.definition.material_count = 0, "no materials");
    REFUSES(s.definition.threads = -1, "threads");
    REFUSES(s.materials[1].name = "glass", "two materials are named 'glass'");
    REFUSES(s.objects[1].name = "plate", "two objects are named 'plate'");
    REFUSES(s.objects[1].name = "", "object 1 has no name");
    REFUSES(s.objects[1].material = NULL, "object 'block' has no material");
    REFUSES(s.objects[1].material = "gold", "no material 'gold'");
    REFUSES(s.objects[1].placement.position[2] = nan, "object 'block'");
    REFUSES(s.objects[1].placement.angular_velocity[0] = (double)INFINITY, "object 'block'");
    REFUSES(s.objects[1].placement.rotation_axis[2] = 0.0, "axis");
    REFUSES(s.objects[1].placement.position[0] = 1e18, "nearer to the origin");
    REFUSES(s.objects[1].mesh.size[0] = -1.0, "object 'block'");
#undef REFUSES
}

static void failed_allocations_release_everything(void **state)
{
    (void)state;
    Scene scene;
    scene_make(&scene);
    ShvMemory *memory = shv_memory_create();
    assert_non_null(memory);
    ShvStatus status = SHV_NO_MEMORY;
    int64_t failures = 0;
    for (; status != SHV_OK; failures++) {
        ShvModel model;
        ShvState start = {0};
        ShvError error;
        shv_memory_fail_after(memory, failures);
        status = shv_model_build(&model, memory, &scene.definition, NULL, &error);
        if (status == SHV_OK) status = shv_state_create(&start, &model, &scene.definition, &error);
        shv_memory_fail_after(memory, -1);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        shv_state_release(&start);
        shv_model_release(&model);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    }
    /* Materials, objects, meshes, adjacency, state: dozens of places to fail. */
    assert_true(failures > 25);
    shv_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(objects_stand_one_after_another),
        cmocka_unit_test(groups_are_of_their_material),
        cmocka_unit_test(placement_turns_then_shifts),
        cmocka_unit_test(adjacency_is_made_only_where_something_can_break),
        cmocka_unit_test(bad_scenes_are_refused_with_a_name),
        cmocka_unit_test(failed_allocations_release_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
