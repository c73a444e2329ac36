#include "contact/node_contact.h"

#include "contact/candidates.h"

enum { MOST_SWEEPS = 64, MOST_ROUNDS = 4 };
/* Of a pair's speed before any response: what it may still close with when the sweeps are used up without being reported as
   unresolved. */
static const double unresolved_of_speed = 1e-6;

void shv_node_contact_create(ShvNodeContact *contact, ShvMemory *memory)
{
    *contact = (ShvNodeContact){.memory = memory, .stale = true, .next_time = (double)NAN};
}

void shv_node_contact_release(ShvNodeContact *contact)
{
    shv_release(contact->candidates);
    shv_release(contact->boundary);
    shv_release(contact->facets);
    shv_release(contact->last_touch);
    shv_release(contact->pairs);
    shv_release(contact->touches);
    *contact = (ShvNodeContact){0};
}

void shv_node_contact_know_surface(ShvNodeContact *contact, ShvNodeSurface surface)
{
    contact->surface = surface;
    contact->stale = true;
}

void shv_node_contact_invalidate(ShvNodeContact *contact)
{
    contact->stale = true;
}

void shv_node_contact_follow(ShvNodeContact *contact)
{
    contact->split = true;
}

/* ---- pairs ---- */

/* Copies have touched when their origin has. */
static ShvStatus know_nodes(ShvNodeContact *contact, const ShvState *state, ShvError *error)
{
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->last_touch, contact->node_capacity, state->node_count,
                "contact", error);
    for (; contact->known_nodes < state->node_count; contact->known_nodes++)
        contact->last_touch[contact->known_nodes] = contact->last_touch[state->origin[contact->known_nodes]];
    return SHV_OK;
}

/* Mean velocity of an obstacle's material over the coming step. */
static ShvVec3 obstacle_velocity(const ShvObstacle *obstacle, ShvVec3 point, double step, ShvVec3 gravity)
{
    const ShvVec3 velocity = shv_obstacle_velocity(obstacle, point);
    return obstacle->motion == SHV_OBSTACLE_FREE ? shv_madd(velocity, 0.5 * step, gravity) : velocity;
}

/* A node that would pass the tangent plane at its closest point may miss the obstacle or meet it elsewhere: its way
   decides, so that thin obstacles stop fast nodes and corners do not stop what passes by. What misses keeps no plane, but
   may be deflected into the obstacle yet (append_crossings). */
static void find_plane(const ShvObstacle *obstacle, ShvVec3 x, ShvVec3 relative, double step, ShvNodePair *pair)
{
    if (obstacle->shape == SHV_OBSTACLE_PLANE || pair->gap <= 0.0) return;
    if (pair->gap + step * shv_dot(relative, pair->normal) >= 0.0) return;
    ShvCrossing crossing;
    pair->gap = (double)INFINITY;
    if (!shv_obstacle_sweep(obstacle, x, shv_madd(x, step, relative), &crossing)) return;
    pair->point = crossing.point;
    pair->normal = crossing.normal;
    pair->gap = shv_dot(shv_sub(x, crossing.point), crossing.normal);
}

typedef struct ContactStep {
    ShvNodeContact *contact;
    ShvState *state;
    ShvObstacles *obstacles;
    double step;
    ShvVec3 gravity;
} ContactStep;

static ShvVec3 relative_velocity(const ContactStep *now, const ShvNodePair *pair)
{
    const ShvObstacle *obstacle = &now->obstacles->items[pair->obstacle];
    const double *velocity = now->state->velocity;
    ShvVec3 own = shv_scale(shv_load3(velocity + 3 * (int64_t)pair->nodes[0]), pair->weights[0]);
    for (int c = 1; c < pair->node_count; c++)
        own = shv_madd(own, pair->weights[c], shv_load3(velocity + 3 * (int64_t)pair->nodes[c]));
    return shv_sub(own, obstacle_velocity(obstacle, pair->point, now->step, now->gravity));
}

