/* Coupled bodies: fragments in flight that what is awake may touch. They stay rigid but leave flight's step for that of fracture
   mode, in which surface contact gives them its impulses and solves their other contacts with obstacles. Their records are
   kept at the present time; velocities at half steps, as those of nodes. */
#include "coupling/hybrid.h"

#include <string.h>

#include "base/disjoint_sets.h"
#include "coupling/near.h"

ShvStatus shv_coupled_bodies_reserve(ShvHybrid *hybrid, ShvError *error)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    const int32_t room = hybrid->fragments.capacity;
    if (coupled_bodies->room >= room) return SHV_OK;
#define GROW(name)                                                                                                     \
    SHV_RESIZE(hybrid->memory, SHV_PART_CONTACT, coupled_bodies->name, (size_t)room, "coupled bodies",                 \
               (size_t)room * sizeof *coupled_bodies->name, error);
    GROW(items)
    GROW(kept)
    GROW(rotations)
    GROW(impulses)
    GROW(touches)
    GROW(masses)
    GROW(wanted)
    GROW(island)
    GROW(fragments)
    GROW(by_fragment)
#undef GROW
    /* Pointers into items move with them. */
    memset(coupled_bodies->by_fragment, 0, (size_t)room * sizeof *coupled_bodies->by_fragment);
    for (int32_t i = 0; i < coupled_bodies->count; i++)
        coupled_bodies->by_fragment[coupled_bodies->fragments[i]] = &coupled_bodies->items[i];
    coupled_bodies->room = room;
    return SHV_OK;
}

void shv_coupled_bodies_release(ShvHybrid *hybrid)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    shv_release(coupled_bodies->items);
    shv_release(coupled_bodies->kept);
    shv_release(coupled_bodies->rotations);
    shv_release(coupled_bodies->impulses);
    shv_release(coupled_bodies->touches);
    shv_release(coupled_bodies->masses);
    shv_release(coupled_bodies->wanted);
    shv_release(coupled_bodies->island);
    shv_release(coupled_bodies->fragments);
    shv_release(coupled_bodies->by_fragment);
    memset(coupled_bodies, 0, sizeof *coupled_bodies);
}

ShvSurfaceBodies shv_hybrid_bodies(ShvHybrid *hybrid)
{
    return (ShvSurfaceBodies){.state = &hybrid->state,
                              .cohesive = hybrid->model.can_break ? &hybrid->cohesive : NULL,
                              .awake = hybrid->awake.flags,
                              .coupled_bodies =
                                  hybrid->coupling.bodies.count > 0 ? hybrid->coupling.bodies.by_fragment : NULL,
                              .fragment_count = hybrid->fragments.count,
                              .obstacles = &hybrid->obstacles,
                              .gravity = shv_load3(hybrid->gravity),
                              .apart = !hybrid->coupling.mutual,
                              .barred = hybrid->stabiliser.active};
}

/* ---- coming and going ---- */

static ShvMat3 world_inverse(const ShvFragment *fragment, const ShvFreeRotation *rotation)
{
    return shv_free_rotation_world_inverse(rotation, fragment->orientation);
}

/* What supports hold goes along awake: it has no motion as a rigid body. */
ShvStatus shv_coupled_bodies_add(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    if (hybrid->fragments.items[index].fixed) return shv_hybrid_wake_alone(hybrid, index, error);
    SHV_TRY(shv_coupled_bodies_reserve(hybrid, error));
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const int32_t place = coupled_bodies->count++;
    fragment->coupled = true;
    coupled_bodies->fragments[place] = index;
    coupled_bodies->by_fragment[index] = &coupled_bodies->items[place];
    coupled_bodies->rotations[place] = shv_free_rotation_make(&fragment->inertia);
    coupled_bodies->impulses[place] = 0.0;
    coupled_bodies->island[index] = index;
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    coupled_bodies->items[place] =
        (ShvCoupledBody){.mass = fragment->mass,
                         .inverse_inertia = world_inverse(fragment, &coupled_bodies->rotations[place]),
                         .reference_centre = fragment->reference_centre,
                         .position = fragment->position,
                         .orientation = fragment->orientation,
                         .radius = fragment->radius,
                         .velocity = shv_madd(fragment->velocity, -0.5 * hybrid->state.last_step, gravity),
                         .angular_velocity = fragment->angular_velocity,
                         .alone = fragment->dust};
    shv_surface_contact_invalidate(&hybrid->coupling.surface);
    return SHV_OK;
}

