#include "contact/surface_contact.h"

#include "contact/surface_candidates.h"

enum { MOST_SWEEPS = 12, MOST_SWEEPS_OF_OBSTACLES = 64, MOST_ROUNDS = 4 };

ShvStatus shv_surface_contact_create(ShvSurfaceContact *contact, ShvMemory *memory, const ShvModel *model,
                                     double friction, ShvError *error)
{
    if (!(friction >= 0.0 && isfinite(friction)))
        return shv_fail(error, SHV_BAD_INPUT, "friction between surfaces is %g; give a number from 0 on", friction);
    *contact = (ShvSurfaceContact){.memory = memory,
                                   .model = model,
                                   .friction = friction,
                                   .stale = true,
                                   .idle = true,
                                   .list = {.memory = memory, .model = model},
                                   .detection_interval = SHV_SURFACE_DETECTION_INTERVAL,
                                   .node_grid = {.memory = memory},
                                   .facet_grid = {.memory = memory}};
    return SHV_OK;
}

void shv_surface_contact_release(ShvSurfaceContact *contact)
{
    shv_surface_list_release(&contact->list);
    shv_hash_grid_release(&contact->node_grid);
    shv_hash_grid_release(&contact->facet_grid);
    shv_release(contact->rebuilt_facets.items);
    for (int k = 0; k < 2; k++) {
        shv_release(contact->candidates[k].items);
        shv_release(contact->candidates[k].due);
        shv_release(contact->candidates[k].motion_bounds);
        shv_release(contact->candidates[k].motion_classes);
        shv_release(contact->candidates[k].now);
        shv_release(contact->candidates[k].near);
    }
    shv_release(contact->fragments);
    shv_release(contact->found);
    shv_release(contact->keys);
    shv_release(contact->watched);
    shv_release(contact->watched_facets.items);
    shv_release(contact->before);
    shv_release(contact->coupled_body_before);
    shv_release(contact->pairs);
    shv_release(contact->visits);
    *contact = (ShvSurfaceContact){0};
}

void shv_surface_contact_invalidate(ShvSurfaceContact *contact)
{
    contact->stale = true;
}

void shv_surface_contact_wake(ShvSurfaceContact *contact)
{
    contact->woken = true;
}

void shv_surface_contact_recheck(ShvSurfaceContact *contact)
{
    contact->detect_now = true; /* whether this time has been counted or not */
}

/* ---- before the kick ---- */

static ShvStatus remember_nodes(ShvSurfaceContact *contact, const ShvState *state, ShvError *error)
{
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->before, contact->before_capacity,
                3 * (int64_t)contact->watched_count, "contact", error);
    for (int32_t k = 0; k < contact->watched_count; k++) {
        const int32_t node = contact->list.nodes[contact->watched[k]].node;
        shv_store3(contact->before + 3 * (int64_t)k, shv_load3(state->velocity + 3 * (int64_t)node));
    }
    return SHV_OK;
}

static ShvStatus remember_coupled_bodies(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    if (!bodies->coupled_bodies) return SHV_OK;
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->coupled_body_before, contact->coupled_body_capacity,
                bodies->fragment_count, "contact", error);
    for (int32_t i = 0; i < bodies->fragment_count; i++) {
        const ShvCoupledBody *coupled_body = bodies->coupled_bodies[i];
        if (coupled_body)
            contact->coupled_body_before[i] =
                (ShvCoupledBodyBefore){coupled_body->velocity, coupled_body->angular_velocity};
    }
    return SHV_OK;
}

static bool is_quiet(const ShvSurfaceContact *contact)
{
    return contact->idle || contact->candidates[0].count + contact->candidates[1].count == 0;
}

static void clear_step(ShvSurfaceContact *contact)
{
    contact->pair_count = contact->touching = contact->pushed = 0;
    contact->push = shv_vec3(0.0, 0.0, 0.0);
    contact->deepest = 0.0;
    for (int half = 0; half < 2; half++)
        contact->normal_work[half] = contact->friction_work[half] = contact->obstacle_work[half] = 0.0;
}

