#include "rigid/bullet_archive.h"

#include <stdlib.h>

/* ---- bodies ---- */

static int by_number(const void *x, const void *y)
{
    const ShvBulletRigidBody *a = x, *b = y;
    return (a->number > b->number) - (a->number < b->number);
}

/* Bodies by number again, without those that have gone. */
static void tidy(ShvBullet *bullet)
{
    if (!bullet->untidy) return;
    bullet->untidy = false;
    int32_t kept = 0;
    bool sorted = true;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        if (bullet->bodies[i].gone) continue;
        if (kept < i) bullet->bodies[kept] = bullet->bodies[i];
        sorted = sorted && (kept == 0 || bullet->bodies[kept - 1].number < bullet->bodies[kept].number);
        kept++;
    }
    bullet->body_count = kept;
    if (!sorted) qsort(bullet->bodies, (size_t)kept, sizeof *bullet->bodies, by_number);
    for (int32_t i = 0; i < bullet->place_count; i++) bullet->places[i] = 0;
    for (int32_t i = 0; i < kept; i++) bullet->places[bullet->bodies[i].number] = i + 1;
}

static ShvStatus reserve_body(ShvBullet *bullet, int32_t number, ShvError *error)
{
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->bodies, bullet->body_room, (int64_t)bullet->body_count + 1,
                        "the fragments in flight", error);
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->places, bullet->place_room, (int64_t)number + 1,
                        "the fragments in flight", error);
    while (bullet->place_count <= number) bullet->places[bullet->place_count++] = 0;
    return SHV_OK;
}

static ShvStatus add(ShvRigidBackend *backend, int32_t fragment, ShvError *error)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    SHV_TRY(reserve_body(bullet, backend->world.obstacles->count + fragment, error));
    ShvBulletRigidBody body;
    SHV_TRY(shv_bullet_body_fragment(&body, bullet->bullet, &backend->world, fragment, error));
    ShvFragment *record = &backend->world.fragments->items[fragment];
    record->hulls = body.pieces.count;
    record->hull_outside = body.pieces.outside;
    record->hull_missing = body.pieces.missing;
    bullet->bodies[bullet->body_count++] = body;
    bullet->places[body.number] = bullet->body_count;
    bullet->untidy = true;
    return SHV_OK;
}

static void rouse(ShvBullet *bullet, int32_t number)
{
    const int32_t place = shv_bullet_place(bullet, number);
    if (place < 0) return;
    bullet->bodies[place].asleep = false;
    bullet->bodies[place].still = 0;
}

/* Takes a body out; what rested on or under it must find out. */
static void let_go(ShvBullet *bullet, ShvBulletRigidBody *body)
{
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->first != body->number && contact_pair->second != body->number) continue;
        if (contact_pair->touching)
            rouse(bullet, contact_pair->first == body->number ? contact_pair->second : contact_pair->first);
        contact_pair->touching = false;
        contact_pair->allowed_penetration = 0.0;
    }
    bullet->places[body->number] = 0;
    shv_bullet_body_release(body, bullet->bullet);
    body->gone = bullet->untidy = true;
}

static void take_out(ShvRigidBackend *backend, int32_t fragment)
{
    ShvBullet *bullet = (ShvBullet *)backend;
    const int32_t place = shv_bullet_place(bullet, backend->world.obstacles->count + fragment);
    if (place < 0) return;
    let_go(bullet, &bullet->bodies[place]);
}

/* ---- advance ---- */

static ShvStatus check_motion(const ShvBullet *bullet, const ShvBulletRigidBody *body, ShvError *error)
{
    const bool fragment = body->fragment >= 0;
    return shv_rigid_check_motion(fragment ? "fragment" : "obstacle", fragment ? body->fragment : body->obstacle,
                                  body->position, body->velocity, body->spin, body->fastest * bullet->step, error);
}

static bool same_gravity(const ShvBullet *bullet, const ShvBulletRigidBody *body)
{
    const ShvVec3 change = shv_sub(bullet->gravity, body->asleep_gravity);
    return shv_dot(change, change) == 0.0;
}

