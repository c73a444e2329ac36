#include "rigid/bullet_step.h"

#include <stdlib.h>

/* Of the smaller radius: gaps below are touches; how near a time of impact is found; and motion in a step up to which the
   contacts of its start tell the time of impact; the same of bodies that touch already. */
static const double slop_of_radius = 1e-6, impact_of_radius = 1e-7, small_motion_of_radius = 0.2,
                    touching_motion_of_radius = 0.5;

ShvVec3 shv_bullet_relative(const ShvBulletContact *contact, ShvVec3 velocity_a, ShvVec3 spin_a, ShvVec3 velocity_b,
                            ShvVec3 spin_b)
{
    return shv_sub(shv_velocity_at(velocity_a, spin_a, shv_load3(contact->arm_first)),
                   shv_velocity_at(velocity_b, spin_b, shv_load3(contact->arm_second)));
}

ShvVec3 shv_bullet_relative_gravity(const ShvBullet *bullet, const ShvBulletRigidBody *a, const ShvBulletRigidBody *b)
{
    return shv_scale(bullet->gravity, (a->moves ? a->fall : 0.0) - (b->moves ? b->fall : 0.0));
}

/* ---- pairs ---- */

bool shv_bullet_leaves_pair(const ShvBulletRigidBody *a, const ShvBulletRigidBody *b)
{
    if (!a->moves && !b->moves) return true;
    if ((a->dust || b->dust) && a->fragment >= 0 && b->fragment >= 0) return true;
    return (a->coupled && (b->coupled || b->obstacle >= 0)) || (b->coupled && a->obstacle >= 0);
}

/* Beside the straight way: what gravity and supports that give way make of it in a step; and a share of the radius, so that
   near neighbours are pairs, whatever pushes them together, or what the nodes of a whole body need to touch before its convex pieces do. */
static const double beside_of_radius = 0.02;

ShvStatus shv_bullet_reach(const ShvBullet *bullet, const ShvBulletRigidBody *body, double time, ShvError *error)
{
    double displacement[3];
    shv_store3(displacement, shv_scale(body->velocity, time));
    const double fall = body->moves ? 2.0 * shv_norm(bullet->gravity) * bullet->step * time : 0.0;
    const double beside = isfinite(body->radius) ? beside_of_radius * body->radius : 0.0;
    const double around = fmax(beside, shv_bullet_body_cut(body, &bullet->backend.world));
    const double turn = body->round || body->fastest == 0.0 ? 0.0 : fmin(2.0, body->fastest * time) * body->radius;
    return shv_bullet_world_reach(bullet->bullet, body->number, displacement, fall + around, turn, error);
}

/* Bound of the relative motion of two surfaces; supports that give way let a body come nearer by the fall of a step, of which
   the solver must know. */
static double relative_travel(const ShvBullet *bullet, const ShvBulletRigidBody *a, const ShvBulletRigidBody *b)
{
    const double speed = shv_norm(shv_sub(a->velocity, b->velocity));
    double displacement = (speed + 2.0 * shv_norm(bullet->gravity) * bullet->step) * bullet->step;
    if (!a->round && a->fastest > 0.0) displacement += fmin(2.0, a->fastest * bullet->step) * a->radius;
    if (!b->round && b->fastest > 0.0) displacement += fmin(2.0, b->fastest * bullet->step) * b->radius;
    return displacement;
}

bool shv_bullet_is_active(const ShvBulletRigidBody *body)
{
    return body->moves ? !body->asleep : shv_norm(body->velocity) > 0.0 || shv_norm(body->spin) > 0.0;
}

ShvStatus shv_bullet_place_all(ShvBullet *bullet, ShvError *error)
{
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        const bool stays = !shv_bullet_is_active(body);
        if (stays && body->settled) continue;
        body->settled = stays;
        shv_bullet_body_place(body, bullet->bullet, body->position, body->orientation);
        SHV_TRY(shv_bullet_reach(bullet, body, bullet->step, error));
    }
    return SHV_OK;
}