ShvStatus shv_surface_contact_begin(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                    ShvError *error)
{
    clear_step(contact);
    SHV_TRY(shv_surface_candidates_refresh(contact, bodies, step, error));
    if (is_quiet(contact)) return SHV_OK;
    SHV_TRY(remember_nodes(contact, bodies->state, error));
    return remember_coupled_bodies(contact, bodies, error);
}

/* ---- pairs ---- */

/* Facets are in one plane when 1 − cosine of their normals, and the relative difference of their gaps, are round-off; one rises
   above the plane of another by more than this share of the distance between them. */
static const double same_normal = 1e-9, same_gap = 1e-6, rise = 1e-3;

/* One of two facets in a plane is enough where a node stands over their common edge. */
static bool same_plane(const ShvFacetPair *a, const ShvFacetPair *b)
{
    return shv_dot(a->normal, b->normal) > 1.0 - same_normal && fabs(a->gap - b->gap) <= same_gap * fabs(a->gap);
}

/* Whether a facet rises above the plane of another, as the walls of a groove do: a node can be behind both. */
static bool rises_above(const ShvFacetPair *facet, const ShvFacetPair *other)
{
    const ShvVec3 path = shv_sub(facet->centre, other->point);
    return shv_dot(other->normal, path) + other->gap > rise * shv_norm(path);
}

/* Of the facets round a ridge that a node is behind it came in through the one it is least deep behind, and through none
   when it stands closer above another. */
static void exclude_deeper(ShvSurfaceContact *contact)
{
    for (int32_t i = 0; i < contact->pair_count; i++) {
        ShvFacetPair *pair = &contact->pairs[i];
        if (pair->element < 0 || pair->node_count > 1) continue;
        for (int32_t k = i - 1; k >= 0 && contact->pairs[k].nodes[0] == pair->nodes[0]; k--) {
            ShvFacetPair *other = &contact->pairs[k];
            if (other->fragments[1] != pair->fragments[1]) continue;
            ShvFacetPair *farther = fabs(pair->gap) < fabs(other->gap) ? other : pair;
            const ShvFacetPair *nearer = farther == pair ? other : pair;
            if (same_plane(pair, other) || (farther->gap <= 0.0 && !rises_above(nearer, farther)))
                farther->excluded = true;
        }
    }
    int32_t kept = 0;
    for (int32_t i = 0; i < contact->pair_count; i++) {
        if (contact->pairs[i].excluded) continue;
        contact->deepest = fmax(contact->deepest, -contact->pairs[i].gap);
        contact->pairs[kept++] = contact->pairs[i];
    }
    contact->pair_count = kept;
}

/* ---- response ---- */

/* Velocity of the node against the facet along the normal, both deforming: gradients lie in the facet's plane and have no
   part in it. */
static double closing_velocity(const ShvFacetPair *pair, const double *velocity)
{
    const ShvVec3 n = pair->normal;
    double sum = shv_dot(n, shv_load3(velocity + 3 * (int64_t)pair->nodes[0]));
    for (int k = 0; k < 3; k++)
        sum -= pair->weights[k] * shv_dot(n, shv_load3(velocity + 3 * (int64_t)pair->corners[k]));
    return sum;
}

/* How much faster a pair closes than it may: down to the surface by the end of the step, or not at all. */
static double excess(const ShvFacetPair *pair, const ShvSurfaceBodies *bodies)
{
    const double allowed = pair->gap > 0.0 ? -pair->gap / pair->step : 0.0;
    if (pair->deforming && pair->node_count == 1 && pair->element >= 0)
        return allowed - closing_velocity(pair, bodies->state->velocity);
    return allowed - shv_dot(shv_facet_pair_velocity(pair, bodies), pair->normal);
}

/* The normal impulse so far becomes the one that leaves no excess, or none. Returns by how much velocities change. */
static double apply_normal_impulse(const ShvSurfaceBodies *bodies, ShvFacetPair *pair)
{
    const double wanted = pair->normal_impulse + excess(pair, bodies) / pair->inverse_mass;
    const double change = (wanted > 0.0 ? wanted : 0.0) - pair->normal_impulse;
    if (change == 0.0) return 0.0;
    shv_facet_pair_strike(pair, bodies, shv_scale(pair->normal, change));
    pair->normal_impulse += change;
    return fabs(change) * pair->inverse_mass;
}

