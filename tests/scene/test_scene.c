/* Scenes without faults: every key arrives where it belongs. */
#include "check.h"

#include <locale.h>
#include <stdlib.h>

#include "base/file.h"
#include "parse.h"
#include "scene/schema.h"
#include "shiver/library.h"

static const char glass_plate_drop[] =
    "shiver: 1\n"
    "name: glass plate drop\n"
    "materials:\n"
    "  glass: {density: 2500, youngs_modulus: 70e9, poissons_ratio: 0.22, fracture_energy: 8, cohesive_strength: 40e6, "
    "ppr_shape: 2}\n"
    "objects:\n"
    "  plate: {mesh: {box: {size: [0.3, 0.3, 0.006], edge: 0.003}}, material: glass, position: [0, 0, 1.2], rotation: "
    "{axis: [1, 0, 0], angle: 25}}\n"
    "obstacles:\n"
    "  floor: {plane: {normal: [0, 0, 1], offset: 0}, friction: 0.4, restitution: 0.1}\n"
    "gravity: [0, 0, -9.81]\n"
    "rigid: {engine: analytic, time_step: 1e-3}\n"
    "fracture: {stabiliser: none, time_step: auto, check_every: 10, threshold: 0.9}\n"
    "duration: 1.5\n"
    "output: {rate: 240}\n";

static void check_vector(const double *vector, double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        if (vector[i] != expected[i]) fail_msg("component %d is %.17g, expected %.17g", i, vector[i], expected[i]);
}

