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

/* Impulses between fragments, on both. */
static void pass(const ShvBulletContact *contact, ShvBulletFlyer *a, ShvBulletFlyer *b)
{
    if (a->fragment < 0 || b->fragment < 0) return;
    const ShvVec3 impulse =
        shv_madd(shv_load3(contact->friction_impulse), contact->normal_impulse, shv_load3(contact->normal));
    a->passed = shv_add(a->passed, impulse);
    b->passed = shv_sub(b->passed, impulse);
    a->passed_angular = shv_add(a->passed_angular, shv_cross(shv_load3(contact->arm_first), impulse));
    b->passed_angular = shv_sub(b->passed_angular, shv_cross(shv_load3(contact->arm_second), impulse));
}

void shv_bullet_companions_take(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        if (a->leaves || b->leaves) continue;
        for (int32_t k = 0; k < meeting->contact_count; k++) pass(&bullet->contacts[meeting->contact_begin + k], a, b);
    }
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        const ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->companion || flyer->leaves) continue;
        ShvFragment *record = &bullet->backend.world.fragments->items[flyer->fragment];
        record->contact_force = shv_scale(flyer->passed, 1.0 / bullet->step);
        record->contact_torque = shv_scale(flyer->passed_angular, 1.0 / bullet->step);
    }
}
