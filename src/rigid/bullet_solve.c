#include "rigid/bullet_step.h"

/* Share of an overlap that is undone in a step, and the largest share of a body's radius. */
static const double undone_share = 0.2, largest_shift = 0.05;
/* Of the radius: a contact this close at the moment of impact takes part in it; contacts this close are the same from step to
   step. */
static const double impact_band = 1e-4, same_place = 0.05;
/* Of the mass's own answer to impulses, that of a companion which is held. */
static const double least_give = 1e-6;
/* At most: small islands are solved to the tolerance, of large ones each step goes on from the last one's impulses. */
enum { ROW_BUDGET = 10000, FEWEST_ITERATIONS = 30, MOST_ITERATIONS = 1000 };

/* ---- islands ---- */

static int32_t root_of(ShvBullet *bullet, int32_t flyer)
{
    ShvBulletFlyer *flyers = bullet->flyers;
    while (flyers[flyer].island != flyer) {
        flyers[flyer].island = flyers[flyers[flyer].island].island;
        flyer = flyers[flyer].island;
    }
    return flyer;
}

static bool takes_part(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    return meeting->contact_count > 0 && !bullet->flyers[meeting->a].leaves && !bullet->flyers[meeting->b].leaves;
}

static void find_islands(ShvBullet *bullet)
{
    ShvBulletFlyer *flyers = bullet->flyers;
    for (int32_t i = 0; i < bullet->flyer_count; i++) flyers[i].island = i;
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (!takes_part(bullet, meeting)) continue;
        flyers[meeting->a].solved = flyers[meeting->b].solved = true;
        if (!flyers[meeting->a].moves || !flyers[meeting->b].moves) continue;
        const int32_t a = root_of(bullet, meeting->a), b = root_of(bullet, meeting->b);
        flyers[a < b ? b : a].island = a < b ? a : b;
    }
    for (int32_t i = 0; i < bullet->flyer_count; i++) flyers[i].island = root_of(bullet, i);
}

static int32_t island_of(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a];
    return a->moves ? a->island : bullet->flyers[meeting->b].island;
}

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

/* A companion that something lies on may be held, one that comes to something gives way by its own mass: two that were
   held as they came to each other would squeeze what is between them at will. */
static double give_of(const ShvBulletFlyer *flyer)
{
    const bool held = flyer->companion && flyer->impact_time < 0.0 && !flyer->meets;
    return held ? fmax(least_give, flyer->fall) : 1.0;
}

static void gather_motions(ShvBullet *bullet, const int32_t *members, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        const ShvBulletFlyer *flyer = &bullet->flyers[members[i]];
        ShvBulletMotion *motion = &bullet->motions[i];
        motion->body = flyer->number;
        motion->give = give_of(flyer);
        shv_store3(motion->velocity, flyer->new_velocity);
        shv_store3(motion->spin, flyer->new_spin);
    }
}

static void take_motions(ShvBullet *bullet, const int32_t *members, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[members[i]];
        const ShvBulletMotion *motion = &bullet->motions[i];
        flyer->new_velocity = shv_load3(motion->velocity);
        flyer->new_spin = shv_load3(motion->spin);
        flyer->push = shv_load3(motion->push);
        flyer->turn = shv_load3(motion->turn);
    }
}

/* What every contact of the island's meetings leaves, in one list. */
static ShvStatus gather_contacts(ShvBullet *bullet, const int32_t *meetings, int32_t count, int32_t *contacts,
                                 ShvError *error)
{
    *contacts = 0;
    for (int32_t k = 0; k < count; k++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[meetings[k]];
        const ShvBulletMeeting *last = last_of(bullet, meeting);
        SHV_BACKEND_RESERVE(&bullet->backend, bullet->island_contacts, bullet->island_room,
                            (int64_t)*contacts + meeting->contact_count, "contacts of bodies", error);
        for (int32_t i = 0; i < meeting->contact_count; i++) {
            ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + i];
            set_contact(bullet, meeting, last, contact);
            bullet->island_contacts[(*contacts)++] = *contact;
        }
    }
    return SHV_OK;
}