#define same(a, b)                                                                                                     \
    do {                                                                                                               \
        const double same_a_ = (a), same_b_ = (b);                                                                     \
        if (same_a_ != same_b_) fail_msg("%s = %.17g, expected %.17g", #a, same_a_, same_b_);                          \
    } while (0)

static void glass_plate_drop_parses(void **state)
{
    (void)state;
    Parsed parsed = parse_good(glass_plate_drop, NULL, 0);
    assert_int_equal(shv_diagnostics_count(parsed.diagnostics), 0);
    const ShvSceneDefinition *scene = shv_scene_definition(parsed.scene);
    assert_int_equal(scene->cookie, SHV_DEFINITION_COOKIE);
    assert_string_equal(scene->name, "glass plate drop");
    assert_int_equal(scene->material_count, 1);
    same(scene->materials[0].cohesive_strength, 40e6);
    assert_true(isnan(scene->materials[0].cohesive_strength_shear));
    assert_int_equal(scene->object_count, 1);
    assert_int_equal(scene->objects[0].mesh.kind, SHV_MESH_BOX);
    check_vector(scene->objects[0].mesh.size, 0.3, 0.3, 0.006);
    assert_int_equal(scene->obstacles[0].motion, SHV_OBSTACLE_FIXED);
    assert_true(isnan(scene->fracture.time_step));
    assert_int_equal(scene->fracture.check_every, 10);
    same(scene->duration, 1.5);
    release(&parsed);
}

static char *read_full(size_t *size)
{
    char *text = NULL;
    ShvError error;
    check_ok(shv_read_file(NULL, SHV_PART_SCENE, "scene/full.yaml", 1 << 20, &text, size, &error), error);
    return text;
}

static void check_materials(const ShvSceneDefinition *scene)
{
    const ShvMaterialDefinition *glass = &scene->materials[0], *steel = &scene->materials[1];
    assert_int_equal(scene->material_count, 2);
    assert_string_equal(glass->name, "glass");
    assert_int_equal(glass->cookie, SHV_DEFINITION_COOKIE);
    same(glass->density, 2500.0);
    same(glass->youngs_modulus, 70e9);
    same(glass->poissons_ratio, 0.22);
    assert_int_equal(glass->kinematics, SHV_COROTATIONAL);
    assert_int_equal(glass->smoothing, SHV_SMOOTHING_EDGES);
    assert_true(glass->breakable);
    assert_int_equal(glass->law, SHV_CAMACHO_ORTIZ);
    same(glass->fracture_energy, 8.0);
    same(glass->cohesive_strength, 40e6);
    same(glass->fracture_energy_shear, 9.0);
    same(glass->cohesive_strength_shear, 50e6);
    same(glass->ppr_shape, 3.0);
    same(glass->ppr_shape_shear, 4.0);
    same(glass->weibull_modulus, 10.0);
    same(glass->weibull_volume, 2e-9);
    same(glass->weibull_area, 0.0); /* the library's gives way */
    same(steel->weibull_area, 3e-4);
    assert_int_equal(glass->unresolved, SHV_UNRESOLVED_SCALE_ENERGY);
    same(glass->zone_edges, 7.0);
    same(glass->loss_factor, 0.25);
    same(glass->face_restitution, 0.5);
    same(glass->friction_angle_degrees, 35.0);
    assert_string_equal(steel->name, "steel");
    assert_false(steel->breakable);
    assert_true(isnan(steel->cohesive_strength));
}

static void check_plates(const ShvSceneDefinition *scene)
{
    static const char *const names[] = {"plate_1", "plate_2", "plate_3"};
    for (int i = 0; i < 3; i++) {
        const ShvObjectDefinition *plate = &scene->objects[i];
        assert_string_equal(plate->name, names[i]);
        assert_string_equal(plate->material, "glass");
        assert_int_equal(plate->mesh.kind, SHV_MESH_BOX);
        check_vector(plate->mesh.size, 0.3, 0.2, 0.006);
        same(plate->mesh.edge, 0.003);
        same(plate->mesh.jitter, 0.2);
        assert_int_equal(plate->mesh.pattern, SHV_PATTERN_BRICKS);
        check_vector(plate->placement.stretch_rate, 0.0, 1000.0, -2.0);
        assert_int_equal(plate->mesh.seed, 7);
        check_vector(plate->placement.position, 1.0, 2.0, 3.0 + i * 0.01);
        check_vector(plate->placement.rotation_axis, 1.0, 0.0, 0.0);
        same(plate->placement.rotation_degrees, 25.0);
        check_vector(plate->placement.velocity, 0.0, 0.0, -1.0);
        check_near(plate->placement.angular_velocity[0], 3.14159265358979323846, 1e-15);
        same(plate->placement.angular_velocity[2], 1.0);
    }
}

static void check_meshes(const ShvSceneDefinition *scene)
{
    const ShvObjectDefinition *o = scene->objects + 3;
    assert_int_equal(scene->object_count, 14);
    assert_int_equal(o[0].crack_count, 0);
    assert_int_equal(o[4].crack_count, 1);
    assert_int_equal(o[4].group_count, 1);
    assert_string_equal(o[4].groups[0].name, "an inlay");
    assert_string_equal(o[4].groups[0].material, "steel");
    same(o[4].cracks[0].plane.plane_normal[2], 1.0);
    same(o[4].cracks[0].plane.plane_offset, 0.01);
    same(o[4].cracks[0].plane.tolerance, 1e-6);
    check_vector(o[4].cracks[0].box.box_max, 4.0, 5.0, 6.0);
    assert_int_equal(o[0].mesh.kind, SHV_MESH_BALL);
    assert_string_equal(o[0].material, "steel");
    same(o[0].mesh.radius, 0.05);
    assert_int_equal(o[1].mesh.kind, SHV_MESH_HOLLOW_BALL);
    same(o[1].mesh.inner_radius, 0.05 - 0.002);
    assert_int_equal(o[2].mesh.kind, SHV_MESH_CYLINDER);
    same(o[2].mesh.inner_radius, 0.01);
    same(o[2].mesh.height, 0.2);
    assert_int_equal(o[3].mesh.kind, SHV_MESH_NOTCHED_BEAM);
    check_vector(o[3].mesh.size, 0.4, 0.1, 0.1);
    same(o[3].mesh.notch_depth, 0.05);
    same(o[3].mesh.notch_offset, -0.03);
    same(o[3].mesh.notch_edge, 0.001);
    same(o[3].mesh.notch_growth, 0.05);
    assert_int_equal(o[3].mesh.pattern, SHV_PATTERN_BRICKS);
    assert_int_equal(o[4].mesh.kind, SHV_MESH_GMSH);
    assert_string_equal(o[4].mesh.file, "full.yaml");
    same(o[4].mesh.scale, 0.001);
    assert_int_equal(o[5].mesh.kind, SHV_MESH_TETGEN);
    assert_string_equal(o[5].mesh.file, "full.yaml");
    same(o[5].mesh.scale, 0.01);
    assert_int_equal(o[6].mesh.kind, SHV_MESH_SHELL);
    assert_string_equal(o[6].mesh.file, "full.yaml");
    same(o[6].mesh.scale, 0.1);
    same(o[6].mesh.thickness, 0.003);
    assert_int_equal(o[6].mesh.layers, 2);
    assert_true(o[6].mesh.refine_to == INT64_C(5000000000));
    const ShvMeshDefinition *urn = &scene->objects[13].mesh;
    static const double profile[6] = {0.0, -0.01, 0.02, 0.0, 0.0, 0.03};
    assert_int_equal(urn->kind, SHV_MESH_TURNED);
    assert_int_equal(urn->profile_count, 3);
    for (int i = 0; i < 6; i++) same(urn->profile[i], profile[i]);
    same(urn->edge, 0.001);
}

/* Shifted and turned at random, each its own way. */
static void check_heap(const ShvSceneDefinition *scene)
{
    const ShvObjectDefinition *heap = scene->objects + 10;
    for (int i = 0; i < 2; i++) {
        const ShvPlacement *at = &heap[i].placement;
        assert_int_equal(heap[i].mesh.kind, SHV_MESH_STL);
        same(heap[i].mesh.edge, 0.002);
        same(heap[i].mesh.scale, 0.001);
        assert_true(at->position[0] != 0.0 && fabs(at->position[0]) < 0.05);
        same(at->position[1], 0.0);
        assert_true(at->position[2] != 1.0 + i && fabs(at->position[2] - 1.0 - i) < 0.1);
        const double *axis = at->rotation_axis;
        check_near(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2], 1.0, 1e-14);
        assert_true(at->rotation_degrees > 0.0 && at->rotation_degrees <= 360.0);
    }
    assert_int_equal(heap[2].mesh.kind, SHV_MESH_MEMORY);
    assert_true(heap[2].waits && !heap[1].waits);
    assert_true(heap[0].placement.rotation_degrees != heap[1].placement.rotation_degrees);
}

