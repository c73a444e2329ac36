#include "rigid/bullet_step.h"

/* Share of an overlap that is undone in a step, and the largest share of a body's radius. */
static const double undone_share = 0.2, largest_shift = 0.05;
/* Of the radius: a contact this close at the moment of impact takes part in it; contacts this close are the same from step to
   step. */
static const double impact_band = 1e-4, same_place = 0.05;
/* ---- what a contact leaves ---- */

static void pair_laws(const ShvBullet *bullet, const ShvBulletMeeting *meeting, double *friction, double *restitution)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    if (a->fragment >= 0 && b->fragment >= 0) {
        *friction = bullet->backend.fragment_friction;
        *restitution = bullet->backend.fragment_restitution;
    } else if (a->fragment >= 0 || b->fragment >= 0) {
        const ShvBulletFlyer *obstacle = a->fragment >= 0 ? b : a;
        *friction = obstacle->friction;
        *restitution = obstacle->restitution;
    } else {
        *friction = sqrt(a->friction * b->friction);
        *restitution = fmax(a->restitution, b->restitution);
    }
}

/* Normal velocity that a fast contact leaves at the step's end: thrown back at its moment, then flown on; or 0 when it would
   be back within the step. */
static double thrown_back(const ShvBullet *bullet, const ShvBulletMeeting *meeting, double closing, double acceleration,
                          double restitution)
{
    const double left = bullet->step - meeting->impact;
    const double back = restitution * closing;
    if (back + 0.5 * acceleration * left <= 0.0) {
        bullet->flyers[meeting->a].stopped = bullet->flyers[meeting->b].stopped = true;
        return 0.0;
    }
    return back + acceleration * left;
}

/* A contact that is held: its gap may close until the step's end, no more. */
static void hold(const ShvBullet *bullet, const ShvBulletMeeting *meeting, ShvBulletContact *contact, double gap,
                 double speed)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const double since = meeting->struck ? meeting->impact : fmax(0.0, fmax(a->impact_time, b->impact_time));
    const double left = fmax(bullet->step - since, 1e-9 * bullet->step);
    const double then = meeting->struck ? gap : gap + speed * since;
    if (gap > 0.0) {
        contact->target = -fmax(0.0, then) / left;
        return;
    }
    const double radius = fmin(a->radius, b->radius);
    contact->target = 0.0;
    contact->push = fmin(undone_share * fmax(0.0, -gap - meeting->slop), largest_shift * radius) / bullet->step;
}

static void set_support(const ShvBullet *bullet, const ShvBulletMeeting *meeting, ShvBulletContact *contact)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const ShvVec3 none = shv_vec3(0.0, 0.0, 0.0);
    if (!b->moves)
        shv_store3(contact->support, shv_add(b->velocity, shv_cross(b->spin, shv_load3(contact->arm_second))));
    if (!a->moves)
        shv_store3(contact->support,
                   shv_sub(none, shv_add(a->velocity, shv_cross(a->spin, shv_load3(contact->arm_first)))));
}

/* Impulses of the last step's nearest contact of the pair, to start from. */
static void warm(const ShvBullet *bullet, const ShvBulletMeeting *meeting, const ShvBulletMeeting *last,
                 ShvBulletContact *contact)
{
    if (!last) return;
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const ShvVec3 arm = shv_rotate(shv_quat_conjugate(a->orientation), shv_load3(contact->arm_first));
    double nearest = same_place * fmin(a->radius, b->radius);
    const ShvBulletTrace *best = NULL;
    for (int32_t i = 0; i < last->contact_count; i++) {
        const ShvBulletTrace *trace = &bullet->last_traces[last->contact_begin + i];
        const double distance = shv_norm(shv_sub(arm, trace->arm));
        if (distance >= nearest) continue;
        nearest = distance;
        best = trace;
    }
    if (!best) return;
    const double share = bullet->step / bullet->last_step;
    contact->normal_impulse = share * best->normal_impulse;
    shv_store3(contact->friction_impulse, shv_scale(best->friction_impulse, share));
}

static void set_contact(ShvBullet *bullet, const ShvBulletMeeting *meeting, const ShvBulletMeeting *last,
                        ShvBulletContact *contact)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    double restitution;
    pair_laws(bullet, meeting, &contact->friction, &restitution);
    const double moment = meeting->struck ? meeting->impact : 0.0;
    const ShvVec3 normal = shv_load3(contact->normal);
    const ShvVec3 spin_a = meeting->struck ? a->solver_spin : a->spin,
                  spin_b = meeting->struck ? b->solver_spin : b->spin;
    const double speed =
        shv_dot(normal, shv_bullet_relative(contact, shv_bullet_flyer_velocity(a, moment, bullet->gravity), spin_a,
                                            shv_bullet_flyer_velocity(b, moment, bullet->gravity), spin_b));
    const double gap = contact->gap + meeting->allowance;
    const double band = fmax(meeting->slop, impact_band * fmin(a->radius, b->radius));
    set_support(bullet, meeting, contact);
    if (meeting->struck && gap <= band && -speed > bullet->rest) {
        const double acceleration = shv_dot(normal, shv_bullet_relative_gravity(bullet, a, b));
        contact->target = thrown_back(bullet, meeting, -speed, acceleration, restitution);
    } else {
        hold(bullet, meeting, contact, gap, speed);
        if (-speed > 2.0 * bullet->rest) bullet->flyers[meeting->a].meets = bullet->flyers[meeting->b].meets = true;
        if (!meeting->struck) warm(bullet, meeting, last, contact);
    }
}

