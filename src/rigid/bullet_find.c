#include "rigid/bullet_step.h"

#include <stdlib.h>

/* Of the smaller radius: gaps below are touches; how near an impact's moment is found; and motion in a step up to which the
   contacts of its start tell the moment of impact; the same of bodies that touch already. */
static const double slop_of_radius = 1e-6, impact_of_radius = 1e-7, small_motion_of_radius = 0.2,
                    touching_motion_of_radius = 0.5;

ShvVec3 shv_bullet_relative(const ShvBulletContact *contact, ShvVec3 velocity_a, ShvVec3 spin_a, ShvVec3 velocity_b,
                            ShvVec3 spin_b)
{
    return shv_sub(shv_add(velocity_a, shv_cross(spin_a, shv_load3(contact->arm_first))),
                   shv_add(velocity_b, shv_cross(spin_b, shv_load3(contact->arm_second))));
}

ShvVec3 shv_bullet_relative_gravity(const ShvBullet *bullet, const ShvBulletFlyer *a, const ShvBulletFlyer *b)
{
    return shv_scale(bullet->gravity, (a->moves ? a->fall : 0.0) - (b->moves ? b->fall : 0.0));
}

/* ---- pairs ---- */

bool shv_bullet_leaves_pair(const ShvBulletFlyer *a, const ShvBulletFlyer *b)
{
    if ((a->dust || b->dust) && a->fragment >= 0 && b->fragment >= 0) return true;
    return (a->companion && (b->companion || b->obstacle >= 0)) || (b->companion && a->obstacle >= 0);
}

/* Beside the straight way: what gravity and supports that give way make of it in a step; and a share of the radius, so that
   near neighbours are pairs, whatever pushes them together. */
static const double beside_of_radius = 0.02;

ShvStatus shv_bullet_reach(const ShvBullet *bullet, const ShvBulletFlyer *flyer, double time, ShvError *error)
{
    double way[3];
    shv_store3(way, shv_scale(flyer->velocity, time));
    const double fall = flyer->moves ? 2.0 * shv_norm(bullet->gravity) * bullet->step * time : 0.0;
    const double beside = isfinite(flyer->radius) ? beside_of_radius * flyer->radius : 0.0;
    const double turn = flyer->round || flyer->fastest == 0.0 ? 0.0 : fmin(2.0, flyer->fastest * time) * flyer->radius;
    return shv_bullet_world_reach(bullet->bullet, flyer->number, way, fall + beside, turn, error);
}

/* Bound of the relative motion of two surfaces; supports that give way let a body come nearer by the fall of a step, of which
   the solver must know. */
static double relative_travel(const ShvBullet *bullet, const ShvBulletFlyer *a, const ShvBulletFlyer *b)
{
    const double speed = shv_norm(shv_sub(a->velocity, b->velocity));
    double way = (speed + 2.0 * shv_norm(bullet->gravity) * bullet->step) * bullet->step;
    if (!a->round && a->fastest > 0.0) way += fmin(2.0, a->fastest * bullet->step) * a->radius;
    if (!b->round && b->fastest > 0.0) way += fmin(2.0, b->fastest * bullet->step) * b->radius;
    return way;
}

bool shv_bullet_is_active(const ShvBulletFlyer *flyer)
{
    return flyer->moves ? !flyer->asleep : shv_norm(flyer->velocity) > 0.0 || shv_norm(flyer->spin) > 0.0;
}

ShvStatus shv_bullet_place_all(ShvBullet *bullet, ShvError *error)
{
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        const bool stays = !shv_bullet_is_active(flyer);
        if (stays && flyer->settled) continue;
        flyer->settled = stays;
        shv_bullet_flyer_place(flyer, bullet->bullet, flyer->position, flyer->orientation);
        SHV_TRY(shv_bullet_reach(bullet, flyer, bullet->step, error));
    }
    return SHV_OK;
}

static ShvBulletMeeting meeting_of(const ShvBullet *bullet, const ShvBulletPair *pair)
{
    ShvBulletMeeting meeting = {.first = pair->first, .second = pair->second, .impact = -1.0};
    meeting.a = shv_bullet_place(bullet, pair->first);
    meeting.b = shv_bullet_place(bullet, pair->second);
    const ShvBulletFlyer *a = &bullet->flyers[meeting.a], *b = &bullet->flyers[meeting.b];
    meeting.slop = slop_of_radius * fmin(a->radius, b->radius);
    meeting.reach = relative_travel(bullet, a, b) + 2.0 * meeting.slop;
    return meeting;
}