static void check_conditions(const ShvSceneDefinition *scene)
{
    const ShvConditionDefinition *c = scene->conditions;
    assert_int_equal(scene->condition_count, 7);
    /* `plane_strain` is a support of all nodes, always. */
    assert_string_equal(c[6].name, "part.plane_strain");
    assert_string_equal(c[6].object, "part");
    assert_int_equal(c[6].kind, SHV_CONDITION_SUPPORT);
    assert_int_equal(c[6].selection.kind, SHV_SELECT_ALL);
    assert_true(!c[6].axes[0] && !c[6].axes[1] && c[6].axes[2]);
    assert_true(c[6].start == 0.0 && isinf(c[6].end));
    assert_string_equal(c[0].name, "clamp");
    assert_string_equal(c[0].object, "beam");
    assert_int_equal(c[0].kind, SHV_CONDITION_SUPPORT);
    assert_int_equal(c[0].selection.kind, SHV_SELECT_BOX);
    check_vector(c[0].selection.box_min, -1.0, -2.0, -3.0);
    check_vector(c[0].selection.box_max, -0.5, 2.0, 3.0);
    assert_true(c[0].axes[0] && !c[0].axes[1] && c[0].axes[2]);
    same(c[0].start, 0.001);
    same(c[0].end, 0.005);
    assert_int_equal(c[1].selection.kind, SHV_SELECT_PLANE);
    check_vector(c[1].selection.plane_normal, 0.0, 0.0, 1.0);
    same(c[1].selection.plane_offset, -0.1);
    same(c[1].selection.tolerance, 1e-6);
    assert_true(c[1].axes[0] && c[1].axes[1] && c[1].axes[2]);
    assert_int_equal(c[2].kind, SHV_CONDITION_VELOCITY);
    check_near(c[2].selection.plane_normal[0], 0.6, 1e-15);
    check_near(c[2].selection.plane_normal[2], 0.8, 1e-15);
    assert_true(c[2].axes[0] && !c[2].axes[1] && !c[2].axes[2]);
    check_vector(c[2].value, 0.5, 0.0, 0.0);
    same(c[2].ramp_time, 196e-6);
    assert_true(isinf(c[3].end));
    assert_int_equal(c[4].kind, SHV_CONDITION_TRACTION);
    assert_string_equal(c[4].object, "plate_2");
    check_vector(c[4].value, 1000.0, 0.0, -2.0);
    same(c[4].ramp_time, 0.5);
    assert_int_equal(c[5].selection.kind, SHV_SELECT_PLANE);
    same(c[5].selection.tolerance, 0.25);
}

static void check_obstacles(const ShvSceneDefinition *scene)
{
    const ShvObstacleDefinition *o = scene->obstacles;
    assert_int_equal(scene->obstacle_count, 4);
    assert_string_equal(o[0].name, "floor");
    check_near(o[0].plane_normal[1], 0.6, 1e-15);
    check_near(o[0].plane_normal[2], 0.8, 1e-15);
    same(o[0].plane_offset, -0.5);
    same(o[0].friction, 0.4);
    same(o[0].restitution, 0.1);
    assert_int_equal(o[1].shape, SHV_OBSTACLE_SPHERE);
    assert_int_equal(o[1].motion, SHV_OBSTACLE_FREE);
    same(o[1].radius, 0.2);
    same(o[1].mass, 2000.0);
    check_vector(o[1].placement.position, 0.0, 0.0, -2.0);
    check_near(o[1].placement.rotation_degrees, 90.0, 1e-12);
    check_vector(o[1].placement.velocity, 1.0, 2.0, 3.0);
    check_vector(o[1].placement.angular_velocity, 4.0, 5.0, 6.0);
    assert_int_equal(o[2].shape, SHV_OBSTACLE_BOX);
    assert_int_equal(o[2].motion, SHV_OBSTACLE_SCRIPTED);
    check_vector(o[2].size, 1.0, 2.0, 3.0);
    assert_int_equal(o[2].keyframe_count, 2);
    check_vector(o[2].keyframes[0].rotation_axis, 0.0, 0.0, 1.0);
    same(o[2].keyframes[1].time, 0.1);
    check_vector(o[2].keyframes[1].position, 0.0, 0.0, 0.5);
    check_near(o[2].keyframes[1].rotation_axis[0], sqrt(0.5), 1e-15);
    check_near(o[2].keyframes[1].rotation_axis[1], sqrt(0.5), 1e-15);
    same(o[2].keyframes[1].rotation_degrees, -90.0);
    assert_int_equal(o[3].shape, SHV_OBSTACLE_MESH);
    assert_int_equal(o[3].motion, SHV_OBSTACLE_FIXED);
    assert_string_equal(o[3].file, "full.yaml");
    same(o[3].scale, 2.0);
}

static void check_events(const ShvSceneDefinition *scene)
{
    const ShvEventDefinition *e = scene->events;
    assert_int_equal(scene->event_count, 4);
    assert_int_equal(e[0].kind, SHV_EVENT_RELEASE);
    assert_string_equal(e[0].target, "clamp");
    same(e[0].time, 0.1);
    assert_int_equal(e[1].kind, SHV_EVENT_SET_VELOCITY);
    assert_string_equal(e[1].target, "plate_1");
    check_vector(e[1].value, 1.0, 2.0, 3.0);
    check_vector(e[1].angular, 4.0, 5.0, 6.0);
    assert_int_equal(e[2].kind, SHV_EVENT_IMPULSE);
    assert_string_equal(e[2].target, "anvil");
    check_vector(e[2].value, 7.0, 8.0, 9.0);
    assert_int_equal(e[3].kind, SHV_EVENT_GRAVITY);
    check_vector(e[3].value, 0.0, 0.0, -9.81);
}