static ShvContactPair contact_pair_of(const ShvBullet *bullet, const ShvBulletPair *pair)
{
    ShvContactPair contact_pair = {.first = pair->first, .second = pair->second, .impact = -1.0};
    contact_pair.a = shv_bullet_place(bullet, pair->first);
    contact_pair.b = shv_bullet_place(bullet, pair->second);
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair.a], *b = &bullet->bodies[contact_pair.b];
    contact_pair.slop = slop_of_radius * fmin(a->radius, b->radius);
    contact_pair.reach = relative_travel(bullet, a, b) + 2.0 * contact_pair.slop;
    return contact_pair;
}

/* This step's pairs with what is remembered of them. */
static ShvStatus list_contact_pairs(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error)
{
    ShvContactPair *contact_pairs = bullet->last_contact_pairs;
    const int32_t room = bullet->last_room;
    bullet->last_contact_pairs = bullet->contact_pairs;
    bullet->last_room = bullet->contact_pair_room;
    bullet->last_count = bullet->contact_pair_count;
    bullet->contact_pairs = contact_pairs;
    bullet->contact_pair_room = room;
    bullet->contact_pair_count = 0;
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->contact_pairs, bullet->contact_pair_room, count, "pairs of bodies",
                        error);
    for (int32_t i = 0, k = 0; i < count; i++) {
        ShvContactPair contact_pair = contact_pair_of(bullet, &pairs[i]);
        if (shv_bullet_leaves_pair(&bullet->bodies[contact_pair.a], &bullet->bodies[contact_pair.b])) continue;
        const ShvContactPair *last = bullet->last_contact_pairs;
        while (k < bullet->last_count && (last[k].first < contact_pair.first || (last[k].first == contact_pair.first &&
                                                                                 last[k].second < contact_pair.second)))
            k++;
        if (k < bullet->last_count && last[k].first == contact_pair.first && last[k].second == contact_pair.second) {
            contact_pair.touched = last[k].touching;
            contact_pair.allowed_penetration = last[k].allowed_penetration;
        }
        bullet->contact_pairs[bullet->contact_pair_count++] = contact_pair;
    }
    return SHV_OK;
}

/* ---- contacts ---- */

static ShvStatus collide(ShvBullet *bullet, ShvContactPair *contact_pair, double reach, ShvError *error)
{
    ShvBulletContact *found;
    int32_t count;
    SHV_TRY(shv_bullet_world_collide(bullet->bullet, contact_pair->first, contact_pair->second,
                                     reach + contact_pair->allowed_penetration, &found, &count, error));
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->contacts, bullet->contact_room,
                        (int64_t)bullet->contact_count + count, "contacts of bodies", error);
    contact_pair->contact_begin = bullet->contact_count;
    contact_pair->contact_count = count;
    for (int32_t i = 0; i < count; i++) bullet->contacts[bullet->contact_count++] = found[i];
    return SHV_OK;
}

/* Of the smaller radius: having slid so far, two bodies touch at other places. */
static const double new_place_of_radius = 0.25;

/* How far a pair slides in the step at the contact where that is most. */
static double slide_of(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    double fastest = 0.0;
    for (int32_t i = 0; i < contact_pair->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + i];
        fastest = fmax(fastest, shv_norm(shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin)));
    }
    return fastest * bullet->step;
}

/* A pair of which one has just come: overlaps are the hulls' affair, not an impact, and are let be as long as they last and the
   two stay where they were to each other. (Deeper ones are not the hulls': what is inside another stays there.) */
static void allow_overlaps(const ShvBullet *bullet, ShvContactPair *contact_pair)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    if (!bullet->backend.world.settings->bullet.keep_overlaps) return;
    double deepest = 0.0;
    for (int32_t i = 0; i < contact_pair->contact_count; i++)
        deepest = fmin(deepest, bullet->contacts[contact_pair->contact_begin + i].gap);
    if (a->born || b->born) {
        contact_pair->allowed_penetration = -deepest;
    } else if (contact_pair->allowed_penetration > 0.0) {
        const double place = new_place_of_radius * fmin(a->radius, b->radius);
        if (contact_pair->allowed_penetration < place)
            contact_pair->allowed_penetration *= fmax(0.0, 1.0 - slide_of(bullet, contact_pair) / place);
        contact_pair->allowed_penetration = fmin(contact_pair->allowed_penetration, -deepest);
    }
}

