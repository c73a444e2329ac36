#include "rigid/bullet_archive.h"

#include <stdlib.h>

/* ---- bodies ---- */

static int by_number(const void *x, const void *y)
{
    const ShvBulletFlyer *a = x, *b = y;
    return (a->number > b->number) - (a->number < b->number);
}

/* Flyers by number again, without those that have gone. */
static void tidy(ShvBullet *bullet)
{
    if (!bullet->untidy) return;
    bullet->untidy = false;
    int32_t kept = 0;
    bool sorted = true;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        if (bullet->flyers[i].gone) continue;
        if (kept < i) bullet->flyers[kept] = bullet->flyers[i];
        sorted = sorted && (kept == 0 || bullet->flyers[kept - 1].number < bullet->flyers[kept].number);
        kept++;
    }
    bullet->flyer_count = kept;
    if (!sorted) qsort(bullet->flyers, (size_t)kept, sizeof *bullet->flyers, by_number);
    for (int32_t i = 0; i < bullet->place_count; i++) bullet->places[i] = 0;
    for (int32_t i = 0; i < kept; i++) bullet->places[bullet->flyers[i].number] = i + 1;
}

static ShvStatus reserve_flyer(ShvBullet *bullet, int32_t number, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->flyers, bullet->flyer_room, (int64_t)bullet->flyer_count + 1,
                        "the fragments in flight", error);
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->places, bullet->place_room, (int64_t)number + 1,
                        "the fragments in flight", error);
    while (bullet->place_count <= number) bullet->places[bullet->place_count++] = 0;
    return SHV_OK;
}

static ShvStatus add(ShvRigidBackend *backend, int32_t fragment, ShvError *error)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    SHV_TRY(reserve_flyer(bullet, backend->world.obstacles->count + fragment, error));
    ShvBulletFlyer flyer;
    SHV_TRY(shv_bullet_flyer_fragment(&flyer, bullet->bullet, &backend->world, fragment, error));
    ShvFragment *record = &backend->world.fragments->items[fragment];
    record->hulls = flyer.pieces.count;
    record->hull_outside = flyer.pieces.outside;
    record->hull_missing = flyer.pieces.missing;
    bullet->flyers[bullet->flyer_count++] = flyer;
    bullet->places[flyer.number] = bullet->flyer_count;
    bullet->untidy = true;
    return SHV_OK;
}

static void rouse(ShvBullet *bullet, int32_t number)
{
    const int32_t place = shv_bullet_place(bullet, number);
    if (place < 0) return;
    bullet->flyers[place].asleep = false;
    bullet->flyers[place].still = 0;
}

/* Takes a flyer out; what rested on or under it must find out. */
static void let_go(ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->first != flyer->number && meeting->second != flyer->number) continue;
        if (meeting->touching) rouse(bullet, meeting->first == flyer->number ? meeting->second : meeting->first);
        meeting->touching = false;
        meeting->allowance = 0.0;
    }
    bullet->places[flyer->number] = 0;
    shv_bullet_flyer_release(flyer, bullet->bullet);
    flyer->gone = bullet->untidy = true;
}

static void take_out(ShvRigidBackend *backend, int32_t fragment)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    const int32_t place = shv_bullet_place(bullet, backend->world.obstacles->count + fragment);
    if (place < 0) return;
    let_go(bullet, &bullet->flyers[place]);
}

/* ---- advance ---- */

static ShvStatus check_motion(const ShvBullet *bullet, const ShvBulletFlyer *flyer, ShvError *error)
{
    const char *kind = flyer->fragment >= 0 ? "fragment" : "obstacle";
    const int number = (int)(flyer->fragment >= 0 ? flyer->fragment : flyer->obstacle);
    if (!shv_finite3(flyer->position) || !shv_finite3(flyer->velocity) || !shv_finite3(flyer->spin))
        return shv_fail(error, SHV_DIVERGED,
                        "The motion of %s %d is not finite any more: use a smaller rigid.time_step or check its "
                        "velocities.",
                        kind, number);
    if (!(flyer->fastest * bullet->step <= SHV_LARGEST_TURN))
        return shv_fail(error, SHV_DIVERGED,
                        "The %s %d turns by %.3g rad in one rigid step of %.3g s: use a smaller rigid.time_step.", kind,
                        number, flyer->fastest * bullet->step, bullet->step);
    return SHV_OK;
}

