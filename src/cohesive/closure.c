#include <math.h>
#include <string.h>

#include "cohesive/facet_rotation.h"
#include "cohesive/solve.h"

enum { MOST_PASSES = 4 };

/* One pair, and the facet whose corner it is. */
typedef struct Closing {
    ShvFacetRotation *rotation; /* its rate is that of the present velocities as long as `known` */
    ShvFacetGaps *gaps;
    int corner;
    bool known;
    double held;     /* what the pair may give when it parts, J */
    bool elastic;    /* it gives back a share of what closing takes */
    double friction; /* tan φ */
} Closing;

/* Of opening, seen by one who turns with the facet. */
static ShvVec3 opening_rate(Closing *closing, const ShvState *state)
{
    ShvFacetRotation *rotation = closing->rotation;
    const int i = closing->corner;
    if (!closing->known) rotation->rate = shv_facet_rotation_rate(rotation, state);
    closing->known = true;
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)rotation->second[i]),
                                 shv_load3(state->velocity + 3 * (int64_t)rotation->first[i]));
    return shv_sub(rate, shv_cross(rotation->rate, closing->gaps->opening[i]));
}

static double response(const Closing *closing, const ShvState *state, ShvVec3 direction)
{
    const int i = closing->corner;
    return shv_turn_response(closing->rotation, state, i, closing->gaps->opening[i], direction);
}

/* Impulse on a pair, taken by the whole masses of its nodes: pairs are served one after another, each impulse for itself
   inelastic, so that kinetic energy falls with every one of them. Returns the force on the first node. */
static ShvVec3 apply_impulse(Closing *closing, ShvState *state, ShvVec3 impulse, double kick)
{
    const int i = closing->corner;
    const int32_t first = closing->rotation->first[i], second = closing->rotation->second[i];
    const ShvVec3 force = shv_scale(impulse, -1.0 / kick);
    shv_add_to3(state->velocity + 3 * (int64_t)first, shv_scale(impulse, -1.0 / state->mass[first]));
    shv_add_to3(state->velocity + 3 * (int64_t)second, shv_scale(impulse, 1.0 / state->mass[second]));
    shv_facet_rotation_strike(closing->rotation, state, shv_cross(closing->gaps->opening[i], force), kick);
    shv_add_to3(state->force + 3 * (int64_t)first, force);
    shv_add_to3(state->force + 3 * (int64_t)second, shv_scale(force, -1.0));
    closing->known = false;
    return force;
}

static void apply_normal_impulse(Closing *closing, ShvState *state, double impulse, double kick)
{
    ShvVec3 *push = &closing->gaps->push[closing->corner];
    *push = shv_add(*push, apply_impulse(closing, state, shv_scale(closing->rotation->normal, impulse), kick));
}

/* Faces part when they do so faster than by this share of the speed that what they hold would give them: slower is noise of
   neighbours under one pressure. */
static const double parting_share = 1e-3;
/* A push that changes by no more than this share of itself has settled. */
static const double settled_share = 1e-3;

/* Changes the push of a pair by an impulse along its normal. `speed`: at which it opens, of which the impulse makes
   speed + impulse × inverse mass. */
static void change_push(Closing *closing, ShvState *state, double kick, double impulse, double speed,
                        double inverse_mass)
{
    closing->gaps->freed[closing->corner] += impulse * (speed + 0.5 * impulse * inverse_mass);
    apply_normal_impulse(closing, state, impulse, kick);
}

/* Of a pair that nothing has pressed in this step all that is held comes back over the way from n − 1/2 to n + 1/2:
   push × (way without it + yield × push) = held. That is what is booked; besides, kinetic energy rises by no more than that,
   so that impulses of neighbours, each counting on the others as they are, together never give more than is held. */
static bool restitute(Closing *closing, ShvState *state, double kick, double step, double speed)
{
    const ShvVec3 normal = closing->rotation->normal;
    const ShvFacetGaps *gaps = closing->gaps;
    const double inverse_mass = response(closing, state, normal), yield = 0.5 * step * kick * inverse_mass;
    if (!(speed * speed > parting_share * parting_share * 2.0 * closing->held * inverse_mass)) return false;
    const double push = -shv_dot(gaps->push[closing->corner], normal);
    const double approach = shv_dot(gaps->before[closing->corner], normal) + 0.5 * step * speed - yield * push;
    const double root = sqrt(approach * approach + 4.0 * yield * closing->held);
    const double whole = approach > 0.0 ? 2.0 * closing->held / (approach + root) : 0.5 * (root - approach) / yield;
    if (!(fabs(whole - push) > settled_share * whole)) return false;
    const double left = shv_larger(closing->held - gaps->freed[closing->corner], 0.0);
    const double most = 2.0 * left / (speed + sqrt(speed * speed + 2.0 * left * inverse_mass));
    const double impulse = shv_smaller(shv_larger((whole - push) * kick, -speed / inverse_mass), most);
    if (!(fabs(impulse) > settled_share * whole * kick)) return false;
    change_push(closing, state, kick, impulse, speed, inverse_mass);
    return true;
}