/* Whether a contact closes fast in the step: its time of impact, by the parabola of its gap. */
static bool closes_fast(const ShvBullet *bullet, const ShvContactPair *contact_pair, const ShvBulletContact *contact,
                        double *time)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    const ShvVec3 normal = shv_load3(contact->normal);
    const double closing = -shv_dot(normal, shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin));
    const double acceleration = shv_dot(normal, shv_bullet_relative_gravity(bullet, a, b));
    const double gap = contact->gap + contact_pair->allowed_penetration;
    if (gap <= contact_pair->slop) {
        *time = 0.0;
        return closing > bullet->rest;
    }
    const double discriminant = closing * closing - 2.0 * acceleration * gap;
    if (!(discriminant > 0.0)) return false;
    *time = 2.0 * gap / (closing + sqrt(discriminant));
    return *time >= 0.0 && *time < bullet->step && closing - acceleration * *time > bullet->rest;
}

static void find_slow_impact(const ShvBullet *bullet, ShvContactPair *contact_pair)
{
    const double latest = bullet->backend.world.settings->bullet.times_of_impact ? bullet->step : 0.0;
    for (int32_t i = 0; i < contact_pair->contact_count; i++) {
        double time;
        if (!closes_fast(bullet, contact_pair, &bullet->contacts[contact_pair->contact_begin + i], &time)) continue;
        if (time > latest) continue;
        if (contact_pair->impact < 0.0 || time < contact_pair->impact) contact_pair->impact = time;
    }
}

bool shv_bullet_paths_meet(const ShvBullet *bullet, const ShvBulletRigidBody *a, const ShvBulletRigidBody *b,
                           double time)
{
    const double radii = a->radius + b->radius + 2.0 * shv_norm(bullet->gravity) * time * time;
    if (!isfinite(radii)) return true;
    const ShvVec3 between = shv_sub(a->position, b->position);
    const ShvVec3 displacement = shv_scale(shv_sub(a->velocity, b->velocity), time);
    const double length = shv_dot(displacement, displacement);
    const double share = length > 0.0 ? fmin(1.0, fmax(0.0, -shv_dot(between, displacement) / length)) : 0.0;
    return shv_norm(shv_madd(between, share, displacement)) <= radii;
}

/* Of the smaller piece: gap that counts as contact for times of impact (impact_time.h). */
static const double impact_tolerance = 1e-6;

/* Here, and only here, pairs whose relative motion in the step is large against their size are asked for their time of impact:
   the contacts of the start say nothing of what they will meet. */
static ShvStatus find_fast_impact(ShvBullet *bullet, ShvContactPair *contact_pair, ShvError *error)
{
    if (!shv_bullet_paths_meet(bullet, &bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b],
                               bullet->step))
        return SHV_OK;
    ShvImpactBody bodies[2];
    const ShvRigidWorld *world = &bullet->backend.world;
    SHV_TRY(shv_bullet_body_impact_body(&bullet->bodies[contact_pair->a], world, bullet->gravity, &bodies[0], error));
    SHV_TRY(shv_bullet_body_impact_body(&bullet->bodies[contact_pair->b], world, bullet->gravity, &bodies[1], error));
    const ShvImpactSettings settings = {.step = bullet->step, .tolerance = impact_tolerance, .slowest = bullet->rest};
    bool found;
    ShvImpact impact;
    SHV_TRY(shv_impact_time(&bodies[0], &bodies[1], &settings, &found, &impact, error));
    if (found && impact.time < bullet->step) contact_pair->impact = impact.time;
    return SHV_OK;
}