static bool same_gravity(const ShvBullet *bullet, const ShvBulletFlyer *flyer)
{
    const ShvVec3 change = shv_sub(bullet->gravity, flyer->asleep_gravity);
    return shv_dot(change, change) == 0.0;
}

/* What comes back to flight is among what it touches, however close. */
static void note_companion(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    if (flyer->fragment < 0) return;
    const bool was = flyer->companion;
    ShvFragment *record = &bullet->backend.world.fragments->items[flyer->fragment];
    record->touches_companion = false;
    flyer->companion = record->companion;
    if (flyer->companion) {
        flyer->asleep = flyer->settled = false;
        flyer->still = 0;
    } else if (was) {
        flyer->born = true;
    }
}

static ShvStatus begin(ShvBullet *bullet, ShvError *error)
{
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        const bool changed = shv_bullet_flyer_read(flyer, &bullet->backend.world);
        flyer->settled &= !changed;
        note_companion(bullet, flyer);
        if (flyer->asleep && (changed || !same_gravity(bullet, flyer))) {
            flyer->asleep = false;
            flyer->still = 0;
        }
        flyer->fastest = flyer->moves
                             ? shv_free_rotation_fastest(&flyer->rotation, flyer->orientation, flyer->angular_momentum)
                             : shv_norm(flyer->spin);
        flyer->impact_time = -1.0;
        flyer->until = bullet->step;
        flyer->leaves = flyer->meets = flyer->thrown = flyer->stopped = flyer->held = flyer->solved = false;
        flyer->restless = flyer->supported = false;
        flyer->push = flyer->turn = shv_vec3(0.0, 0.0, 0.0);
        flyer->impulse = 0.0;
        flyer->island = i;
        flyer->new_velocity = flyer->velocity;
        flyer->new_spin = flyer->spin;
        SHV_TRY(check_motion(bullet, flyer, error));
    }
    return SHV_OK;
}

/* This step's contacts are the next one's past. */
static void end(ShvBullet *bullet)
{
    ShvBulletTrace *traces = bullet->last_traces;
    const int32_t room = bullet->last_trace_room;
    bullet->last_traces = bullet->traces;
    bullet->last_trace_room = bullet->trace_room;
    bullet->traces = traces;
    bullet->trace_room = room;
    bullet->last_step = bullet->step;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        bullet->flyers[i].born = false;
        if (bullet->flyers[i].leaves) let_go(bullet, &bullet->flyers[i]);
    }
}

/* All that flies sleeps and nothing moves among it: what is remembered of it stays. */
static bool all_at_rest(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->flyer_count; i++)
        if (shv_bullet_is_active(&bullet->flyers[i]) || !bullet->flyers[i].settled) return false;
    return true;
}

typedef struct Detection {
    ShvBullet *bullet;
    ShvWakeJudge judge;
    void *judge_data;
    ShvRigidContact *wakes;
    int32_t *wake_count;
} Detection;

/* Between Bullet's broadphase and its islands. */
static ShvStatus detect(void *data, const ShvBulletPair *pairs, int32_t count, ShvBulletTask *task, ShvError *error)
{
    const Detection *detection = data;
    ShvBullet *bullet = detection->bullet;
    SHV_TRY(shv_bullet_find(bullet, pairs, count, error));
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->traces, bullet->trace_room, bullet->contact_count,
                        "contacts of bodies", error);
    SHV_TRY(shv_bullet_judge(bullet, detection->judge, detection->judge_data, detection->wakes, detection->wake_count,
                             error));
    return shv_bullet_gather(bullet, task, error);
}