/* This step's pairs with what is remembered of them. */
static ShvStatus list_meetings(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error)
{
    ShvBulletMeeting *meetings = bullet->last_meetings;
    const int32_t room = bullet->last_room;
    bullet->last_meetings = bullet->meetings;
    bullet->last_room = bullet->meeting_room;
    bullet->last_count = bullet->meeting_count;
    bullet->meetings = meetings;
    bullet->meeting_room = room;
    bullet->meeting_count = 0;
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->meetings, bullet->meeting_room, count, "pairs of bodies", error);
    for (int32_t i = 0, k = 0; i < count; i++) {
        ShvBulletMeeting meeting = meeting_of(bullet, &pairs[i]);
        if (shv_bullet_leaves_pair(&bullet->flyers[meeting.a], &bullet->flyers[meeting.b])) continue;
        const ShvBulletMeeting *last = bullet->last_meetings;
        while (k < bullet->last_count &&
               (last[k].first < meeting.first || (last[k].first == meeting.first && last[k].second < meeting.second)))
            k++;
        if (k < bullet->last_count && last[k].first == meeting.first && last[k].second == meeting.second) {
            meeting.touched = last[k].touching;
            meeting.allowance = last[k].allowance;
        }
        bullet->meetings[bullet->meeting_count++] = meeting;
    }
    return SHV_OK;
}

/* ---- contacts ---- */

static ShvStatus collide(ShvBullet *bullet, ShvBulletMeeting *meeting, double reach, ShvError *error)
{
    ShvBulletContact *found;
    int32_t count;
    SHV_TRY(shv_bullet_world_collide(bullet->bullet, meeting->first, meeting->second, reach + meeting->allowance,
                                     &found, &count, error));
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->contacts, bullet->contact_room,
                        (int64_t)bullet->contact_count + count, "contacts of bodies", error);
    meeting->contact_begin = bullet->contact_count;
    meeting->contact_count = count;
    for (int32_t i = 0; i < count; i++) bullet->contacts[bullet->contact_count++] = found[i];
    return SHV_OK;
}

/* Of the smaller radius: having slid so far, two bodies touch at other places. */
static const double new_place_of_radius = 0.25;

/* How far a pair slides in the step at the contact where that is most. */
static double slide_of(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    double fastest = 0.0;
    for (int32_t i = 0; i < meeting->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + i];
        fastest = fmax(fastest, shv_norm(shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin)));
    }
    return fastest * bullet->step;
}

/* A pair of which one has just come: overlaps are the hulls' affair, not an impact, and are let be as long as they last and the
   two stay where they were to each other. (Deeper ones are not the hulls': what is inside another stays there.) */
static void allow_overlaps(const ShvBullet *bullet, ShvBulletMeeting *meeting)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    if (!bullet->backend.world.settings->bullet.keep_overlaps) return;
    double deepest = 0.0;
    for (int32_t i = 0; i < meeting->contact_count; i++)
        deepest = fmin(deepest, bullet->contacts[meeting->contact_begin + i].gap);
    if (a->born || b->born) {
        meeting->allowance = -deepest;
    } else if (meeting->allowance > 0.0) {
        const double place = new_place_of_radius * fmin(a->radius, b->radius);
        if (meeting->allowance < place) meeting->allowance *= fmax(0.0, 1.0 - slide_of(bullet, meeting) / place);
        meeting->allowance = fmin(meeting->allowance, -deepest);
    }
}

/* Whether a contact closes fast in the step: its moment, by the parabola of its gap. */
static bool closes_fast(const ShvBullet *bullet, const ShvBulletMeeting *meeting, const ShvBulletContact *contact,
                        double *moment)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const ShvVec3 normal = shv_load3(contact->normal);
    const double closing = -shv_dot(normal, shv_bullet_relative(contact, a->velocity, a->spin, b->velocity, b->spin));
    const double acceleration = shv_dot(normal, shv_bullet_relative_gravity(bullet, a, b));
    const double gap = contact->gap + meeting->allowance;
    if (gap <= meeting->slop) {
        *moment = 0.0;
        return closing > bullet->rest;
    }
    const double discriminant = closing * closing - 2.0 * acceleration * gap;
    if (!(discriminant > 0.0)) return false;
    *moment = 2.0 * gap / (closing + sqrt(discriminant));
    return *moment >= 0.0 && *moment < bullet->step && closing - acceleration * *moment > bullet->rest;
}

static void find_slow_impact(const ShvBullet *bullet, ShvBulletMeeting *meeting)
{
    const double latest = bullet->backend.world.settings->bullet.times_of_impact ? bullet->step : 0.0;
    for (int32_t i = 0; i < meeting->contact_count; i++) {
        double moment;
        if (!closes_fast(bullet, meeting, &bullet->contacts[meeting->contact_begin + i], &moment)) continue;
        if (moment > latest) continue;
        if (meeting->impact < 0.0 || moment < meeting->impact) meeting->impact = moment;
    }
}