static void check_rest(const ShvSceneDefinition *scene)
{
    assert_int_equal(scene->reference.law, SHV_REFERENCE_BOUNCE);
    assert_string_equal(scene->reference.body, "plate_1");
    assert_string_equal(scene->reference.on, "floor");
    assert_string_equal(scene->survival.object, "plate_1");
    assert_true(scene->survival.broken == 0.9 && scene->survival.turn);
    assert_int_equal(scene->survival.vary, SHV_SURVIVAL_SPEED);
    assert_string_equal(scene->name, "every key");
    check_vector(scene->gravity, 0.5, -0.001, -1.62);
    assert_true(scene->seed == UINT64_MAX);
    assert_int_equal(scene->threads, 2);
    assert_int_equal(scene->overlaps, SHV_OVERLAPS_KEEP);
    same(scene->duration, 1.5);
    assert_int_equal(scene->rigid.engine, SHV_RIGID_PBD);
    same(scene->rigid.time_step, 2e-3);
    assert_int_equal(scene->rigid.wake, SHV_WAKE_CONTACT);
    same(scene->rigid.wake_fraction, 0.25);
    same(scene->rigid.wake_factor, 5.0);
    same(scene->rigid.friction, 0.4);
    same(scene->rigid.restitution, 0.1);
    assert_int_equal(scene->rigid.dust, SHV_DUST_BIN);
    same(scene->rigid.dust_size, 0.002);
    assert_false(scene->fracture.enabled);
    assert_int_equal(scene->fracture.on.kind, SHV_SELECT_PLANE);
    check_vector(scene->fracture.on.plane_normal, 0.0, 0.0, 1.0);
    same(scene->fracture.on.plane_offset, 1e-3);
    same(scene->fracture.on.tolerance, 1e-6);
    assert_int_equal(scene->fracture.stabiliser, SHV_STABILISER_BARS);
    same(scene->fracture.time_step, 10e-9);
    same(scene->fracture.safety, 0.5);
    assert_int_equal(scene->fracture.check_every, 10);
    same(scene->fracture.threshold, 0.8);
    assert_int_equal(scene->fracture.criterion, SHV_CRITERION_PRINCIPAL);
    assert_int_equal(scene->fracture.activation, SHV_ACTIVATION_STRENGTH);
    same(scene->fracture.regularisation, 0.01);
    assert_int_equal(scene->fracture.quiet_checks, 30);
    same(scene->fracture.longest, 0.001);
    assert_int_equal(scene->fracture.deformation, SHV_DEFORMATION_KEEP);
    same(scene->fracture.energy_bound, 0.1);
    same(scene->audit.momentum, 1e-9);
    same(scene->audit.dropped_share, 0.5);
    assert_true(isinf(scene->audit.hull_error));
    same(scene->pbd.stiffness, 0.9);
    assert_int_equal(scene->pbd.iterations, 3);
    assert_int_equal(scene->pbd.form, SHV_BARS_ELEMENT);
    same(scene->pbd.damping, 0.5);
    assert_true(scene->pbd.exact_rotation);
    const ShvBulletDefinition *bullet = &scene->rigid.bullet;
    assert_false(bullet->exact_flight || bullet->times_of_impact || bullet->exact_contacts);
    assert_false(bullet->settled_impulses || bullet->touching_islands || bullet->keep_overlaps);
    same(scene->bullet_plain.unit, 0.05);
    same(scene->bullet_plain.margin, 0.001);
    assert_true(scene->bullet_plain.exact_flight && scene->bullet_plain.sharp_impacts);
    assert_true(scene->bullet_plain.sorted_pairs && scene->bullet_plain.keep_overlaps);
    assert_string_equal(scene->output.file, "out/run.h5");
    same(scene->output.rate, 1000.0);
    assert_int_equal(scene->output.fracture_every, 50);
    assert_true(scene->output.nodes);
    same(scene->output.nodes_within.from, 1e-3);
    same(scene->output.nodes_within.to, 2e-3);
    assert_int_equal(scene->output.nodes_within.every, 3);
    same(scene->output.nodes_within.box.box_max[2], 3.0);
    assert_int_equal(scene->output.probe_every, 5);
    same(scene->output.probe_interval, 2e-6);
}

static void check_probes(const ShvSceneDefinition *scene)
{
    assert_int_equal(scene->probe_count, 5);
    const ShvProbeDefinition *tip = &scene->probes[0], *ends = &scene->probes[1];
    assert_int_equal(tip->kind, SHV_PROBE_POINT);
    assert_string_equal(tip->name, "tip");
    assert_string_equal(tip->object, "plate_1");
    same(tip->point[0], 0.01);
    same(tip->point[2], 1.2);
    assert_int_equal(ends->kind, SHV_PROBE_NODES);
    assert_string_equal(ends->object, "plate_2");
    assert_int_equal(ends->selection.kind, SHV_SELECT_BOX);
    same(ends->selection.box_max[2], 2.0);
    assert_int_equal(scene->probes[2].selection.kind, SHV_SELECT_ALL);
    same(scene->probes[3].selection.plane_normal[1], 1.0);
    assert_int_equal(scene->probes[4].kind, SHV_PROBE_OBSTACLE);
    assert_string_equal(scene->probes[4].obstacle, "floor");
}

