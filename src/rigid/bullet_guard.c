#include "rigid/bullet_step.h"

/* Of the smaller radius: motion after an impact that is looked at again; and of two that have met each other in it. */
static const double small_motion_of_radius = 0.2, separating_motion_of_radius = 0.5;

/* Of the smaller body's size: so near to what it would meet a body waits. It need not touch: half the cost of a pile at 10 ms
   went into the last digits of where it does. */
static const double waiting_gap = 1e-3;

/* The body as it flies on from a time of the step, after the solution. */
static ShvBulletRigidBody from_time(const ShvBullet *bullet, const ShvBulletRigidBody *body, double time)
{
    ShvBulletRigidBody later = *body;
    if (body->asleep) {
        later.fall = 0.0;
        return later;
    }
    const double own = fmax(0.0, body->impact_time);
    if (!body->moves || !body->solved) {
        later.position = shv_bullet_body_position(body, time, bullet->gravity);
        later.orientation = shv_bullet_body_orientation(body, time);
        later.velocity = shv_bullet_body_velocity(body, time, bullet->gravity);
        return later;
    }
    const ShvVec3 change = shv_sub(body->new_spin, body->solver_spin);
    later.angular_momentum =
        shv_add(body->angular_momentum, shv_free_rotation_momentum(&body->rotation, body->solver_orientation, change));
    /* what holds it against gravity does so evenly */
    later.velocity =
        shv_madd(body->new_velocity, body->stopped ? 0.0 : (time - bullet->step) * body->fall, bullet->gravity);
    later.position = shv_bullet_body_position(body, own, bullet->gravity);
    later.position = shv_madd(later.position, time - own, later.velocity);
    later.orientation =
        shv_free_rotation_advance(&body->rotation, body->solver_orientation, later.angular_momentum, time - own);
    later.spin = shv_free_rotation_velocity(&later.rotation, later.orientation, later.angular_momentum);
    later.fastest = shv_free_rotation_fastest(&later.rotation, later.orientation, later.angular_momentum);
    return later;
}

/* Two bodies of which one has been struck, on their way to the step's end: where they meet again they wait. */
static ShvStatus guard_pair(ShvBullet *bullet, ShvBulletRigidBody *a, ShvBulletRigidBody *b, ShvError *error)
{
    ShvBulletRigidBody *pair[2] = {a, b};
    const double time = fmax(0.0, fmax(a->impact_time, b->impact_time));
    const double left = bullet->step - time;
    if (!(left > 0.0)) return SHV_OK;
    ShvBulletRigidBody later[2] = {from_time(bullet, a, time), from_time(bullet, b, time)};
    double displacement = shv_norm(shv_sub(later[0].velocity, later[1].velocity)) * left;
    for (int i = 0; i < 2; i++)
        if (!later[i].round && later[i].fastest > 0.0)
            displacement += fmin(2.0, later[i].fastest * left) * later[i].radius;
    const bool separate = a->moves && b->moves && a->impact_time >= 0.0 && a->impact_time == b->impact_time;
    const double share = separate ? separating_motion_of_radius : small_motion_of_radius;
    if (displacement <= share * fmin(a->radius, b->radius)) return SHV_OK;
    if (!shv_bullet_paths_meet(bullet, &later[0], &later[1], left)) return SHV_OK;
    ShvImpactBody bodies[2];
    for (int i = 0; i < 2; i++) {
        SHV_TRY(shv_bullet_body_impact_body(&later[i], &bullet->backend.world, bullet->gravity, &bodies[i], error));
        pair[i]->impact = later[i].impact; /* made by now */
    }
    const ShvImpactSettings settings = {.step = left, .tolerance = waiting_gap, .slowest = bullet->rest};
    bool found;
    ShvImpact impact;
    SHV_TRY(shv_impact_time(&bodies[0], &bodies[1], &settings, &found, &impact, error));
    if (!found || impact.time <= 0.0) return SHV_OK;
    for (int i = 0; i < 2; i++)
        if (pair[i]->moves) pair[i]->until = fmin(pair[i]->until, time + impact.time);
    return SHV_OK;
}

/* Of what has been thrown off the way on which pairs were found, by its impact or by what it touches, or meets more on it, the new
   one. */
static ShvStatus find_new_way(ShvBullet *bullet, ShvBulletRigidBody *body, double smallest, ShvError *error)
{
    const double since = fmax(0.0, body->impact_time), left = bullet->step - since;
    const double turn = body->round ? 0.0 : shv_norm(shv_sub(body->new_spin, body->solver_spin)) * body->radius;
    const ShvVec3 before = shv_bullet_body_velocity(body, bullet->step, bullet->gravity);
    const double change = shv_norm(shv_sub(body->new_velocity, before)) + turn;
    if (!(change * left > small_motion_of_radius * smallest) && !body->later_impact) return SHV_OK;
    body->thrown = true;
    const ShvBulletRigidBody later = from_time(bullet, body, since);
    shv_bullet_body_place(&later, bullet->bullet, later.position, later.orientation);
    return shv_bullet_reach(bullet, &later, left, error);
}

static ShvStatus guard_body(ShvBullet *bullet, ShvBulletRigidBody *body, ShvError *error)
{
    const int32_t *others;
    int32_t count;
    SHV_TRY(shv_bullet_world_near(bullet->bullet, body->number, &others, &count, error));
    for (int32_t k = 0; k < count; k++) {
        ShvBulletRigidBody *other = &bullet->bodies[shv_bullet_place(bullet, others[k])];
        if (other->leaves || (other->thrown && other->number < body->number)) continue;
        if (!shv_bullet_leaves_pair(body, other)) SHV_TRY(guard_pair(bullet, body, other, error));
    }
    return SHV_OK;
}

ShvStatus shv_bullet_guard(ShvBullet *bullet, ShvError *error)
{
    if (!bullet->backend.world.settings->bullet.times_of_impact) return SHV_OK;
    double smallest = (double)INFINITY;
    for (int32_t i = 0; i < bullet->body_count; i++) smallest = fmin(smallest, bullet->bodies[i].radius);
    bool any = false;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!body->moves || !body->solved || body->leaves) continue;
        SHV_TRY(find_new_way(bullet, body, smallest, error));
        any |= body->thrown;
    }
    for (int32_t i = 0; any && i < bullet->body_count; i++)
        if (bullet->bodies[i].thrown) SHV_TRY(guard_body(bullet, &bullet->bodies[i], error));
    return SHV_OK;
}
