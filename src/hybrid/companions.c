/* Companions: fragments in flight that what is awake may touch. They stay rigid but leave flight's step for that of fracture
   mode, in which surface contact gives them its impulses and solves their other contacts with obstacles. Their records are
   kept at the present moment; velocities at half steps, as those of nodes. */
#include "hybrid/hybrid.h"

#include <string.h>

#include "hybrid/near.h"

ShvStatus shv_companions_reserve(ShvHybrid *hybrid, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    const int32_t room = hybrid->fragments.capacity;
    if (companions->room >= room) return SHV_OK;
#define GROW(name)                                                                                                     \
    SHV_RESIZE(hybrid->memory, SHV_PART_CONTACT, companions->name, (size_t)room, "companions",                         \
               (size_t)room * sizeof *companions->name, error);
    GROW(items)
    GROW(kept)
    GROW(rotations)
    GROW(impulses)
    GROW(touches)
    GROW(masses)
    GROW(wanted)
    GROW(fragments)
    GROW(by_fragment)
#undef GROW
    /* Pointers into items move with them. */
    memset(companions->by_fragment, 0, (size_t)room * sizeof *companions->by_fragment);
    for (int32_t i = 0; i < companions->count; i++)
        companions->by_fragment[companions->fragments[i]] = &companions->items[i];
    companions->room = room;
    return SHV_OK;
}

void shv_companions_release(ShvHybrid *hybrid)
{
    ShvCompanions *companions = &hybrid->companions;
    shv_release(companions->items);
    shv_release(companions->kept);
    shv_release(companions->rotations);
    shv_release(companions->impulses);
    shv_release(companions->touches);
    shv_release(companions->masses);
    shv_release(companions->wanted);
    shv_release(companions->fragments);
    shv_release(companions->by_fragment);
    memset(companions, 0, sizeof *companions);
}

ShvSurfaceBodies shv_hybrid_bodies(ShvHybrid *hybrid)
{
    return (ShvSurfaceBodies){.state = &hybrid->state,
                              .cohesive = hybrid->model.can_break ? &hybrid->cohesive : NULL,
                              .awake = hybrid->awake.flags,
                              .companions = hybrid->companions.count > 0 ? hybrid->companions.by_fragment : NULL,
                              .fragment_count = hybrid->fragments.count,
                              .obstacles = &hybrid->obstacles};
}

/* ---- coming and going ---- */

static ShvMat3 world_inverse(const ShvFragment *fragment, const ShvFreeRotation *rotation)
{
    return shv_free_rotation_world_inverse(rotation, fragment->orientation);
}

ShvStatus shv_companions_add(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    SHV_TRY(shv_companions_reserve(hybrid, error));
    ShvCompanions *companions = &hybrid->companions;
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const int32_t place = companions->count++;
    fragment->companion = true;
    companions->fragments[place] = index;
    companions->by_fragment[index] = &companions->items[place];
    companions->rotations[place] = shv_free_rotation_make(&fragment->inertia);
    companions->impulses[place] = 0.0;
    const ShvVec3 gravity = shv_load3(hybrid->gravity);
    companions->items[place] =
        (ShvCompanion){.mass = fragment->mass,
                       .inverse_inertia = world_inverse(fragment, &companions->rotations[place]),
                       .reference_centre = fragment->reference_centre,
                       .position = fragment->position,
                       .orientation = fragment->orientation,
                       .radius = fragment->radius,
                       .velocity = shv_madd(fragment->velocity, -0.5 * hybrid->state.last_step, gravity),
                       .angular_velocity = fragment->angular_velocity,
                       .alone = fragment->dust};
    shv_surface_contact_invalidate(&hybrid->surface);
    return SHV_OK;
}

/* Back to flight's step, with the velocity of now; the impulses of the step that is not taken are nobody's. */
static void let_go(ShvHybrid *hybrid, int32_t place)
{
    ShvCompanions *companions = &hybrid->companions;
    ShvFragment *fragment = &hybrid->fragments.items[companions->fragments[place]];
    const ShvCompanion *companion = &companions->items[place];
    fragment->companion = false;
    fragment->velocity = shv_madd(companion->velocity, 0.5 * hybrid->state.last_step, shv_load3(hybrid->gravity));
    fragment->angular_velocity = companion->angular_velocity;
    companions->by_fragment[fragment->id] = NULL;
    const int32_t last = --companions->count;
    if (place == last) return;
    companions->items[place] = companions->items[last];
    companions->rotations[place] = companions->rotations[last];
    companions->impulses[place] = companions->impulses[last];
    companions->fragments[place] = companions->fragments[last];
    companions->by_fragment[companions->fragments[place]] = &companions->items[place];
}

