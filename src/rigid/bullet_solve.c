#include "rigid/bullet_step.h"

/* Share of an overlap that is undone in a step, and the largest share of a body's radius. */
static const double undone_share = 0.2, largest_shift = 0.05;
/* Of the radius: a contact this close at the time of impact takes part in it; contacts this close are the same from step to
   step. */
static const double impact_band = 1e-4, same_place = 0.05;
/* ---- what a contact leaves ---- */

static void pair_laws(const ShvBullet *bullet, const ShvContactPair *contact_pair, double *friction,
                      double *restitution)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    if (a->fragment >= 0 && b->fragment >= 0) {
        *friction = bullet->backend.fragment_friction;
        *restitution = bullet->backend.fragment_restitution;
    } else if (a->fragment >= 0 || b->fragment >= 0) {
        const ShvBulletRigidBody *obstacle = a->fragment >= 0 ? b : a;
        *friction = obstacle->friction;
        *restitution = obstacle->restitution;
    } else {
        *friction = sqrt(a->friction * b->friction);
        *restitution = fmax(a->restitution, b->restitution);
    }
}

/* Normal velocity that a fast contact leaves at the step's end: thrown back at its time of impact, then flown on; or 0 when it would
   be back within the step. */
static double thrown_back(const ShvBullet *bullet, const ShvContactPair *contact_pair, double closing,
                          double acceleration, double restitution)
{
    const double left = bullet->step - contact_pair->impact;
    const double back = restitution * closing;
    if (back + 0.5 * acceleration * left <= 0.0) {
        bullet->bodies[contact_pair->a].stopped = bullet->bodies[contact_pair->b].stopped = true;
        return 0.0;
    }
    return back + acceleration * left;
}

/* Of the step: the least time that a gap has to close in; it only keeps the quotient finite. */
static const double least_left = 1e-9;

/* A contact that is held: its gap may close until the step's end, no more. Of a touch that parts fast, from which the body goes to its time
   of impact elsewhere, it is the gap that there is by then. */
static void hold(const ShvBullet *bullet, const ShvContactPair *contact_pair, ShvBulletContact *contact, double gap,
                 double speed)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    const double since = contact_pair->struck ? contact_pair->impact : fmax(0.0, fmax(a->impact_time, b->impact_time));
    const double left = fmax(bullet->step - since, least_left * bullet->step);
    const double then = contact_pair->struck ? gap : gap + speed * since;
    if (gap > 0.0 || (speed > bullet->rest && then > 0.0)) {
        contact->target = -fmax(0.0, then) / left;
        return;
    }
    const double radius = fmin(a->radius, b->radius);
    contact->target = 0.0;
    contact->push = fmin(undone_share * fmax(0.0, -gap - contact_pair->slop), largest_shift * radius) / bullet->step;
}

static void set_support(const ShvBullet *bullet, const ShvContactPair *contact_pair, ShvBulletContact *contact)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    const ShvVec3 none = shv_vec3(0.0, 0.0, 0.0);
    if (!b->moves) shv_store3(contact->support, shv_velocity_at(b->velocity, b->spin, shv_load3(contact->arm_second)));
    if (!a->moves)
        shv_store3(contact->support,
                   shv_sub(none, shv_velocity_at(a->velocity, a->spin, shv_load3(contact->arm_first))));
}

/* Impulses of the last step's nearest contact of the pair, to start from. */
static void warm(const ShvBullet *bullet, const ShvContactPair *contact_pair, const ShvContactPair *last,
                 ShvBulletContact *contact)
{
    if (!last) return;
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    const ShvVec3 arm = shv_rotate(shv_quat_conjugate(a->orientation), shv_load3(contact->arm_first));
    double nearest = same_place * fmin(a->radius, b->radius);
    const ShvCachedImpulse *best = NULL;
    for (int32_t i = 0; i < last->contact_count; i++) {
        const ShvCachedImpulse *cached = &bullet->last_cached_impulses[last->contact_begin + i];
        const double distance = shv_norm(shv_sub(arm, cached->arm));
        if (distance >= nearest) continue;
        nearest = distance;
        best = cached;
    }
    if (!best) return;
    const double share = bullet->step / bullet->last_step;
    contact->normal_impulse = share * best->normal_impulse;
    shv_store3(contact->friction_impulse, shv_scale(best->friction_impulse, share));
}