static double inverse_mass(const ContactStep *now, const ShvNodePair *pair, ShvVec3 direction)
{
    double own = 0.0;
    for (int c = 0; c < pair->node_count; c++)
        own += pair->weights[c] * pair->weights[c] / now->state->mass[pair->nodes[c]];
    return own + shv_obstacle_inverse_mass(&now->obstacles->items[pair->obstacle], pair->point, direction);
}

/* What follows from where they are and how they move. Of the two directions across the normal, each yields at least what the
   masses alone yield: what the sum of both has more is the most that one can have more. */
static void weigh(const ContactStep *now, ShvNodePair *pair)
{
    const ShvVec3 n = pair->normal;
    const ShvVec3 first = shv_unit(shv_cross(n, fabs(n.x) < 0.6 ? shv_vec3(1.0, 0.0, 0.0) : shv_vec3(0.0, 1.0, 0.0)));
    double masses = 1.0 / now->obstacles->items[pair->obstacle].mass;
    for (int c = 0; c < pair->node_count; c++)
        masses += pair->weights[c] * pair->weights[c] / now->state->mass[pair->nodes[c]];
    pair->relative = relative_velocity(now, pair);
    pair->speed = fabs(pair->relative.x) + fabs(pair->relative.y) + fabs(pair->relative.z);
    pair->inverse_mass = inverse_mass(now, pair, n);
    pair->slip_inverse_mass = inverse_mass(now, pair, first) + inverse_mass(now, pair, shv_cross(n, first)) - masses;
}

static bool make_pair(const ContactStep *now, int32_t node, int32_t index, double obstacle_speed, ShvNodePair *pair)
{
    const ShvObstacle *obstacle = &now->obstacles->items[index];
    const int64_t i = 3 * (int64_t)node;
    const ShvVec3 v = shv_load3(now->state->velocity + i), x = shv_state_position(now->state, node);
    /* Twice the way it can go: other impulses of the step may speed it up. */
    const double limit = 2.0 * now->step * (shv_norm(v) + obstacle_speed);
    const ShvSurfacePoint at = shv_obstacle_closest(obstacle, x, limit);
    if (at.gap > 0.0 && at.gap >= limit) return false;
    const ShvVec3 relative = shv_sub(v, obstacle_velocity(obstacle, at.point, now->step, now->gravity));
    *pair = (ShvNodePair){.nodes = {node},
                          .node_count = 1,
                          .weights = {1.0},
                          .obstacle = index,
                          .gap = at.gap,
                          .point = at.point,
                          .normal = at.normal};
    find_plane(obstacle, x, relative, now->step, pair);
    return true;
}

static ShvStatus append_pair(const ContactStep *now, const ShvNodePair *pair, ShvError *error)
{
    ShvNodeContact *contact = now->contact;
    const ShvNodePair copy = *pair; /* may lie in the block that moves */
    SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->pairs, contact->pair_capacity, contact->pair_count, "contact",
             error);
    contact->pairs[contact->pair_count++] = copy;
    weigh(now, &contact->pairs[contact->pair_count - 1]);
    return SHV_OK;
}

static ShvStatus list_pairs(const ContactStep *now, ShvError *error)
{
    ShvNodeContact *contact = now->contact;
    contact->pair_count = 0;
    for (int32_t k = 0; k < contact->candidate_count; k++) {
        const ShvNodeCandidate *candidate = &contact->candidates[k];
        const ShvObstacle *obstacle = &now->obstacles->items[candidate->obstacle];
        const double speed = shv_candidates_obstacle_speed(obstacle) + now->step * shv_norm(now->gravity);
        ShvNodePair pair;
        if (!make_pair(now, candidate->node, candidate->obstacle, speed, &pair)) continue;
        pair.before[0] = candidate->before;
        SHV_TRY(append_pair(now, &pair, error));
    }
    return SHV_OK;
}