/* Friction so far goes against the slip, up to its bound. */
static double apply_friction(const ShvSurfaceBodies *bodies, ShvFacetPair *pair)
{
    if (!(pair->friction_bound > 0.0)) return 0.0;
    const ShvVec3 relative = shv_facet_pair_velocity(pair, bodies);
    const ShvVec3 slip = shv_madd(relative, -shv_dot(relative, pair->normal), pair->normal);
    ShvVec3 wanted = shv_madd(pair->friction, -1.0 / pair->slip_inverse_mass, slip);
    const double size = shv_norm(wanted);
    if (size > pair->friction_bound) wanted = shv_scale(wanted, pair->friction_bound / size);
    const ShvVec3 change = shv_sub(wanted, pair->friction);
    shv_facet_pair_strike(pair, bodies, change);
    pair->friction = wanted;
    return shv_norm(change) * pair->slip_inverse_mass;
}

/* ---- sweeps ---- */

static ShvStatus reserve_visits(ShvSurfaceContact *contact, ShvError *error)
{
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->visits, contact->visit_capacity, contact->list.node_count,
                "contact", error);
    for (int32_t i = 0; i < contact->pair_count; i++)
        for (int k = 0; k < 6; k++)
            if (contact->pairs[i].slots[k] >= 0) contact->visits[contact->pairs[i].slots[k]] = 0;
    contact->visit = contact->rigid_visit = 0;
    return SHV_OK;
}

/* Whether a velocity of the pair has changed since its last visit. */
static bool is_moved(const ShvSurfaceContact *contact, const ShvFacetPair *pair)
{
    for (int k = 0; k < 6; k++) {
        const int32_t slot = pair->slots[k];
        if (slot != SHV_SLOT_NONE && (slot >= 0 ? contact->visits[slot] : contact->rigid_visit) > pair->visit)
            return true;
    }
    return false;
}

/* Those who share a velocity that has changed by enough are visited again. */
static void pass_on(ShvSurfaceContact *contact, const ShvFacetPair *pair)
{
    for (int k = 0; k < 6; k++) {
        if (pair->slots[k] >= 0) contact->visits[pair->slots[k]] = contact->visit;
        if (pair->slots[k] == SHV_SLOT_RIGID) contact->rigid_visit = contact->visit;
    }
}

/* Changes of velocity below which sweeps end, of the largest closing speed; */
static const double settled_of_closing = 0.001;
/* of what deforms against an obstacle, which keeps it out to rounding, of the pair's own speed: of a node; of a point of a facet,
   whose steps are short. */
static const double settled_node = 1e-13, settled_facet = 1e-6;

static bool is_exact(const ShvFacetPair *pair)
{
    return pair->element < 0 && pair->deforming;
}

static double settled(const ShvFacetPair *pair, double largest)
{
    const ShvVec3 v = pair->relative;
    if (!is_exact(pair)) return settled_of_closing * largest;
    /* Unlike the Euclidean norm the sum does not vanish before the velocity does. */
    return (pair->node_count > 1 ? settled_facet : settled_node) * (fabs(v.x) + fabs(v.y) + fabs(v.z));
}

/* Sweeps until no velocity changes by more than it may, or they are used up; obstacles have more of them. */
static void relax(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double largest)
{
    bool again = true;
    for (int pass = 0; pass < MOST_SWEEPS_OF_OBSTACLES && again; pass++) {
        again = false;
        for (int32_t k = 0; k < contact->pair_count; k++) {
            ShvFacetPair *pair = &contact->pairs[k];
            if (!is_moved(contact, pair) || (pass >= MOST_SWEEPS && !is_exact(pair))) continue;
            const double pressed = apply_normal_impulse(bodies, pair), sliding = apply_friction(bodies, pair),
                         good = settled(pair, largest);
            pair->visit = ++contact->visit;
            if (!(pressed > good) && !(sliding > good)) continue;
            pass_on(contact, pair);
            again = true;
        }
    }
}