/* Whether the balls around two bodies touch on their way. */
static bool paths_meet(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const double radii = a->radius + b->radius + 2.0 * shv_norm(bullet->gravity) * bullet->step * bullet->step;
    if (!isfinite(radii)) return true;
    const ShvVec3 apart = shv_sub(a->position, b->position);
    const ShvVec3 way = shv_scale(shv_sub(a->velocity, b->velocity), bullet->step);
    const double length = shv_dot(way, way);
    const double share = length > 0.0 ? fmin(1.0, fmax(0.0, -shv_dot(apart, way) / length)) : 0.0;
    return shv_norm(shv_madd(apart, share, way)) <= radii;
}

/* Here, and only here, pairs whose relative motion in the step is large against their size are asked for their time of impact:
   the contacts of the start say nothing of what they will meet. */
static ShvStatus find_fast_impact(ShvBullet *bullet, ShvBulletMeeting *meeting, ShvError *error)
{
    if (!paths_meet(bullet, meeting)) return SHV_OK;
    ShvImpactBody bodies[2];
    const ShvRigidWorld *world = &bullet->backend.world;
    SHV_TRY(shv_bullet_flyer_impact_body(&bullet->flyers[meeting->a], world, bullet->gravity, &bodies[0], error));
    SHV_TRY(shv_bullet_flyer_impact_body(&bullet->flyers[meeting->b], world, bullet->gravity, &bodies[1], error));
    const ShvImpactSettings settings = {.step = bullet->step, .tolerance = 1e-6, .slowest = bullet->rest};
    bool found;
    ShvImpact impact;
    SHV_TRY(shv_impact_time(&bodies[0], &bodies[1], &settings, &found, &impact, error));
    if (found && impact.time < bullet->step) meeting->impact = impact.time;
    return SHV_OK;
}

static ShvStatus find_meeting(ShvBullet *bullet, ShvBulletMeeting *meeting, ShvError *error)
{
    meeting->found = true;
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
    const double small = small_motion_of_radius * fmin(a->radius, b->radius);
    SHV_TRY(collide(bullet, meeting, fmin(meeting->reach, small + 2.0 * meeting->slop), error));
    allow_overlaps(bullet, meeting);
    for (int32_t i = 0; i < meeting->contact_count; i++)
        meeting->touching |= bullet->contacts[meeting->contact_begin + i].gap + meeting->allowance <= meeting->slop;
    if (a->born || b->born) meeting->touched = meeting->touching;
    const double told = meeting->touching ? touching_motion_of_radius * fmin(a->radius, b->radius) : small;
    if (meeting->reach > told && bullet->backend.world.settings->bullet.times_of_impact)
        SHV_TRY(find_fast_impact(bullet, meeting, error));
    else
        find_slow_impact(bullet, meeting);
    return SHV_OK;
}

/* Contacts of every pair that is not at rest; what a pair with them finds asleep wakes up, and its own pairs are due. */
static ShvStatus find_contacts(ShvBullet *bullet, ShvError *error)
{
    bullet->contact_count = 0;
    for (bool again = true; again;) {
        again = false;
        for (int32_t i = 0; i < bullet->meeting_count; i++) {
            ShvBulletMeeting *meeting = &bullet->meetings[i];
            ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
            if (meeting->found || (!shv_bullet_is_active(a) && !shv_bullet_is_active(b))) continue;
            SHV_TRY(find_meeting(bullet, meeting, error));
            if (meeting->contact_count == 0 && meeting->impact < 0.0) continue;
            for (int side = 0; side < 2; side++) {
                ShvBulletFlyer *sleeper = side ? b : a;
                if (!sleeper->asleep) continue;
                sleeper->asleep = false;
                sleeper->still = 0;
                again = true;
            }
        }
    }
    /* Pairs at rest are remembered as they are. */
    for (int32_t i = 0; i < bullet->meeting_count; i++)
        if (!bullet->meetings[i].found) bullet->meetings[i].touching = bullet->meetings[i].touched;
    return SHV_OK;
}

/* ---- moments of impact ---- */

static int by_moment(const void *x, const void *y)
{
    const ShvBulletMoment *a = x, *b = y;
    if (a->moment != b->moment) return a->moment < b->moment ? -1 : 1;
    return (a->meeting > b->meeting) - (a->meeting < b->meeting);
}

/* Impacts of a body this near each other, in steps, are one. */
static const double same_moment = 0.01;

/* Whether a body can take part in an impact: it has no other, or one at (nearly) that moment, which then holds for both. */
static bool is_free_for(const ShvBullet *bullet, const ShvBulletFlyer *flyer, double moment)
{
    return !flyer->moves || flyer->impact_time < 0.0 || fabs(flyer->impact_time - moment) <= same_moment * bullet->step;
}