/* As make_pair; the way of a step is a small share of a facet, so that the plane found is the one that counts. */
static ShvStatus list_facet_pairs(const ContactStep *now, const ShvFacetCandidate *candidate, ShvError *error)
{
    const ShvObstacle *obstacle = &now->obstacles->items[candidate->obstacle];
    const ShvFacetShape shape = shv_candidate_shape(candidate, now->state);
    double speed = shv_candidates_obstacle_speed(obstacle) + now->step * shv_norm(now->gravity), fastest = 0.0;
    for (int c = 0; c < 3; c++)
        fastest = fmax(fastest, shv_norm(shv_load3(now->state->velocity + 3 * (int64_t)candidate->nodes[c])));
    ShvFeaturePoint points[3];
    const int count = shv_feature_meet(obstacle, &obstacle->features[candidate->feature], &shape,
                                       2.0 * now->step * (fastest + speed), points);
    for (int k = 0; k < count; k++) {
        ShvNodePair pair = {.node_count = 3,
                            .obstacle = candidate->obstacle,
                            .gap = points[k].gap,
                            .point = points[k].point,
                            .normal = points[k].normal};
        for (int c = 0; c < 3; c++) {
            pair.nodes[c] = candidate->nodes[c];
            pair.weights[c] = points[k].weights[c];
            pair.before[c] = candidate->before[c];
        }
        SHV_TRY(append_pair(now, &pair, error));
    }
    return SHV_OK;
}

/* ---- response ---- */

static void apply_impulse(const ContactStep *now, const ShvNodePair *pair, ShvVec3 impulse)
{
    ShvObstacle *obstacle = &now->obstacles->items[pair->obstacle];
    for (int c = 0; c < pair->node_count; c++)
        shv_add_to3(now->state->velocity + 3 * (int64_t)pair->nodes[c],
                    shv_scale(impulse, pair->weights[c] / now->state->mass[pair->nodes[c]]));
    if (obstacle->motion != SHV_OBSTACLE_FREE) return;
    now->contact->obstacle_work[0] -= 0.5 * shv_dot(impulse, shv_obstacle_velocity(obstacle, pair->point));
    shv_obstacle_impulse(obstacle, pair->point, shv_scale(impulse, -1.0));
    now->contact->obstacle_work[1] -= 0.5 * shv_dot(impulse, shv_obstacle_velocity(obstacle, pair->point));
}

/* How much faster a pair closes than it may: down to the surface by the end of the step, or not at all. */
static double excess(const ContactStep *now, const ShvNodePair *pair)
{
    const double allowed = pair->gap > 0.0 ? -pair->gap / now->step : 0.0;
    return allowed - shv_dot(relative_velocity(now, pair), pair->normal);
}

/* The normal impulse so far becomes the one that leaves no excess, or none. Returns by how much the velocity changes. */
static double press(const ContactStep *now, ShvNodePair *pair)
{
    const double wanted = fmax(0.0, pair->normal_impulse + excess(now, pair) / pair->inverse_mass);
    const double change = wanted - pair->normal_impulse;
    if (change == 0.0) return 0.0;
    apply_impulse(now, pair, shv_scale(pair->normal, change));
    pair->normal_impulse = wanted;
    return fabs(change) * pair->inverse_mass;
}

ShvVec3 shv_coulomb_friction(ShvVec3 so_far, ShvVec3 relative, ShvVec3 normal, double inverse_mass, double bound)
{
    const ShvVec3 slip = shv_madd(relative, -shv_dot(relative, normal), normal);
    const ShvVec3 wanted = shv_madd(so_far, -1.0 / inverse_mass, slip);
    const double size = shv_norm(wanted);
    return size > bound ? shv_scale(wanted, bound / size) : wanted;
}

/* Friction so far goes against the slip, up to its bound. */
static double rub(const ContactStep *now, ShvNodePair *pair)
{
    if (!(pair->friction_bound > 0.0)) return 0.0;
    const ShvVec3 wanted = shv_coulomb_friction(pair->friction, relative_velocity(now, pair), pair->normal,
                                                pair->slip_inverse_mass, pair->friction_bound);
    const ShvVec3 change = shv_sub(wanted, pair->friction);
    apply_impulse(now, pair, change);
    pair->friction = wanted;
    return shv_norm(change) * pair->slip_inverse_mass;
}

/* Sweeps until no velocity changes by more than rounding, that of a facet, whose steps are short, by a millionth of its pair's,
   or they are used up: true. */