/* Back to flight's step, with the velocity of now; the impulses of the step that is not taken are nobody's. */
static void let_go(ShvHybrid *hybrid, int32_t place)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    ShvFragment *fragment = &hybrid->fragments.items[coupled_bodies->fragments[place]];
    const ShvCoupledBody *coupled_body = &coupled_bodies->items[place];
    fragment->coupled = false;
    fragment->velocity = shv_madd(coupled_body->velocity, 0.5 * hybrid->state.last_step, shv_load3(hybrid->gravity));
    fragment->angular_velocity = coupled_body->angular_velocity;
    coupled_bodies->by_fragment[fragment->id] = NULL;
    const int32_t last = --coupled_bodies->count;
    if (place == last) return;
    coupled_bodies->items[place] = coupled_bodies->items[last];
    coupled_bodies->rotations[place] = coupled_bodies->rotations[last];
    coupled_bodies->impulses[place] = coupled_bodies->impulses[last];
    coupled_bodies->fragments[place] = coupled_bodies->fragments[last];
    coupled_bodies->by_fragment[coupled_bodies->fragments[place]] = &coupled_bodies->items[place];
}

/* ---- contacts with what is in flight ---- */

/* Flight sees them with the velocities of now, which gravity alone has changed since the last kick (records are those of the observer
   after a frame: with half of the next one's impulses), */
void shv_coupled_bodies_to_flight(ShvHybrid *hybrid)
{
    const double half = 0.5 * hybrid->state.last_step;
    for (int32_t i = 0; i < hybrid->coupling.bodies.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[hybrid->coupling.bodies.fragments[i]];
        fragment->velocity = shv_madd(hybrid->coupling.bodies.items[i].velocity, half, shv_load3(hybrid->gravity));
        fragment->angular_velocity = hybrid->coupling.bodies.items[i].angular_velocity;
    }
}

/* and what it met gives them its impulses at once. */
void shv_coupled_bodies_from_flight(ShvHybrid *hybrid)
{
    const double half = 0.5 * hybrid->state.last_step;
    for (int32_t i = 0; i < hybrid->coupling.bodies.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[hybrid->coupling.bodies.fragments[i]];
        hybrid->coupling.bodies.items[i].velocity = shv_madd(fragment->velocity, -half, shv_load3(hybrid->gravity));
        hybrid->coupling.bodies.items[i].angular_velocity = fragment->angular_velocity;
    }
    shv_surface_contact_recheck(&hybrid->coupling.surface);
}

void shv_coupled_bodies_remove(ShvHybrid *hybrid, int32_t index)
{
    for (int32_t place = 0; place < hybrid->coupling.bodies.count; place++)
        if (hybrid->coupling.bodies.fragments[place] == index) {
            let_go(hybrid, place);
            break;
        }
    shv_surface_contact_wake(&hybrid->coupling.surface);
}

/* ---- what presses on what ---- */

/* Coupled bodies that have pressed on each other since the interval began are of one island. */
static void join_islands(ShvHybrid *hybrid)
{
    const ShvSurfaceContact *surface = &hybrid->coupling.surface;
    ShvCoupledBody **by_fragment = hybrid->coupling.bodies.by_fragment;
    int32_t *island = hybrid->coupling.bodies.island;
    for (int32_t k = 0; k < surface->pair_count; k++) {
        const ShvFacetPair *pair = &surface->pairs[k];
        if (pair->element < 0 || !(pair->normal_impulse > 0.0)) continue;
        if (!by_fragment[pair->fragments[0]] || !by_fragment[pair->fragments[1]]) continue;
        shv_set_join(island, pair->fragments[0], pair->fragments[1]);
    }
}

/* ---- waking ---- */

/* What a coupled body felt is judged as any contact of a rigid body. */
static ShvStatus judge(ShvHybrid *hybrid, int32_t index, const ShvFragmentTouch *touch, double load, ShvError *error)
{
    const ShvRigidContact contact = {.fragment = index,
                                     .obstacle = -1,
                                     .other = -1,
                                     .time = hybrid->state.time,
                                     .closing_speed = touch ? touch->closing_speed : 0.0,
                                     .fresh = touch && touch->severity > 0.0,
                                     .other_mass = touch ? touch->other_mass : 0.0,
                                     .load = load};
    return shv_hybrid_judge(hybrid, &contact) ? shv_hybrid_wake(hybrid, &contact, error) : SHV_OK;
}

