#include "rigid/bullet_flyer.h"

/* ---- shapes ---- */

static ShvStatus add_pieces(ShvBulletFlyer *flyer, ShvBulletWorld *bullet, ShvError *error)
{
    ShvBodyShape body;
    SHV_TRY(shv_body_shape_of_pieces(&body, &flyer->pieces, &flyer->rotation.axes, flyer->dust, error));
    const ShvStatus status =
        shv_bullet_world_add(bullet, flyer->number, &body.shape, 1.0 / flyer->mass, flyer->rotation.inverse, error);
    shv_body_shape_release(&body);
    return status;
}

ShvStatus shv_bullet_flyer_fragment(ShvBulletFlyer *flyer, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                    int32_t fragment, ShvError *error)
{
    const ShvFragment *record = &world->fragments->items[fragment];
    *flyer = (ShvBulletFlyer){.number = world->obstacles->count + fragment,
                              .fragment = fragment,
                              .obstacle = -1,
                              .moves = true,
                              .fall = 1.0,
                              .mass = record->mass,
                              .dust = record->dust,
                              .born = true};
    if (!(record->mass > 0.0) || !isfinite(record->mass))
        return shv_fail(error, SHV_BAD_INPUT, "fragment %d has the mass %g kg and cannot fly: check the density",
                        (int)record->id, record->mass);
    flyer->rotation = shv_free_rotation_make(&record->inertia);
    SHV_TRY(shv_convex_pieces_make(&flyer->pieces, world->fragments, world->model, world->state, fragment, error));
    const ShvStatus status = add_pieces(flyer, bullet, error);
    if (status != SHV_OK) {
        shv_convex_pieces_release(&flyer->pieces);
        return status == SHV_NO_MEMORY ? status : shv_fail_within(error, status, "fragment %d", (int)record->id);
    }
    flyer->radius = shv_bullet_world_radius(bullet, flyer->number);
    shv_bullet_flyer_read(flyer, world);
    return SHV_OK;
}

ShvStatus shv_bullet_flyer_obstacle(ShvBulletFlyer *flyer, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                    int32_t index, ShvError *error)
{
    const ShvObstacle *obstacle = &world->obstacles->items[index];
    *flyer = (ShvBulletFlyer){.number = index,
                              .fragment = -1,
                              .obstacle = index,
                              .moves = obstacle->motion == SHV_OBSTACLE_FREE,
                              .fall = 1.0,
                              .round = obstacle->shape == SHV_OBSTACLE_SPHERE,
                              .mass = obstacle->mass,
                              .friction = obstacle->friction,
                              .restitution = obstacle->restitution,
                              .born = true};
    flyer->rotation = shv_free_rotation_make(&obstacle->inertia);
    if (!flyer->moves) flyer->rotation.axes = shv_identity();
    ShvBodyShape body;
    SHV_TRY(shv_body_shape_of_obstacle(&body, obstacle, &flyer->rotation.axes, world->fragments->memory, error));
    const ShvStatus status = shv_bullet_world_add(bullet, index, &body.shape, flyer->moves ? 1.0 / flyer->mass : 0.0,
                                                  flyer->rotation.inverse, error);
    shv_body_shape_release(&body);
    if (status == SHV_NO_MEMORY) return status;
    if (status != SHV_OK) return shv_fail_within(error, status, "obstacle %s", obstacle->definition->name);
    flyer->radius = shv_bullet_world_radius(bullet, flyer->number);
    shv_bullet_flyer_read(flyer, world);
    shv_bullet_flyer_place(flyer, bullet, flyer->position, flyer->orientation);
    const double none[3] = {0.0, 0.0, 0.0};
    return shv_bullet_world_reach(bullet, flyer->number, none, 0.0, 0.0, error);
}

void shv_bullet_flyer_release(ShvBulletFlyer *flyer, ShvBulletWorld *bullet)
{
    shv_bullet_world_remove(bullet, flyer->number);
    shv_impact_shape_release(flyer->impact);
    shv_convex_pieces_release(&flyer->pieces);
}

