#include "rigid/bullet_step.h"

/* Of the smaller radius: motion after an impact that is looked at again; and of two that have met each other in it. */
static const double small_motion_of_radius = 0.2, parting_motion_of_radius = 0.5;

/* Of the smaller body's size: so near to what it would meet a body waits. It need not touch: half the cost of a pile at 10 ms
   went into the last digits of where it does. */
static const double waiting_gap = 1e-3;

/* The body as it flies on from a moment of the step, after the solution. */
static ShvBulletFlyer from_moment(const ShvBullet *bullet, const ShvBulletFlyer *flyer, double moment)
{
    ShvBulletFlyer later = *flyer;
    if (flyer->asleep) {
        later.fall = 0.0;
        return later;
    }
    const double own = fmax(0.0, flyer->impact_time);
    if (!flyer->moves || !flyer->solved) {
        later.position = shv_bullet_flyer_position(flyer, moment, bullet->gravity);
        later.orientation = shv_bullet_flyer_orientation(flyer, moment);
        later.velocity = shv_bullet_flyer_velocity(flyer, moment, bullet->gravity);
        return later;
    }
    const ShvVec3 change = shv_sub(flyer->new_spin, flyer->solver_spin);
    later.angular_momentum = shv_add(flyer->angular_momentum,
                                     shv_free_rotation_momentum(&flyer->rotation, flyer->solver_orientation, change));
    /* what holds it against gravity does so evenly */
    later.velocity =
        shv_madd(flyer->new_velocity, flyer->stopped ? 0.0 : (moment - bullet->step) * flyer->fall, bullet->gravity);
    later.position = shv_bullet_flyer_position(flyer, own, bullet->gravity);
    later.position = shv_madd(later.position, moment - own, later.velocity);
    later.orientation =
        shv_free_rotation_advance(&flyer->rotation, flyer->solver_orientation, later.angular_momentum, moment - own);
    later.spin = shv_free_rotation_velocity(&later.rotation, later.orientation, later.angular_momentum);
    later.fastest = shv_free_rotation_fastest(&later.rotation, later.orientation, later.angular_momentum);
    return later;
}

/* Whether the balls around two bodies touch on their ways. */
static bool paths_meet(const ShvBullet *bullet, const ShvBulletFlyer *a, const ShvBulletFlyer *b, double left)
{
    const double radii = a->radius + b->radius + shv_norm(bullet->gravity) * left * left;
    if (!isfinite(radii)) return true;
    const ShvVec3 apart = shv_sub(a->position, b->position), way = shv_scale(shv_sub(a->velocity, b->velocity), left);
    const double length = shv_dot(way, way);
    const double share = length > 0.0 ? fmin(1.0, fmax(0.0, -shv_dot(apart, way) / length)) : 0.0;
    return shv_norm(shv_madd(apart, share, way)) <= radii;
}

/* Two bodies of which one has been struck, on their way to the step's end: where they meet again they wait. */
static ShvStatus guard_pair(ShvBullet *bullet, ShvBulletFlyer *a, ShvBulletFlyer *b, ShvError *error)
{
    ShvBulletFlyer *pair[2] = {a, b};
    const double moment = fmax(0.0, fmax(a->impact_time, b->impact_time));
    const double left = bullet->step - moment;
    if (!(left > 0.0)) return SHV_OK;
    ShvBulletFlyer later[2] = {from_moment(bullet, a, moment), from_moment(bullet, b, moment)};
    double way = shv_norm(shv_sub(later[0].velocity, later[1].velocity)) * left;
    for (int i = 0; i < 2; i++)
        if (!later[i].round && later[i].fastest > 0.0) way += fmin(2.0, later[i].fastest * left) * later[i].radius;
    const bool parted = a->moves && b->moves && a->impact_time >= 0.0 && a->impact_time == b->impact_time;
    const double share = parted ? parting_motion_of_radius : small_motion_of_radius;
    if (way <= share * fmin(a->radius, b->radius)) return SHV_OK;
    if (!paths_meet(bullet, &later[0], &later[1], left)) return SHV_OK;
    ShvImpactBody bodies[2];
    for (int i = 0; i < 2; i++) {
        SHV_TRY(shv_bullet_flyer_impact_body(&later[i], &bullet->backend.world, bullet->gravity, &bodies[i], error));
        pair[i]->impact = later[i].impact; /* made by now */
    }
    const ShvImpactSettings settings = {.step = left, .tolerance = waiting_gap, .slowest = bullet->rest};
    bool found;
    ShvImpact impact;
    SHV_TRY(shv_impact_time(&bodies[0], &bodies[1], &settings, &found, &impact, error));
    if (!found || impact.time <= 0.0) return SHV_OK;
    for (int i = 0; i < 2; i++)
        if (pair[i]->moves) pair[i]->until = fmin(pair[i]->until, moment + impact.time);
    return SHV_OK;
}

/* Of what has been thrown off the way on which pairs were found, the new one. */
static ShvStatus find_new_way(ShvBullet *bullet, ShvBulletFlyer *flyer, double smallest, ShvError *error)
{
    const double left = bullet->step - flyer->impact_time;
    const double turn = flyer->round ? 0.0 : shv_norm(shv_sub(flyer->new_spin, flyer->solver_spin)) * flyer->radius;
    const ShvVec3 before = shv_bullet_flyer_velocity(flyer, bullet->step, bullet->gravity);
    const double change = shv_norm(shv_sub(flyer->new_velocity, before)) + turn;
    if (!(change * left > small_motion_of_radius * smallest)) return SHV_OK;
    flyer->thrown = true;
    const ShvBulletFlyer later = from_moment(bullet, flyer, flyer->impact_time);
    shv_bullet_flyer_place(&later, bullet->bullet, later.position, later.orientation);
    return shv_bullet_reach(bullet, &later, left, error);
}

static ShvStatus guard_flyer(ShvBullet *bullet, ShvBulletFlyer *flyer, ShvError *error)
{
    const int32_t *others;
    int32_t count;
    SHV_TRY(shv_bullet_world_near(bullet->bullet, flyer->number, &others, &count, error));
    for (int32_t k = 0; k < count; k++) {
        ShvBulletFlyer *other = &bullet->flyers[shv_bullet_place(bullet, others[k])];
        if (other->leaves || (other->thrown && other->number < flyer->number)) continue;
        if (!shv_bullet_leaves_pair(flyer, other)) SHV_TRY(guard_pair(bullet, flyer, other, error));
    }
    return SHV_OK;
}

ShvStatus shv_bullet_guard(ShvBullet *bullet, ShvError *error)
{
    if (!bullet->backend.world.settings->bullet.times_of_impact) return SHV_OK;
    double smallest = (double)INFINITY;
    for (int32_t i = 0; i < bullet->flyer_count; i++) smallest = fmin(smallest, bullet->flyers[i].radius);
    bool any = false;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->moves || !flyer->solved || flyer->impact_time < 0.0 || flyer->leaves) continue;
        SHV_TRY(find_new_way(bullet, flyer, smallest, error));
        any |= flyer->thrown;
    }
    for (int32_t i = 0; any && i < bullet->flyer_count; i++)
        if (bullet->flyers[i].thrown) SHV_TRY(guard_flyer(bullet, &bullet->flyers[i], error));
    return SHV_OK;
}
