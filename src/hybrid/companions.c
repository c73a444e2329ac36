/* Companions: fragments in flight that what is awake may touch. They stay rigid but leave flight's step for that of fracture
   mode, in which surface contact gives them its impulses and solves their other contacts with obstacles. Their records are
   kept at the present moment; velocities at half steps, as those of nodes. */
#include "hybrid/hybrid.h"

#include <string.h>

#include "contact/box.h"

#define GROW(block, part, count, error)                                                                                \
    do {                                                                                                               \
        void *grown_ = shv_reallocate(hybrid->memory, part, block, (size_t)(count), sizeof *(block));                  \
        if (!grown_) return shv_fail_memory(error, "companions", (size_t)(count) * sizeof *(block));                   \
        (block) = grown_;                                                                                              \
    } while (0)

ShvStatus shv_companions_reserve(ShvHybrid *hybrid, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    const int32_t room = hybrid->fragments.capacity;
    if (companions->room >= room) return SHV_OK;
    /* Pointers into items move with them. */
    GROW(companions->items, SHV_PART_CONTACT, room, error);
    GROW(companions->kept, SHV_PART_CONTACT, room, error);
    GROW(companions->rotations, SHV_PART_CONTACT, room, error);
    GROW(companions->impulses, SHV_PART_CONTACT, room, error);
    GROW(companions->touches, SHV_PART_CONTACT, room, error);
    GROW(companions->fragments, SHV_PART_CONTACT, room, error);
    GROW(companions->by_fragment, SHV_PART_CONTACT, room, error);
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
                       .angular_velocity = fragment->angular_velocity};
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
                                     .fresh = touch && touch->fresh > 0,
                                     .other_mass = hybrid->companions.awake_mass,
                                     .load = load};
    const bool wakes = isfinite(hybrid->fragments.items[index].strength) && shv_hybrid_judge(hybrid, &contact);
    return wakes ? shv_hybrid_wake(hybrid, &contact, error) : SHV_OK;
}

ShvStatus shv_companions_judge(ShvHybrid *hybrid, ShvError *error)
{
    ShvCompanions *companions = &hybrid->companions;
    if (companions->count == 0 || hybrid->surface.touching == 0) return SHV_OK;
    memset(companions->touches, 0, (size_t)hybrid->fragments.count * sizeof *companions->touches);
    shv_surface_contact_by_fragment(&hybrid->surface, companions->touches);
    for (int32_t place = companions->count - 1; place >= 0; place--) {
        const ShvFragmentTouch *touch = &companions->touches[companions->fragments[place]];
        companions->impulses[place] += touch->impulse;
        if (touch->fresh > 0) SHV_TRY(judge(hybrid, companions->fragments[place], touch, 0.0, error));
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
    companions->awake_mass = 0.0;
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].mode == SHV_MODE_FRACTURE)
            companions->awake_mass += hybrid->fragments.items[i].mass;
    return shv_awake_refresh(hybrid, error);
}

/* ---- who is near ---- */

typedef struct Near {
    ShvBox box;   /* of an awake fragment's nodes */
    double speed; /* m/s, their largest */
} Near;

static Near near_of(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    Near near = {.box = shv_box_empty(), .speed = 0.0};
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        shv_box_add(&near.box, shv_state_position(&hybrid->state, node));
        near.speed = fmax(near.speed, shv_norm(shv_load3(hybrid->state.velocity + 3 * (int64_t)node)));
    }
    return near;
}

/* Distance of a point from a box, 0 inside. */
static double distance(const ShvBox *box, ShvVec3 p)
{
    const ShvVec3 out = {fmax(0.0, fmax(box->low.x - p.x, p.x - box->high.x)),
                         fmax(0.0, fmax(box->low.y - p.y, p.y - box->high.y)),
                         fmax(0.0, fmax(box->low.z - p.z, p.z - box->high.z))};
    return shv_norm(out);
}

/* Whether a fragment's sphere may come to the box within the interval; companions stay until they are twice as far. */
static bool comes_near(const ShvHybrid *hybrid, const ShvFragment *fragment, const Near *near, double interval)
{
    const double fall = interval * shv_norm(shv_load3(hybrid->gravity));
    const double way = interval * (shv_norm(fragment->velocity) + near->speed + 2.0 * fall) + 1e-3 * fragment->radius;
    return distance(&near->box, fragment->position) <= fragment->radius + (fragment->companion ? 2.0 : 1.0) * way;
}

static ShvStatus choose_beside(ShvHybrid *hybrid, const Near *near, double interval, uint8_t *wanted, ShvError *error)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        if (fragment->mode != SHV_MODE_FLIGHT || fragment->dust || wanted[i] ||
            !comes_near(hybrid, fragment, near, interval))
            continue;
        wanted[i] = 1;
        if (!fragment->companion) SHV_TRY(shv_companions_add(hybrid, i, error));
    }
    return SHV_OK;
}

ShvStatus shv_companions_choose(ShvHybrid *hybrid, double interval, ShvError *error)
{
    if (!hybrid->mutual || (hybrid->awake.count == 0 && hybrid->companions.count == 0)) return SHV_OK;
    SHV_TRY(judge_loads(hybrid, error));
    uint8_t *wanted = shv_allocate(hybrid->memory, SHV_PART_CONTACT, (size_t)hybrid->fragments.count, 1);
    if (!wanted) return shv_fail_memory(error, "companions", (size_t)hybrid->fragments.count);
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < hybrid->fragments.count && status == SHV_OK; i++) {
        if (!hybrid->awake.flags[i]) continue;
        const Near near = near_of(hybrid, &hybrid->fragments.items[i]);
        status = choose_beside(hybrid, &near, interval, wanted, error);
    }
    for (int32_t place = hybrid->companions.count - 1; place >= 0; place--)
        if (status == SHV_OK && !wanted[hybrid->companions.fragments[place]]) {
            let_go(hybrid, place);
            shv_surface_contact_invalidate(&hybrid->surface);
        }
    shv_release(wanted);
    return status;
}

/* ---- the step ---- */

/* Of the contacts with what is in flight, W. */
static double power(const ShvCompanion *companion, const ShvFragment *fragment)
{
    return shv_dot(fragment->contact_force, companion->velocity) +
           shv_dot(fragment->contact_torque, companion->angular_velocity);
}

void shv_companions_kick(ShvHybrid *hybrid, double kick)
{
    for (int32_t i = 0; i < hybrid->companions.count; i++) {
        ShvCompanion *companion = &hybrid->companions.items[i];
        const ShvFragment *fragment = &hybrid->fragments.items[hybrid->companions.fragments[i]];
        const ShvVec3 pull = shv_madd(shv_load3(hybrid->gravity), 1.0 / companion->mass, fragment->contact_force);
        const double before = power(companion, fragment);
        companion->velocity = shv_madd(companion->velocity, kick, pull);
        companion->angular_velocity = shv_madd(companion->angular_velocity, kick,
                                               shv_apply(&companion->inverse_inertia, fragment->contact_torque));
        shv_ledger_book(&hybrid->ledger, SHV_WORK_CONTACT, 0.5 * kick * before,
                        0.5 * kick * power(companion, fragment));
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
