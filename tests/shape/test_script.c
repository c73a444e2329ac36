#include "check.h"

#include "shape/scene.h"

static const double PI = 3.14159265358979323846;

static double quat_distance(ShvQuat a, ShvQuat b)
{
    const double sign = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z < 0.0 ? -1.0 : 1.0;
    return sqrt((a.w - sign * b.w) * (a.w - sign * b.w) + (a.x - sign * b.x) * (a.x - sign * b.x) +
                (a.y - sign * b.y) * (a.y - sign * b.y) + (a.z - sign * b.z) * (a.z - sign * b.z));
}

static ShvObstacleDefinition scripted(ShvObstacleDefinition definition, const ShvKeyframe *keyframes, int32_t count)
{
    definition.motion = SHV_OBSTACLE_SCRIPTED;
    definition.keyframes = keyframes;
    definition.keyframe_count = count;
    return definition;
}

static const ShvKeyframe keyframes[3] = {
    {1.0, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.0},
    {3.0, {4.0, -2.0, 1.0}, {0.0, 0.0, 1.0}, 90.0},
    {3.5, {4.0, -2.0, 1.0}, {0.0, 0.0, 1.0}, 350.0}, /* the short way from 90° to 350° is 100° back */
};

static void test_keyframes(void **state)
{
    (void)state;
    const ShvObstacleDefinition definition =
        scripted(box_definition("box", shv_vec3(1.0, 1.0, 1.0), shv_vec3(9.0, 9.0, 9.0)), keyframes, 3);
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    const ShvObstacle *box = &obstacles.items[0];
    check_near(shv_norm(box->position), 0.0, 0.0); /* keyframes place it; held before the first */
    check_near(shv_norm(box->velocity), 0.0, 0.0);
    shv_obstacles_script(&obstacles, 2.0);
    check_near(shv_norm(shv_sub(box->position, shv_vec3(2.0, -1.0, 0.5))), 0.0, 1e-15);
    check_near(shv_norm(shv_sub(box->velocity, shv_vec3(2.0, -1.0, 0.5))), 0.0, 1e-15);
    check_near(box->angular_velocity.z, PI / 4.0, 1e-15);
    check_near(quat_distance(box->orientation, (ShvQuat){cos(PI / 8.0), 0.0, 0.0, sin(PI / 8.0)}), 0.0, 1e-15);
    shv_obstacles_script(&obstacles, 3.0); /* of the motion that begins */
    check_near(shv_norm(box->velocity), 0.0, 0.0);
    check_near(box->angular_velocity.z, -100.0 / 180.0 * PI / 0.5, 1e-14);
    shv_obstacles_script(&obstacles, 7.0);
    check_near(shv_norm(shv_sub(box->position, shv_vec3(4.0, -2.0, 1.0))), 0.0, 0.0);
    check_near(shv_norm(box->angular_velocity), 0.0, 0.0);
    shv_obstacles_release(&obstacles);
}

/* The velocity of material points is the derivative of where they are: central differences, exact to h² |ω|³ r / 6. */
static void test_velocity_is_derivative(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    const ShvObstacleDefinition definition =
        scripted(mesh_definition("mesh", file.path, shv_vec3(0.0, 0.0, 0.0)), keyframes, 3);
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvObstacle *mesh = &obstacles.items[0];
    const double h = 1e-4;
    const ShvVec3 local = {0.7, -0.2, 0.3};
    for (int k = 0; k < 20; k++) {
        const double time = 1.05 + 0.12 * k;
        if (fabs(time - 3.0) < 2.0 * h) continue;
        ShvVec3 where[2];
        for (int side = 0; side < 2; side++) {
            shv_obstacles_script(&obstacles, time + (side ? h : -h));
            where[side] = shv_add(mesh->position, shv_rotate(mesh->orientation, local));
        }
        shv_obstacles_script(&obstacles, time);
        const ShvVec3 at = shv_add(mesh->position, shv_rotate(mesh->orientation, local));
        const ShvVec3 difference = shv_scale(shv_sub(where[1], where[0]), 0.5 / h);
        const double spin = shv_norm(mesh->angular_velocity);
        check_near(shv_norm(shv_sub(difference, shv_obstacle_velocity(mesh, at))), 0.0,
                   h * h * spin * spin * spin * 2.0 / 6.0 + 1e-11);
        /* The file's origin follows the keyframes. */
        const ShvVec3 origin = shv_sub(mesh->position, shv_rotate(mesh->orientation, mesh->centre));
        const double share = fmin(1.0, (time - 1.0) / 2.0);
        check_near(shv_norm(shv_sub(origin, shv_scale(shv_vec3(4.0, -2.0, 1.0), share))), 0.0, 1e-14);
    }
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

/* Velocities over a step lead to the pose at its end, across a keyframe too. */
static void test_script_step(void **state)
{
    (void)state;
    const SurfaceFile file = surface_file(box_text);
    const ShvObstacleDefinition definition =
        scripted(mesh_definition("mesh", file.path, shv_vec3(0.0, 0.0, 0.0)), keyframes, 3);
    ShvObstacles obstacles = make_obstacles(&definition, 1);
    ShvObstacle *mesh = &obstacles.items[0];
    const double starts[] = {0.9, 1.5, 2.95, 3.45, 3.6}, step = 0.1;
    for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
        shv_obstacles_script_step(&obstacles, starts[k], step);
        const ShvVec3 position = shv_madd(mesh->position, step, mesh->velocity);
        const ShvQuat orientation =
            shv_quat_multiply(shv_quat_exponential(shv_scale(mesh->angular_velocity, step)), mesh->orientation);
        shv_obstacles_script(&obstacles, starts[k] + step);
        check_near(shv_norm(shv_sub(position, mesh->position)), 0.0, 1e-14);
        check_near(quat_distance(orientation, mesh->orientation), 0.0, 1e-14);
    }
    shv_obstacles_release(&obstacles);
    remove_surface_file(&file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_keyframes),
        cmocka_unit_test(test_velocity_is_derivative),
        cmocka_unit_test(test_script_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