/* ---- records ---- */

static bool same_vector(ShvVec3 a, ShvVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_quaternion(ShvQuat a, ShvQuat b)
{
    return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
}

bool shv_bullet_flyer_read(ShvBulletFlyer *flyer, const ShvRigidWorld *world)
{
    const ShvFragment *fragment = flyer->fragment >= 0 ? &world->fragments->items[flyer->fragment] : NULL;
    const ShvObstacle *obstacle = flyer->obstacle >= 0 ? &world->obstacles->items[flyer->obstacle] : NULL;
    const ShvVec3 position = fragment ? fragment->position : obstacle->position;
    const ShvVec3 velocity = fragment ? fragment->velocity : obstacle->velocity;
    const ShvVec3 spin = fragment ? fragment->angular_velocity : obstacle->angular_velocity;
    const ShvQuat orientation = fragment ? fragment->orientation : obstacle->orientation;
    const bool turned = !same_vector(spin, flyer->seen_spin) || !same_quaternion(orientation, flyer->seen_orientation);
    const bool moved = !same_vector(position, flyer->seen_position) || !same_vector(velocity, flyer->seen_velocity);
    flyer->position = flyer->seen_position = position;
    flyer->velocity = flyer->seen_velocity = velocity;
    flyer->orientation = flyer->seen_orientation = orientation;
    flyer->spin = flyer->seen_spin = spin;
    if (turned && flyer->moves)
        flyer->angular_momentum = shv_free_rotation_momentum(&flyer->rotation, orientation, spin);
    return turned || moved;
}

void shv_bullet_flyer_write(ShvBulletFlyer *flyer, const ShvRigidWorld *world)
{
    ShvFragment *fragment = flyer->fragment >= 0 ? &world->fragments->items[flyer->fragment] : NULL;
    ShvObstacle *obstacle = flyer->obstacle >= 0 ? &world->obstacles->items[flyer->obstacle] : NULL;
    flyer->spin = shv_free_rotation_velocity(&flyer->rotation, flyer->orientation, flyer->angular_momentum);
    *(fragment ? &fragment->position : &obstacle->position) = flyer->seen_position = flyer->position;
    *(fragment ? &fragment->velocity : &obstacle->velocity) = flyer->seen_velocity = flyer->velocity;
    *(fragment ? &fragment->orientation : &obstacle->orientation) = flyer->seen_orientation = flyer->orientation;
    *(fragment ? &fragment->angular_velocity : &obstacle->angular_velocity) = flyer->seen_spin = flyer->spin;
}

/* ---- motion ---- */

ShvVec3 shv_bullet_flyer_position(const ShvBulletFlyer *flyer, double time, ShvVec3 gravity)
{
    const ShvVec3 straight = shv_madd(flyer->position, time, flyer->velocity);
    return flyer->moves ? shv_madd(straight, 0.5 * time * time * flyer->fall, gravity) : straight;
}

ShvQuat shv_bullet_flyer_orientation(const ShvBulletFlyer *flyer, double time)
{
    if (!(time > 0.0)) return flyer->orientation;
    if (flyer->moves)
        return shv_free_rotation_advance(&flyer->rotation, flyer->orientation, flyer->angular_momentum, time);
    return shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(flyer->spin, time)), flyer->orientation));
}

ShvVec3 shv_bullet_flyer_velocity(const ShvBulletFlyer *flyer, double time, ShvVec3 gravity)
{
    return flyer->moves ? shv_madd(flyer->velocity, time * flyer->fall, gravity) : flyer->velocity;
}

ShvVec3 shv_bullet_flyer_spin(const ShvBulletFlyer *flyer, ShvQuat orientation)
{
    if (!flyer->moves) return flyer->spin;
    return shv_free_rotation_velocity(&flyer->rotation, orientation, flyer->angular_momentum);
}