/* ---- contacts with what is in flight ---- */

/* Flight sees them with the velocities of now, */
void shv_companions_to_flight(ShvHybrid *hybrid)
{
    const double half = 0.5 * hybrid->state.last_step;
    for (int32_t i = 0; i < hybrid->companions.count; i++) {
        ShvFragment *fragment = &hybrid->fragments.items[hybrid->companions.fragments[i]];
        fragment->velocity = shv_madd(hybrid->companions.items[i].velocity, half, shv_load3(hybrid->gravity));
    }
}

/* and what it met gives them its impulses at once. */
void shv_companions_from_flight(ShvHybrid *hybrid)
{
    const double half = 0.5 * hybrid->state.last_step;
    for (int32_t i = 0; i < hybrid->companions.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[hybrid->companions.fragments[i]];
        hybrid->companions.items[i].velocity = shv_madd(fragment->velocity, -half, shv_load3(hybrid->gravity));
        hybrid->companions.items[i].angular_velocity = fragment->angular_velocity;
    }
    shv_surface_contact_recheck(&hybrid->surface);
}

void shv_companions_remove(ShvHybrid *hybrid, int32_t index)
{
    for (int32_t place = 0; place < hybrid->companions.count; place++)
        if (hybrid->companions.fragments[place] == index) {
            let_go(hybrid, place);
            break;
        }
    shv_surface_contact_wake(&hybrid->surface);
}

/* ---- waking ---- */

/* What a companion felt is judged as any contact of a rigid body. */
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
    const bool wakes = isfinite(hybrid->fragments.items[index].strength) && shv_hybrid_judge(hybrid, &contact);
    if (!wakes) return SHV_OK;
    return shv_hybrid_wake(hybrid, &contact, error);
}

ShvStatus shv_companions_judge(ShvHybrid *hybrid, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    if (companions->count == 0 || hybrid->surface.pair_count == 0) return SHV_OK;
    memset(companions->touches, 0, (size_t)hybrid->fragments.count * sizeof *companions->touches);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) companions->masses[i] = hybrid->fragments.items[i].mass;
    shv_surface_contact_by_fragment(&hybrid->surface, companions->masses, companions->touches);
    for (int32_t place = companions->count - 1; place >= 0; place--) {
        const ShvFragmentTouch *touch = &companions->touches[companions->fragments[place]];
        companions->impulses[place] += touch->impulse;
        if (touch->severity > 0.0) SHV_TRY(judge(hybrid, companions->fragments[place], touch, 0.0, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* Mean forces since the last time. */
static ShvStatus judge_loads(ShvHybrid *hybrid, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    const double time = hybrid->state.time - companions->since;
    companions->since = hybrid->state.time;
    for (int32_t place = companions->count - 1; place >= 0; place--) {
        const double impulse = companions->impulses[place];
        companions->impulses[place] = 0.0;
        if (time > 0.0) SHV_TRY(judge(hybrid, companions->fragments[place], NULL, impulse / time, error));
    }
    return shv_awake_refresh(hybrid, error);
}

/* ---- who goes along ---- */

/* Whether a fragment may come to what is awake within the interval. */
static bool comes_near(const ShvHybrid *hybrid, const ShvNear *near, const ShvFragment *fragment, double interval)
{
    const double fall = interval * shv_norm(shv_load3(hybrid->gravity));
    const double way = interval * (shv_norm(fragment->velocity) + near->speed + 2.0 * fall) + 1e-3 * fragment->radius;
    return shv_near_meets(near, fragment->position, fragment->radius + way);
}

static void choose_beside(ShvHybrid *hybrid, const ShvNear *near, double interval)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FLIGHT || fragment->dust || hybrid->companions.wanted[i]) continue;
        hybrid->companions.wanted[i] = comes_near(hybrid, near, fragment, interval);
    }
}

static bool touches(const ShvFragment *a, const ShvFragment *b)
{
    return shv_norm(shv_sub(a->position, b->position)) <= (1.0 + 1e-3) * (a->radius + b->radius);
}

/* What presses on a companion goes along with it, since flight does not know what holds that; and those that do stay while they
   are near. Returns whether there are more. */