static ShvStatus find_contact_pair(ShvBullet *bullet, ShvContactPair *contact_pair, ShvError *error)
{
    contact_pair->found = true;
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    const double small = small_motion_of_radius * fmin(a->radius, b->radius);
    SHV_TRY(collide(bullet, contact_pair, fmin(contact_pair->reach, small + 2.0 * contact_pair->slop), error));
    allow_overlaps(bullet, contact_pair);
    for (int32_t i = 0; i < contact_pair->contact_count; i++)
        contact_pair->touching |=
            bullet->contacts[contact_pair->contact_begin + i].gap + contact_pair->allowed_penetration <=
            contact_pair->slop;
    if (a->born || b->born) contact_pair->touched = contact_pair->touching;
    const double told = contact_pair->touching ? touching_motion_of_radius * fmin(a->radius, b->radius) : small;
    if (contact_pair->reach > told && bullet->backend.world.settings->bullet.times_of_impact)
        SHV_TRY(find_fast_impact(bullet, contact_pair, error));
    else
        find_slow_impact(bullet, contact_pair);
    return SHV_OK;
}

/* Contacts of every pair that is not at rest; what a pair with them finds asleep wakes up, and its own pairs are due. */
static ShvStatus find_contacts(ShvBullet *bullet, ShvError *error)
{
    bullet->contact_count = 0;
    for (bool again = true; again;) {
        again = false;
        for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
            ShvContactPair *contact_pair = &bullet->contact_pairs[i];
            ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
            if (contact_pair->found || (!shv_bullet_is_active(a) && !shv_bullet_is_active(b))) continue;
            SHV_TRY(find_contact_pair(bullet, contact_pair, error));
            if (contact_pair->contact_count == 0 && contact_pair->impact < 0.0) continue;
            for (int side = 0; side < 2; side++) {
                ShvBulletRigidBody *sleeper = side ? b : a;
                if (!sleeper->asleep) continue;
                sleeper->asleep = false;
                sleeper->still = 0;
                again = true;
            }
        }
    }
    /* Pairs at rest are remembered as they are. */
    for (int32_t i = 0; i < bullet->contact_pair_count; i++)
        if (!bullet->contact_pairs[i].found) bullet->contact_pairs[i].touching = bullet->contact_pairs[i].touched;
    return SHV_OK;
}

/* ---- times of impact ---- */

static int by_moment(const void *x, const void *y)
{
    const ShvPairImpact *a = x, *b = y;
    if (a->time != b->time) return a->time < b->time ? -1 : 1;
    return (a->contact_pair > b->contact_pair) - (a->contact_pair < b->contact_pair);
}

/* Impacts of a body this near each other, in steps, are one. */
static const double same_moment = 0.01;

/* Whether a body can take part in an impact: it has no other, or one at (nearly) that time, which then holds for both. */
static bool is_free_for(const ShvBullet *bullet, const ShvBulletRigidBody *body, double time)
{
    return body->impact_time < 0.0 || fabs(body->impact_time - time) <= same_moment * bullet->step;
}

ShvStatus shv_bullet_collide_at(ShvBullet *bullet, ShvContactPair *contact_pair, double time, ShvError *error)
{
    const ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
    for (int i = 0; i < 2; i++)
        shv_bullet_body_place(pair[i], bullet->bullet, shv_bullet_body_position(pair[i], time, bullet->gravity),
                              shv_bullet_body_orientation(pair[i], time));
    return collide(bullet, contact_pair, contact_pair->reach, error);
}

/* The contact that is nearest to closing, and how fast it closes at a time; false when none does fast. */
static bool nearest_closing(const ShvBullet *bullet, const ShvContactPair *contact_pair, double time, double *gap,
                            double *closing)
{
    const ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
    ShvVec3 velocity[2], spin[2];
    for (int i = 0; i < 2; i++) {
        velocity[i] = shv_bullet_body_velocity(pair[i], time, bullet->gravity);
        spin[i] = shv_bullet_body_spin(pair[i], shv_bullet_body_orientation(pair[i], time));
    }
    bool any = false;
    for (int32_t i = 0; i < contact_pair->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + i];
        const double speed = -shv_dot(shv_load3(contact->normal),
                                      shv_bullet_relative(contact, velocity[0], spin[0], velocity[1], spin[1]));
        if (!(speed > bullet->rest) || (any && contact->gap + contact_pair->allowed_penetration >= *gap)) continue;
        any = true;
        *gap = contact->gap + contact_pair->allowed_penetration;
        *closing = speed;
    }
    return any;
}

enum { IMPACT_CORRECTIONS = 8 };

/* Of the step: how long before its end an impact is at the latest, so that something of it is left. */
static const double least_left = 1e-9;