/* The moment that a body's earlier impact has set; −1: none. */
static double set_moment(const ShvBulletFlyer *flyer)
{
    return flyer->moves ? flyer->impact_time : -1.0;
}

/* The pair as it stands at a moment; its contacts there. */
static ShvStatus collide_at(ShvBullet *bullet, ShvBulletMeeting *meeting, double moment, ShvError *error)
{
    const ShvBulletFlyer *pair[2] = {&bullet->flyers[meeting->a], &bullet->flyers[meeting->b]};
    for (int i = 0; i < 2; i++)
        shv_bullet_flyer_place(pair[i], bullet->bullet, shv_bullet_flyer_position(pair[i], moment, bullet->gravity),
                               shv_bullet_flyer_orientation(pair[i], moment));
    return collide(bullet, meeting, meeting->reach, error);
}

/* The contact that is nearest to closing, and how fast it closes at a moment; false when none does fast. */
static bool nearest_closing(const ShvBullet *bullet, const ShvBulletMeeting *meeting, double moment, double *gap,
                            double *closing)
{
    const ShvBulletFlyer *pair[2] = {&bullet->flyers[meeting->a], &bullet->flyers[meeting->b]};
    ShvVec3 velocity[2], spin[2];
    for (int i = 0; i < 2; i++) {
        velocity[i] = shv_bullet_flyer_velocity(pair[i], moment, bullet->gravity);
        spin[i] = shv_bullet_flyer_spin(pair[i], shv_bullet_flyer_orientation(pair[i], moment));
    }
    bool any = false;
    for (int32_t i = 0; i < meeting->contact_count; i++) {
        const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + i];
        const double speed = -shv_dot(shv_load3(contact->normal),
                                      shv_bullet_relative(contact, velocity[0], spin[0], velocity[1], spin[1]));
        if (!(speed > bullet->rest) || (any && contact->gap + meeting->allowance >= *gap)) continue;
        any = true;
        *gap = contact->gap + meeting->allowance;
        *closing = speed;
    }
    return any;
}

enum { MOMENT_CORRECTIONS = 8 };

/* Contacts at the very moment: it is corrected until the gap is closed. */
static ShvStatus find_moment(ShvBullet *bullet, ShvBulletMeeting *meeting, ShvError *error)
{
    const double near = impact_of_radius * fmin(bullet->flyers[meeting->a].radius, bullet->flyers[meeting->b].radius);
    for (int i = 0; i < MOMENT_CORRECTIONS; i++) {
        SHV_TRY(collide_at(bullet, meeting, meeting->impact, error));
        double gap = 0.0, closing = 1.0;
        if (!nearest_closing(bullet, meeting, meeting->impact, &gap, &closing) || fabs(gap) <= near) return SHV_OK;
        meeting->impact = fmin(fmax(0.0, meeting->impact + gap / closing), bullet->step * (1.0 - 1e-9));
    }
    return collide_at(bullet, meeting, meeting->impact, error);
}

/* The earliest impacts first: a body takes part in one. */
static ShvStatus choose_impacts(ShvBullet *bullet, ShvError *error)
{
    bullet->order_count = 0;
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        if (bullet->meetings[i].impact < 0.0) continue;
        SHV_BACKEND_RESERVE(&bullet->backend, bullet->order, bullet->order_room, (int64_t)bullet->order_count + 1,
                            "impacts", error);
        bullet->order[bullet->order_count++] = (ShvBulletMoment){bullet->meetings[i].impact, i};
    }
    if (bullet->order_count > 1) qsort(bullet->order, (size_t)bullet->order_count, sizeof *bullet->order, by_moment);
    for (int32_t k = 0; k < bullet->order_count; k++) {
        ShvBulletMeeting *meeting = &bullet->meetings[bullet->order[k].meeting];
        ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        if (!is_free_for(bullet, a, meeting->impact) || !is_free_for(bullet, b, meeting->impact)) continue;
        const double set_a = set_moment(a), set_b = set_moment(b), set = fmax(set_a, set_b);
        if (set_a >= 0.0 && set_b >= 0.0 && set_a != set_b) continue;
        meeting->struck = meeting->touching = true;
        if (set >= 0.0) {
            meeting->impact = set;
            SHV_TRY(collide_at(bullet, meeting, set, error));
        } else if (meeting->impact > 0.0) {
            SHV_TRY(find_moment(bullet, meeting, error));
        }
        a->impact_time = b->impact_time = meeting->impact;
    }
    return SHV_OK;
}

ShvStatus shv_bullet_find(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error)
{
    SHV_TRY(list_meetings(bullet, pairs, count, error));
    SHV_TRY(find_contacts(bullet, error));
    return choose_impacts(bullet, error);
}
