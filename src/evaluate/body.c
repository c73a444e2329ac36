#include "evaluate/body.h"

static double ball_radius(double mass, const ShvMat3 *inertia)
{
    /* A ball has 2/5 m r² three times. */
    return sqrt(5.0 * (inertia->m[0][0] + inertia->m[1][1] + inertia->m[2][2]) / (6.0 * mass));
}

static ShvBody of_fragment(const ShvSceneDefinition *scene, const ShvFragmentView *view, int32_t index)
{
    ShvBody body = {.name = scene->objects[view->object].name,
                    .mass = view->mass,
                    .inertia = shv_from_voigt(view->inertia),
                    .fragment = index,
                    .obstacle = -1};
    body.radius = ball_radius(body.mass, &body.inertia);
    return body;
}

/* The homogeneous solid. */
static ShvStatus of_obstacle(ShvBody *body, const ShvObstacleDefinition *obstacle, int32_t index, ShvError *error)
{
    *body = (ShvBody){.name = obstacle->name, .mass = obstacle->mass, .fragment = -1, .obstacle = index};
    double square[3]; /* mean of x² and so on over the solid */
    for (int k = 0; k < 3; k++) {
        if (obstacle->shape == SHV_OBSTACLE_SPHERE)
            square[k] = obstacle->radius * obstacle->radius / 5.0;
        else if (obstacle->shape == SHV_OBSTACLE_BOX)
            square[k] = obstacle->size[k] * obstacle->size[k] / 12.0;
        else
            return shv_fail(error, SHV_UNSUPPORTED,
                            "'%s' is a free obstacle of triangles, whose inertia a comparison does not know; use a "
                            "sphere, a box or an object",
                            obstacle->name);
    }
    for (int k = 0; k < 3; k++) body->inertia.m[k][k] = body->mass * (square[(k + 1) % 3] + square[(k + 2) % 3]);
    body->radius = ball_radius(body->mass, &body->inertia);
    return SHV_OK;
}

static ShvStatus fill(ShvBodies *bodies, const ShvSceneDefinition *scene, const ShvFrameView *frame, ShvError *error)
{
    for (int32_t i = 0; i < frame->fragment_count; i++)
        bodies->items[bodies->count++] = of_fragment(scene, &frame->fragments[i], i);
    for (int32_t i = 0; i < scene->obstacle_count; i++)
        if (scene->obstacles[i].motion == SHV_OBSTACLE_FREE)
            SHV_TRY(of_obstacle(&bodies->items[bodies->count++], &scene->obstacles[i], i, error));
    return SHV_OK;
}

ShvStatus shv_bodies_create(ShvBodies *bodies, const ShvSceneDefinition *scene, const ShvFrameView *frame,
                            ShvMemory *memory, ShvError *error)
{
    const size_t most = (size_t)frame->fragment_count + (size_t)scene->obstacle_count;
    *bodies = (ShvBodies){shv_allocate(memory, SHV_PART_RECORD, most, sizeof(ShvBody)), 0};
    if (!bodies->items) return shv_fail_memory(error, "the bodies to compare", most * sizeof(ShvBody));
    const ShvStatus status = fill(bodies, scene, frame, error);
    if (status != SHV_OK) shv_bodies_release(bodies);
    return status;
}

void shv_bodies_release(ShvBodies *bodies)
{
    shv_release(bodies->items);
    *bodies = (ShvBodies){NULL, 0};
}

static ShvBodyState state_from(const double *position, const double *orientation, const double *velocity,
                               const double *angular_velocity)
{
    return (ShvBodyState){shv_load3(position),
                          {orientation[0], orientation[1], orientation[2], orientation[3]},
                          shv_load3(velocity),
                          shv_load3(angular_velocity)};
}

ShvBodyState shv_body_state(const ShvBody *body, const ShvFrameView *frame)
{
    if (body->fragment < 0) {
        const ShvObstacleView *view = &frame->obstacles[body->obstacle];
        return state_from(view->position, view->orientation, view->velocity, view->angular_velocity);
    }
    const ShvFragmentView *view = &frame->fragments[body->fragment];
    return state_from(view->position, view->orientation, view->velocity, view->angular_velocity);
}

ShvVec3 shv_body_spin_momentum(const ShvBody *body, const ShvBodyState *state)
{
    const ShvVec3 spin = shv_rotate(shv_quat_conjugate(state->orientation), state->angular_velocity);
    return shv_rotate(state->orientation, shv_apply(&body->inertia, spin));
}

double shv_body_kinetic(const ShvBody *body, const ShvBodyState *state)
{
    return 0.5 * body->mass * shv_dot(state->velocity, state->velocity) +
           0.5 * shv_dot(state->angular_velocity, shv_body_spin_momentum(body, state));
}

double shv_angle_between(ShvQuat a, ShvQuat b)
{
    const ShvQuat turn = shv_quat_multiply(shv_quat_conjugate(a), b);
    return 2.0 * atan2(shv_norm(shv_vec3(turn.x, turn.y, turn.z)), fabs(turn.w));
}
