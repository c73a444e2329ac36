#include "shape/obstacle.h"

static bool is_free(const ShvObstacle *obstacle)
{
    return obstacle->motion == SHV_OBSTACLE_FREE;
}

/* R A Rᵀ v with R the orientation. */
static ShvVec3 apply_in_world(const ShvObstacle *obstacle, const ShvMat3 *local, ShvVec3 vector)
{
    const ShvVec3 turned = shv_rotate(shv_quat_conjugate(obstacle->orientation), vector);
    return shv_rotate(obstacle->orientation, shv_apply(local, turned));
}

ShvVec3 shv_obstacle_velocity(const ShvObstacle *obstacle, ShvVec3 point)
{
    if (obstacle->motion == SHV_OBSTACLE_FIXED) return shv_vec3(0.0, 0.0, 0.0);
    return shv_velocity_at(obstacle->velocity, obstacle->angular_velocity, shv_sub(point, obstacle->position));
}

double shv_obstacle_inverse_mass(const ShvObstacle *obstacle, ShvVec3 point, ShvVec3 direction)
{
    if (!is_free(obstacle)) return 0.0;
    const ShvVec3 torque = shv_cross(shv_sub(point, obstacle->position), direction);
    return 1.0 / obstacle->mass + shv_dot(torque, apply_in_world(obstacle, &obstacle->inverse_inertia, torque));
}

void shv_obstacle_impulse(ShvObstacle *obstacle, ShvVec3 point, ShvVec3 impulse)
{
    if (!is_free(obstacle)) return;
    obstacle->velocity = shv_madd(obstacle->velocity, 1.0 / obstacle->mass, impulse);
    const ShvVec3 torque = shv_cross(shv_sub(point, obstacle->position), impulse);
    obstacle->angular_velocity =
        shv_add(obstacle->angular_velocity, apply_in_world(obstacle, &obstacle->inverse_inertia, torque));
}

double shv_obstacle_kinetic(const ShvObstacle *obstacle)
{
    if (!is_free(obstacle)) return 0.0;
    const ShvVec3 spin = apply_in_world(obstacle, &obstacle->inertia, obstacle->angular_velocity);
    return 0.5 * obstacle->mass * shv_dot(obstacle->velocity, obstacle->velocity) +
           0.5 * shv_dot(obstacle->angular_velocity, spin);
}

ShvVec3 shv_obstacle_angular_momentum(const ShvObstacle *obstacle)
{
    if (!is_free(obstacle)) return shv_vec3(0.0, 0.0, 0.0);
    return shv_add(apply_in_world(obstacle, &obstacle->inertia, obstacle->angular_velocity),
                   shv_scale(shv_cross(obstacle->position, obstacle->velocity), obstacle->mass));
}