static bool choose_pressing(const ShvHybrid *hybrid)
{
    uint8_t *wanted = hybrid->companions.wanted;
    const ShvFragment *items = hybrid->fragments.items;
    bool more = false;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        if (items[i].mode != SHV_MODE_FLIGHT || wanted[i] || !(items[i].companion || items[i].touches_companion))
            continue;
        for (int32_t k = 0; k < hybrid->fragments.count && !wanted[i]; k++)
            wanted[i] = wanted[k] && touches(&items[i], &items[k]);
        more |= wanted[i];
    }
    return more;
}

ShvStatus shv_companions_choose(ShvHybrid *hybrid, double interval, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    if (!hybrid->mutual || (hybrid->awake.count == 0 && companions->count == 0)) return SHV_OK;
    SHV_TRY(shv_companions_reserve(hybrid, error));
    SHV_TRY(judge_loads(hybrid, error));
    memset(companions->wanted, 0, (size_t)hybrid->fragments.count);
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        if (!hybrid->awake.flags[i]) continue;
        ShvNear near;
        shv_near_find(hybrid, &hybrid->fragments.items[i], &near);
        choose_beside(hybrid, &near, interval);
    }
    while (choose_pressing(hybrid)) continue;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (companions->wanted[i] && !hybrid->fragments.items[i].companion)
            SHV_TRY(shv_companions_add(hybrid, i, error));
    for (int32_t place = companions->count - 1; place >= 0; place--)
        if (!companions->wanted[companions->fragments[place]]) {
            let_go(hybrid, place);
            shv_surface_contact_invalidate(&hybrid->surface);
        }
    return SHV_OK;
}

/* ---- the step ---- */

void shv_companions_kick(ShvHybrid *hybrid, double kick)
{
    for (int32_t i = 0; i < hybrid->companions.count; i++) {
        ShvCompanion *companion = &hybrid->companions.items[i];
        companion->velocity = shv_madd(companion->velocity, kick, shv_load3(hybrid->gravity));
    }
}

void shv_companions_drift(ShvHybrid *hybrid, double step)
{
    ShvCompanions *companions = &hybrid->companions;
    for (int32_t i = 0; i < companions->count; i++) {
        ShvCompanion *companion = &companions->items[i];
        ShvFragment *fragment = &hybrid->fragments.items[companions->fragments[i]];
        const ShvFreeRotation *rotation = &companions->rotations[i];
        const ShvVec3 momentum =
            shv_free_rotation_momentum(rotation, companion->orientation, companion->angular_velocity);
        companion->position = shv_madd(companion->position, step, companion->velocity);
        companion->orientation = shv_free_rotation_advance(rotation, companion->orientation, momentum, step);
        companion->angular_velocity = shv_free_rotation_velocity(rotation, companion->orientation, momentum);
        fragment->position = companion->position;
        fragment->orientation = companion->orientation;
        fragment->velocity = companion->velocity;
        fragment->angular_velocity = companion->angular_velocity;
        companion->inverse_inertia = world_inverse(fragment, rotation);
    }
}

/* ---- the present moment ---- */

void shv_companions_keep(ShvHybrid *hybrid)
{
    ShvCompanions *companions = &hybrid->companions;
    if (companions->count > 0)
        memcpy(companions->kept, companions->items, (size_t)companions->count * sizeof *companions->items);
}

/* After a ghost step: records get the mean velocities, companions their own back. Kinetic energy is ½ m v₋·v₊ + ½ ω₋·I ω₊. */
double shv_companions_put_back(ShvHybrid *hybrid)
{
    ShvCompanions *companions = &hybrid->companions;
    double kinetic = 0.0;
    for (int32_t i = 0; i < companions->count; i++) {
        const ShvCompanion *before = &companions->kept[i], *after = &companions->items[i];
        ShvFragment *fragment = &hybrid->fragments.items[companions->fragments[i]];
        const ShvMat3 inertia = shv_fragment_world_inertia(fragment);
        kinetic += 0.5 * fragment->mass * shv_dot(before->velocity, after->velocity) +
                   0.5 * shv_dot(before->angular_velocity, shv_apply(&inertia, after->angular_velocity));
        fragment->velocity = shv_scale(shv_add(before->velocity, after->velocity), 0.5);
        fragment->angular_velocity = shv_scale(shv_add(before->angular_velocity, after->angular_velocity), 0.5);
    }
    if (companions->count > 0)
        memcpy(companions->items, companions->kept, (size_t)companions->count * sizeof *companions->items);
    return kinetic;
}