/* A pair that others have moved on since does not push its faces apart. */
static bool reduce_push(Closing *closing, ShvState *state, double kick, double speed)
{
    const ShvVec3 normal = closing->rotation->normal;
    const double inverse_mass = response(closing, state, normal);
    const double push = -shv_dot(closing->gaps->push[closing->corner], normal);
    const double less = shv_smaller(push, speed / (kick * inverse_mass));
    if (!(less > settled_share * push)) return false;
    change_push(closing, state, kick, -less * kick, speed, inverse_mass);
    return true;
}

/* Coulomb friction of a pair that is pushed: what stops the slip, at most tan φ × push. It takes energy on the way from n − 1/2
   to n + 1/2, on which it is booked: in a step in which the slip turns round it is less. Cohesion has been pulled before, so
   that friction bears what is left of the load; the pull after contact then finds what cohesion has to bear beside it. */
static bool apply_friction(Closing *closing, ShvState *state, double kick, double step)
{
    const ShvVec3 rate = opening_rate(closing, state), normal = closing->rotation->normal;
    ShvVec3 *sum = &closing->gaps->friction[closing->corner];
    const double most = -closing->friction * shv_dot(closing->gaps->push[closing->corner], normal);
    const ShvVec3 slip = shv_madd(rate, -shv_dot(rate, normal), normal);
    const double speed = shv_norm(slip);
    if (!(most > 0.0 && speed > 0.0)) return false;
    const double yield = kick * response(closing, state, shv_scale(slip, 1.0 / speed));
    const ShvVec3 stopping = shv_madd(*sum, 1.0 / yield, slip);
    const ShvVec3 wanted = shv_scale(stopping, shv_smaller(most / shv_norm(stopping), 1.0));
    const ShvVec3 free = shv_madd(closing->gaps->before[closing->corner], 0.5 * step, shv_madd(slip, yield, *sum));
    const double share = shv_dot(wanted, free) / (0.5 * step * yield * shv_dot(wanted, wanted));
    const ShvVec3 force = shv_scale(wanted, shv_smaller(shv_larger(share, 0.0), 1.0)), change = shv_sub(force, *sum);
    if (!(shv_norm(change) > settled_share * most)) return false;
    *sum = shv_add(*sum, apply_impulse(closing, state, shv_scale(change, -kick), kick));
    return true;
}

static bool close_pair(Closing *closing, ShvState *state, double kick, double step)
{
    const ShvVec3 normal = closing->rotation->normal;
    bool *pressed = &closing->gaps->pressed[closing->corner];
    const double gap = shv_dot(closing->gaps->opening[closing->corner], normal);
    const double speed = shv_dot(opening_rate(closing, state), normal);
    const double allowed = gap > 0.0 ? -gap / step : 0.0;
    if (*pressed && speed > 0.0 && closing->elastic) return reduce_push(closing, state, kick, speed);
    if (speed > 0.0 && closing->held > 0.0) return restitute(closing, state, kick, step, speed);
    if (!(speed < allowed)) return false;
    const double impulse = (allowed - speed) / response(closing, state, normal);
    apply_normal_impulse(closing, state, impulse, kick);
    *pressed = true;
    return true;
}

static bool close_facet(ShvCohesive *cohesive, ShvState *state, int32_t k, double kick, double step)
{
    Closing closing = {.rotation = &cohesive->rotations[k], .gaps = &cohesive->gaps[k]};
    closing.elastic = closing.rotation->returned > 0.0;
    closing.friction = closing.rotation->friction;
    bool any = false;
    if (!closing.rotation->known || cohesive->phase[closing.rotation->index] == SHV_COHESIVE_SEPARATED) return false;
    for (closing.corner = 0; closing.corner < 3; closing.corner++) {
        if (closing.rotation->first[closing.corner] == closing.rotation->second[closing.corner]) continue;
        if (closing.elastic) closing.held = shv_cohesive_releasable(cohesive, state, closing.rotation, closing.corner);
        any = close_pair(&closing, state, kick, step) || any;
        if (closing.friction > 0.0) any = apply_friction(&closing, state, kick, step) || any;
    }
    return any;
}

/* What a facet finds to do hangs on the velocities of its nodes alone: it is asked again once one of them was struck. */
static bool has_news(const ShvCohesive *cohesive, int32_t k)
{
    const ShvFacetRotation *rotation = &cohesive->rotations[k];
    const int32_t *struck = cohesive->struck, before = cohesive->closed[k];
    for (int i = 0; i < 3; i++)
        if (struck[rotation->first[i]] > before || struck[rotation->second[i]] > before) return true;
    return false;
}

static bool may_meet(const ShvCohesive *cohesive, const ShvState *state, int32_t k, double step)
{
    const double apart = cohesive->apart[cohesive->rotations[k].index];
    return !(apart > 0.0 && apart > step * shv_cohesive_spread_of_speeds(&cohesive->rotations[k], state));
}