static void every_key_arrives(void **state)
{
    (void)state;
    size_t size = 0;
    char *text = read_full(&size);
    Parsed parsed = parse_good(text, NULL, 0);
    assert_int_equal(shv_diagnostics_count(parsed.diagnostics), 1); /* several objects under pbd */
    const ShvSceneDefinition *scene = shv_scene_definition(parsed.scene);
    check_materials(scene);
    check_plates(scene);
    check_heap(shv_scene_definition(parsed.scene));
    check_meshes(scene);
    check_conditions(scene);
    check_obstacles(scene);
    check_events(scene);
    check_rest(scene);
    check_probes(scene);
    assert_string_equal(shv_scene_text(parsed.scene), text);
    assert_int_equal(shv_scene_text_length(parsed.scene), size);
    release(&parsed);
    shv_release(text);
}

/* Walks tables and tree side by side: a key that full.yaml leaves out would be a key that no test has seen. */
static void look_for_keys(const ShvTable *table, const ShvNode *const *nodes, int count)
{
    for (int i = 0; i < table->key_count; i++) {
        const ShvKey *key = &table->keys[i];
        const ShvNode *below[64];
        int found = 0;
        for (int n = 0; n < count; n++) {
            const ShvEntry *entry = shv_tree_find(nodes[n], key->name);
            if (!entry) continue;
            if (key->type != SHV_KEY_NAMED && key->type != SHV_KEY_LIST) {
                below[found++] = entry->value;
                continue;
            }
            for (const ShvEntry *item = entry->value->first; item; item = item->next) below[found++] = item->value;
        }
        if (found == 0) fail_msg("full.yaml lacks %s in %s", key->name, table->name);
        if (key->table) look_for_keys(key->table, below, found);
    }
}

static void full_scene_has_every_key(void **state)
{
    (void)state;
    size_t size = 0;
    char *text = read_full(&size);
    ShvPool pool = {.memory = NULL};
    ShvDiagnostics *diagnostics = shv_diagnostics_create(NULL, "full.yaml", NULL, 0);
    const ShvNode *root = shv_tree_read(&pool, diagnostics, text, size, 0);
    assert_non_null(root);
    look_for_keys(&shv_scene_table, &root, 1);
    shv_diagnostics_destroy(diagnostics);
    shv_pool_release(&pool);
    shv_release(text);
}

/* The library's value for every key that the scene does not give, each with its source; no value goes astray. */
static void the_library_fills_in_what_is_left_out(void **state)
{
    (void)state;
    static const char text[] = "shiver: 1\n"
                               "materials:\n"
                               "  a: {library: plaster, density: 1 t/m3}\n"
                               "  b: {library: steel}\n"
                               "  c: {library: ice}\n"
                               "  d: {library: ice, unresolved: keep}\n"
                               "objects:\n"
                               "  x: {mesh: {ball: {radius: 1, edge: 0.1}}, material: a}\n"
                               "  y: {mesh: {ball: {radius: 1, edge: 0.1}}, material: b}\n"
                               "duration: 1\n";
    Parsed parsed = parse_good(text, NULL, 0);
    const ShvMaterialDefinition *own = shv_scene_definition(parsed.scene)->materials;
    const ShvMaterialDefinition plaster = shv_library_definition(shv_library_find("plaster"));
    same(own[0].density, 1000.0);
    same(own[0].youngs_modulus, plaster.youngs_modulus);
    same(own[0].fracture_energy, plaster.fracture_energy);
    same(own[0].cohesive_strength, plaster.cohesive_strength);
    same(own[0].cohesive_strength_shear, plaster.cohesive_strength_shear);
    same(own[0].fracture_energy_shear, plaster.fracture_energy_shear);
    same(own[0].weibull_modulus, plaster.weibull_modulus);
    assert_int_equal(own[0].unresolved, SHV_UNRESOLVED_TIP_STRENGTH);
    assert_false(own[1].breakable);
    same(own[1].youngs_modulus, 210e9);
    assert_int_equal(own[2].unresolved, SHV_UNRESOLVED_TIP_STRENGTH);
    assert_int_equal(own[3].unresolved, SHV_UNRESOLVED_KEEP);
    release(&parsed);
    assert_null(shv_library_get(-1));
    assert_null(shv_library_get(shv_library_count()));
    for (int32_t i = 0; i < shv_library_count(); i++) {
        const ShvLibraryMaterial *material = shv_library_get(i);
        assert_ptr_equal(shv_library_find(material->name), material);
        assert_true(shv_is_name(material->name));
        for (const ShvLibraryNumber *number = material->numbers; number->key; number++)
            assert_true(number->value > 0.0 && strlen(number->source) > 10);
        const bool resolved = !material->breakable || shv_library_figures(material).cohesive_zone > 15e-3;
        assert_true(!resolved || material->unresolved == SHV_UNRESOLVED_KEEP);
    }
}