static void set_contact(ShvBullet *bullet, const ShvContactPair *contact_pair, const ShvContactPair *last,
                        ShvBulletContact *contact)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    double restitution;
    pair_laws(bullet, contact_pair, &contact->friction, &restitution);
    const double time = contact_pair->struck ? contact_pair->impact : 0.0;
    const ShvVec3 normal = shv_load3(contact->normal);
    const ShvVec3 spin_a = contact_pair->struck ? a->solver_spin : a->spin,
                  spin_b = contact_pair->struck ? b->solver_spin : b->spin;
    const double speed =
        shv_dot(normal, shv_bullet_relative(contact, shv_bullet_body_velocity(a, time, bullet->gravity), spin_a,
                                            shv_bullet_body_velocity(b, time, bullet->gravity), spin_b));
    const double gap = contact->gap + contact_pair->allowed_penetration;
    const double band = fmax(contact_pair->slop, impact_band * fmin(a->radius, b->radius));
    set_support(bullet, contact_pair, contact);
    if (contact_pair->struck && gap <= band && -speed > bullet->rest) {
        const double acceleration = shv_dot(normal, shv_bullet_relative_gravity(bullet, a, b));
        contact->target = thrown_back(bullet, contact_pair, -speed, acceleration, restitution);
    } else {
        hold(bullet, contact_pair, contact, gap, speed);
        if (-speed > 2.0 * bullet->rest)
            bullet->bodies[contact_pair->a].meets = bullet->bodies[contact_pair->b].meets = true;
        if (!contact_pair->struck) warm(bullet, contact_pair, last, contact);
    }
}

/* ---- solution ---- */

static const ShvContactPair *last_of(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    int32_t low = 0, high = bullet->last_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const ShvContactPair *last = &bullet->last_contact_pairs[middle];
        if (last->first < contact_pair->first ||
            (last->first == contact_pair->first && last->second < contact_pair->second))
            low = middle + 1;
        else
            high = middle;
    }
    if (low == bullet->last_count) return NULL;
    const ShvContactPair *last = &bullet->last_contact_pairs[low];
    return last->first == contact_pair->first && last->second == contact_pair->second ? last : NULL;
}

/* The body as the solver sees it: in its pose at its time of impact, with the velocity that gravity gives it by the step's end. */
static void enter(ShvBullet *bullet, ShvBulletRigidBody *body)
{
    const double time = fmax(0.0, body->impact_time);
    body->solver_orientation = shv_bullet_body_orientation(body, time);
    body->solver_spin = shv_bullet_body_spin(body, body->solver_orientation);
    body->new_spin = body->solver_spin;
    body->new_velocity = shv_bullet_body_velocity(body, bullet->step, bullet->gravity);
    if (body->solved) shv_bullet_body_place(body, bullet->bullet, body->position, body->solver_orientation);
}

/* Contacts that take part, in one list, by contact pairs; whom they move. */
static ShvStatus gather_contacts(ShvBullet *bullet, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->active_contacts, bullet->active_contact_room, bullet->contact_count,
                        "contacts of bodies", error);
    int32_t count = 0;
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
        if (a->leaves || b->leaves) contact_pair->contact_count = 0;
        const ShvBulletContact *found = bullet->contacts + contact_pair->contact_begin;
        contact_pair->contact_begin = count;
        for (int32_t k = 0; k < contact_pair->contact_count; k++) bullet->active_contacts[count++] = found[k];
        if (contact_pair->contact_count > 0) a->solved = b->solved = true;
    }
    ShvBulletContact *contacts = bullet->active_contacts;
    const int32_t room = bullet->active_contact_room;
    bullet->active_contacts = bullet->contacts;
    bullet->active_contact_room = bullet->contact_room;
    bullet->contacts = contacts;
    bullet->contact_room = room;
    bullet->contact_count = count;
    return SHV_OK;
}

static bool is_moved(const ShvBulletRigidBody *body)
{
    return body->moves && !body->leaves && !body->asleep;
}

static ShvStatus gather_motions(ShvBullet *bullet, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->motions, bullet->motion_room, bullet->body_count,
                        "bodies with contacts", error);
    bullet->motion_count = 0;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!is_moved(body)) continue;
        enter(bullet, body);
        if (!body->solved) continue;
        ShvBulletMotion *motion = &bullet->motions[bullet->motion_count++];
        *motion = (ShvBulletMotion){.body = body->number};
        shv_store3(motion->velocity, body->new_velocity);
        shv_store3(motion->spin, body->new_spin);
    }
    return SHV_OK;
}

ShvStatus shv_bullet_set_up_contacts(ShvBullet *bullet, ShvBulletTask *task, ShvError *error)
{
    SHV_TRY(gather_contacts(bullet, error));
    SHV_TRY(gather_motions(bullet, error));
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        const ShvContactPair *last = contact_pair->contact_count > 0 ? last_of(bullet, contact_pair) : NULL;
        for (int32_t k = 0; k < contact_pair->contact_count; k++)
            set_contact(bullet, contact_pair, last, &bullet->contacts[contact_pair->contact_begin + k]);
    }
    *task = (ShvBulletTask){.motions = bullet->motions,
                            .motion_count = bullet->motion_count,
                            .contacts = bullet->contacts,
                            .contact_count = bullet->contact_count,
                            .rest = bullet->rest};
    return SHV_OK;
}

