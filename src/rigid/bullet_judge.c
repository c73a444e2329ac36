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
                              double closing, double time, bool first)
{
    const int32_t own = first ? contact_pair->a : contact_pair->b, other = first ? contact_pair->b : contact_pair->a;
    const ShvBulletRigidBody *body = &bullet->bodies[own];
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

/* ---- nodes ---- */

/* Of a body's radius: how far round a contact convex pieces cut a corner. A face of the regular hull of 64 vertices in a ball, 4 π/124 of
   a unit sphere, has a circumscribed circle of 0.28. */
static const double near_of_radius = 0.3;

/* The tangent plane of a body's convex pieces at a contact that closes at a time of the step, and the obstacle met there, or NULL. */
typedef struct ContactPlane {
    double time;
    ShvVec3 point, normal; /* into the body */
    const ShvObstacle *obstacle;
} ContactPlane;

/* How far the nodes of a body round a contact are from the obstacle, or else inside of the plane, m; negative: beyond. */
static double gap_of_nodes(const ShvBullet *bullet, const ShvBulletRigidBody *body, const ContactPlane *plane)
{
    const ShvRigidWorld *world = &bullet->backend.world;
    const ShvFragment *fragment = &world->fragments->items[body->fragment];
    const ShvVec3 centre = shv_bullet_body_position(body, plane->time, bullet->gravity);
    const ShvQuat orientation = shv_bullet_body_orientation(body, plane->time);
    const double near = near_of_radius * body->radius;
    double least = (double)INFINITY;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = world->fragments->nodes[fragment->node_begin + k];
        const ShvVec3 arm = shv_rotate(orientation, shv_fragment_shape_position(fragment, world->state, node));
        const ShvVec3 x = shv_add(centre, arm), from = shv_sub(x, plane->point);
        double gap = shv_dot(plane->normal, from);
        if (shv_dot(from, from) - gap * gap > near * near) continue;
        if (plane->obstacle) { /* stands where the step began */
            const ShvVec3 then = shv_madd(x, -plane->time, shv_obstacle_velocity(plane->obstacle, x));
            gap = shv_obstacle_closest(plane->obstacle, then, near).gap;
        }
        least = fmin(least, gap);
    }
    return least;
}

/* By how much nodes of both may touch before their convex pieces do, m. */
static double cuts_of(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    const ShvRigidWorld *world = &bullet->backend.world;
    return shv_bullet_body_cut(&bullet->bodies[contact_pair->a], world) +
           shv_bullet_body_cut(&bullet->bodies[contact_pair->b], world);
}

/* A contact of two bodies' convex pieces that closes in this step or the next. */
typedef struct Closing {
    const ShvBulletContact *contact;
    double speed, time, gap; /* m/s; s, of the step; m: what is left there at that time */
} Closing;

/* When nodes of the two touch there: no later. As late as convex pieces that cut corners the blow would come to many nodes at once, deep
   in the other side. Deeper than those cut is no such corner. */
static double time_of_nodes(const ShvBullet *bullet, const ShvContactPair *contact_pair, const Closing *closing)
{
    const ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
    double gap = closing->gap;
    for (int i = 0; i < 2; i++) {
        if (!(shv_bullet_body_cut(pair[i], &bullet->backend.world) > 0.0)) continue;
        const double *arm = i == 0 ? closing->contact->arm_first : closing->contact->arm_second;
        const int32_t obstacle = pair[1 - i]->obstacle;
        ContactPlane plane = {.time = closing->time,
                              .normal = shv_scale(shv_load3(closing->contact->normal), i == 0 ? 1.0 : -1.0)};
        plane.point = shv_add(shv_bullet_body_position(pair[i], closing->time, bullet->gravity), shv_load3(arm));
        plane.point = shv_madd(plane.point, 0.5 * closing->contact->gap, plane.normal); /* arms end in the middle */
        if (obstacle >= 0) plane.obstacle = &bullet->backend.world.obstacles->items[obstacle];
        const double own = gap_of_nodes(bullet, pair[i], &plane);
        gap = obstacle >= 0 ? own : gap + own;
    }
    if (!(gap < 0.0 && gap >= -cuts_of(bullet, contact_pair) && closing->speed > 0.0)) return closing->time;
    return fmax(0.0, closing->time + gap / closing->speed);
}

/* ---- judging ---- */

/* Where wakes go, and who is asked. */
typedef struct Judgement {
    ShvWakeJudge judge;
    void *data;
    ShvRigidContact *wakes;
    int32_t *wake_count;
} Judgement;