/* MPa, as the sources have it: what τ and φ come to where something is crushed. With the cohesion of a Mohr-Coulomb line alone and
   not its friction, a brick was crushed at 8. */
static void columns_of_the_library_bear_what_their_sources_say(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double least, most;
    } columns[] = {{"soda_lime_glass", 800, 1000},
                   {"tempered_glass", 990, 1010},
                   {"alumina", 2900, 3100},
                   {"plaster", 25, 30},
                   {"pmma", 100, 125},
                   {"porcelain", 580, 600},
                   {"stoneware", 290, 310},
                   {"brick", 29, 31},
                   {"concrete_c30", 37, 39},
                   {"concrete_c50", 57, 59},
                   {"mortar", 9.9, 10.1},
                   {"granite", 165, 175},
                   {"ice", 9.9, 10.1}};
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        const ShvLibraryFigures figures = shv_library_figures(shv_library_find(columns[i].name));
        assert_true(figures.compressive_strength >= columns[i].least * 1e6);
        assert_true(figures.compressive_strength <= columns[i].most * 1e6);
    }
    assert_true(isinf(shv_library_figures(shv_library_find("steel")).compressive_strength));
}

static void unknown_library_material_is_reported(void **state)
{
    (void)state;
    static const struct {
        const char *name, *told;
    } cases[] = {
        {"stel", "3:16: error: the library has no material 'stel'; did you mean 'steel'?"},
        {"glass", "3:16: error: the library has no material 'glass'; it has soda_lime_glass, tempered_glass, "}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        char text[256];
        snprintf(text, sizeof text,
                 "shiver: 1\nmaterials:\n  a: {library: %s}\n"
                 "objects: {x: {mesh: {ball: {radius: 1, edge: 0.1}}, material: a}}\nduration: 1\n",
                 cases[k].name);
        Parsed parsed = parse_bytes(text, strlen(text), NULL, 0);
        assert_int_equal(parsed.status, SHV_BAD_INPUT);
        bool found = false;
        for (int32_t i = 0; i < shv_diagnostics_count(parsed.diagnostics); i++)
            found = found || strstr(message(&parsed, i), cases[k].told);
        assert_true(found);
        release(&parsed);
    }
}

static void what_is_left_out_has_its_default(void **state)
{
    (void)state;
    Parsed parsed = parse_good(SMALL_SCENE, NULL, 0);
    const ShvSceneDefinition *scene = shv_scene_definition(parsed.scene);
    const ShvSceneDefinition expected = shv_scene_default();
    assert_string_equal(scene->name, "s");
    assert_null(scene->output.file);
    assert_memory_equal(scene->gravity, expected.gravity, sizeof expected.gravity);
    same(scene->rigid.time_step, expected.rigid.time_step);
    same(scene->fracture.threshold, expected.fracture.threshold);
    same(scene->rigid.friction, 0.5);
    same(scene->rigid.restitution, 0.0);
    assert_int_equal(scene->rigid.dust, SHV_DUST_KEEP);
    assert_int_equal(scene->fracture.deformation, SHV_DEFORMATION_DROP);
    assert_true(isinf(scene->audit.momentum) && isinf(scene->audit.dropped_share) && isinf(scene->audit.hull_error));
    assert_int_equal(scene->rigid.engine, SHV_RIGID_BULLET);
    assert_int_equal(scene->reference.law, SHV_REFERENCE_NONE);
    assert_int_equal(scene->fracture.stabiliser, SHV_STABILISER_NONE);
    assert_int_equal(scene->overlaps, SHV_OVERLAPS_REFUSE);
    assert_int_equal(scene->obstacle_count, 0);
    assert_int_equal(scene->event_count, 0);
    assert_int_equal(scene->condition_count, 0);
    release(&parsed);
}

static void overrides_take_the_place_of_keys(void **state)
{
    (void)state;
    static const char *const overrides[] = {"materials.glass.density=2600",
                                            "gravity=[0, 0, -2]",
                                            "gravity.2=-1.62",
                                            "fracture.time_step=5 ns",
                                            "name=other = name",
                                            "obstacles={floor: {plane: {normal: [0, 0, 1]}}}",
                                            "obstacles.floor.friction=0.5",
                                            "events=[{at: 0.5, gravity: [0, 0, 0]}]",
                                            "events.0.at=0.75",
                                            "objects.plate.mesh.ball.edge=20 cm"};
    Parsed parsed = parse_good(SMALL_SCENE, overrides, 10);
    const ShvSceneDefinition *scene = shv_scene_definition(parsed.scene);
    same(scene->materials[0].density, 2600.0);
    check_vector(scene->gravity, 0.0, 0.0, -1.62);
    same(scene->fracture.time_step, 5e-9);
    assert_string_equal(scene->name, "other = name");
    same(scene->obstacles[0].friction, 0.5);
    same(scene->events[0].time, 0.75);
    same(scene->objects[0].mesh.edge, 0.2);
    assert_string_equal(shv_scene_text(parsed.scene), SMALL_SCENE);
    assert_int_equal(shv_scene_override_count(parsed.scene), 10);
    assert_string_equal(shv_scene_override(parsed.scene, 2), "gravity.2=-1.62");
    assert_null(shv_scene_override(parsed.scene, 10));
    release(&parsed);
}

