#include "rigid/bullet_step.h"

/* What else acts on a companion is known to whoever moves it only. It has moved in the last step as far as the others let
   it: by all of what gravity and the contacts known here asked for, or by none of it, when it is held. The same share is taken
   for this step: something heavy stands on a companion on the floor without pressing it in, and falls with one that falls. */
static double moved_share(const ShvBullet *bullet, const ShvBulletFlyer *flyer)
{
    const ShvVec3 asked = shv_madd(shv_scale(flyer->passed, 1.0 / flyer->mass), bullet->last_step, bullet->gravity);
    const ShvVec3 turning = shv_free_rotation_velocity(&flyer->rotation, flyer->orientation, flyer->passed_angular);
    const double all = flyer->mass * shv_dot(asked, asked) + shv_dot(flyer->passed_angular, turning);
    if (flyer->born || !(all > 0.0)) return 1.0;
    const ShvVec3 change = shv_sub(flyer->velocity, flyer->last_velocity);
    const ShvVec3 turned = shv_sub(flyer->angular_momentum, flyer->last_angular_momentum);
    const double part = flyer->mass * shv_dot(change, asked) + shv_dot(turned, turning);
    return fmin(1.0, fmax(0.0, part / all));
}

void shv_bullet_companion_begin(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    if (flyer->fragment < 0) return;
    ShvFragment *record = &bullet->backend.world.fragments->items[flyer->fragment];
    const bool was = flyer->companion;
    record->contact_force = record->contact_torque = shv_vec3(0.0, 0.0, 0.0);
    record->contact_power = record->contact_slack = record->contact_untaken = 0.0;
    flyer->companion = record->companion;
    flyer->fall = 1.0;
    if (flyer->companion) {
        flyer->fall = moved_share(bullet, flyer);
        flyer->asleep = flyer->settled = false;
        flyer->still = 0;
    } else if (was) {
        flyer->born = true; /* among what it touches, however close */
    }
    flyer->last_velocity = flyer->velocity;
    flyer->last_angular_momentum = flyer->angular_momentum;
    flyer->passed = flyer->passed_angular = shv_vec3(0.0, 0.0, 0.0);
    flyer->passed_work = flyer->passed_slack = flyer->passed_speed = 0.0;
}

bool shv_bullet_flyer_holds(const ShvBulletFlyer *flyer)
{
    return !flyer->moves || (flyer->companion && flyer->fall < 0.5);
}

bool shv_bullet_leaves_pair(const ShvBulletFlyer *a, const ShvBulletFlyer *b)
{
    if ((a->dust || b->dust) && a->fragment >= 0 && b->fragment >= 0) return true;
    return (a->companion && (b->companion || b->obstacle >= 0)) || (b->companion && a->obstacle >= 0);
}

static double work(ShvVec3 impulse, ShvVec3 velocity, ShvVec3 spin, ShvVec3 arm)
{
    return shv_dot(impulse, shv_add(velocity, shv_cross(spin, arm)));
}

/* Most work that an impulse on a flyer does while what gives it keeps up: with the velocity that either has after the step or the
   other had before, and half as fast again as they closed or fall. */
static void bound_work(const ShvBullet *bullet, ShvVec3 impulse, ShvVec3 relative, ShvBulletFlyer *flyer, ShvVec3 arm,
                       const ShvBulletFlyer *other, ShvVec3 other_arm)
{
    const double before = work(impulse, other->velocity, other->spin, other_arm);
    const double after = work(impulse, other->new_velocity, other->new_spin, other_arm);
    const double own = work(impulse, flyer->new_velocity, flyer->new_spin, arm);
    const double slack = shv_norm(impulse) * (0.5 * shv_norm(relative) + 2.0 * bullet->rest);
    flyer->passed_work += fmax(own, fmax(before, after)) + slack;
    flyer->passed_slack += slack;
    flyer->passed_speed = fmax(flyer->passed_speed, shv_norm(relative));
}

