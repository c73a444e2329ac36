#include "base/disjoint_sets.h"
#include "rigid/bullet_step.h"

/* ---- what the other side weighs ---- */

/* Islands of what touched before this step; the lowest place stands for all. */
static ShvStatus find_heaps(ShvBullet *bullet, ShvError *error)
{
    ShvBulletRigidBody *bodies = bullet->bodies;
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->heaps, bullet->heap_room, bullet->body_count, "heaps", error);
    for (int32_t i = 0; i < bullet->body_count; i++) {
        bullet->heaps[i] = i;
        bodies[i].heap_mass = bodies[i].moves ? bodies[i].mass : (double)INFINITY;
    }
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (!contact_pair->touched) continue;
        const int32_t a = shv_set_root(bullet->heaps, contact_pair->a),
                      b = shv_set_root(bullet->heaps, contact_pair->b);
        if (!bodies[contact_pair->a].moves ||
            !bodies[contact_pair->b].moves) { /* a support holds a heap, it does not join two */
            bodies[bodies[contact_pair->a].moves ? a : b].heap_mass = (double)INFINITY;
            continue;
        }
        if (a == b) continue;
        bodies[a < b ? a : b].heap_mass += bodies[a < b ? b : a].heap_mass;
        shv_set_join(bullet->heaps, a, b);
    }
    return SHV_OK;
}

static double other_mass(ShvBullet *bullet, int32_t own, int32_t other)
{
    if (!bullet->bodies[other].moves) return (double)INFINITY;
    const int32_t heap = shv_set_root(bullet->heaps, other);
    const double mass = bullet->bodies[heap].heap_mass;
    return heap == shv_set_root(bullet->heaps, own) && isfinite(mass) ? mass - bullet->bodies[own].mass : mass;
}

/* ---- contacts of one side ---- */

/* The contact of a contact pair that closes fastest, at the contact pair's time of impact. */
static const ShvBulletContact *fastest_contact(const ShvBullet *bullet, const ShvContactPair *contact_pair,
                                               double *closing)
{
    const ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
    const double time = contact_pair->struck ? contact_pair->impact : 0.0;
    ShvVec3 velocity[2], spin[2];
    for (int i = 0; i < 2; i++) {
        velocity[i] = shv_bullet_body_velocity(pair[i], time, bullet->gravity);
        spin[i] = shv_bullet_body_spin(pair[i], shv_bullet_body_orientation(pair[i], time));
    }
    const ShvBulletContact *fastest = NULL;
    for (int32_t i = 0; i < contact_pair->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + i];
        const double speed = -shv_dot(shv_load3(contact->normal),
                                      shv_bullet_relative(contact, velocity[0], spin[0], velocity[1], spin[1]));
        if (!contact_pair->struck && contact->gap + contact_pair->allowed_penetration > contact_pair->slop) continue;
        if (fastest && speed <= *closing) continue;
        fastest = contact;
        *closing = speed;
    }
    return fastest;
}

static ShvRigidContact report(ShvBullet *bullet, const ShvContactPair *contact_pair, const ShvBulletContact *contact,
                              double closing, bool first)
{
    const int32_t own = first ? contact_pair->a : contact_pair->b, other = first ? contact_pair->b : contact_pair->a;
    const ShvBulletRigidBody *body = &bullet->bodies[own];
    const double time = contact_pair->struck ? contact_pair->impact : 0.0;
    const ShvVec3 centre = shv_bullet_body_position(body, time, bullet->gravity);
    return (ShvRigidContact){.fragment = body->fragment,
                             .obstacle = bullet->bodies[other].obstacle,
                             .other = bullet->bodies[other].fragment,
                             .time = bullet->time + time,
                             .point = shv_add(centre, shv_load3(first ? contact->arm_first : contact->arm_second)),
                             .normal = shv_scale(shv_load3(contact->normal), first ? 1.0 : -1.0),
                             .closing_speed = fmax(0.0, closing),
                             .fresh = !contact_pair->touched,
                             .other_mass = other_mass(bullet, own, other),
                             .load = shv_bullet_body_load(body)};
}

/* Whether something that does not fall holds it. Bodies that only press on one another fall together. */
static bool is_supported(ShvBullet *bullet, int32_t own)
{
    const ShvBulletRigidBody *body = &bullet->bodies[own];
    const bool rests = body->asleep || isinf(bullet->bodies[shv_set_root(bullet->heaps, own)].heap_mass);
    return rests && shv_bullet_body_load(body) > 0.0;
}

/* Leaves flight as it is at the contact's time of impact. What it hit waits there for the rest of the step, so that it does not get
   into what is no longer in its world. */
static void take_out(ShvBullet *bullet, int32_t own, int32_t other, double time)
{
    ShvBulletRigidBody *body = &bullet->bodies[own], *partner = &bullet->bodies[other];
    body->leaves = true;
    if (partner->moves && (partner->fragment >= 0 || partner->impact_time >= 0.0)) {
        partner->until = fmin(partner->until, time);
        partner->waits = true;
    }
    if (body->coupled) return; /* it will be there when somebody else has led it there */
    const ShvQuat orientation = shv_bullet_body_orientation(body, time);
    const bool supported = is_supported(bullet, own);
    const double before = shv_bullet_body_energy(body, bullet->gravity);
    body->position = shv_bullet_body_position(body, time, bullet->gravity);
    if (!supported) body->velocity = shv_bullet_body_velocity(body, time, bullet->gravity);
    body->orientation = orientation;
    shv_bullet_body_write(body, &bullet->backend.world);
    if (supported) /* what holds it has worked */
        bullet->backend.contact_work += shv_bullet_body_energy(body, bullet->gravity) - before;
}

static void judge_contact_pair(ShvBullet *bullet, const ShvContactPair *contact_pair, ShvWakeJudge judge,
                               void *judge_data, ShvRigidContact *wakes, int32_t *wake_count)
{
    if (contact_pair->contact_count == 0 || bullet->bodies[contact_pair->a].leaves ||
        bullet->bodies[contact_pair->b].leaves)
        return;
    double closing = 0.0;
    const ShvBulletContact *contact = fastest_contact(bullet, contact_pair, &closing);
    if (!contact) return;
    bool accepted[2] = {false, false};
    ShvRigidContact contacts[2];
    for (int side = 0; side < 2; side++) {
        if (bullet->bodies[side ? contact_pair->b : contact_pair->a].fragment < 0) continue;
        contacts[side] = report(bullet, contact_pair, contact, closing, side == 0);
        accepted[side] = judge(judge_data, &contacts[side]);
    }
    for (int side = 0; side < 2; side++) {
        if (!accepted[side]) continue;
        wakes[(*wake_count)++] = contacts[side];
        take_out(bullet, side ? contact_pair->b : contact_pair->a, side ? contact_pair->a : contact_pair->b,
                 contact_pair->struck ? contact_pair->impact : 0.0);
    }
}

ShvStatus shv_bullet_judge(ShvBullet *bullet, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                           int32_t *wake_count, ShvError *error)
{
    if (!judge) return SHV_OK;
    SHV_TRY(find_heaps(bullet, error));
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->found && contact_pair->touching && !contact_pair->struck)
            judge_contact_pair(bullet, contact_pair, judge, judge_data, wakes, wake_count);
    }
    for (int32_t k = 0; k < bullet->order_count; k++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[bullet->order[k].contact_pair];
        if (contact_pair->struck) judge_contact_pair(bullet, contact_pair, judge, judge_data, wakes, wake_count);
    }
    return SHV_OK;
}
