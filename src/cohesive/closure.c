#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/turn.h"

enum { MOST_PASSES = 4 };

/* One pair, and the facet whose corner it is. */
typedef struct Closing {
    ShvCohesivePoint *point, *points;
    const ShvFacetTurn *turn;
    ShvVec3 turn_rate; /* rad/s; as long as `known`: no velocity has changed since */
    bool known;
} Closing;

static void look_at(const ShvCohesive *cohesive, int32_t p, Closing *closing)
{
    const int32_t facet = p / 3;
    closing->known = closing->known && closing->turn == cohesive->turns + facet;
    closing->turn = cohesive->turns + facet;
    closing->points = cohesive->points + 3 * (int64_t)facet;
    closing->point = cohesive->points + p;
}

/* Of opening, seen by one who turns with the facet. */
static ShvVec3 rate_of(Closing *closing, const ShvState *state)
{
    const ShvCohesivePoint *point = closing->point;
    if (!closing->known) closing->turn_rate = shv_turn_rate(closing->turn, closing->points, state);
    closing->known = true;
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                 shv_load3(state->velocity + 3 * (int64_t)point->first));
    return shv_sub(rate, shv_cross(closing->turn_rate, point->opening));
}

static double response(const Closing *closing, const ShvState *state, ShvVec3 direction)
{
    return shv_turn_response(closing->turn, closing->points, state, (int)(closing->point - closing->points), direction);
}

/* Impulse on a pair, taken by the whole masses of its nodes: pairs are served one after another, each impulse for itself
   inelastic, so that kinetic energy falls with every one of them. */
static void strike(Closing *closing, ShvState *state, ShvVec3 impulse, double kick)
{
    ShvCohesivePoint *point = closing->point;
    const int32_t first = point->first, second = point->second;
    const ShvVec3 force = shv_scale(impulse, -1.0 / kick); /* on the first node */
    shv_add_to3(state->velocity + 3 * (int64_t)first, shv_scale(impulse, -1.0 / state->mass[first]));
    shv_add_to3(state->velocity + 3 * (int64_t)second, shv_scale(impulse, 1.0 / state->mass[second]));
    shv_turn_strike(closing->turn, closing->points, state, shv_cross(point->opening, force), kick);
    shv_add_to3(state->force + 3 * (int64_t)first, force);
    shv_add_to3(state->force + 3 * (int64_t)second, shv_scale(force, -1.0));
    point->push = shv_add(point->push, force);
    closing->known = false;
}

/* Coulomb: at most `limit`, and at most what stops the slip. */
static void rub(Closing *closing, ShvState *state, double kick, double limit)
{
    const ShvVec3 rate = rate_of(closing, state), normal = closing->point->normal;
    const ShvVec3 slip = shv_madd(rate, -shv_dot(rate, normal), normal);
    const double speed = shv_norm(slip);
    if (!(speed > 0.0)) return;
    const double stopping = speed / response(closing, state, shv_scale(slip, 1.0 / speed));
    strike(closing, state, shv_scale(slip, -fmin(stopping, limit) / speed), kick);
}

static bool close_pair(Closing *closing, ShvState *state, double kick, double step, double friction)
{
    const ShvCohesivePoint *point = closing->point;
    const double gap = shv_dot(point->opening, point->normal);
    const double speed = shv_dot(rate_of(closing, state), point->normal);
    const double allowed = gap > 0.0 ? -gap / step : 0.0;
    if (!(speed < allowed)) return false;
    const double impulse = (allowed - speed) / response(closing, state, point->normal);
    strike(closing, state, shv_scale(point->normal, impulse), kick);
    if (friction > 0.0 && !point->carrying) rub(closing, state, kick, friction * impulse);
    return true;
}

void shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double kick, double step, double friction)
{
    if (!(step > 0.0 && kick > 0.0)) return;
    bool again = true;
    for (int pass = 0; again && pass < MOST_PASSES; pass++) {
        again = false;
        Closing closing = {.known = false};
        for (int32_t i = 0; i < cohesive->pair_count; i++) {
            look_at(cohesive, cohesive->pairs[i], &closing);
            if (close_pair(&closing, state, kick, step, friction)) again = true;
        }
    }
}