/* What comes back to flight is among what it touches, however close. */
static void note_coupled_body(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    if (body->fragment < 0) return;
    const bool was = body->coupled;
    ShvFragment *record = &bullet->backend.world.fragments->items[body->fragment];
    record->touches_coupled = false;
    body->coupled = record->coupled;
    if (body->coupled) {
        body->asleep = body->settled = false;
        body->still = 0;
    } else if (was) {
        body->born = true;
    }
}

static ShvStatus begin(ShvBullet *bullet, ShvError *error)
{
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        const bool changed = shv_bullet_body_read(body, &bullet->backend.world);
        body->settled &= !changed;
        note_coupled_body(bullet, body);
        if (body->asleep && (changed || !same_gravity(bullet, body))) {
            body->asleep = false;
            body->still = 0;
        }
        body->fastest = body->moves
                            ? shv_free_rotation_fastest(&body->rotation, body->orientation, body->angular_momentum)
                            : shv_norm(body->spin);
        body->impact_time = -1.0;
        body->until = bullet->step;
        body->leaves = body->waits = body->meets = body->later_impact = body->thrown = false;
        body->stopped = body->held = body->solved = body->restless = body->supported = false;
        body->rebounds = body->kinematic = false;
        body->work = body->square = 0.0;
        body->push = body->turn = shv_vec3(0.0, 0.0, 0.0);
        body->impulse = 0.0;
        body->island = i;
        body->new_velocity = body->velocity;
        body->new_spin = body->spin;
        SHV_TRY(check_motion(bullet, body, error));
    }
    return SHV_OK;
}

/* This step's contacts are the next one's past. */
static void end(ShvBullet *bullet)
{
    ShvCachedImpulse *cached_impulses = bullet->last_cached_impulses;
    const int32_t room = bullet->last_cached_impulse_room;
    bullet->last_cached_impulses = bullet->cached_impulses;
    bullet->last_cached_impulse_room = bullet->cached_impulse_room;
    bullet->cached_impulses = cached_impulses;
    bullet->cached_impulse_room = room;
    bullet->last_step = bullet->step;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        bullet->bodies[i].born = false;
        if (bullet->bodies[i].leaves) let_go(bullet, &bullet->bodies[i]);
    }
}

/* All that flies sleeps and nothing moves among it: what is remembered of it stays. */
static bool all_at_rest(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->body_count; i++)
        if (shv_bullet_is_active(&bullet->bodies[i]) || !bullet->bodies[i].settled) return false;
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
    SHV_BACKEND_RESERVE(&bullet->backend, bullet->cached_impulses, bullet->cached_impulse_room, bullet->contact_count,
                        "contacts of bodies", error);
    SHV_TRY(shv_bullet_judge(bullet, detection->judge, detection->judge_data, detection->wakes, detection->wake_count,
                             error));
    return shv_bullet_set_up_contacts(bullet, task, error);
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
    shv_bullet_limit_rebounds(bullet);
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
    for (int32_t i = 0; i < bullet->body_count; i++)
        if (!bullet->bodies[i].gone) shv_bullet_body_release(&bullet->bodies[i], bullet->bullet);
    shv_bullet_world_destroy(bullet->bullet);
    shv_release(bullet->bodies);
    shv_release(bullet->places);
    shv_release(bullet->contact_pairs);
    shv_release(bullet->last_contact_pairs);
    shv_release(bullet->contacts);
    shv_release(bullet->cached_impulses);
    shv_release(bullet->last_cached_impulses);
    shv_release(bullet->order);
    shv_release(bullet->motions);
    shv_release(bullet->active_contacts);
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
        SHV_TRY(reserve_body(bullet, i, error));
        SHV_TRY(shv_bullet_body_obstacle(&bullet->bodies[i], bullet->bullet, world, i, error));
        bullet->places[i] = ++bullet->body_count;
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
