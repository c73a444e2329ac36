#include "rigid/bullet_step.h"
#include "rigid/disjoint_sets.h"

/* ---- what the other side weighs ---- */

/* Islands of what touched before this step; the lowest place stands for all. */
static ShvStatus find_heaps(ShvBullet *bullet, ShvError *error)
{
    ShvBulletFlyer *flyers = bullet->flyers;
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->heaps, bullet->heap_room, bullet->flyer_count, "heaps", error);
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        bullet->heaps[i] = i;
        flyers[i].heap_mass = flyers[i].moves ? flyers[i].mass : (double)INFINITY;
    }
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (!meeting->touched) continue;
        const int32_t a = shv_set_root(bullet->heaps, meeting->a), b = shv_set_root(bullet->heaps, meeting->b);
        if (!flyers[meeting->a].moves || !flyers[meeting->b].moves) { /* a support holds a heap, it does not join two */
            flyers[flyers[meeting->a].moves ? a : b].heap_mass = (double)INFINITY;
            continue;
        }
        if (a == b) continue;
        flyers[a < b ? a : b].heap_mass += flyers[a < b ? b : a].heap_mass;
        shv_set_join(bullet->heaps, a, b);
    }
    return SHV_OK;
}

static double other_mass(ShvBullet *bullet, int32_t own, int32_t other)
{
    if (!bullet->flyers[other].moves) return (double)INFINITY;
    const int32_t heap = shv_set_root(bullet->heaps, other);
    const double mass = bullet->flyers[heap].heap_mass;
    return heap == shv_set_root(bullet->heaps, own) && isfinite(mass) ? mass - bullet->flyers[own].mass : mass;
}

/* ---- contacts of one side ---- */

/* The contact of a meeting that closes fastest, at the meeting's moment. */
static const ShvBulletContact *fastest_contact(const ShvBullet *bullet, const ShvBulletMeeting *meeting,
                                               double *closing)
{
    const ShvBulletFlyer *pair[2] = {&bullet->flyers[meeting->a], &bullet->flyers[meeting->b]};
    const double moment = meeting->struck ? meeting->impact : 0.0;
    ShvVec3 velocity[2], spin[2];
    for (int i = 0; i < 2; i++) {
        velocity[i] = shv_bullet_flyer_velocity(pair[i], moment, bullet->gravity);
        spin[i] = shv_bullet_flyer_spin(pair[i], shv_bullet_flyer_orientation(pair[i], moment));
    }
    const ShvBulletContact *fastest = NULL;
    for (int32_t i = 0; i < meeting->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + i];
        const double speed = -shv_dot(shv_load3(contact->normal),
                                      shv_bullet_relative(contact, velocity[0], spin[0], velocity[1], spin[1]));
        if (!meeting->struck && contact->gap + meeting->allowance > meeting->slop) continue;
        if (fastest && speed <= *closing) continue;
        fastest = contact;
        *closing = speed;
    }
    return fastest;
}

static ShvRigidContact report(ShvBullet *bullet, const ShvBulletMeeting *meeting, const ShvBulletContact *contact,
                              double closing, bool first)
{
    const int32_t own = first ? meeting->a : meeting->b, other = first ? meeting->b : meeting->a;
    const ShvBulletFlyer *flyer = &bullet->flyers[own];
    const double moment = meeting->struck ? meeting->impact : 0.0;
    const ShvVec3 centre = shv_bullet_flyer_position(flyer, moment, bullet->gravity);
    return (ShvRigidContact){.fragment = flyer->fragment,
                             .obstacle = bullet->flyers[other].obstacle,
                             .other = bullet->flyers[other].fragment,
                             .time = bullet->time + moment,
                             .point = shv_add(centre, shv_load3(first ? contact->arm_first : contact->arm_second)),
                             .normal = shv_scale(shv_load3(contact->normal), first ? 1.0 : -1.0),
                             .closing_speed = fmax(0.0, closing),
                             .fresh = !meeting->touched,
                             .other_mass = other_mass(bullet, own, other),
                             .load = shv_bullet_flyer_load(flyer)};
}

/* Leaves flight as it is at the contact's moment. What it hit waits there for the rest of the step, so that it does not get
   into what is no longer in its world. */
static void take_out(ShvBullet *bullet, int32_t own, int32_t other, double moment)
{
    ShvBulletFlyer *flyer = &bullet->flyers[own], *partner = &bullet->flyers[other];
    flyer->leaves = true;
    if (partner->moves && (partner->fragment >= 0 || partner->impact_time >= 0.0))
        partner->until = fmin(partner->until, moment);
    if (flyer->companion) return; /* it will be there when somebody else has led it there */
    const ShvQuat orientation = shv_bullet_flyer_orientation(flyer, moment);
    const bool supported = shv_bullet_flyer_load(flyer) > 0.0;
    const double before = shv_bullet_flyer_energy(flyer, bullet->gravity);
    flyer->position = shv_bullet_flyer_position(flyer, moment, bullet->gravity);
    if (!supported) flyer->velocity = shv_bullet_flyer_velocity(flyer, moment, bullet->gravity);
    flyer->orientation = orientation;
    shv_bullet_flyer_write(flyer, &bullet->backend.world);
    if (supported) /* what holds it has worked */
        bullet->backend.contact_work += shv_bullet_flyer_energy(flyer, bullet->gravity) - before;
}

static void judge_meeting(ShvBullet *bullet, const ShvBulletMeeting *meeting, ShvWakeJudge judge, void *judge_data,
                          ShvRigidContact *wakes, int32_t *wake_count)
{
    if (meeting->contact_count == 0 || bullet->flyers[meeting->a].leaves || bullet->flyers[meeting->b].leaves) return;
    double closing = 0.0;
    const ShvBulletContact *contact = fastest_contact(bullet, meeting, &closing);
    if (!contact) return;
    bool accepted[2] = {false, false};
    ShvRigidContact contacts[2];
    for (int side = 0; side < 2; side++) {
        if (bullet->flyers[side ? meeting->b : meeting->a].fragment < 0) continue;
        contacts[side] = report(bullet, meeting, contact, closing, side == 0);
        accepted[side] = judge(judge_data, &contacts[side]);
    }
    for (int side = 0; side < 2; side++) {
        if (!accepted[side]) continue;
        wakes[(*wake_count)++] = contacts[side];
        take_out(bullet, side ? meeting->b : meeting->a, side ? meeting->a : meeting->b,
                 meeting->struck ? meeting->impact : 0.0);
    }
}

ShvStatus shv_bullet_judge(ShvBullet *bullet, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                           int32_t *wake_count, ShvError *error)
{
    if (!judge) return SHV_OK;
    SHV_TRY(find_heaps(bullet, error));
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->found && meeting->touching && !meeting->struck)
            judge_meeting(bullet, meeting, judge, judge_data, wakes, wake_count);
    }
    for (int32_t k = 0; k < bullet->order_count; k++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[bullet->order[k].meeting];
        if (meeting->struck) judge_meeting(bullet, meeting, judge, judge_data, wakes, wake_count);
    }
    return SHV_OK;
}
