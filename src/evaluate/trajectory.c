#include "evaluate/trajectory.h"

#include <stdlib.h>
#include <string.h>

/* ---- the ways of two runs ---- */

typedef struct Ways {
    ShvTrackScene scene;
    int32_t body_count;
    bool closed; /* compared with the closed form, which may be of one body */
    const ShvBody *bodies;
    const ShvBodyState *own, *exact; /* frame by frame, all bodies */
    const double *times;
    int32_t count, exact_count; /* frames; of a shorter reference fewer */
} Ways;

static bool is_chosen(const Ways *ways, int32_t body)
{
    return !ways->closed || ways->bodies[body].chosen == 1.0;
}

static int32_t first_chosen(const Ways *ways)
{
    int32_t i = 0;
    while (!is_chosen(ways, i)) i++;
    return i;
}

/* Where both runs have a frame it is at one time. */
static ShvStatus check_frames(const ShvOutcome *run, const ShvOutcome *reference, const Ways *ways, ShvError *error)
{
    const ShvOutcomeList *a = shv_outcome_find(run, "frame.time"), *b = shv_outcome_find(reference, "frame.time");
    if (ways->body_count != shv_outcome_number(reference, "track.bodies"))
        return shv_fail(error, SHV_BAD_INPUT, "the runs of this study do not have the same bodies; do not vary them");
    for (int64_t i = 0; i < a->count && i < b->count; i++)
        if (fabs(a->values[i] - b->values[i]) > 1e-9 * ways->scene.duration)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the frames of the runs are not at the same times; give all one output.rate and no "
                            "output.fracture_every");
    return SHV_OK;
}

/* No frames where one of both is not kept. */
static ShvStatus find_ways(Ways *ways, const ShvOutcome *run, const ShvOutcome *reference, ShvError *error)
{
    const ShvOutcomeList *times = shv_outcome_find(run, "frame.time"), *track = shv_outcome_find(run, "track"),
                         *exact = shv_outcome_find(reference ? reference : run, reference ? "track" : "exact"),
                         *scene = shv_outcome_find(run, "track.scene"), *bodies = shv_outcome_find(run, "track.masses");
    *ways = (Ways){.closed = !reference};
    if (times && run->no_motion[0] && !(track && reference))
        return shv_fail(error, SHV_BAD_INPUT, "%s", run->no_motion);
    if (!times || times->count == 0 || !track || !exact || !scene || !bodies) return SHV_OK;
    memcpy(&ways->scene, scene->values, sizeof ways->scene);
    ways->body_count = (int32_t)shv_outcome_number(run, "track.bodies");
    if (reference) SHV_TRY(check_frames(run, reference, ways, error));
    ways->bodies = (const void *)bodies->values;
    ways->own = (const void *)track->values;
    ways->exact = (const void *)exact->values;
    ways->times = times->values;
    ways->count = (int32_t)times->count;
    ways->exact_count = (int32_t)(exact->count / ((int64_t)ways->body_count * SHV_STATE_NUMBERS));
    return SHV_OK;
}

/* ---- frame by frame ---- */

/* Sums over the chosen bodies in one frame; own, and of what they are compared with. */
typedef struct Sums {
    double energy, exact_energy, exact_kinetic; /* J */
    ShvVec3 momentum, exact_momentum;
} Sums;

/* The largest over the frames so far: errors, and what they are measured by. */
typedef struct Extremes {
    double errors[SHV_TRAJECTORY_MEASURES]; /* J, kg m²/s, kg m/s and so on */
    double lowest;                          /* J: the least energy */
    double kinetic, start, fallen; /* J, of the exact motion: kinetic; potential at the start, and its change */
    double spin, momentum;         /* of the exact motion: kg m²/s, about a body's own centre; kg m/s */
} Extremes;

static void raise(double *largest, double value)
{
    *largest = fmax(*largest, value);
}

static double angle_between(ShvQuat a, ShvQuat b)
{
    const ShvQuat turn = shv_quat_multiply(shv_quat_conjugate(a), b);
    return 2.0 * atan2(shv_norm(shv_vec3(turn.x, turn.y, turn.z)), fabs(turn.w));
}

/* About its own centre, world axes. */
static ShvVec3 spin_momentum(const ShvBody *body, const ShvBodyState *state)
{
    const ShvVec3 spin = shv_rotate(shv_quat_conjugate(state->orientation), state->angular_velocity);
    return shv_rotate(state->orientation, shv_apply(&body->inertia, spin));
}

