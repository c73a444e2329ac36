#include "evaluate/trajectory.h"

#include "base/memory.h"

int32_t shv_body_count(const ShvSceneDefinition *scene, int32_t fragments)
{
    for (int32_t i = 0; i < scene->obstacle_count; i++) fragments += scene->obstacles[i].motion == SHV_OBSTACLE_FREE;
    return fragments;
}

const ShvObstacleDefinition *shv_body_obstacle(const ShvSceneDefinition *scene, int32_t fragments, int32_t body)
{
    const ShvObstacleDefinition *obstacle = scene->obstacles;
    if (body < fragments) return NULL;
    for (int32_t free = body - fragments; free > 0 || obstacle->motion != SHV_OBSTACLE_FREE; obstacle++)
        free -= obstacle->motion == SHV_OBSTACLE_FREE;
    return obstacle;
}

/* The homogeneous solid. */
static ShvStatus describe_obstacle(ShvBody *body, const ShvObstacleDefinition *obstacle, ShvError *error)
{
    const double r = obstacle->radius, *a = obstacle->size;
    const bool ball = obstacle->shape == SHV_OBSTACLE_SPHERE;
    if (!ball && obstacle->shape != SHV_OBSTACLE_BOX)
        return shv_fail(error, SHV_UNSUPPORTED,
                        "'%s' is a free obstacle of triangles, whose inertia a comparison does not know; use a "
                        "sphere, a box or an object",
                        obstacle->name);
    body->mass = obstacle->mass;
    for (int k = 0; k < 3; k++) {
        const double y = a[(k + 1) % 3], z = a[(k + 2) % 3];
        body->inertia.m[k][k] = body->mass * (ball ? r * r / 5.0 + r * r / 5.0 : y * y / 12.0 + z * z / 12.0);
    }
    return SHV_OK;
}

ShvStatus shv_body_describe(ShvBody *body, const ShvSceneDefinition *scene, const ShvFrameView *frame, int32_t index,
                            ShvError *error)
{
    const ShvObstacleDefinition *obstacle = shv_body_obstacle(scene, frame->fragment_count, index);
    const ShvFragmentView *fragment = &frame->fragments[index];
    *body = (ShvBody){.chosen = 1.0};
    if (obstacle)
        SHV_TRY(describe_obstacle(body, obstacle, error));
    else
        *body = (ShvBody){.mass = fragment->mass, .inertia = shv_from_voigt(fragment->inertia), .chosen = 1.0};
    /* A ball has 2/5 m r² three times. */
    const double(*moment)[3] = (const double(*)[3])body->inertia.m;
    body->radius = sqrt(5.0 * (moment[0][0] + moment[1][1] + moment[2][2]) / (6.0 * body->mass));
    return SHV_OK;
}

static ShvBodyState state_from(const double *position, const double *orientation, const double *velocity,
                               const double *angular_velocity)
{
    return (ShvBodyState){shv_load3(position),
                          {orientation[0], orientation[1], orientation[2], orientation[3]},
                          shv_load3(velocity),
                          shv_load3(angular_velocity)};
}

ShvBodyState shv_body_state(const ShvSceneDefinition *scene, const ShvFrameView *frame, int32_t fragments, int32_t body)
{
    const ShvObstacleDefinition *obstacle = shv_body_obstacle(scene, fragments, body);
    if (obstacle) {
        const ShvObstacleView *view = &frame->obstacles[obstacle - scene->obstacles];
        return state_from(view->position, view->orientation, view->velocity, view->angular_velocity);
    }
    const ShvFragmentView *view = &frame->fragments[body];
    return state_from(view->position, view->orientation, view->velocity, view->angular_velocity);
}