/* Impulses between fragments, on both. */
static void pass(const ShvBullet *bullet, const ShvBulletContact *contact, ShvBulletFlyer *a, ShvBulletFlyer *b)
{
    if (a->fragment < 0 || b->fragment < 0) return;
    const ShvVec3 impulse = shv_bullet_impulse(contact);
    const ShvVec3 opposite = shv_scale(impulse, -1.0);
    const ShvVec3 arm_a = shv_load3(contact->arm_first), arm_b = shv_load3(contact->arm_second);
    const ShvVec3 relative = shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin);
    a->passed = shv_add(a->passed, impulse);
    b->passed = shv_add(b->passed, opposite);
    a->passed_angular = shv_add(a->passed_angular, shv_cross(arm_a, impulse));
    b->passed_angular = shv_add(b->passed_angular, shv_cross(arm_b, opposite));
    bound_work(bullet, impulse, relative, a, arm_a, b, arm_b);
    bound_work(bullet, opposite, relative, b, arm_b, a, arm_a);
}

void shv_bullet_companions_take(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        ShvBulletMeeting *meeting = &bullet->meetings[i];
        ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        if (a->leaves || b->leaves) continue;
        meeting->passes = b->fragment < 0 || a->fragment < 0 ? 0 : a->companion ? 1 : b->companion ? 2 : 0;
        for (int32_t k = 0; k < meeting->contact_count; k++)
            pass(bullet, &bullet->contacts[meeting->contact_begin + k], a, b);
    }
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        const ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->companion || flyer->leaves) continue;
        ShvFragment *record = &bullet->backend.world.fragments->items[flyer->fragment];
        record->contact_force = shv_scale(flyer->passed, 1.0 / bullet->step);
        record->contact_torque = shv_scale(flyer->passed_angular, 1.0 / bullet->step);
        record->contact_power = flyer->passed_work / bullet->step;
        record->contact_slack = flyer->passed_slack / bullet->step;
    }
}

/* ---- what was not taken ---- */

static ShvFragment *record_of(const ShvBullet *bullet, int32_t number)
{
    return &bullet->backend.world.fragments->items[number - bullet->backend.world.obstacles->count];
}

static void add_untaken(ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    const bool first = meeting->passes == 1;
    const double share = record_of(bullet, first ? meeting->first : meeting->second)->contact_untaken / bullet->step;
    const int32_t place = shv_bullet_place(bullet, first ? meeting->second : meeting->first);
    if (share == 0.0 || place < 0) return;
    ShvBulletFlyer *giver = &bullet->flyers[place];
    for (int32_t k = 0; k < meeting->contact_count; k++) {
        const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + k];
        const ShvVec3 impulse = shv_bullet_impulse(contact);
        const ShvVec3 back = shv_scale(impulse, first ? share : -share);
        const ShvVec3 arm = shv_load3(first ? contact->arm_second : contact->arm_first);
        giver->returned = shv_add(giver->returned, back);
        giver->returned_angular = shv_add(giver->returned_angular, shv_cross(arm, back));
    }
}

/* Companions that come to each other, as nothing here knows that they are not held so fast, may have squeezed it at will: it gets
   back no more than brings it from what the step made of it to what it was, and as much again as it met them with. */
static void give_back(ShvBullet *bullet, const ShvBulletFlyer *flyer)
{
    ShvFragment *record = &bullet->backend.world.fragments->items[flyer->fragment];
    const ShvMat3 inverse = shv_free_rotation_world_inverse(&flyer->rotation, record->orientation);
    const ShvVec3 turn = shv_apply(&inverse, flyer->returned_angular);
    const double size =
        sqrt(shv_dot(flyer->returned, flyer->returned) / flyer->mass + shv_dot(flyer->returned_angular, turn));
    const double most = sqrt(flyer->mass) * (shv_norm(shv_sub(record->velocity, flyer->last_velocity)) +
                                             flyer->passed_speed + 2.0 * bullet->rest);
    const double share = size > most ? most / size : 1.0, before = shv_fragment_kinetic(record);
    record->velocity = shv_madd(record->velocity, share / flyer->mass, flyer->returned);
    record->angular_velocity = shv_madd(record->angular_velocity, share, turn);
    bullet->backend.contact_work += shv_fragment_kinetic(record) - before;
}

void shv_bullet_take_back(ShvRigidBackend *backend)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    for (int32_t i = 0; i < bullet->flyer_count; i++)
        bullet->flyers[i].returned = bullet->flyers[i].returned_angular = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = 0; i < bullet->meeting_count; i++)
        if (bullet->meetings[i].passes) add_untaken(bullet, &bullet->meetings[i]);
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->passes)
            record_of(bullet, meeting->passes == 1 ? meeting->first : meeting->second)->contact_untaken = 0.0;
    }
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        const ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->gone && shv_norm(flyer->returned) > 0.0) give_back(bullet, flyer);
    }
}