static void add_body(Sums *sums, Extremes *most, const ShvBody *body, const ShvBodyState *state,
                     const ShvBodyState *exact, ShvVec3 gravity)
{
    const double moved = shv_norm(shv_sub(state->position, exact->position));
    const double turned = angle_between(state->orientation, exact->orientation);
    const ShvVec3 spin = spin_momentum(body, state), exact_spin = spin_momentum(body, exact);
    const double kinetic =
        0.5 * body->mass * shv_dot(state->velocity, state->velocity) + 0.5 * shv_dot(state->angular_velocity, spin);
    const double exact_kinetic = 0.5 * body->mass * shv_dot(exact->velocity, exact->velocity) +
                                 0.5 * shv_dot(exact->angular_velocity, exact_spin);
    raise(&most->errors[SHV_TRAJECTORY_POSITION], moved);
    raise(&most->errors[SHV_TRAJECTORY_ORIENTATION], turned);
    raise(&most->errors[SHV_TRAJECTORY_VELOCITY], shv_norm(shv_sub(state->velocity, exact->velocity)));
    raise(&most->errors[SHV_TRAJECTORY_SURFACE], moved + body->radius * turned);
    raise(&most->errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM], shv_norm(shv_sub(spin, exact_spin)));
    raise(&most->spin, shv_norm(exact_spin));
    sums->energy += kinetic - body->mass * shv_dot(gravity, state->position);
    sums->exact_energy += exact_kinetic - body->mass * shv_dot(gravity, exact->position);
    sums->exact_kinetic += exact_kinetic;
    sums->momentum = shv_add(sums->momentum, shv_scale(state->velocity, body->mass));
    sums->exact_momentum = shv_madd(sums->exact_momentum, body->mass, exact->velocity);
}

/* Beyond the end of a shorter reference a run is compared with itself. */
static void add_frame(const Ways *ways, int32_t frame, Extremes *most)
{
    const int64_t first = (int64_t)frame * ways->body_count;
    const ShvBodyState *exact = frame < ways->exact_count ? ways->exact : ways->own;
    Sums sums = {.energy = 0.0};
    for (int32_t i = 0; i < ways->body_count; i++)
        if (is_chosen(ways, i))
            add_body(&sums, most, &ways->bodies[i], &ways->own[first + i], &exact[first + i], ways->scene.gravity);
    const double potential = sums.exact_energy - sums.exact_kinetic;
    if (frame == 0) most->start = potential;
    most->lowest = frame == 0 ? sums.energy : fmin(most->lowest, sums.energy);
    raise(&most->errors[SHV_TRAJECTORY_ENERGY_GAIN], sums.energy - most->lowest);
    raise(&most->errors[SHV_TRAJECTORY_ENERGY], fabs(sums.energy - sums.exact_energy));
    raise(&most->errors[SHV_TRAJECTORY_LINEAR_MOMENTUM], shv_norm(shv_sub(sums.momentum, sums.exact_momentum)));
    raise(&most->kinetic, sums.exact_kinetic);
    raise(&most->fallen, fabs(potential - most->start));
    raise(&most->momentum, shv_norm(sums.exact_momentum));
}

/* ---- events of one body ---- */

static const ShvBodyState *state_at(const ShvTrack *track, int32_t frame)
{
    return &track->states[(int64_t)frame * track->stride];
}

/* Whether the body hit a plane between this frame and the next; *time receives when, *place where along the normal. */
static bool impact_after(const ShvTrack *track, int32_t frame, ShvVec3 normal, ShvVec3 gravity, double *time,
                         double *place)
{
    const ShvBodyState *from = state_at(track, frame), *to = state_at(track, frame + 1);
    const double step = track->times[frame + 1] - track->times[frame], g = shv_dot(gravity, normal);
    const double x0 = shv_dot(from->position, normal), x1 = shv_dot(to->position, normal);
    const double v0 = shv_dot(from->velocity, normal), v1 = shv_dot(to->velocity, normal);
    const double jump = v1 - v0 - g * step;
    if (jump <= 3.0 * fabs(g) * step || v0 + g * step >= 0.0 || v1 - g * step <= 0.0) return false;
    /* x0 + v0 τ + ½ g τ² = x1 − v1 (h − τ) + ½ g (h − τ)² */
    const double since = fmin(step, fmax(0.0, (x0 - x1 + v1 * step - 0.5 * g * step * step) / jump));
    *time = track->times[frame] + since;
    *place = x0 + (v0 + 0.5 * g * since) * since;
    return true;
}

int shv_track_impacts(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *times, double *heights, int most)
{
    int count = 0;
    int32_t last = -1;
    double ground = 0.0, place;
    for (int32_t i = 0; i + 1 < track->count && count < most; i++) {
        if (!impact_after(track, i, normal, gravity, &times[count], &place)) continue;
        if (last < 0) ground = place;
        const ShvBodyState *middle = state_at(track, (last + i + 1) / 2);
        const double v = shv_dot(middle->velocity, normal);
        if (last >= 0)
            heights[count - 1] = shv_dot(middle->position, normal) + 0.5 * v * v / -shv_dot(gravity, normal) - ground;
        last = i;
        count++;
    }
    return count;
}