/* Whom it wakes leaves flight when nodes touch, if that is in this step. */
static void judge_contact(ShvBullet *bullet, const ShvContactPair *contact_pair, const Closing *closing,
                          const Judgement *to)
{
    bool accepted[2] = {false, false};
    ShvRigidContact contacts[2];
    for (int side = 0; side < 2; side++) {
        if (bullet->bodies[side ? contact_pair->b : contact_pair->a].fragment < 0) continue;
        contacts[side] = report(bullet, contact_pair, closing->contact, closing->speed, closing->time, side == 0);
        accepted[side] = to->judge(to->data, &contacts[side]);
    }
    if (!accepted[0] && !accepted[1]) return;
    const double touch = closing->time > 0.0 ? time_of_nodes(bullet, contact_pair, closing) : closing->time;
    if (touch >= bullet->step) return;
    for (int side = 0; side < 2; side++) {
        if (!accepted[side]) continue;
        if (touch < closing->time && contacts[side].obstacle < 0) contacts[side].expected = contacts[side].time;
        contacts[side].time = bullet->time + touch;
        to->wakes[(*to->wake_count)++] = contacts[side];
        take_out(bullet, side ? contact_pair->b : contact_pair->a, side ? contact_pair->a : contact_pair->b, touch);
    }
}

static bool has_left(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    return bullet->bodies[contact_pair->a].leaves || bullet->bodies[contact_pair->b].leaves;
}

static void judge_contact_pair(ShvBullet *bullet, const ShvContactPair *contact_pair, const Judgement *to)
{
    Closing closing = {.time = contact_pair->struck ? contact_pair->impact : 0.0};
    if (contact_pair->contact_count == 0 || has_left(bullet, contact_pair)) return;
    closing.contact = fastest_contact(bullet, contact_pair, &closing.speed);
    if (!closing.contact) return;
    closing.gap = closing.contact->gap;
    judge_contact(bullet, contact_pair, &closing, to);
}

/* ---- contacts of nodes before those of convex pieces ---- */

/* Whether a pair that convex pieces keep apart in this step, in free flight, could wake somebody if it closed as fast as it moves. */
static bool could_wake(ShvBullet *bullet, const ShvContactPair *contact_pair, const Judgement *to)
{
    const ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
    const ShvBulletContact none = {.normal = {0.0, 0.0, 0.0}};
    if (!contact_pair->found || contact_pair->touching || contact_pair->struck || has_left(bullet, contact_pair))
        return false;
    for (int side = 0; side < 2; side++)
        if (pair[side]->coupled || pair[side]->impact_time >= 0.0) return false;
    if (!(cuts_of(bullet, contact_pair) > 0.0)) return false;
    const double fastest = contact_pair->reach / bullet->step;
    for (int side = 0; side < 2; side++) {
        if (pair[side]->fragment < 0) continue;
        const ShvRigidContact contact = report(bullet, contact_pair, &none, fastest, 0.0, side == 0);
        if (to->judge(to->data, &contact)) return true;
    }
    return false;
}

/* The contact of a pair apart that closes first, if they go on as they do. */
static Closing soonest_contact(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    Closing soonest = {.contact = NULL};
    for (int32_t i = 0; i < contact_pair->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + i];
        const double speed = -shv_dot(shv_load3(contact->normal),
                                      shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin));
        const double time = (contact->gap + contact_pair->allowed_penetration) / speed;
        if (!(speed > bullet->rest) || (soonest.contact && time >= soonest.time)) continue;
        soonest = (Closing){contact, speed, time, 0.0};
    }
    return soonest;
}

/* Nodes may touch in this step where convex pieces will in the next. */
static ShvStatus judge_ahead(ShvBullet *bullet, const ShvContactPair *contact_pair, const Judgement *to,
                             ShvError *error)
{
    const int32_t known = bullet->contact_count;
    ShvContactPair ahead = *contact_pair;
    ahead.reach += cuts_of(bullet, contact_pair);
    SHV_TRY(shv_bullet_collide_at(bullet, &ahead, 0.0, error));
    const Closing closing = soonest_contact(bullet, &ahead);
    if (closing.contact && closing.time >= bullet->step) judge_contact(bullet, &ahead, &closing, to);
    bullet->contact_count = known;
    return SHV_OK;
}

ShvStatus shv_bullet_judge(ShvBullet *bullet, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                           int32_t *wake_count, ShvError *error)
{
    if (!judge) return SHV_OK;
    const Judgement to = {judge, judge_data, wakes, wake_count};
    SHV_TRY(find_heaps(bullet, error));
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->found && contact_pair->touching && !contact_pair->struck)
            judge_contact_pair(bullet, contact_pair, &to);
    }
    for (int32_t k = 0; k < bullet->order_count; k++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[bullet->order[k].contact_pair];
        if (contact_pair->struck) judge_contact_pair(bullet, contact_pair, &to);
    }
    for (int32_t i = 0; i < bullet->contact_pair_count; i++)
        if (could_wake(bullet, &bullet->contact_pairs[i], &to))
            SHV_TRY(judge_ahead(bullet, &bullet->contact_pairs[i], &to, error));
    return SHV_OK;
}
