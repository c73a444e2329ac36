/* The scenes of the chapter against the numbers that it prints. */
#include "check.h"

#include "mesh/generate.h"
#include "shiver/scene.h"

/* NaN: the chapter prints none. */
typedef struct Printed {
    const char *file;
    double youngs_modulus, poissons_ratio, fracture_energy, cohesive_strength;
    double rigid_step, fracture_step, stiffness, damping;
    int iterations; /* 0: none */
} Printed;

#define NONE ((double)NAN)
static const Printed scenes[] = {
    {"fig_6_3_bunny_drop", 0.6, 0.23, 22.0, 1e-4, 1e-3, 5e-6, 0.9, 1.0, 3},
    {"fig_6_6_mixed_mode_beam", 9e6, 0.24, 22.0, 8e3, NONE, 3e-5, 1.0, NONE, 4},
    {"fig_6_6_slow_beam", 9e6, 0.24, 22.0, 8e3, NONE, 3e-5, 1.0, NONE, 4},
    {"fig_6_7a_hollow_sphere", NONE, NONE, NONE, NONE, 1e-4, NONE, 1.0, 0.0, 0},
    {"fig_6_7b_hollow_sphere", NONE, NONE, NONE, NONE, 1e-4, NONE, 0.1, 0.0, 0},
    {"fig_6_7c_hollow_sphere", NONE, NONE, NONE, NONE, 1e-4, NONE, 0.01, 0.0, 0},
    {"fig_6_8b_hollow_sphere", NONE, NONE, NONE, NONE, 5e-4, NONE, 1.0, 0.0, 0},
    {"fig_6_9_plate_undamped", NONE, NONE, NONE, NONE, NONE, NONE, NONE, 0.0, 0},
    {"fig_6_10_plate_damped", NONE, NONE, NONE, NONE, NONE, NONE, NONE, 1.0, 0},
    {"fig_6_11a_sphere_strong", 100.0, NONE, NONE, 5e-3, NONE, NONE, NONE, NONE, 0},
    {"fig_6_11b_sphere_weak", 100.0, NONE, NONE, 0.5e-6, NONE, NONE, NONE, NONE, 0},
    {"fig_6_12_hollow_sphere_brittle", 100.0, 0.1, 22.0, 5e-3, 2e-3, 5e-6, NONE, NONE, 0},
    {"fig_6_13_bunny_hit", 0.6, 0.24, 22.0, 5e-5, 2e-3, 3e-6, NONE, NONE, 0},
    {"fig_6_14_glass_plate", 5e5, 0.24, 22e5, 50.0, 2e-3, 5e-6, NONE, NONE, 0},
};
enum { SCENE_COUNT = sizeof scenes / sizeof *scenes };

/* Meshes are not part of the source tree: any file stands for the bunny's surface. */
static ShvScene *load(const char *name)
{
    static const char *const surface[] = {"objects.bunny.mesh.shell.surface=fig_6_3_bunny_drop.yaml"};
    char path[200];
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    ShvError error;
    snprintf(path, sizeof path, "../scenes/thesis/%s.yaml", name);
    check_ok(shv_scene_load(&scene, path, surface, strstr(name, "bunny") ? 1 : 0, NULL, &diagnostics, &error), error);
    if (shv_diagnostics_count(diagnostics) > 0) fail_msg("%s", shv_diagnostics_get(diagnostics, 0)->message);
    shv_diagnostics_destroy(diagnostics);
    return scene;
}

static void check_printed(const char *name, const char *what, double value, double printed)
{
    if (!isnan(printed) && value != printed) fail_msg("%s: %s is %.17g, printed %.17g", name, what, value, printed);
}

static void printed_numbers_are_kept(void **state)
{
    (void)state;
    for (int i = 0; i < SCENE_COUNT; i++) {
        const Printed *p = &scenes[i];
        ShvScene *loaded = load(p->file);
        const ShvSceneDefinition *scene = shv_scene_definition(loaded);
        const ShvMaterialDefinition *material = &scene->materials[0];
        check_printed(p->file, "density", material->density, 2400.0);
        check_printed(p->file, "youngs_modulus", material->youngs_modulus, p->youngs_modulus);
        check_printed(p->file, "poissons_ratio", material->poissons_ratio, p->poissons_ratio);
        check_printed(p->file, "fracture_energy", material->fracture_energy, p->fracture_energy);
        check_printed(p->file, "cohesive_strength", material->cohesive_strength, p->cohesive_strength);
        check_printed(p->file, "ppr_shape", material->ppr_shape, 2.0);
        check_printed(p->file, "rigid.time_step", scene->rigid.time_step, p->rigid_step);
        check_printed(p->file, "fracture.time_step", scene->fracture.time_step, p->fracture_step);
        check_printed(p->file, "pbd.stiffness", scene->pbd.stiffness, p->stiffness);
        check_printed(p->file, "pbd.damping", scene->pbd.damping, p->damping);
        if (p->iterations > 0) assert_int_equal(scene->pbd.iterations, p->iterations);
        if (material->breakable) {
            assert_int_equal(scene->fracture.stabiliser, SHV_STABILISER_BARS);
            assert_int_equal(scene->fracture.criterion, SHV_CRITERION_PRINCIPAL);
            check_printed(p->file, "fracture.threshold", scene->fracture.threshold, 0.9);
        }
        shv_scene_destroy(loaded);
    }
}

/* 113,984 tets and 25,777 nodes are printed; 300 steps, and a check every 10. */
static void beam_has_the_printed_size(void **state)
{
    (void)state;
    static const char *const names[] = {"fig_6_6_mixed_mode_beam", "fig_6_6_slow_beam"};
    for (int i = 0; i < 2; i++) {
        ShvScene *loaded = load(names[i]);
        const ShvSceneDefinition *scene = shv_scene_definition(loaded);
        ShvMesh mesh;
        ShvError error;
        check_ok(shv_mesh_generate(&mesh, NULL, &scene->objects[0].mesh, NULL, &error), error);
        check_near(mesh.element_count, 113984, 0.05 * 113984);
        check_near(mesh.node_count, 25777, 0.05 * 25777);
        assert_int_equal(scene->fracture.check_every, 10);
        if (i == 0) check_near(scene->duration / scene->fracture.time_step, 300.0, 1e-9);
        if (i == 0) assert_true(scene->conditions[2].value[2] == -25.0);
        shv_mesh_release(&mesh);
        shv_scene_destroy(loaded);
    }
}

static void missing_meshes_say_where_they_come_from(void **state)
{
    (void)state;
    static const char *const surface[] = {"objects.bunny.mesh.shell.surface=../../build/meshes/none.obj"};
    ShvScene *scene = NULL;
    ShvError error;
    check_fails(shv_scene_load(&scene, "../scenes/thesis/fig_6_3_bunny_drop.yaml", surface, 1, NULL, NULL, &error),
                SHV_BAD_INPUT, error, "./bootstrap meshes makes it");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(printed_numbers_are_kept),
                                       cmocka_unit_test(beam_has_the_printed_size),
                                       cmocka_unit_test(missing_meshes_say_where_they_come_from)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