static bool relax(const ContactStep *now)
{
    const double rounding = 1e-13, good = 1e-6;
    ShvNodeContact *contact = now->contact;
    bool again = contact->pair_count > 0;
    for (int pass = 0; pass < MOST_SWEEPS && again; pass++) {
        again = false;
        for (int32_t k = 0; k < contact->pair_count; k++) {
            ShvNodePair *pair = &contact->pairs[k];
            const double change = press(now, pair) + rub(now, pair);
            again |= change > (pair->node_count > 1 ? good : rounding) * pair->speed;
        }
    }
    return again;
}

/* Normal impulses first, then, with µ times those as bounds of friction, both: so the impulses together take energy or leave
   it, whatever sweeps were made (respond() of surface_contact.c tells why). Points of facets share nodes: an impulse is
   taken back where another one has done its work. */
static void sweep(const ContactStep *now)
{
    ShvNodeContact *contact = now->contact;
    bool open = relax(now), rough = false;
    for (int32_t k = 0; k < contact->pair_count; k++) {
        ShvNodePair *pair = &contact->pairs[k];
        const double most = now->obstacles->items[pair->obstacle].friction * pair->normal_impulse;
        pair->friction_bound = fmax(pair->friction_bound, most);
        rough |= pair->friction_bound > 0.0;
    }
    if (rough) open = relax(now);
    contact->unresolved = 0;
    for (int32_t k = 0; open && k < contact->pair_count; k++)
        contact->unresolved += excess(now, &contact->pairs[k]) > unresolved_of_speed * contact->pairs[k].speed;
}

/* Of the obstacle's radius: how far outside its surface a path begins, so that round-off does not put it inside. */
static const double outside_of_radius = 1e-12;

/* What has been deflected may run into an obstacle that it would have missed, or into another face of a mesh (a convex
   shape lies behind its one plane): its new way is tried again, from just outside. */
static ShvStatus append_crossings(const ContactStep *now, bool *any, ShvError *error)
{
    ShvNodeContact *contact = now->contact;
    const int32_t count = contact->pair_count;
    *any = false;
    for (int32_t k = 0; k < count; k++) {
        ShvNodePair pair = contact->pairs[k];
        const ShvObstacle *obstacle = &now->obstacles->items[pair.obstacle];
        if (pair.node_count > 1 || (obstacle->shape != SHV_OBSTACLE_MESH && isfinite(pair.gap))) continue;
        const double rounding = outside_of_radius * obstacle->bounding_radius;
        const ShvVec3 from =
            shv_madd(shv_state_position(now->state, pair.nodes[0]), fmax(0.0, -pair.gap) + rounding, pair.normal);
        ShvCrossing crossing;
        const ShvVec3 path = shv_scale(relative_velocity(now, &pair), now->step);
        if (!shv_obstacle_sweep(obstacle, from, shv_add(from, path), &crossing)) continue;
        pair.point = crossing.point;
        pair.normal = crossing.normal;
        pair.gap = shv_dot(shv_sub(from, crossing.point), crossing.normal);
        pair.normal_impulse = pair.friction_bound = 0.0;
        pair.friction = shv_vec3(0.0, 0.0, 0.0);
        if (pair.gap + shv_dot(path, pair.normal) > -2.0 * rounding) continue;
        SHV_TRY(append_pair(now, &pair, error));
        *any = true;
    }
    return SHV_OK;
}

static ShvStatus respond(const ContactStep *now, ShvError *error)
{
    bool again = true;
    sweep(now);
    for (int round = 0; round < MOST_ROUNDS && again; round++) {
        SHV_TRY(append_crossings(now, &again, error));
        if (again) sweep(now);
    }
    return SHV_OK;
}