static ShvStatus advance(ShvRigidBackend *backend, double time, double step, const double gravity[3],
                         ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes, int32_t *wake_count,
                         ShvError *error)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    if (!(step > 0.0)) return SHV_OK;
    bullet->gravity = shv_load3(gravity);
    bullet->time = time;
    bullet->step = step;
    bullet->rest = shv_norm(bullet->gravity) * step;
    tidy(bullet);
    SHV_TRY(begin(bullet, error));
    if (all_at_rest(bullet)) return SHV_OK;
    SHV_TRY(shv_bullet_place_all(bullet, error));
    Detection detection = {bullet, judge, judge_data, wakes, wake_count};
    SHV_TRY(shv_bullet_world_step(bullet->bullet, step, detect, &detection, error));
    shv_bullet_take_motions(bullet);
    SHV_TRY(shv_bullet_guard(bullet, error));
    shv_bullet_move(bullet);
    end(bullet);
    return SHV_OK;
}

/* ---- life ---- */

static void destroy(ShvRigidBackend *backend)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    if (!bullet) return;
    for (int32_t i = 0; i < bullet->flyer_count; i++)
        if (!bullet->flyers[i].gone) shv_bullet_flyer_release(&bullet->flyers[i], bullet->bullet);
    shv_bullet_world_destroy(bullet->bullet);
    shv_release(bullet->flyers);
    shv_release(bullet->places);
    shv_release(bullet->meetings);
    shv_release(bullet->last_meetings);
    shv_release(bullet->contacts);
    shv_release(bullet->traces);
    shv_release(bullet->last_traces);
    shv_release(bullet->order);
    shv_release(bullet->motions);
    shv_release(bullet->gathered);
    shv_release(bullet->heaps);
    shv_release(bullet);
}

/* Radius of the largest body that is not a plane. */
static double typical_length(const ShvRigidWorld *world)
{
    double length = 0.0;
    for (int32_t i = 0; i < world->fragments->count; i++)
        if (world->fragments->items[i].mode != SHV_MODE_DEAD) length = fmax(length, world->fragments->items[i].radius);
    for (int32_t i = 0; i < world->obstacles->count && !(length > 0.0); i++)
        if (isfinite(world->obstacles->items[i].bounding_radius))
            length = fmax(length, world->obstacles->items[i].bounding_radius);
    return length > 0.0 ? length : 1.0;
}

static ShvStatus add_obstacles(ShvBullet *bullet, ShvError *error)
{
    const ShvRigidWorld *world = &bullet->backend.world;
    for (int32_t i = 0; i < world->obstacles->count; i++) {
        SHV_TRY(reserve_flyer(bullet, i, error));
        SHV_TRY(shv_bullet_flyer_obstacle(&bullet->flyers[i], bullet->bullet, world, i, error));
        bullet->places[i] = ++bullet->flyer_count;
    }
    return SHV_OK;
}

ShvStatus shv_bullet_create(ShvRigidBackend **backend, const ShvRigidWorld *world, ShvError *error)
{
    static const ShvRigidFunctions functions = {.name = "bullet",
                                                .add = add,
                                                .remove = take_out,
                                                .advance = advance,
                                                .archive = shv_bullet_archive,
                                                .destroy = destroy};
    *backend = NULL;
    ShvBullet *bullet = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 1, sizeof *bullet);
    if (!bullet) return shv_fail_memory(error, "the rigid backend", sizeof *bullet);
    bullet->backend.functions = &functions;
    bullet->backend.world = *world;
    bullet->backend.moves_obstacles = true;
    bullet->backend.fragment_friction = world->settings->friction;
    bullet->backend.fragment_restitution = world->settings->restitution;
    const ShvBulletDefinition *settings = &world->settings->bullet;
    const ShvBulletOverrides overrides = {.exact_contacts = settings->exact_contacts,
                                          .settled_impulses = settings->settled_impulses,
                                          .touching_islands = settings->touching_islands};
    ShvStatus status = shv_bullet_world_create(&bullet->bullet, typical_length(world), &overrides, error);
    if (status == SHV_OK) status = add_obstacles(bullet, error);
    if (status == SHV_OK)
        *backend = &bullet->backend;
    else
        destroy(&bullet->backend);
    return status;
}