/* Contacts at the very time of impact: it is corrected until the gap is closed. */
static ShvStatus find_contacts_at_impact(ShvBullet *bullet, ShvContactPair *contact_pair, ShvError *error)
{
    const double near =
        impact_of_radius * fmin(bullet->bodies[contact_pair->a].radius, bullet->bodies[contact_pair->b].radius);
    for (int i = 0; i < IMPACT_CORRECTIONS; i++) {
        SHV_TRY(shv_bullet_collide_at(bullet, contact_pair, contact_pair->impact, error));
        double gap = 0.0, closing = 1.0;
        if (!nearest_closing(bullet, contact_pair, contact_pair->impact, &gap, &closing) || fabs(gap) <= near)
            return SHV_OK;
        contact_pair->impact = fmin(fmax(0.0, contact_pair->impact + gap / closing), bullet->step * (1.0 - least_left));
    }
    return shv_bullet_collide_at(bullet, contact_pair, contact_pair->impact, error);
}

/* Of those who have an impact at another time. */
static void note_later_impact(ShvBulletRigidBody *a, ShvBulletRigidBody *b)
{
    a->later_impact = a->later_impact || a->impact_time >= 0.0;
    b->later_impact = b->later_impact || b->impact_time >= 0.0;
}

/* One that turned out to be later than it was taken for, and than the next one, has its turn then. */
static bool defer(ShvBullet *bullet, int32_t k)
{
    const ShvPairImpact impact = bullet->order[k];
    ShvContactPair *contact_pair = &bullet->contact_pairs[impact.contact_pair];
    if (contact_pair->deferred || !(contact_pair->impact > impact.time + same_moment * bullet->step)) return false;
    if (k + 1 == bullet->order_count || !(bullet->order[k + 1].time < contact_pair->impact)) return false;
    contact_pair->deferred = true;
    for (; k + 1 < bullet->order_count && bullet->order[k + 1].time < contact_pair->impact; k++)
        bullet->order[k] = bullet->order[k + 1];
    bullet->order[k] = (ShvPairImpact){contact_pair->impact, impact.contact_pair};
    return true;
}

/* The earliest impacts first: a body takes part in one. */
static ShvStatus choose_impacts(ShvBullet *bullet, ShvError *error)
{
    bullet->order_count = 0;
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        if (bullet->contact_pairs[i].impact < 0.0) continue;
        SHV_BACKEND_RESERVE(&bullet->backend, bullet->order, bullet->order_room, (int64_t)bullet->order_count + 1,
                            "impacts", error);
        bullet->order[bullet->order_count++] = (ShvPairImpact){bullet->contact_pairs[i].impact, i};
    }
    if (bullet->order_count > 1) qsort(bullet->order, (size_t)bullet->order_count, sizeof *bullet->order, by_moment);
    for (int32_t k = 0; k < bullet->order_count; k++) {
        ShvContactPair *contact_pair = &bullet->contact_pairs[bullet->order[k].contact_pair];
        ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
        const double set = fmax(a->impact_time, b->impact_time);
        if (!is_free_for(bullet, a, contact_pair->impact) || !is_free_for(bullet, b, contact_pair->impact) ||
            (a->impact_time >= 0.0 && b->impact_time >= 0.0 && a->impact_time != b->impact_time)) {
            note_later_impact(a, b);
            continue;
        }
        if (set >= 0.0) {
            contact_pair->impact = set;
            SHV_TRY(shv_bullet_collide_at(bullet, contact_pair, set, error));
        } else if (contact_pair->impact > 0.0) {
            SHV_TRY(find_contacts_at_impact(bullet, contact_pair, error));
            if (defer(bullet, k)) {
                k--;
                continue;
            }
        }
        contact_pair->struck = contact_pair->touching = true;
        if (a->moves) a->impact_time = contact_pair->impact;
        if (b->moves) b->impact_time = contact_pair->impact;
    }
    return SHV_OK;
}

ShvStatus shv_bullet_find(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error)
{
    SHV_TRY(list_contact_pairs(bullet, pairs, count, error));
    SHV_TRY(find_contacts(bullet, error));
    return choose_impacts(bullet, error);
}