static ShvStatus append_touch(ShvNodeContact *contact, const ShvNodePair *pair, int corner, ShvError *error)
{
    SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->touches, contact->touch_capacity, contact->touching, "contact",
             error);
    const ShvNodeTouch touch = {.node = pair->nodes[corner],
                                .obstacle = pair->obstacle,
                                .fresh = contact->last_touch[pair->nodes[corner]] + 1 < contact->step_number,
                                .closing_speed = -shv_dot(pair->relative, pair->normal),
                                .point = pair->point,
                                .normal = pair->normal,
                                .normal_impulse = pair->weights[corner] * pair->normal_impulse,
                                .friction = shv_scale(pair->friction, pair->weights[corner]),
                                .before = pair->before[corner]};
    contact->touches[contact->touching++] = touch;
    if (touch.fresh) contact->largest_closing_speed = fmax(contact->largest_closing_speed, touch.closing_speed);
    contact->impulse = shv_add(contact->impulse, shv_madd(touch.friction, touch.normal_impulse, touch.normal));
    return SHV_OK;
}

static ShvStatus list_touches(ShvNodeContact *contact, ShvError *error)
{
    contact->touching = 0;
    contact->largest_closing_speed = 0.0;
    contact->impulse = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < contact->pair_count; k++) {
        const ShvNodePair *pair = &contact->pairs[k];
        const bool touches = pair->normal_impulse > 0.0 || shv_dot(pair->friction, pair->friction) > 0.0;
        for (int c = 0; c < pair->node_count && touches; c++)
            if (pair->weights[c] > 0.0) SHV_TRY(append_touch(contact, pair, c, error));
    }
    for (int32_t k = 0; k < contact->touching; k++)
        contact->last_touch[contact->touches[k].node] = contact->step_number;
    return SHV_OK;
}

ShvStatus shv_node_contact_begin(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, const double gravity[3],
                                 ShvError *error)
{
    SHV_TRY(shv_candidates_refresh(contact, state, obstacles, nodes, count, step, shv_norm(shv_load3(gravity)), error));
    for (int32_t k = 0; k < contact->candidate_count; k++)
        contact->candidates[k].before = shv_load3(state->velocity + 3 * (int64_t)contact->candidates[k].node);
    for (int32_t k = 0; k < contact->facet_count; k++)
        for (int c = 0; c < 3; c++)
            contact->facets[k].before[c] = shv_load3(state->velocity + 3 * (int64_t)contact->facets[k].nodes[c]);
    return SHV_OK;
}

ShvStatus shv_node_contact_apply(ShvNodeContact *contact, ShvState *state, ShvObstacles *obstacles, double step,
                                 const double gravity[3], ShvError *error)
{
    const ContactStep now = {contact, state, obstacles, step, shv_load3(gravity)};
    contact->obstacle_work[0] = contact->obstacle_work[1] = 0.0;
    /* After a pause every touch is fresh: a number is left out. */
    contact->step_number += fabs(state->time - contact->next_time) <= 0.5 * step ? 1 : 2;
    contact->next_time = state->time + step;
    SHV_TRY(know_nodes(contact, state, error));
    SHV_TRY(list_pairs(&now, error));
    for (int32_t k = 0; k < contact->facet_count; k++) SHV_TRY(list_facet_pairs(&now, &contact->facets[k], error));
    SHV_TRY(respond(&now, error));
    SHV_TRY(list_touches(contact, error));
    shv_node_contact_book(contact, state);
    return SHV_OK;
}

/* ---- reports ---- */

void shv_node_contact_book(ShvNodeContact *contact, const ShvState *state)
{
    for (int half = 0; half < 2; half++) contact->normal_work[half] = contact->friction_work[half] = 0.0;
    for (int32_t k = 0; k < contact->touching; k++) {
        const ShvNodeTouch *touch = &contact->touches[k];
        const ShvVec3 velocity[2] = {touch->before, shv_load3(state->velocity + 3 * (int64_t)touch->node)};
        for (int half = 0; half < 2; half++) {
            contact->normal_work[half] += 0.5 * touch->normal_impulse * shv_dot(touch->normal, velocity[half]);
            contact->friction_work[half] += 0.5 * shv_dot(touch->friction, velocity[half]);
        }
    }
}

void shv_node_contact_book_ledger(const ShvNodeContact *contact, ShvLedger *ledger)
{
    shv_ledger_book(ledger, SHV_WORK_CONTACT, contact->normal_work[0], contact->normal_work[1]);
    shv_ledger_book(ledger, SHV_WORK_FRICTION, contact->friction_work[0], contact->friction_work[1]);
}