void shv_bullet_flyer_place(const ShvBulletFlyer *flyer, ShvBulletWorld *bullet, ShvVec3 position, ShvQuat orientation)
{
    const ShvMat3 turned = shv_quat_to_matrix(orientation), axes = shv_multiply(&turned, &flyer->rotation.axes);
    double origin[3], rows[9];
    shv_store3(origin, position);
    for (int i = 0; i < 9; i++) rows[i] = axes.m[i / 3][i % 3];
    shv_bullet_world_place(bullet, flyer->number, origin, rows);
}

double shv_bullet_flyer_energy(const ShvBulletFlyer *flyer, ShvVec3 gravity)
{
    return 0.5 * flyer->mass * shv_dot(flyer->velocity, flyer->velocity) +
           shv_free_rotation_energy(&flyer->rotation, flyer->orientation, flyer->angular_momentum) -
           flyer->mass * shv_dot(gravity, flyer->position);
}

double shv_bullet_flyer_load(const ShvBulletFlyer *flyer)
{
    double sum = 0.0;
    for (int i = 0; i < flyer->load_count; i++) sum += flyer->loads[i];
    return sum / fmax(5.0, flyer->load_count);
}

/* ---- time of impact ---- */

static ShvStatus make_impact_shape(ShvBulletFlyer *flyer, const ShvRigidWorld *world, ShvError *error)
{
    if (flyer->impact) return SHV_OK;
    if (flyer->fragment >= 0)
        return shv_impact_hulls_create(&flyer->impact, flyer->pieces.vertices, flyer->pieces.vertex_begin,
                                       flyer->pieces.count, error);
    const ShvObstacle *obstacle = &world->obstacles->items[flyer->obstacle];
    double three[3];
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        shv_store3(three, obstacle->normal);
        return shv_impact_plane_create(&flyer->impact, three, obstacle->offset, error);
    case SHV_OBSTACLE_SPHERE:
        return shv_impact_sphere_create(&flyer->impact, obstacle->radius, error);
    case SHV_OBSTACLE_BOX:
        shv_store3(three, obstacle->half);
        return shv_impact_box_create(&flyer->impact, three, error);
    case SHV_OBSTACLE_MESH:
        break;
    }
    return shv_impact_mesh_create(&flyer->impact, obstacle->surface.positions, obstacle->surface.node_count,
                                  obstacle->surface.triangles, obstacle->surface.triangle_count, error);
}

static void turn(const void *data, double time, double orientation[4], double angular_velocity[3])
{
    const ShvBulletFlyer *flyer = data;
    const ShvQuat q = shv_bullet_flyer_orientation(flyer, time);
    orientation[0] = q.w;
    orientation[1] = q.x;
    orientation[2] = q.y;
    orientation[3] = q.z;
    shv_store3(angular_velocity, shv_free_rotation_velocity(&flyer->rotation, q, flyer->angular_momentum));
}

ShvStatus shv_bullet_flyer_impact_body(ShvBulletFlyer *flyer, const ShvRigidWorld *world, ShvVec3 gravity,
                                       ShvImpactBody *body, ShvError *error)
{
    SHV_TRY(make_impact_shape(flyer, world, error));
    *body = (ShvImpactBody){.shape = flyer->impact};
    ShvImpactMotion *motion = &body->motion;
    shv_store3(motion->position, flyer->position);
    shv_store3(motion->velocity, flyer->velocity);
    if (flyer->moves) shv_store3(motion->acceleration, shv_scale(gravity, flyer->fall));
    motion->orientation[0] = flyer->orientation.w;
    motion->orientation[1] = flyer->orientation.x;
    motion->orientation[2] = flyer->orientation.y;
    motion->orientation[3] = flyer->orientation.z;
    shv_store3(motion->angular_velocity, flyer->spin);
    if (!flyer->moves || flyer->round || flyer->fastest == 0.0) return SHV_OK;
    motion->turn = turn;
    motion->data = flyer;
    motion->fastest = flyer->fastest;
    motion->angular_acceleration = flyer->rotation.growth * flyer->fastest * flyer->fastest;
    return SHV_OK;
}
