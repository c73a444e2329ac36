#include "rigid/bullet_body.h"

/* ---- shapes ---- */

static ShvStatus add_shape(const ShvBulletRigidBody *body, ShvBulletWorld *bullet, ShvBodyShape *body_shape,
                           ShvError *error)
{
    const double mobility = body->moves ? 1.0 / body->mass : 0.0;
    const ShvStatus status =
        shv_bullet_world_add(bullet, body->number, &body_shape->shape, mobility, body->rotation.inverse, error);
    shv_body_shape_release(body_shape);
    return status;
}

ShvStatus shv_bullet_body_add_pieces(const ShvBulletRigidBody *body, ShvBulletWorld *bullet, ShvError *error)
{
    ShvBodyShape body_shape;
    SHV_TRY(shv_body_shape_of_pieces(&body_shape, &body->pieces, &body->rotation.axes, body->dust, error));
    return add_shape(body, bullet, &body_shape, error);
}

ShvStatus shv_bullet_body_fragment(ShvBulletRigidBody *body, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                   int32_t fragment, ShvError *error)
{
    const ShvFragment *record = &world->fragments->items[fragment];
    *body = (ShvBulletRigidBody){.number = world->obstacles->count + fragment,
                                 .fragment = fragment,
                                 .obstacle = -1,
                                 .moves = !record->fixed,
                                 .fall = 1.0,
                                 .mass = record->mass,
                                 .dust = record->dust,
                                 .born = true};
    SHV_TRY(shv_rigid_check_mass(record, error));
    body->rotation = shv_free_rotation_make(&record->inertia);
    SHV_TRY(shv_convex_pieces_make(&body->pieces, world->fragments, world->model, world->state, fragment, error));
    const ShvStatus status = shv_bullet_body_add_pieces(body, bullet, error);
    if (status != SHV_OK) {
        shv_convex_pieces_release(&body->pieces);
        return status == SHV_NO_MEMORY ? status : shv_fail_within(error, status, "fragment %d", (int)record->id);
    }
    body->radius = shv_bullet_world_radius(bullet, body->number);
    shv_bullet_body_read(body, world);
    return SHV_OK;
}

ShvStatus shv_bullet_body_obstacle(ShvBulletRigidBody *body, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                   int32_t index, ShvError *error)
{
    const ShvObstacle *obstacle = &world->obstacles->items[index];
    *body = (ShvBulletRigidBody){.number = index,
                                 .fragment = -1,
                                 .obstacle = index,
                                 .moves = obstacle->motion == SHV_OBSTACLE_FREE,
                                 .fall = 1.0,
                                 .round = obstacle->shape == SHV_OBSTACLE_SPHERE,
                                 .mass = obstacle->mass,
                                 .friction = obstacle->friction,
                                 .restitution = obstacle->restitution,
                                 .born = true};
    body->rotation = shv_free_rotation_make(&obstacle->inertia);
    if (!body->moves) body->rotation.axes = shv_identity();
    ShvBodyShape body_shape;
    SHV_TRY(shv_body_shape_of_obstacle(&body_shape, obstacle, &body->rotation.axes, world->fragments->memory, error));
    const ShvStatus status = add_shape(body, bullet, &body_shape, error);
    if (status == SHV_NO_MEMORY) return status;
    if (status != SHV_OK) return shv_fail_within(error, status, "obstacle %s", obstacle->name);
    body->radius = shv_bullet_world_radius(bullet, body->number);
    shv_bullet_body_read(body, world);
    shv_bullet_body_place(body, bullet, body->position, body->orientation);
    const double none[3] = {0.0, 0.0, 0.0};
    return shv_bullet_world_reach(bullet, body->number, none, 0.0, 0.0, error);
}

void shv_bullet_body_release(ShvBulletRigidBody *body, ShvBulletWorld *bullet)
{
    shv_bullet_world_remove(bullet, body->number);
    shv_impact_shape_release(body->impact);
    shv_convex_pieces_release(&body->pieces);
}