/* Islands go by their first body. */
void shv_bullet_take_motions(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->motion_count; i++) {
        const ShvBulletMotion *motion = &bullet->motions[i];
        ShvBulletRigidBody *body = &bullet->bodies[shv_bullet_place(bullet, motion->body)];
        body->island = shv_bullet_place(bullet, bullet->motions[motion->island].body);
        body->new_velocity = shv_load3(motion->velocity);
        body->new_spin = shv_load3(motion->spin);
        body->push = shv_load3(motion->push);
        body->turn = shv_load3(motion->turn);
    }
}

/* ---- rebounds that would gain energy ----
   Newton's law of restitution with friction may give what spins more energy than it had (Kane 1984). All impulses of an island that
   would are scaled by λ: what they give is λ × work + λ² × square, and nothing at λ = −work/square. Momentum stays, and so do
   friction cones. */

/* Of `square`: less gain is the solver's. */
static const double least_gain = 1e-6;

/* Speeds at the time of impact or at the step's end, whichever has less gained: gravity acts between. */
static void add_work(ShvBullet *bullet, const ShvBulletRigidBody *body)
{
    ShvBulletRigidBody *island = &bullet->bodies[body->island];
    const ShvVec3 end = shv_bullet_body_velocity(body, bullet->step, bullet->gravity);
    const ShvVec3 then = shv_bullet_body_velocity(body, fmax(0.0, body->impact_time), bullet->gravity);
    const ShvVec3 change = shv_sub(body->new_velocity, end), turn = shv_sub(body->new_spin, body->solver_spin);
    const ShvVec3 spin = shv_free_rotation_momentum(&body->rotation, body->solver_orientation, turn);
    island->work += body->mass * fmin(shv_dot(end, change), shv_dot(then, change)) + shv_dot(spin, body->solver_spin);
    island->square += 0.5 * (body->mass * shv_dot(change, change) + shv_dot(spin, turn));
}

static bool is_kinematic(const ShvBulletRigidBody *body)
{
    return !body->moves && shv_norm(body->velocity) + shv_norm(body->spin) > 0.0;
}

static void look_at_contacts(ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    ShvBulletRigidBody *island = shv_bullet_island(bullet, contact_pair);
    if (contact_pair->contact_count == 0) return;
    if (is_kinematic(&bullet->bodies[contact_pair->a]) || is_kinematic(&bullet->bodies[contact_pair->b]))
        island->kinematic = true;
    for (int32_t k = 0; k < contact_pair->contact_count && contact_pair->struck; k++)
        if (bullet->contacts[contact_pair->contact_begin + k].target > 0.0) island->rebounds = true;
}

static double share_of_impulses(const ShvBulletRigidBody *island)
{
    const bool gains =
        island->rebounds && !island->kinematic && island->work + island->square > least_gain * island->square;
    return gains ? fmax(0.0, -island->work / island->square) : 1.0;
}

static void scale_contacts(ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    const double share = share_of_impulses(shv_bullet_island(bullet, contact_pair));
    for (int32_t k = 0; k < contact_pair->contact_count; k++) {
        ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + k];
        contact->normal_impulse *= share;
        shv_store3(contact->friction_impulse, shv_scale(shv_load3(contact->friction_impulse), share));
    }
}

void shv_bullet_limit_rebounds(ShvBullet *bullet)
{
    bool any = false;
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) look_at_contacts(bullet, &bullet->contact_pairs[i]);
    for (int32_t i = 0; i < bullet->body_count; i++) {
        const ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!is_moved(body) || !body->solved || !bullet->bodies[body->island].rebounds) continue;
        add_work(bullet, body);
        any = true;
    }
    for (int32_t i = 0; any && i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        const double share = share_of_impulses(&bullet->bodies[body->island]);
        if (!is_moved(body) || !body->solved || share == 1.0) continue;
        const ShvVec3 end = shv_bullet_body_velocity(body, bullet->step, bullet->gravity);
        body->new_velocity = shv_madd(end, share, shv_sub(body->new_velocity, end));
        body->new_spin = shv_madd(body->solver_spin, share, shv_sub(body->new_spin, body->solver_spin));
    }
    for (int32_t i = 0; any && i < bullet->contact_pair_count; i++) scale_contacts(bullet, &bullet->contact_pairs[i]);
}
