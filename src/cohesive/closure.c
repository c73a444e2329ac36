#include <math.h>

#include "cohesive/facet_rotation.h"
#include "cohesive/solve.h"

enum { MOST_PASSES = 4 };

/* One pair, and the facet whose corner it is. */
typedef struct Closing {
    ShvFacetRotation *rotation; /* its rate is that of the present velocities as long as `known` */
    ShvFacetGaps *gaps;
    int corner;
    bool known;
    double held;  /* what the pair may give when it parts, J */
    bool elastic; /* it gives back a share of what closing takes */
} Closing;

/* Of opening, seen by one who turns with the facet. */
static ShvVec3 rate_of(Closing *closing, const ShvState *state)
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
   inelastic, so that kinetic energy falls with every one of them. */
static void strike(Closing *closing, ShvState *state, ShvVec3 impulse, double kick)
{
    const int i = closing->corner;
    const int32_t first = closing->rotation->first[i], second = closing->rotation->second[i];
    const ShvVec3 force = shv_scale(impulse, -1.0 / kick); /* on the first node */
    shv_add_to3(state->velocity + 3 * (int64_t)first, shv_scale(impulse, -1.0 / state->mass[first]));
    shv_add_to3(state->velocity + 3 * (int64_t)second, shv_scale(impulse, 1.0 / state->mass[second]));
    shv_facet_rotation_strike(closing->rotation, state, shv_cross(closing->gaps->opening[i], force), kick);
    shv_add_to3(state->force + 3 * (int64_t)first, force);
    shv_add_to3(state->force + 3 * (int64_t)second, shv_scale(force, -1.0));
    closing->gaps->push[i] = shv_add(closing->gaps->push[i], force);
    closing->known = false;
}

/* Coulomb: at most `limit`, and at most what stops the slip. */
static void rub(Closing *closing, ShvState *state, double kick, double limit)
{
    const ShvVec3 rate = rate_of(closing, state), normal = closing->rotation->normal;
    const ShvVec3 slip = shv_madd(rate, -shv_dot(rate, normal), normal);
    const double speed = shv_norm(slip);
    if (!(speed > 0.0)) return;
    const double stopping = speed / response(closing, state, shv_scale(slip, 1.0 / speed));
    strike(closing, state, shv_scale(slip, -fmin(stopping, limit) / speed), kick);
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
    strike(closing, state, shv_scale(closing->rotation->normal, impulse), kick);
}

/* Of a pair that nothing has pressed in this step all that is held comes back over the way from n − 1/2 to n + 1/2:
   push × (way without it + yield × push) = held. That is what is booked; besides, kinetic energy rises by no more than that,
   so that impulses of neighbours, each counting on the others as they are, together never give more than is held. */
static bool rebound(Closing *closing, ShvState *state, double kick, double step, double speed)
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
static bool yield_back(Closing *closing, ShvState *state, double kick, double speed)
{
    const ShvVec3 normal = closing->rotation->normal;
    const double inverse_mass = response(closing, state, normal);
    const double push = -shv_dot(closing->gaps->push[closing->corner], normal);
    const double less = shv_smaller(push, speed / (kick * inverse_mass));
    if (!(less > settled_share * push)) return false;
    change_push(closing, state, kick, -less * kick, speed, inverse_mass);
    return true;
}

static bool close_pair(Closing *closing, ShvState *state, double kick, double step, double friction, bool failed)
{
    const ShvVec3 normal = closing->rotation->normal;
    bool *pressed = &closing->gaps->pressed[closing->corner];
    const double gap = shv_dot(closing->gaps->opening[closing->corner], normal);
    const double speed = shv_dot(rate_of(closing, state), normal);
    const double allowed = gap > 0.0 ? -gap / step : 0.0;
    if (*pressed && speed > 0.0 && closing->elastic) return yield_back(closing, state, kick, speed);
    if (speed > 0.0 && closing->held > 0.0) return rebound(closing, state, kick, step, speed);
    if (!(speed < allowed)) return false;
    const double impulse = (allowed - speed) / response(closing, state, normal);
    strike(closing, state, shv_scale(normal, impulse), kick);
    if (friction > 0.0 && failed) rub(closing, state, kick, friction * impulse);
    *pressed = true;
    return true;
}

static bool close_facet(ShvCohesive *cohesive, ShvState *state, int32_t k, double kick, double step, double friction)
{
    Closing closing = {.rotation = &cohesive->rotations[k], .gaps = &cohesive->gaps[k]};
    closing.elastic = cohesive->sides[closing.rotation->index].returned > 0.0;
    const uint8_t phase = cohesive->phase[closing.rotation->index];
    bool any = false;
    if (phase == SHV_COHESIVE_SEPARATED) return false;
    for (closing.corner = 0; closing.corner < 3; closing.corner++) {
        if (closing.rotation->first[closing.corner] == closing.rotation->second[closing.corner]) continue;
        closing.held = shv_cohesive_releasable(cohesive, state, closing.rotation, closing.corner);
        any = close_pair(&closing, state, kick, step, friction, phase == SHV_COHESIVE_FAILED) || any;
    }
    return any;
}

void shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double kick, double step, double friction)
{
    if (!(step > 0.0 && kick > 0.0)) return;
    bool again = true;
    for (int pass = 0; again && pass < MOST_PASSES; pass++) {
        again = false;
        for (int32_t k = 0; k < cohesive->rotation_count; k++)
            again = close_facet(cohesive, state, k, kick, step, friction) || again;
        cohesive->pushed = cohesive->pushed || again;
    }
}