ShvStatus shv_coupled_bodies_judge(ShvHybrid *hybrid, ShvError *error)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    if (coupled_bodies->count == 0 || hybrid->coupling.surface.pair_count == 0) return SHV_OK;
    join_islands(hybrid);
    memset(coupled_bodies->touches, 0, (size_t)hybrid->fragments.count * sizeof *coupled_bodies->touches);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) coupled_bodies->masses[i] = hybrid->fragments.items[i].mass;
    shv_surface_contact_by_fragment(&hybrid->coupling.surface, coupled_bodies->masses, coupled_bodies->touches);
    for (int32_t place = coupled_bodies->count - 1; place >= 0; place--) {
        const ShvFragmentTouch *touch = &coupled_bodies->touches[coupled_bodies->fragments[place]];
        coupled_bodies->impulses[place] += touch->impulse;
        if (touch->severity > 0.0) SHV_TRY(judge(hybrid, coupled_bodies->fragments[place], touch, 0.0, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* Mean forces since the last time. */
static ShvStatus judge_loads(ShvHybrid *hybrid, ShvError *error)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    const double time = hybrid->state.time - coupled_bodies->since;
    coupled_bodies->since = hybrid->state.time;
    for (int32_t place = coupled_bodies->count - 1; place >= 0; place--) {
        const double impulse = coupled_bodies->impulses[place];
        coupled_bodies->impulses[place] = 0.0;
        if (time > 0.0) SHV_TRY(judge(hybrid, coupled_bodies->fragments[place], NULL, impulse / time, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* ---- who goes along ---- */

/* Of the radius: a distance that counts as contact when it is asked who goes along. */
static const double margin_of_radius = 1e-3;

/* Whether a fragment may come to what is awake within the interval. */
static bool comes_near(const ShvHybrid *hybrid, const ShvNear *near, const ShvFragment *fragment, double interval)
{
    const double fall = interval * shv_norm(shv_load3(hybrid->gravity));
    const double travel =
        interval * (shv_norm(fragment->velocity) + near->speed + 2.0 * fall) + margin_of_radius * fragment->radius;
    return shv_near_meets(near, fragment->position, fragment->radius + travel);
}

static void choose_beside(ShvHybrid *hybrid, const ShvNear *near, double interval)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FLIGHT || fragment->dust || hybrid->coupling.bodies.wanted[i]) continue;
        hybrid->coupling.bodies.wanted[i] = comes_near(hybrid, near, fragment, interval);
    }
}

static bool touches(const ShvFragment *a, const ShvFragment *b)
{
    return shv_norm(shv_sub(a->position, b->position)) <= (1.0 + margin_of_radius) * (a->radius + b->radius);
}

/* What presses on a coupled body goes along with it, since flight does not know what holds that: coupled bodies of one island while
   they press, */
static void choose_islands(ShvHybrid *hybrid)
{
    enum { CHOSEN = 1, ISLAND_CHOSEN = 2 };
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    int32_t *island = coupled_bodies->island;
    uint8_t *wanted = coupled_bodies->wanted;
    for (int32_t place = 0; place < coupled_bodies->count; place++) {
        const int32_t fragment = coupled_bodies->fragments[place], root = shv_set_root(island, fragment);
        if (wanted[fragment] & CHOSEN) wanted[root] |= ISLAND_CHOSEN;
    }
    for (int32_t place = 0; place < coupled_bodies->count; place++) {
        const int32_t fragment = coupled_bodies->fragments[place], root = shv_set_root(island, fragment);
        if (wanted[root] & ISLAND_CHOSEN) wanted[fragment] |= CHOSEN;
    }
    for (int32_t place = 0; place < coupled_bodies->count; place++) {
        const int32_t fragment = coupled_bodies->fragments[place];
        wanted[shv_set_root(island, fragment)] &= CHOSEN; /* the root may be no coupled body any more */
        island[fragment] = fragment;
    }
}

/* and what has met one in flight. Returns whether there are more. */
static bool choose_pressing(const ShvHybrid *hybrid)
{
    uint8_t *wanted = hybrid->coupling.bodies.wanted;
    const ShvFragment *items = hybrid->fragments.items;
    bool more = false;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        if (items[i].mode != SHV_MODE_FLIGHT || wanted[i] || !items[i].touches_coupled) continue;
        for (int32_t k = 0; k < hybrid->fragments.count && !wanted[i]; k++)
            wanted[i] = wanted[k] && touches(&items[i], &items[k]);
        more |= wanted[i];
    }
    return more;
}

ShvStatus shv_coupled_bodies_choose(ShvHybrid *hybrid, double interval, ShvError *error)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    if (!hybrid->coupling.mutual || (hybrid->awake.count == 0 && coupled_bodies->count == 0)) return SHV_OK;
    SHV_TRY(shv_coupled_bodies_reserve(hybrid, error));
    SHV_TRY(judge_loads(hybrid, error));
    memset(coupled_bodies->wanted, 0, (size_t)hybrid->fragments.count);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        if (!hybrid->awake.flags[i]) continue;
        ShvNear near;
        shv_near_find(hybrid, &hybrid->fragments.items[i], &near);
        choose_beside(hybrid, &near, interval);
    }
    choose_islands(hybrid);
    while (choose_pressing(hybrid)) continue;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (coupled_bodies->wanted[i] && !hybrid->fragments.items[i].coupled)
            SHV_TRY(shv_coupled_bodies_add(hybrid, i, error));
    for (int32_t place = coupled_bodies->count - 1; place >= 0; place--)
        if (!coupled_bodies->wanted[coupled_bodies->fragments[place]]) {
            let_go(hybrid, place);
            shv_surface_contact_invalidate(&hybrid->coupling.surface);
        }
    return shv_awake_refresh(hybrid, error);
}

