#include "pbd/pbd_body.h"

#include "fragment/free_rotation.h"

/* A smaller gap is a touch, in radii. */
static const double slop_of_radius = 1e-6;

static ShvFragment *fragment_of(const ShvPbdBody *body, const ShvRigidWorld *world)
{
    return &world->fragments->items[body->fragment];
}

static const int32_t *nodes_of(const ShvPbdBody *body, const ShvRigidWorld *world)
{
    return world->fragments->nodes + fragment_of(body, world)->node_begin;
}

/* ---- life ---- */

static bool touches(const ShvPbdBody *body, const ShvRigidWorld *world, const ShvObstacle *obstacle)
{
    const ShvFragment *fragment = fragment_of(body, world);
    const double slop = slop_of_radius * fragment->radius;
    const int32_t *nodes = nodes_of(body, world);
    for (int32_t i = 0; i < fragment->node_count; i++)
        if (shv_obstacle_closest(obstacle, shv_state_position(world->state, nodes[i]), 2.0 * slop).gap <= slop)
            return true;
    return false;
}

ShvStatus shv_pbd_body_create(ShvPbdBody **body, const ShvRigidWorld *world, int32_t fragment, ShvError *error)
{
    ShvMemory *memory = world->fragments->memory;
    const size_t obstacles = (size_t)world->obstacles->count;
    ShvPbdBody *made = *body = shv_allocate(memory, SHV_PART_RIGID, 1, sizeof *made);
    if (made) {
        made->fragment = fragment;
        made->time = world->state->time;
        made->touched = shv_allocate(memory, SHV_PART_RIGID, obstacles, 1);
        made->fastest = shv_allocate(memory, SHV_PART_RIGID, obstacles, sizeof *made->fastest);
    }
    if (!made || !made->touched || !made->fastest) {
        shv_pbd_body_destroy(made);
        *body = NULL;
        return shv_fail_memory(error, "a fragment in flight", sizeof *made + 5 * obstacles);
    }
    for (int32_t o = 0; o < world->obstacles->count; o++)
        made->touched[o] = touches(made, world, &world->obstacles->items[o]);
    return SHV_OK;
}

void shv_pbd_body_destroy(ShvPbdBody *body)
{
    if (!body) return;
    shv_release(body->touched);
    shv_release(body->fastest);
    shv_release(body);
}

/* ---- the start of a step ---- */

static ShvStatus find_turn(ShvPbdBody *body, const ShvRigidWorld *world, double step, ShvError *error)
{
    const ShvRigidField *field = &body->field;
    const ShvFreeRotation rotation = shv_free_rotation_make(&field->inertia);
    const ShvQuat start = shv_quat_identity();
    const double turn = step * shv_free_rotation_fastest(&rotation, start, field->angular_momentum);
    const ShvFragment *fragment = fragment_of(body, world);
    SHV_TRY(shv_rigid_check_motion("fragment", fragment->id, fragment->position, fragment->velocity,
                                   fragment->angular_velocity, turn, error));
    if (turn == 0.0) return SHV_OK;
    body->rotation = shv_free_rotation_advance(&rotation, start, field->angular_momentum, step);
    body->spin = shv_free_rotation_velocity(&rotation, body->rotation, field->angular_momentum);
    return SHV_OK;
}

/* (R − 1) r, exactly zero without rotation. */
static ShvVec3 rotation_displacement(ShvQuat q, ShvVec3 arm)
{
    const ShvVec3 axis = shv_vec3(q.x, q.y, q.z);
    const ShvVec3 t = shv_scale(shv_cross(axis, arm), 2.0);
    return shv_madd(shv_cross(axis, t), q.w, t);
}

static ShvVec3 arm_of(const ShvPbdBody *body, const ShvRigidWorld *world, int32_t node)
{
    return shv_sub(shv_state_position(world->state, node), body->field.centre);
}

