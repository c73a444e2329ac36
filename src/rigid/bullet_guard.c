#include "rigid/bullet_step.h"

/* Of the smaller radius: motion after an impact that is looked at again. */
static const double small_motion_of_radius = 0.2;

/* The body as it flies on from a moment of the step, after the solution. */
static ShvBulletFlyer from_moment(const ShvBullet *bullet, const ShvBulletFlyer *flyer, double moment)
{
    ShvBulletFlyer later = *flyer;
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

/* Two bodies of which one has been struck, on their way to the step's end: where they meet again they wait. */
static ShvStatus guard_pair(ShvBullet *bullet, const ShvBulletMeeting *meeting, ShvError *error)
{
    ShvBulletFlyer *pair[2] = {&bullet->flyers[meeting->a], &bullet->flyers[meeting->b]};
    const double moment = fmax(0.0, fmax(pair[0]->impact_time, pair[1]->impact_time));
    const double left = bullet->step - moment;
    if (!(left > 0.0)) return SHV_OK;
    ShvBulletFlyer later[2] = {from_moment(bullet, pair[0], moment), from_moment(bullet, pair[1], moment)};
    double way = shv_norm(shv_sub(later[0].velocity, later[1].velocity)) * left;
    for (int i = 0; i < 2; i++)
        if (!later[i].round && later[i].fastest > 0.0) way += fmin(2.0, later[i].fastest * left) * later[i].radius;
    if (way <= small_motion_of_radius * fmin(pair[0]->radius, pair[1]->radius)) return SHV_OK;
    ShvImpactBody bodies[2];
    for (int i = 0; i < 2; i++) {
        SHV_TRY(shv_bullet_flyer_impact_body(&later[i], &bullet->backend.world, bullet->gravity, &bodies[i], error));
        pair[i]->impact = later[i].impact; /* made by now */
    }
    const ShvImpactSettings settings = {.step = left, .tolerance = 1e-6, .slowest = bullet->rest};
    bool found;
    ShvImpact impact;
    SHV_TRY(shv_impact_time(&bodies[0], &bodies[1], &settings, &found, &impact, error));
    if (!found || impact.time <= 0.0) return SHV_OK;
    for (int i = 0; i < 2; i++)
        if (pair[i]->moves) pair[i]->until = fmin(pair[i]->until, moment + impact.time);
    return SHV_OK;
}

ShvStatus shv_bullet_guard(ShvBullet *bullet, ShvError *error)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        const bool struck = (a->moves && a->impact_time >= 0.0) || (b->moves && b->impact_time >= 0.0);
        if (!meeting->found || !struck || a->leaves || b->leaves) continue;
        SHV_TRY(guard_pair(bullet, meeting, error));
    }
    return SHV_OK;
}