static void engines_have_one_word(void **state)
{
    (void)state;
    for (int engine = SHV_RIGID_ANALYTIC; engine <= SHV_RIGID_BULLET_PLAIN; engine++) {
        char text[64];
        snprintf(text, sizeof text, "rigid.engine=%s", shv_rigid_engine_name((ShvRigidEngine)engine));
        const char *const overrides[] = {text};
        Parsed parsed = parse_good(SMALL_SCENE, overrides, 1);
        assert_int_equal(shv_scene_definition(parsed.scene)->rigid.engine, engine);
        release(&parsed);
    }
}

/* An override changes the one place it names, not what an alias shares with it. */
static void overrides_do_not_leak_through_aliases(void **state)
{
    (void)state;
    static const char text[] = SMALL_SCENE "obstacles:\n"
                                           "  one: &it {sphere: {radius: 1}}\n"
                                           "  two: *it\n";
    static const char *const overrides[] = {"obstacles.two.sphere.radius=3"};
    Parsed parsed = parse_good(text, overrides, 1);
    const ShvSceneDefinition *scene = shv_scene_definition(parsed.scene);
    same(scene->obstacles[0].radius, 1.0);
    same(scene->obstacles[1].radius, 3.0);
    release(&parsed);
}

/* Directions whose squares underflow or overflow are directions all the same. */
static void tiny_and_huge_directions_count(void **state)
{
    (void)state;
    Parsed parsed = parse_good(SMALL_SCENE "obstacles:\n"
                                           "  one: {plane: {normal: [0, 3e-300, 4e-300]}}\n"
                                           "  two: {plane: {normal: [0, 3e300, -4e300]}}\n",
                               NULL, 0);
    const ShvObstacleDefinition *planes = shv_scene_definition(parsed.scene)->obstacles;
    check_near(planes[0].plane_normal[1], 0.6, 1e-15);
    check_near(planes[1].plane_normal[2], -0.8, 1e-15);
    release(&parsed);
}

/* As editors of other systems write them. */
static void line_ends_and_byte_order_mark_do_not_matter(void **state)
{
    (void)state;
    Parsed parsed =
        parse_good("\xEF\xBB\xBFshiver: 1\r\n"
                   "materials: {m: {density: 1, youngs_modulus: 1e9, poissons_ratio: 0.2, breakable: false}}\r\n"
                   "objects: {o: {mesh: {ball: {radius: 1, edge: 0.1}}, material: m}}\r\n"
                   "duration: 1\r\n",
                   NULL, 0);
    same(shv_scene_definition(parsed.scene)->duration, 1.0);
    release(&parsed);
}

static uint64_t hash_of(const char *text, const char *const *overrides, int32_t count)
{
    Parsed parsed = parse_good(text, overrides, count);
    const uint64_t hash = shv_scene_hash(parsed.scene);
    release(&parsed);
    return hash;
}

static void hash_tells_texts_and_overrides_apart(void **state)
{
    (void)state;
    static const char *const one[] = {"seed=1"}, *const two[] = {"seed=2"}, *const both[] = {"seed=1", "seed=2"};
    const uint64_t hashes[] = {hash_of(SMALL_SCENE, NULL, 0), hash_of(SMALL_SCENE "seed: 1\n", NULL, 0),
                               hash_of(SMALL_SCENE, one, 1), hash_of(SMALL_SCENE, two, 1),
                               hash_of(SMALL_SCENE, both, 2)};
    for (int i = 0; i < 5; i++)
        for (int j = 0; j < i; j++) assert_true(hashes[i] != hashes[j]);
    assert_true(hash_of(SMALL_SCENE, one, 1) == hashes[2]);
}

static void files_are_loaded(void **state)
{
    (void)state;
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    ShvError error;
    check_ok(shv_scene_load(&scene, "scene/full.yaml", NULL, 0, NULL, &diagnostics, &error), error);
    assert_string_equal(shv_scene_folder(scene), "scene");
    shv_scene_destroy(scene);
    shv_diagnostics_destroy(diagnostics);
    check_fails(shv_scene_load(&scene, "scene/none.yaml", NULL, 0, NULL, &diagnostics, &error), SHV_FILE_ERROR, error,
                "scene/none.yaml");
    assert_null(scene);
    assert_null(diagnostics);
    check_fails(shv_scene_load(&scene, "scene", NULL, 0, NULL, NULL, &error), SHV_BAD_INPUT, error, "folder");
}