/* ---- solution ---- */

static const ShvBulletMeeting *last_of(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    int32_t low = 0, high = bullet->last_count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        const ShvBulletMeeting *last = &bullet->last_meetings[middle];
        if (last->first < meeting->first || (last->first == meeting->first && last->second < meeting->second))
            low = middle + 1;
        else
            high = middle;
    }
    if (low == bullet->last_count) return NULL;
    const ShvBulletMeeting *last = &bullet->last_meetings[low];
    return last->first == meeting->first && last->second == meeting->second ? last : NULL;
}

/* The body as the solver sees it: in its pose at its moment of impact, with the velocity that gravity gives it by the step's end. */
static void enter(ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    const double moment = fmax(0.0, flyer->impact_time);
    flyer->solver_orientation = shv_bullet_flyer_orientation(flyer, moment);
    flyer->solver_spin = shv_bullet_flyer_spin(flyer, flyer->solver_orientation);
    flyer->new_spin = flyer->solver_spin;
    flyer->new_velocity = shv_bullet_flyer_velocity(flyer, bullet->step, bullet->gravity);
    if (flyer->solved) shv_bullet_flyer_place(flyer, bullet->bullet, flyer->position, flyer->solver_orientation);
}

/* Contacts that take part, in one list, by meetings; whom they move. */
static ShvStatus gather_contacts(ShvBullet *bullet, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->gathered, bullet->gathered_room, bullet->contact_count,
                        "contacts of bodies", error);
    int32_t count = 0;
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        ShvBulletMeeting *meeting = &bullet->meetings[i];
        ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        if (a->leaves || b->leaves) meeting->contact_count = 0;
        const ShvBulletContact *found = bullet->contacts + meeting->contact_begin;
        meeting->contact_begin = count;
        for (int32_t k = 0; k < meeting->contact_count; k++) bullet->gathered[count++] = found[k];
        if (meeting->contact_count > 0) a->solved = b->solved = true;
    }
    ShvBulletContact *contacts = bullet->gathered;
    const int32_t room = bullet->gathered_room;
    bullet->gathered = bullet->contacts;
    bullet->gathered_room = bullet->contact_room;
    bullet->contacts = contacts;
    bullet->contact_room = room;
    bullet->contact_count = count;
    return SHV_OK;
}

static bool is_moved(const ShvBulletFlyer *flyer)
{
    return flyer->moves && !flyer->leaves && !flyer->asleep;
}

static ShvStatus gather_motions(ShvBullet *bullet, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->motions, bullet->motion_room, bullet->flyer_count,
                        "bodies with contacts", error);
    bullet->motion_count = 0;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!is_moved(flyer)) continue;
        enter(bullet, flyer);
        if (!flyer->solved) continue;
        ShvBulletMotion *motion = &bullet->motions[bullet->motion_count++];
        *motion = (ShvBulletMotion){.body = flyer->number};
        shv_store3(motion->velocity, flyer->new_velocity);
        shv_store3(motion->spin, flyer->new_spin);
    }
    return SHV_OK;
}

ShvStatus shv_bullet_gather(ShvBullet *bullet, ShvBulletTask *task, ShvError *error)
{
    SHV_TRY(gather_contacts(bullet, error));
    SHV_TRY(gather_motions(bullet, error));
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        const ShvBulletMeeting *last = meeting->contact_count > 0 ? last_of(bullet, meeting) : NULL;
        for (int32_t k = 0; k < meeting->contact_count; k++)
            set_contact(bullet, meeting, last, &bullet->contacts[meeting->contact_begin + k]);
    }
    *task = (ShvBulletTask){.motions = bullet->motions,
                            .motion_count = bullet->motion_count,
                            .contacts = bullet->contacts,
                            .contact_count = bullet->contact_count,
                            .rest = bullet->rest};
    return SHV_OK;
}

/* Islands go by their first flyer. */
void shv_bullet_take_motions(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->motion_count; i++) {
        const ShvBulletMotion *motion = &bullet->motions[i];
        ShvBulletFlyer *flyer = &bullet->flyers[shv_bullet_place(bullet, motion->body)];
        flyer->island = shv_bullet_place(bullet, bullet->motions[motion->island].body);
        flyer->new_velocity = shv_load3(motion->velocity);
        flyer->new_spin = shv_load3(motion->spin);
        flyer->push = shv_load3(motion->push);
        flyer->turn = shv_load3(motion->turn);
    }
}