int shv_track_flips(const ShvTrack *track, const ShvMat3 *inertia, double *times, int most)
{
    double moments[3], before = 0.0;
    ShvMat3 axes;
    int count = 0;
    shv_symmetric_eigen(inertia, moments, &axes);
    const ShvVec3 middle = {axes.m[0][1], axes.m[1][1], axes.m[2][1]};
    for (int32_t i = 0; i < track->count && count < most; i++) {
        const ShvBodyState *state = state_at(track, i);
        const double spin = shv_dot(shv_rotate(state->orientation, middle), state->angular_velocity);
        /* Zero within round-off is no side to come from. */
        if (fabs(spin) <= 1e-12 * shv_norm(state->angular_velocity)) continue;
        if (spin * before < 0.0) {
            const double step = track->times[i] - track->times[i - 1];
            times[count++] = track->times[i] - step * spin / (spin - before);
        }
        before = spin;
    }
    return count;
}

enum { MOST_MOMENTS = 8 };

/* Largest difference of the first entries, over the exact ones where `relative`; NaN unless all are there. */
static double largest_apart(const double *found, int count, const double *exact, int wanted, bool relative)
{
    double most = 0.0;
    if (count == 0 || count != wanted) return (double)NAN;
    for (int i = 0; i < count; i++) most = fmax(most, fabs(found[i] - exact[i]) / (relative ? fabs(exact[i]) : 1.0));
    return most;
}

/* Of the first chosen body, where there is a law that has events. */
static void find_events(const Ways *ways, double errors[SHV_TRAJECTORY_MEASURES])
{
    double found[2][MOST_MOMENTS + 1], heights[2][MOST_MOMENTS];
    int count[2];
    const bool bounce = ways->scene.law == SHV_REFERENCE_BOUNCE;
    const ShvVec3 up = ways->scene.up, g = ways->scene.gravity;
    const int32_t body = first_chosen(ways), stride = ways->body_count;
    const ShvTrack tracks[2] = {{ways->times, ways->own + body, stride, ways->count},
                                {ways->times, ways->exact + body, stride, ways->count}};
    if (!bounce && ways->scene.law != SHV_REFERENCE_FLIGHT) return;
    for (int i = 0; i < 2; i++)
        count[i] = bounce ? shv_track_impacts(&tracks[i], up, g, found[i], heights[i], MOST_MOMENTS + 1)
                          : shv_track_flips(&tracks[i], &ways->bodies[body].inertia, found[i], MOST_MOMENTS);
    const int own = count[0] < MOST_MOMENTS ? count[0] : MOST_MOMENTS;
    const int exact = count[1] < MOST_MOMENTS ? count[1] : MOST_MOMENTS;
    errors[SHV_TRAJECTORY_EVENT_TIME] = largest_apart(found[0], own, found[1], exact, false);
    if (exact > 0) errors[SHV_TRAJECTORY_EVENT_COUNT] = abs(own - exact);
    const int least = (count[0] < count[1] ? count[0] : count[1]) - 1;
    if (bounce && own == exact && own > 0)
        errors[SHV_TRAJECTORY_APEX] = largest_apart(heights[0], least, heights[1], least, true);
}

/* ---- all ---- */

/* What energies are measured by: the largest kinetic energy of the reference or change of its potential energy; of what stays
   at rest, the weight times the radius. */
static double energy_scale(const Ways *ways, const Extremes *most)
{
    const double gravity = shv_norm(ways->scene.gravity), largest = fmax(most->kinetic, most->fallen);
    double weight = 0.0;
    for (int32_t i = 0; i < ways->body_count; i++)
        if (is_chosen(ways, i)) weight += ways->bodies[i].mass * gravity * ways->bodies[i].radius;
    return largest > 1e-12 * weight ? largest : weight;
}

static double over(double value, double scale)
{
    return scale > 0.0 ? value / scale : (double)NAN;
}

ShvStatus shv_trajectory_errors(const ShvOutcome *run, const ShvOutcome *reference,
                                double errors[SHV_TRAJECTORY_MEASURES], ShvError *error)
{
    Ways ways;
    Extremes most = {.lowest = 0.0};
    for (int i = 0; i < SHV_TRAJECTORY_MEASURES; i++) errors[i] = (double)NAN;
    SHV_TRY(find_ways(&ways, run, reference, error));
    if (ways.count == 0) return SHV_OK;
    for (int32_t frame = 0; frame < ways.count; frame++) add_frame(&ways, frame, &most);
    const double scale = energy_scale(&ways, &most);
    memcpy(errors, most.errors, SHV_TRAJECTORY_EVENT_TIME * sizeof *errors);
    errors[SHV_TRAJECTORY_ENERGY] = over(errors[SHV_TRAJECTORY_ENERGY], scale);
    errors[SHV_TRAJECTORY_ENERGY_GAIN] = over(errors[SHV_TRAJECTORY_ENERGY_GAIN], scale);
    errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM] = over(errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM], most.spin);
    if (errors[SHV_TRAJECTORY_LINEAR_MOMENTUM] != 0.0)
        errors[SHV_TRAJECTORY_LINEAR_MOMENTUM] = over(errors[SHV_TRAJECTORY_LINEAR_MOMENTUM], most.momentum);
    if (!reference) find_events(&ways, errors);
    return SHV_OK;
}