static double friction_of(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvFacetPair *pair)
{
    return pair->element < 0 ? shv_bodies_obstacle(bodies, pair->element)->friction : contact->friction;
}

/* Projected Gauss-Seidel: normal impulses first, then, with µ times those as bounds of friction, both together. With u the
   velocities before, A the inverse masses and a ≤ 0 what is allowed, every change lowers f = ½ λ·A λ + λ·u − λn·a: a normal
   one by going to its least point, a tangential one as a projected gradient step no longer than the inverse of the
   largest eigenvalue; bounds stay while it is used, and only grow. Kinetic energy changes by f + λn·a, and f starts from 0: so the
   impulses together take energy or leave it, after any number of sweeps and whichever pairs they leave out. */
static ShvStatus respond(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    double largest = 0.0;
    for (int32_t k = 0; k < contact->pair_count; k++) {
        contact->pairs[k].visit = -1;
        largest = fmax(largest, excess(&contact->pairs[k], bodies));
    }
    if (!(largest > 0.0)) return SHV_OK;
    SHV_TRY(reserve_visits(contact, error));
    relax(contact, bodies, largest);
    bool rough = false;
    for (int32_t k = 0; k < contact->pair_count; k++) {
        ShvFacetPair *pair = &contact->pairs[k];
        pair->friction_bound = fmax(pair->friction_bound, friction_of(contact, bodies, pair) * pair->normal_impulse);
        if (!(pair->friction_bound > 0.0)) continue;
        pair->visit = -1;
        rough = true;
    }
    if (rough) relax(contact, bodies, largest);
    return SHV_OK;
}

/* And with what has been deflected into an obstacle. */
static ShvStatus respond_to_all(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    int32_t before = -1;
    for (int round = 0; round <= MOST_ROUNDS && before < contact->pair_count; round++) {
        SHV_TRY(respond(contact, bodies, error));
        before = contact->pair_count;
        for (int32_t k = 0; k < before && round < MOST_ROUNDS; k++) {
            ShvFacetPair crossing;
            if (!shv_obstacle_pair_crosses(&contact->pairs[k], bodies, &crossing)) continue;
            SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->pairs, contact->pair_capacity, contact->pair_count,
                     "contact", error);
            contact->pairs[contact->pair_count++] = crossing;
        }
    }
    return SHV_OK;
}

/* Friction may have taken the place of a normal impulse. */
static bool has_impulse(const ShvFacetPair *pair)
{
    return pair->normal_impulse > 0.0 || shv_dot(pair->friction, pair->friction) > 0.0;
}

static void count_touches(ShvSurfaceContact *contact)
{
    for (int32_t k = 0; k < contact->pair_count; k++) {
        const ShvFacetPair *pair = &contact->pairs[k];
        if (!has_impulse(pair)) continue;
        contact->touching++;
        if (!is_exact(pair)) continue;
        contact->pushed++;
        contact->push = shv_add(contact->push, shv_madd(pair->friction, pair->normal_impulse, pair->normal));
    }
}

ShvStatus shv_surface_contact_apply(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                    ShvError *error)
{
    clear_step(contact);
    if (is_quiet(contact) || !(step > 0.0)) return SHV_OK;
    SHV_TRY(shv_narrow_phase(contact, bodies, step, error));
    if (contact->pair_count == 0) return SHV_OK;
    exclude_deeper(contact);
    SHV_TRY(respond_to_all(contact, bodies, error));
    count_touches(contact);
    shv_surface_contact_book(contact, bodies);
    return SHV_OK;
}

/* ---- works ---- */

/* Velocity against which an impulse on the pair's node works, before the kick or now. */
static ShvVec3 velocity_then(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t node,
                             int32_t fragment, ShvVec3 point, int half)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, fragment);
    if (coupled_body) {
        ShvCoupledBody moving = *coupled_body;
        if (half == 0) {
            moving.velocity = contact->coupled_body_before[fragment].velocity;
            moving.angular_velocity = contact->coupled_body_before[fragment].angular_velocity;
        }
        return shv_coupled_body_velocity(&moving, point);
    }
    if (half == 1) return shv_load3(bodies->state->velocity + 3 * (int64_t)node);
    return shv_load3(contact->before + 3 * (int64_t)contact->list.nodes[contact->list.slot[node]].watch);
}