/* ---- the step ---- */

void shv_coupled_bodies_kick(ShvHybrid *hybrid, double kick)
{
    for (int32_t i = 0; i < hybrid->coupling.bodies.count; i++) {
        ShvCoupledBody *coupled_body = &hybrid->coupling.bodies.items[i];
        coupled_body->velocity = shv_madd(coupled_body->velocity, kick, shv_load3(hybrid->gravity));
    }
}

void shv_coupled_bodies_drift(ShvHybrid *hybrid, double step)
{
    enum { WORTH_THREADS = 64 };
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
#pragma omp parallel for schedule(static) num_threads(hybrid->model.threads) if (coupled_bodies->count > WORTH_THREADS)
    for (int32_t i = 0; i < coupled_bodies->count; i++) {
        ShvCoupledBody *coupled_body = &coupled_bodies->items[i];
        ShvFragment *fragment = &hybrid->fragments.items[coupled_bodies->fragments[i]];
        const ShvFreeRotation *rotation = &coupled_bodies->rotations[i];
        const ShvVec3 momentum =
            shv_free_rotation_momentum(rotation, coupled_body->orientation, coupled_body->angular_velocity);
        coupled_body->position = shv_madd(coupled_body->position, step, coupled_body->velocity);
        coupled_body->orientation = shv_free_rotation_advance(rotation, coupled_body->orientation, momentum, step);
        coupled_body->angular_velocity = shv_free_rotation_velocity(rotation, coupled_body->orientation, momentum);
        fragment->position = coupled_body->position;
        fragment->orientation = coupled_body->orientation;
        fragment->velocity = coupled_body->velocity;
        fragment->angular_velocity = coupled_body->angular_velocity;
        coupled_body->inverse_inertia = world_inverse(fragment, rotation);
    }
}

/* ---- the present time ---- */

void shv_coupled_bodies_keep(ShvHybrid *hybrid)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    if (coupled_bodies->count > 0)
        memcpy(coupled_bodies->kept, coupled_bodies->items,
               (size_t)coupled_bodies->count * sizeof *coupled_bodies->items);
}

/* After a ghost step: records get the mean velocities, coupled bodies their own back. Kinetic energy is ½ m v₋·v₊ + ½ ω₋·I ω₊. */
double shv_coupled_bodies_put_back(ShvHybrid *hybrid)
{
    ShvCoupledBodies *coupled_bodies = &hybrid->coupling.bodies;
    double kinetic = 0.0;
    for (int32_t i = 0; i < coupled_bodies->count; i++) {
        const ShvCoupledBody *before = &coupled_bodies->kept[i], *after = &coupled_bodies->items[i];
        ShvFragment *fragment = &hybrid->fragments.items[coupled_bodies->fragments[i]];
        const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
        kinetic += 0.5 * fragment->mass * shv_dot(before->velocity, after->velocity) +
                   0.5 * shv_dot(before->angular_velocity, shv_apply(&inertia, after->angular_velocity));
        fragment->velocity = shv_scale(shv_add(before->velocity, after->velocity), 0.5);
        fragment->angular_velocity = shv_scale(shv_add(before->angular_velocity, after->angular_velocity), 0.5);
    }
    if (coupled_bodies->count > 0)
        memcpy(coupled_bodies->items, coupled_bodies->kept,
               (size_t)coupled_bodies->count * sizeof *coupled_bodies->items);
    return kinetic;
}