/* What a node's velocity has beside the rigid motion. */
static ShvVec3 deviation(const ShvPbdBody *body, const ShvRigidWorld *world, int32_t node, ShvVec3 arm)
{
    const ShvVec3 rigid = shv_velocity_at(body->field.velocity, body->field.angular_velocity, arm);
    return shv_sub(shv_load3(world->state->velocity + 3 * (int64_t)node), rigid);
}

static void predict_turning(const ShvPbdBody *body, const ShvRigidWorld *world, ShvRelax *relax, double step,
                            ShvVec3 fall)
{
    const ShvVec3 displacement = shv_madd(fall, step, body->field.velocity);
    const int32_t *nodes = nodes_of(body, world);
    for (int32_t i = 0; i < fragment_of(body, world)->node_count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        const ShvVec3 arm = arm_of(body, world, nodes[i]);
        const ShvVec3 own = shv_rotate(body->rotation, deviation(body, world, nodes[i], arm));
        const ShvVec3 turning = shv_madd(rotation_displacement(body->rotation, arm), step, own);
        shv_store3(relax->predicted + k,
                   shv_add(shv_add(shv_load3(world->state->displacement + k), displacement), turning));
    }
}

static void predict_straight(const ShvPbdBody *body, const ShvRigidWorld *world, ShvRelax *relax, double step,
                             ShvVec3 fall)
{
    const int32_t *nodes = nodes_of(body, world);
    for (int32_t i = 0; i < fragment_of(body, world)->node_count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        const ShvVec3 displacement = shv_madd(fall, step, shv_load3(world->state->velocity + k));
        shv_store3(relax->predicted + k, shv_add(shv_load3(world->state->displacement + k), displacement));
    }
}

ShvStatus shv_pbd_body_predict(ShvPbdBody *body, const ShvRigidWorld *world, const ShvPbdDefinition *pbd,
                               ShvRelax *relax, const ShvRelaxStep *step, double *taken, ShvError *error)
{
    const ShvVec3 fall = shv_scale(shv_load3(step->gravity), 0.5 * step->step * step->step);
    const ShvFragment *fragment = fragment_of(body, world);
    *taken = 0.0;
    body->rotation = shv_quat_identity();
    if (pbd->damping > 0.0 || pbd->exact_rotation)
        *taken =
            shv_damp_velocities(world->state, nodes_of(body, world), fragment->node_count, pbd->damping, &body->field);
    body->spin = body->field.angular_velocity;
    if (pbd->exact_rotation) {
        SHV_TRY(find_turn(body, world, step->step, error));
        predict_turning(body, world, relax, step->step, fall);
    } else {
        predict_straight(body, world, relax, step->step, fall);
    }
    return SHV_OK;
}

void shv_pbd_body_rotate(const ShvPbdBody *body, const ShvRigidWorld *world)
{
    if (body->rotation.x == 0.0 && body->rotation.y == 0.0 && body->rotation.z == 0.0) return;
    const int32_t *nodes = nodes_of(body, world);
    for (int32_t i = 0; i < fragment_of(body, world)->node_count; i++) {
        const ShvVec3 arm = arm_of(body, world, nodes[i]);
        const ShvVec3 own = shv_rotate(body->rotation, deviation(body, world, nodes[i], arm));
        const ShvVec3 turning = shv_cross(body->spin, shv_add(arm, rotation_displacement(body->rotation, arm)));
        shv_store3(world->state->velocity + 3 * (int64_t)nodes[i],
                   shv_add(body->field.velocity, shv_add(turning, own)));
    }
}

/* ---- the end of a step ---- */

void shv_pbd_body_write(ShvPbdBody *body, const ShvRigidWorld *world)
{
    shv_fragment_fit(fragment_of(body, world), world->fragments, world->state);
}

void shv_pbd_body_note_contacts(ShvPbdBody *body, const ShvRigidWorld *world, const ShvRelax *relax)
{
    for (int32_t o = 0; o < world->obstacles->count; o++)
        body->touched[o] = body->fastest[o] >= 0 || (body->touched[o] && touches(body, world, &relax->later[o]));
}