/* ---- records ---- */

bool shv_bullet_body_read(ShvBulletRigidBody *body, const ShvRigidWorld *world)
{
    const ShvFragment *fragment = body->fragment >= 0 ? &world->fragments->items[body->fragment] : NULL;
    const ShvObstacle *obstacle = body->obstacle >= 0 ? &world->obstacles->items[body->obstacle] : NULL;
    const ShvVec3 position = fragment ? fragment->position : obstacle->position;
    const ShvVec3 velocity = fragment ? fragment->velocity : obstacle->velocity;
    const ShvVec3 spin = fragment ? fragment->angular_velocity : obstacle->angular_velocity;
    const ShvQuat orientation = fragment ? fragment->orientation : obstacle->orientation;
    const bool turned = !shv_same3(spin, body->seen_spin) || !shv_same_quat(orientation, body->seen_orientation);
    const bool moved = !shv_same3(position, body->seen_position) || !shv_same3(velocity, body->seen_velocity);
    body->position = body->seen_position = position;
    body->velocity = body->seen_velocity = velocity;
    body->orientation = body->seen_orientation = orientation;
    body->spin = body->seen_spin = spin;
    if (turned && body->moves) body->angular_momentum = shv_free_rotation_momentum(&body->rotation, orientation, spin);
    return turned || moved;
}

void shv_bullet_body_write(ShvBulletRigidBody *body, const ShvRigidWorld *world)
{
    ShvFragment *fragment = body->fragment >= 0 ? &world->fragments->items[body->fragment] : NULL;
    ShvObstacle *obstacle = body->obstacle >= 0 ? &world->obstacles->items[body->obstacle] : NULL;
    body->spin = shv_free_rotation_velocity(&body->rotation, body->orientation, body->angular_momentum);
    *(fragment ? &fragment->position : &obstacle->position) = body->seen_position = body->position;
    *(fragment ? &fragment->velocity : &obstacle->velocity) = body->seen_velocity = body->velocity;
    *(fragment ? &fragment->orientation : &obstacle->orientation) = body->seen_orientation = body->orientation;
    *(fragment ? &fragment->angular_velocity : &obstacle->angular_velocity) = body->seen_spin = body->spin;
}

/* ---- motion ---- */

ShvVec3 shv_bullet_body_position(const ShvBulletRigidBody *body, double time, ShvVec3 gravity)
{
    const ShvVec3 straight = shv_madd(body->position, time, body->velocity);
    return body->moves ? shv_madd(straight, 0.5 * time * time * body->fall, gravity) : straight;
}

ShvQuat shv_bullet_body_orientation(const ShvBulletRigidBody *body, double time)
{
    if (!(time > 0.0)) return body->orientation;
    if (body->moves) return shv_free_rotation_advance(&body->rotation, body->orientation, body->angular_momentum, time);
    return shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(body->spin, time)), body->orientation));
}

ShvVec3 shv_bullet_body_velocity(const ShvBulletRigidBody *body, double time, ShvVec3 gravity)
{
    return body->moves ? shv_madd(body->velocity, time * body->fall, gravity) : body->velocity;
}

ShvVec3 shv_bullet_body_spin(const ShvBulletRigidBody *body, ShvQuat orientation)
{
    if (!body->moves) return body->spin;
    return shv_free_rotation_velocity(&body->rotation, orientation, body->angular_momentum);
}

void shv_bullet_body_place(const ShvBulletRigidBody *body, ShvBulletWorld *bullet, ShvVec3 position,
                           ShvQuat orientation)
{
    const ShvMat3 turned = shv_quat_to_matrix(orientation), axes = shv_multiply(&turned, &body->rotation.axes);
    double origin[3], rows[9];
    shv_store3(origin, position);
    for (int i = 0; i < 9; i++) rows[i] = axes.m[i / 3][i % 3];
    shv_bullet_world_place(bullet, body->number, origin, rows);
}

