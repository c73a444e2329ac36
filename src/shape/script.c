#include "shape/obstacle.h"

#include "base/deterministic.h"
#include "shape/rotation.h"

typedef struct Pose {
    ShvVec3 position; /* of the definition's origin */
    ShvQuat orientation;
} Pose;

static Pose keyframe_pose(const ShvKeyframe *keyframe)
{
    return (Pose){shv_load3(keyframe->position), shv_quat_from_axis_angle(shv_load3(keyframe->rotation_axis),
                                                                          keyframe->rotation_degrees * SHV_DEGREE)};
}

/* Last keyframe at or before a time, −1 before the first. */
static int32_t keyframe_before(const ShvObstacleDefinition *definition, double time)
{
    int32_t low = -1, high = definition->keyframe_count;
    while (high - low > 1) {
        const int32_t middle = low + (high - low) / 2;
        if (definition->keyframes[middle].time <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Pose at a time and constant velocities of the motion that goes on from it. */
static Pose pose_at(const ShvObstacleDefinition *definition, double time, ShvVec3 *velocity, ShvVec3 *spin)
{
    *velocity = *spin = shv_vec3(0.0, 0.0, 0.0);
    const int32_t k = keyframe_before(definition, time), last = definition->keyframe_count - 1;
    if (k < 0) return keyframe_pose(&definition->keyframes[0]);
    if (k >= last) return keyframe_pose(&definition->keyframes[last]);
    const Pose from = keyframe_pose(&definition->keyframes[k]), to = keyframe_pose(&definition->keyframes[k + 1]);
    const double span = definition->keyframes[k + 1].time - definition->keyframes[k].time;
    const double elapsed = time - definition->keyframes[k].time;
    *velocity = shv_scale(shv_sub(to.position, from.position), 1.0 / span);
    *spin = shv_scale(shv_rotation_between(from.orientation, to.orientation), 1.0 / span);
    return (Pose){shv_madd(from.position, elapsed / span, shv_sub(to.position, from.position)),
                  shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(*spin, elapsed)), from.orientation))};
}

static ShvVec3 centre_of(const ShvObstacle *obstacle, Pose pose)
{
    return shv_add(pose.position, shv_rotate(pose.orientation, obstacle->centre));
}

static void place(ShvObstacle *obstacle, double time, double step)
{
    ShvVec3 velocity, spin;
    const Pose pose = pose_at(obstacle->definition, time, &velocity, &spin);
    obstacle->position = centre_of(obstacle, pose);
    obstacle->orientation = pose.orientation;
    obstacle->angular_velocity = spin;
    obstacle->velocity = shv_velocity_at(velocity, spin, shv_sub(obstacle->position, pose.position));
    if (!(step > 0.0)) return;
    const Pose next = pose_at(obstacle->definition, time + step, &velocity, &spin);
    obstacle->velocity = shv_scale(shv_sub(centre_of(obstacle, next), obstacle->position), 1.0 / step);
    obstacle->angular_velocity = shv_scale(shv_rotation_between(pose.orientation, next.orientation), 1.0 / step);
}

void shv_obstacles_script(ShvObstacles *obstacles, double time)
{
    shv_obstacles_script_step(obstacles, time, 0.0);
}

void shv_obstacles_script_step(ShvObstacles *obstacles, double time, double step)
{
    for (int32_t i = 0; i < obstacles->count; i++)
        if (obstacles->items[i].motion == SHV_OBSTACLE_SCRIPTED) place(&obstacles->items[i], time, step);
}