static void note_strike(ShvCohesive *cohesive, int32_t k, int32_t number)
{
    const ShvFacetRotation *rotation = &cohesive->rotations[k];
    for (int i = 0; i < 3; i++) cohesive->struck[rotation->first[i]] = cohesive->struck[rotation->second[i]] = number;
    cohesive->apart[rotation->index] = -(double)INFINITY;
}

/* ---- order ----
   Multicolour Gauss-Seidel: facets of the lists are closed chunk by chunk. Chunks of one colour share no node, and are closed at once by
   threads: impulses are the same for any number of them. */

enum { CHUNK = SHV_CLOSING_CHUNK, LAST_COLOUR = SHV_CLOSING_COLOURS - 1 };

static int32_t chunk_end(const ShvCohesive *cohesive, int32_t chunk)
{
    const int32_t end = (chunk + 1) * CHUNK;
    return end < cohesive->rotation_count ? end : cohesive->rotation_count;
}

/* The first that no earlier chunk has that shares a node of the mesh; `taken`: for each of these, a bit for each colour. */
static int32_t find_colour(const ShvCohesive *cohesive, const ShvState *state, int32_t chunk, int32_t *taken)
{
    const int32_t start = chunk * CHUNK, end = chunk_end(cohesive, chunk);
    int32_t used = 0, colour = 0;
    for (int32_t k = start; k < end; k++)
        for (int i = 0; i < 3; i++) used |= taken[state->origin[cohesive->rotations[k].first[i]]];
    while (colour < LAST_COLOUR && (used >> colour & 1)) colour++;
    for (int32_t k = start; k < end; k++)
        for (int i = 0; i < 3; i++) taken[state->origin[cohesive->rotations[k].first[i]]] |= 1 << colour;
    return colour;
}

void shv_cohesive_order_closing(ShvCohesive *cohesive, const ShvState *state)
{
    const int32_t chunks = (cohesive->rotation_count + CHUNK - 1) / CHUNK;
    int32_t *start = cohesive->colour_start, *taken = cohesive->origin_fill, *colour = cohesive->closed;
    memset(start, 0, sizeof cohesive->colour_start); /* `closed` has room until the next closing */
    for (int32_t chunk = 0; chunk < chunks; chunk++) {
        colour[chunk] = find_colour(cohesive, state, chunk, taken);
        start[colour[chunk]]++;
    }
    memset(taken, 0, (size_t)cohesive->model->mesh.node_count * sizeof *taken);
    shv_cohesive_sum_up(start, SHV_CLOSING_COLOURS + 1);
    int32_t fill[SHV_CLOSING_COLOURS];
    memcpy(fill, start, sizeof fill);
    for (int32_t chunk = 0; chunk < chunks; chunk++) cohesive->chunks[fill[colour[chunk]]++] = chunk;
}

/* `place`: of the chunk among all of all passes. */
static bool close_chunk(ShvCohesive *cohesive, ShvState *state, int32_t place, int pass, double kick, double step)
{
    const int32_t chunks = cohesive->colour_start[SHV_CLOSING_COLOURS], chunk = cohesive->chunks[place];
    int32_t number = (pass * chunks + place) * CHUNK;
    bool any = false;
    for (int32_t k = chunk * CHUNK; k < chunk_end(cohesive, chunk); k++, number++) {
        if (pass > 0 && !has_news(cohesive, k)) continue;
        cohesive->closed[k] = number;
        if (!may_meet(cohesive, state, k, step) || !close_facet(cohesive, state, k, kick, step)) continue;
        note_strike(cohesive, k, number + 1);
        any = true;
    }
    return any;
}

static bool close_all(ShvCohesive *cohesive, ShvState *state, int pass, double kick, double step)
{
    const int32_t threads = cohesive->model->threads, *start = cohesive->colour_start;
    bool any = false;
    for (int colour = 0; start[colour] < start[SHV_CLOSING_COLOURS]; colour++) {
        const bool parallel =
            colour < LAST_COLOUR && shv_cohesive_in_parallel(cohesive, CHUNK * (start[colour + 1] - start[colour]));
#pragma omp parallel for schedule(static, 1) num_threads(threads) if (parallel) reduction(|| : any)
        for (int32_t place = start[colour]; place < start[colour + 1]; place++)
            any = close_chunk(cohesive, state, place, pass, kick, step) || any;
    }
    return any;
}

void shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double kick, double step)
{
    if (!(step > 0.0 && kick > 0.0)) return;
    bool again = true;
    if (cohesive->rotation_count > 0) memset(cohesive->struck, 0, (size_t)state->node_count * sizeof *cohesive->struck);
    for (int pass = 0; again && pass < MOST_PASSES; pass++) {
        again = close_all(cohesive, state, pass, kick, step);
        cohesive->pushed = cohesive->pushed || again;
    }
}
