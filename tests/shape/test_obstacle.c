#include "check.h"

#include "shape/scene.h"

static ShvStatus create(const ShvObstacleDefinition *definition, ShvMemory *memory, ShvError *error)
{
    ShvSceneDefinition scene = shv_scene_default();
    ShvObstacles obstacles;
    scene.obstacles = definition;
    scene.obstacle_count = 1;
    const ShvStatus status = shv_obstacles_create(&obstacles, memory, &scene, NULL, error);
    if (status == SHV_OK) shv_obstacles_release(&obstacles);
    return status;
}

static void check_refused(const ShvObstacleDefinition *definition, const char *part)
{
    ShvError error = {0};
    check_fails(create(definition, NULL, &error), SHV_BAD_INPUT, error, part);
    check_fails(create(definition, NULL, &error), SHV_BAD_INPUT, error, definition->name);
}

static void test_refusals(void **state)
{
    (void)state;
    const ShvVec3 origin = {0.0, 0.0, 0.0}, size = {1.0, 1.0, 1.0};
    ShvObstacleDefinition wrong = {.name = "zeroed"};
    check_refused(&wrong, "shv_obstacle_default");
    wrong = sphere_definition("pea", 0.0, origin);
    check_refused(&wrong, "radius");
    wrong.radius = (double)NAN;
    check_refused(&wrong, "radius");
    wrong = box_definition("crate", shv_vec3(1.0, -1.0, 1.0), origin);
    check_refused(&wrong, "edge lengths");
    wrong = plane_definition("floor", origin, 0.0);
    check_refused(&wrong, "normal");
    wrong = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), (double)INFINITY);
    check_refused(&wrong, "offset");
    wrong = plane_definition("floor", shv_vec3(0.0, 0.0, 1.0), 0.0);
    wrong.motion = SHV_OBSTACLE_SCRIPTED;
    check_refused(&wrong, "fixed");
    wrong = box_definition("crate", size, origin);
    wrong.motion = SHV_OBSTACLE_FREE;
    check_refused(&wrong, "mass > 0");
    wrong.mass = (double)INFINITY;
    check_refused(&wrong, "mass > 0");
    wrong = box_definition("crate", size, origin);
    wrong.placement.velocity[1] = 1.0;
    check_refused(&wrong, "free");
    wrong = box_definition("crate", size, shv_vec3(0.0, (double)NAN, 0.0));
    check_refused(&wrong, "finite");
    wrong = box_definition("crate", size, origin);
    turn(&wrong, origin, 20.0);
    check_refused(&wrong, "axis");
    wrong = box_definition("crate", size, origin);
    wrong.friction = -0.1;
    check_refused(&wrong, "friction");
    wrong.friction = 0.1;
    wrong.restitution = 1.5;
    check_refused(&wrong, "restitution");
    wrong = mesh_definition("rock", NULL, origin);
    check_refused(&wrong, "file");
    wrong = mesh_definition("rock", "rock.obj", origin);
    wrong.scale = 0.0;
    check_refused(&wrong, "scale");
}

static void test_keyframe_refusals(void **state)
{
    (void)state;
    ShvKeyframe keyframes[2] = {{.time = 1.0}, {.time = 1.0}};
    ShvObstacleDefinition wrong = box_definition("ram", shv_vec3(1.0, 1.0, 1.0), shv_vec3(0.0, 0.0, 0.0));
    wrong.motion = SHV_OBSTACLE_SCRIPTED;
    check_refused(&wrong, "keyframes");
    wrong.keyframes = keyframes;
    wrong.keyframe_count = 2;
    check_refused(&wrong, "increase");
    keyframes[1].time = (double)NAN;
    check_refused(&wrong, "finite");
    keyframes[1].time = 2.0;
    keyframes[1].rotation_degrees = 10.0;
    check_refused(&wrong, "axis");
}

static void test_file_errors(void **state)
{
    (void)state;
    ShvError error = {0};
    ShvObstacleDefinition rock = mesh_definition("rock", "/nowhere/rock.obj", shv_vec3(0.0, 0.0, 0.0));
    check_fails(create(&rock, NULL, &error), SHV_FILE_ERROR, error, "obstacle rock");
    const SurfaceFile open = surface_file("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    rock.file = open.path;
    check_fails(create(&rock, NULL, &error), SHV_BAD_INPUT, error, "not closed");
    remove_surface_file(&open);
}

/* Mass and inertia of the homogeneous solid. */
static void test_inertia(void **state)
{
    (void)state;
    ShvObstacleDefinition definitions[2] = {sphere_definition("ball", 0.5, shv_vec3(0.0, 0.0, 0.0)),
                                            box_definition("crate", shv_vec3(1.0, 2.0, 3.0), shv_vec3(5.0, 0.0, 0.0))};
    make_free(&definitions[0], 10.0);
    make_free(&definitions[1], 12.0);
    ShvObstacles obstacles = make_obstacles(definitions, 2);
    for (int k = 0; k < 3; k++) check_near(obstacles.items[0].inertia.m[k][k], 0.4 * 10.0 * 0.25, 1e-15);
    check_near(obstacles.items[1].inertia.m[0][0], 13.0, 1e-14);
    check_near(obstacles.items[1].inertia.m[1][1], 10.0, 1e-14);
    check_near(obstacles.items[1].inertia.m[2][2], 5.0, 1e-14);
    shv_obstacles_release(&obstacles);
}

/* Every allocation fails in turn: a message, nothing leaked. */
static void test_allocation_failures(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(angle_text);
    ShvObstacleDefinition rock = mesh_definition("rock", file.path, shv_vec3(0.0, 0.0, 0.0));
    make_free(&rock, 1.0);
    ShvStatus status = SHV_NO_MEMORY;
    int failures = 0;
    for (int64_t allowed = 0; status != SHV_OK; allowed++) {
        ShvMemory *memory = shv_memory_create();
        ShvError error = {0};
        shv_memory_fail_after(memory, allowed);
        status = create(&rock, memory, &error);
        if (status != SHV_OK) {
            assert_int_equal(status, SHV_NO_MEMORY);
            assert_true(strlen(error.message) > 0);
            failures++;
        }
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    assert_true(failures > 10);
    remove_surface_file(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refusals), cmocka_unit_test(test_keyframe_refusals),   cmocka_unit_test(test_file_errors),
        cmocka_unit_test(test_inertia),  cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