static void return_contacts(ShvBullet *bullet, const int32_t *meetings, int32_t count)
{
    const ShvBulletContact *solved = bullet->island_contacts;
    for (int32_t k = 0; k < count; k++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[meetings[k]];
        for (int32_t i = 0; i < meeting->contact_count; i++) bullet->contacts[meeting->contact_begin + i] = *solved++;
    }
}

static int32_t most_iterations(int32_t contacts)
{
    const int32_t affordable = ROW_BUDGET / (contacts > 0 ? contacts : 1);
    if (affordable > MOST_ITERATIONS) return MOST_ITERATIONS;
    return affordable > FEWEST_ITERATIONS ? affordable : FEWEST_ITERATIONS;
}

static ShvStatus solve_island(ShvBullet *bullet, const int32_t *meetings, int32_t count, const int32_t *members,
                              int32_t member_count, ShvError *error)
{
    int32_t contacts;
    SHV_TRY(gather_contacts(bullet, meetings, count, &contacts, error));
    gather_motions(bullet, members, member_count);
    double fastest = 0.0;
    for (int32_t i = 0; i < member_count; i++)
        fastest = fmax(fastest, shv_norm(bullet->flyers[members[i]].new_velocity));
    const ShvBulletSolve settings = {.iterations = most_iterations(contacts),
                                     .tolerance = fmax(1e-5 * bullet->rest, 1e-10 * fastest)};
    SHV_TRY(shv_bullet_world_solve(bullet->bullet, bullet->motions, member_count, bullet->island_contacts, contacts,
                                   &settings, error));
    take_motions(bullet, members, member_count);
    return_contacts(bullet, meetings, count);
    return SHV_OK;
}

/* Items by island, each island's together and in order: begin[i] … begin[i + 1] − 1 of `list` are those of island i. `keys`
   are the islands of the items, −1: of none. */
static void sort_by_island(const int32_t *keys, int32_t count, int32_t *begin, int32_t islands, int32_t *list)
{
    for (int32_t i = 0; i <= islands; i++) begin[i] = 0;
    for (int32_t k = 0; k < count; k++)
        if (keys[k] >= 0) begin[keys[k] + 1]++;
    for (int32_t i = 0; i < islands; i++) begin[i + 1] += begin[i];
    for (int32_t k = 0; k < count; k++)
        if (keys[k] >= 0) list[begin[keys[k]]++] = k;
    for (int32_t i = islands; i > 0; i--) begin[i] = begin[i - 1];
    begin[0] = 0;
}

static ShvStatus reserve_lists(ShvBullet *bullet, ShvError *error)
{
    const int64_t flyers = bullet->flyer_count, meetings = bullet->meeting_count;
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->motions, bullet->motion_room, flyers, "bodies of an island", error);
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->lists, bullet->list_room,
                        2 * (flyers + 1) + 2 * flyers + 2 * meetings, "lists of islands", error);
    return SHV_OK;
}

ShvStatus shv_bullet_solve(ShvBullet *bullet, ShvError *error)
{
    const int32_t flyers = bullet->flyer_count, meetings = bullet->meeting_count;
    SHV_TRY(reserve_lists(bullet, error));
    find_islands(bullet);
    int32_t *member_begin = bullet->lists, *meeting_begin = member_begin + flyers + 1;
    int32_t *members = meeting_begin + flyers + 1, *keys = members + flyers,
            *own = keys + (flyers > meetings ? flyers : meetings);
    for (int32_t i = 0; i < flyers; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        const bool in = flyer->moves && !flyer->leaves && !flyer->asleep;
        if (in) enter(bullet, flyer);
        keys[i] = in && flyer->solved ? flyer->island : -1;
    }
    sort_by_island(keys, flyers, member_begin, flyers, members);
    for (int32_t i = 0; i < meetings; i++)
        keys[i] = takes_part(bullet, &bullet->meetings[i]) ? island_of(bullet, &bullet->meetings[i]) : -1;
    sort_by_island(keys, meetings, meeting_begin, flyers, own);
    for (int32_t i = 0; i < flyers; i++) {
        const int32_t count = meeting_begin[i + 1] - meeting_begin[i];
        if (count == 0) continue;
        SHV_TRY(solve_island(bullet, own + meeting_begin[i], count, members + member_begin[i],
                             member_begin[i + 1] - member_begin[i], error));
    }
    return SHV_OK;
}
