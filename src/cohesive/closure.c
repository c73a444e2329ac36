#include <math.h>

#include "cohesive/cohesive.h"

enum { MOST_PASSES = 4 };

/* Impulse on a pair, taken by the whole masses of its nodes: pairs are served one after another, each impulse for itself
   inelastic, so that kinetic energy falls with every one of them. */
static void strike(ShvState *state, ShvCohesivePoint *point, ShvVec3 impulse, double kick)
{
    const int32_t first = point->first, second = point->second;
    const ShvVec3 force = shv_scale(impulse, -1.0 / kick); /* on the first node */
    shv_add_to3(state->velocity + 3 * (int64_t)first, shv_scale(impulse, -1.0 / state->mass[first]));
    shv_add_to3(state->velocity + 3 * (int64_t)second, shv_scale(impulse, 1.0 / state->mass[second]));
    shv_add_to3(state->force + 3 * (int64_t)first, force);
    shv_add_to3(state->force + 3 * (int64_t)second, shv_scale(force, -1.0));
    point->push = shv_add(point->push, force);
}

/* Coulomb: at most friction × the normal impulse, and at most what stops the slip. */
static ShvVec3 friction_impulse(ShvVec3 rate, ShvVec3 normal, double mass, double limit)
{
    const ShvVec3 slip = shv_madd(rate, -shv_dot(rate, normal), normal);
    const double speed = shv_norm(slip);
    if (!(speed > 0.0)) return shv_vec3(0.0, 0.0, 0.0);
    return shv_scale(slip, -fmin(mass, limit / speed));
}

static bool close_pair(ShvState *state, ShvCohesivePoint *point, double kick, double step, double friction)
{
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                 shv_load3(state->velocity + 3 * (int64_t)point->first));
    const double gap = shv_dot(point->opening, point->normal), speed = shv_dot(rate, point->normal);
    const double allowed = gap > 0.0 ? -gap / step : 0.0;
    if (!(speed < allowed)) return false;
    const double first = state->mass[point->first], second = state->mass[point->second];
    const double mass = first * (second / (first + second));
    const double normal = mass * (allowed - speed);
    ShvVec3 impulse = shv_scale(point->normal, normal);
    if (friction > 0.0 && !point->carrying)
        impulse = shv_add(impulse, friction_impulse(rate, point->normal, mass, friction * normal));
    strike(state, point, impulse, kick);
    return true;
}

void shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double kick, double step, double friction)
{
    if (!(step > 0.0 && kick > 0.0)) return;
    bool again = true;
    for (int pass = 0; again && pass < MOST_PASSES; pass++) {
        again = false;
        for (int32_t i = 0; i < cohesive->pair_count; i++)
            if (close_pair(state, &cohesive->points[cohesive->pairs[i]], kick, step, friction)) again = true;
    }
}