/* Each unit against the literal in SI units: equal to the last bit wherever one rounding can do it. */
static void units_are_converted(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        ShvDimension dimension;
        double value;
    } cases[] = {{"70e9", SHV_DIMENSION_PRESSURE, 70e9},
                 {"70 GPa", SHV_DIMENSION_PRESSURE, 70e9},
                 {"70GPa", SHV_DIMENSION_PRESSURE, 70e9},
                 {"9 mm", SHV_DIMENSION_LENGTH, 0.009},
                 {"9e0mm", SHV_DIMENSION_LENGTH, 0.009},
                 {"7 um", SHV_DIMENSION_LENGTH, 7e-6},
                 {"7 \xC2\xB5m", SHV_DIMENSION_LENGTH, 7e-6},
                 {"2 km", SHV_DIMENSION_LENGTH, 2000.0},
                 {"-3 cm", SHV_DIMENSION_LENGTH, -0.03},
                 {"3 cm3", SHV_DIMENSION_VOLUME, 3e-6},
                 {"3 g", SHV_DIMENSION_MASS, 0.003},
                 {"10 ns", SHV_DIMENSION_TIME, 10e-9},
                 {"2 min", SHV_DIMENSION_TIME, 120.0},
                 {"240 Hz", SHV_DIMENSION_FREQUENCY, 240.0},
                 {"36 km/h", SHV_DIMENSION_VELOCITY, 10.0},
                 {"9810 mm/s2", SHV_DIMENSION_ACCELERATION, 9.81},
                 {"25 deg", SHV_DIMENSION_ANGLE, 25.0},
                 {"2.5 g/cm3", SHV_DIMENSION_DENSITY, 2500.0},
                 {"22 N/m", SHV_DIMENSION_SURFACE_ENERGY, 22.0},
                 {"5 kg m/s", SHV_DIMENSION_IMPULSE, 5.0},
                 {".5", SHV_DIMENSION_NONE, 0.5},
                 {"+7.", SHV_DIMENSION_NONE, 7.0},
                 {"1e-400", SHV_DIMENSION_NONE, 0.0},
                 {"-.inf", SHV_DIMENSION_NONE, (double)-INFINITY}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value = (double)NAN;
        const char *unit = NULL;
        const ShvQuantityFault fault = shv_quantity_read(cases[i].text, cases[i].dimension, &value, &unit);
        if (fault != SHV_QUANTITY_FINE || value != cases[i].value)
            fail_msg("%s: fault %d, %.17g, expected %.17g", cases[i].text, (int)fault, value, cases[i].value);
    }
    double turn = 0.0;
    const char *unit = NULL;
    assert_int_equal(shv_quantity_read("60 rpm", SHV_DIMENSION_ANGULAR_VELOCITY, &turn, &unit), SHV_QUANTITY_FINE);
    check_near(turn, 6.283185307179586, 4e-15); /* two roundings of half a unit in the last place, 4.4e-16 */
}

static void wrong_quantities_are_told_apart(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        ShvQuantityFault fault;
    } cases[] = {
        {"", SHV_QUANTITY_NO_NUMBER},        {"mm", SHV_QUANTITY_NO_NUMBER},       {"1.2.3", SHV_QUANTITY_NO_NUMBER},
        {"1,5", SHV_QUANTITY_WRONG_UNIT},    {"0x10", SHV_QUANTITY_WRONG_UNIT},    {"inf", SHV_QUANTITY_NO_NUMBER},
        {"nan", SHV_QUANTITY_NO_NUMBER},     {"3 kg", SHV_QUANTITY_WRONG_UNIT},    {"3 Mm", SHV_QUANTITY_WRONG_UNIT},
        {"1e999", SHV_QUANTITY_TOO_LARGE},   {"1e308 km", SHV_QUANTITY_TOO_LARGE}, {"- 3", SHV_QUANTITY_NO_NUMBER},
        {"3 mm x", SHV_QUANTITY_WRONG_UNIT}, {"1e", SHV_QUANTITY_WRONG_UNIT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double value;
        const char *unit;
        const ShvQuantityFault fault = shv_quantity_read(cases[i].text, SHV_DIMENSION_LENGTH, &value, &unit);
        if (fault != cases[i].fault)
            fail_msg("'%s': fault %d, expected %d", cases[i].text, (int)fault, (int)cases[i].fault);
    }
}

/* Skipped where the system has no locale with a decimal comma. */
static void the_locale_changes_nothing(void **state)
{
    (void)state;
    static const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "fr_FR.utf8"};
    const char *set = NULL;
    for (int i = 0; i < 5 && !set; i++) set = setlocale(LC_ALL, names[i]);
    if (!set) skip();
    Parsed parsed = parse_good(glass_plate_drop, NULL, 0);
    same(shv_scene_definition(parsed.scene)->duration, 1.5);
    release(&parsed);
    static const char fault[] = SMALL_SCENE "rigid: {wake_factor: 1,5}\n";
    Parsed bad = parse_bytes(fault, strlen(fault), NULL, 0);
    assert_int_equal(bad.status, SHV_BAD_INPUT);
    release(&bad);
    setlocale(LC_ALL, "C");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glass_plate_drop_parses),
        cmocka_unit_test(every_key_arrives),
        cmocka_unit_test(full_scene_has_every_key),
        cmocka_unit_test(the_library_fills_in_what_is_left_out),
        cmocka_unit_test(columns_of_the_library_bear_what_their_sources_say),
        cmocka_unit_test(unknown_library_material_is_reported),
        cmocka_unit_test(what_is_left_out_has_its_default),
        cmocka_unit_test(overrides_take_the_place_of_keys),
        cmocka_unit_test(engines_have_one_word),
        cmocka_unit_test(overrides_do_not_leak_through_aliases),
        cmocka_unit_test(tiny_and_huge_directions_count),
        cmocka_unit_test(line_ends_and_byte_order_mark_do_not_matter),
        cmocka_unit_test(hash_tells_texts_and_overrides_apart),
        cmocka_unit_test(files_are_loaded),
        cmocka_unit_test(units_are_converted),
        cmocka_unit_test(wrong_quantities_are_told_apart),
        cmocka_unit_test(the_locale_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