static double half_work(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvFacetPair *pair,
                        ShvVec3 impulse, int half)
{
    double work = 0.0;
    for (int k = 0; k < pair->node_count; k++)
        work += pair->shares[k] *
                shv_dot(impulse, velocity_then(contact, bodies, pair->nodes[k], pair->fragments[0], pair->point, half));
    if (pair->element < 0) return 0.5 * work;
    if (shv_bodies_coupled_body(bodies, pair->fragments[1]))
        return 0.5 *
               (work - shv_dot(impulse, velocity_then(contact, bodies, -1, pair->fragments[1], pair->point, half)));
    for (int k = 0; k < 3; k++)
        work += shv_dot(shv_facet_pair_share(pair, k, impulse),
                        velocity_then(contact, bodies, pair->corners[k], pair->fragments[1], pair->point, half));
    return 0.5 * work;
}

void shv_surface_contact_book(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int half = 0; half < 2; half++) {
        contact->normal_work[half] = contact->friction_work[half] = contact->obstacle_work[half] = 0.0;
        for (int32_t k = 0; k < contact->pair_count; k++) {
            const ShvFacetPair *pair = &contact->pairs[k];
            contact->obstacle_work[half] += pair->obstacle_work[half]; /* also of an impulse that was taken back */
            if (!has_impulse(pair)) continue;
            const ShvVec3 normal = shv_scale(pair->normal, pair->normal_impulse);
            contact->normal_work[half] += half_work(contact, bodies, pair, normal, half);
            contact->friction_work[half] += half_work(contact, bodies, pair, pair->friction, half);
        }
    }
}

void shv_surface_contact_book_ledger(const ShvSurfaceContact *contact, ShvLedger *ledger)
{
    shv_ledger_book(ledger, SHV_WORK_CONTACT, contact->normal_work[0], contact->normal_work[1]);
    shv_ledger_book(ledger, SHV_WORK_CONTACT, contact->obstacle_work[0], contact->obstacle_work[1]);
    shv_ledger_book(ledger, SHV_WORK_FRICTION, contact->friction_work[0], contact->friction_work[1]);
}

/* Rigid bodies that will touch in the next step: what wakes them has to do so before a rigid impulse takes the energy that
   would break them. Pairs are listed as far ahead as that (find_horizon). */
static bool touches_next(const ShvFacetPair *pair)
{
    return !pair->deforming && pair->gap > 0.0 && pair->gap < -2.0 * pair->step * shv_dot(pair->relative, pair->normal);
}

static void add_touch(ShvFragmentTouch *sum, const ShvFacetPair *pair, double own, double other)
{
    sum->impulse += shv_norm(shv_madd(pair->friction, pair->normal_impulse, pair->normal));
    if (!(pair->gap > 0.0)) return;
    const double closing = -shv_dot(pair->relative, pair->normal);
    const double severity = closing * (isfinite(other) ? sqrt(fmax(1.0, other / own)) : 1.0);
    if (!(severity > sum->severity)) return;
    sum->severity = severity;
    sum->closing_speed = closing;
    sum->other_mass = other;
}

void shv_surface_contact_by_fragment(const ShvSurfaceContact *contact, const double *masses,
                                     ShvFragmentTouch *fragments)
{
    for (int32_t k = 0; k < contact->pair_count; k++) {
        const ShvFacetPair *pair = &contact->pairs[k];
        if (!has_impulse(pair) && !touches_next(pair)) continue;
        const double own = masses[pair->fragments[0]];
        const double other = pair->element < 0 ? (double)INFINITY : masses[pair->fragments[1]];
        add_touch(&fragments[pair->fragments[0]], pair, own, other);
        if (pair->element >= 0) add_touch(&fragments[pair->fragments[1]], pair, other, own);
    }
}