double shv_bullet_body_energy(const ShvBulletRigidBody *body, ShvVec3 gravity)
{
    return 0.5 * body->mass * shv_dot(body->velocity, body->velocity) +
           shv_free_rotation_energy(&body->rotation, body->orientation, body->angular_momentum) -
           body->mass * shv_dot(gravity, body->position);
}

/* Windows over which a load is averaged at least: one alone may hold a blow. */
static const double fewest_windows = 5.0;

double shv_bullet_body_load(const ShvBulletRigidBody *body)
{
    double sum = 0.0;
    for (int i = 0; i < body->load_count; i++) sum += body->loads[i];
    return sum / fmax(fewest_windows, body->load_count);
}

/* Of the radius of a ball: height of the cap over a face of a regular hull of 64 vertices in it, 124 equal triangles. */
static const double cut_of_radius = 0.04;

double shv_bullet_body_cut(const ShvBulletRigidBody *body, const ShvRigidWorld *world)
{
    if (body->fragment < 0) return 0.0;
    const ShvFragment *fragment = &world->fragments->items[body->fragment];
    const ShvObject *object = &world->model->objects[fragment->object];
    const bool whole = fragment->element_count == object->element_end - object->element_begin;
    return whole ? cut_of_radius * body->radius : 0.0;
}

/* ---- time of impact ---- */

static ShvStatus make_impact_shape(ShvBulletRigidBody *body, const ShvRigidWorld *world, ShvError *error)
{
    if (body->impact) return SHV_OK;
    if (body->fragment >= 0)
        return shv_impact_hulls_create(&body->impact, body->pieces.vertices, body->pieces.vertex_begin,
                                       body->pieces.count, error);
    const ShvObstacle *obstacle = &world->obstacles->items[body->obstacle];
    double three[3];
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        shv_store3(three, obstacle->normal);
        return shv_impact_plane_create(&body->impact, three, obstacle->offset, error);
    case SHV_OBSTACLE_SPHERE:
        return shv_impact_sphere_create(&body->impact, obstacle->radius, error);
    case SHV_OBSTACLE_BOX:
        shv_store3(three, obstacle->half);
        return shv_impact_box_create(&body->impact, three, error);
    case SHV_OBSTACLE_MESH:
        break;
    }
    return shv_impact_mesh_create(&body->impact, obstacle->surface.positions, obstacle->surface.node_count,
                                  obstacle->surface.triangles, obstacle->surface.triangle_count, error);
}

static void turn(const void *data, double time, double orientation[4], double angular_velocity[3])
{
    const ShvBulletRigidBody *body = data;
    const ShvQuat q = shv_bullet_body_orientation(body, time);
    orientation[0] = q.w;
    orientation[1] = q.x;
    orientation[2] = q.y;
    orientation[3] = q.z;
    shv_store3(angular_velocity, shv_free_rotation_velocity(&body->rotation, q, body->angular_momentum));
}

ShvStatus shv_bullet_body_impact_body(ShvBulletRigidBody *body, const ShvRigidWorld *world, ShvVec3 gravity,
                                      ShvImpactBody *impact_body, ShvError *error)
{
    SHV_TRY(make_impact_shape(body, world, error));
    *impact_body = (ShvImpactBody){.shape = body->impact};
    ShvImpactMotion *motion = &impact_body->motion;
    shv_store3(motion->position, body->position);
    shv_store3(motion->velocity, body->velocity);
    if (body->moves) shv_store3(motion->acceleration, shv_scale(gravity, body->fall));
    motion->orientation[0] = body->orientation.w;
    motion->orientation[1] = body->orientation.x;
    motion->orientation[2] = body->orientation.y;
    motion->orientation[3] = body->orientation.z;
    shv_store3(motion->angular_velocity, body->spin);
    if (!body->moves || body->round || body->fastest == 0.0) return SHV_OK;
    motion->turn = turn;
    motion->data = body;
    motion->fastest = body->fastest;
    motion->angular_acceleration = body->rotation.growth * body->fastest * body->fastest;
    return SHV_OK;
}
