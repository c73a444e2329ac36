#include "evaluate/trajectory_error.h"

#include <stdlib.h>
#include <string.h>

/* ---- opening ---- */

/* With a closed form: the body that it is of, or all. */
static ShvStatus choose_bodies(ShvTrajectoryError *trajectory, bool closed, ShvError *error)
{
    const ShvReferenceDefinition *reference = &trajectory->scene->reference;
    bool any = false;
    for (int32_t i = 0; i < trajectory->bodies.count; i++) {
        ShvBody *body = &trajectory->bodies.items[i];
        body->chosen = !closed || !reference->body || strcmp(body->name, reference->body) == 0;
        any |= body->chosen;
    }
    if (any) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "reference.body must name an object or a free obstacle, not '%s'",
                    closed && reference->body ? reference->body : "");
}

static ShvStatus find_forms(ShvTrajectoryError *trajectory, const ShvSimulation *simulation, ShvError *error)
{
    const ShvReferenceDefinition *reference = &trajectory->scene->reference;
    const size_t count = (size_t)trajectory->bodies.count;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    if (reference->law == SHV_REFERENCE_NONE)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the closed form is asked for, but the scene has no 'reference'; give it one");
    if (!reference->body && reference->law != SHV_REFERENCE_FLIGHT && reference->law != SHV_REFERENCE_REST)
        return shv_fail(error, SHV_BAD_INPUT, "this law of `reference` needs `body`");
    trajectory->forms = shv_allocate(trajectory->memory, SHV_PART_RECORD, count, sizeof *trajectory->forms);
    if (!trajectory->forms) return shv_fail_memory(error, "closed forms", count * sizeof *trajectory->forms);
    for (size_t i = 0; i < count; i++) {
        const ShvBody *body = &trajectory->bodies.items[i];
        const ShvBodyState start = shv_body_state(body, shv_simulation_frame(simulation));
        if (body->chosen)
            SHV_TRY(shv_closed_form(&trajectory->forms[i], trajectory->scene, &mesh, body, &start, error));
    }
    return SHV_OK;
}

ShvStatus shv_trajectory_error_open(ShvTrajectoryError *trajectory, const ShvSceneDefinition *scene, const char *folder,
                                    bool closed, ShvMemory *memory, ShvError *error)
{
    *trajectory = (ShvTrajectoryError){.scene = scene, .memory = memory};
    ShvSimulation *simulation;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = folder;
    options.memory = memory;
    SHV_TRY(shv_simulation_create(&simulation, scene, &options, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    if (status == SHV_OK)
        status = shv_bodies_create(&trajectory->bodies, scene, shv_simulation_frame(simulation), memory, error);
    if (status == SHV_OK) status = choose_bodies(trajectory, closed, error);
    if (status == SHV_OK && closed) status = find_forms(trajectory, simulation, error);
    shv_simulation_destroy(simulation);
    return status;
}

void shv_trajectory_error_close(ShvTrajectoryError *trajectory)
{
    shv_bodies_release(&trajectory->bodies);
    shv_release(trajectory->forms);
    shv_release(trajectory->track.rows);
    trajectory->forms = NULL;
    trajectory->track.rows = NULL;
}

/* ---- frame by frame ---- */

static ShvBodyState state_at(const ShvOutcomeList *track, int32_t bodies, int32_t frame, int32_t body)
{
    ShvBodyState state;
    memcpy(&state, track->values + ((int64_t)frame * bodies + body) * SHV_BODY_NUMBERS, sizeof state);
    return state;
}

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

static double energy_of(const ShvBody *body, const ShvBodyState *state, ShvVec3 gravity)
{
    return shv_body_kinetic(body, state) - body->mass * shv_dot(gravity, state->position);
}

static void raise(double *largest, double value)
{
    *largest = fmax(*largest, value);
}

static void add_body(Sums *sums, Extremes *most, const ShvBody *body, const ShvBodyState *state,
                     const ShvBodyState *exact, ShvVec3 gravity)
{
    const double moved = shv_norm(shv_sub(state->position, exact->position));
    const double turned = shv_angle_between(state->orientation, exact->orientation);
    const ShvVec3 spin = shv_body_spin_momentum(body, state), exact_spin = shv_body_spin_momentum(body, exact);
    raise(&most->errors[SHV_TRAJECTORY_POSITION], moved);
    raise(&most->errors[SHV_TRAJECTORY_ORIENTATION], turned);
    raise(&most->errors[SHV_TRAJECTORY_VELOCITY], shv_norm(shv_sub(state->velocity, exact->velocity)));
    raise(&most->errors[SHV_TRAJECTORY_SURFACE], moved + body->radius * turned);
    raise(&most->errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM], shv_norm(shv_sub(spin, exact_spin)));
    raise(&most->spin, shv_norm(exact_spin));
    sums->energy += energy_of(body, state, gravity);
    sums->exact_energy += energy_of(body, exact, gravity);
    sums->exact_kinetic += shv_body_kinetic(body, exact);
    sums->momentum = shv_add(sums->momentum, shv_scale(state->velocity, body->mass));
    sums->exact_momentum = shv_madd(sums->exact_momentum, body->mass, exact->velocity);
}

static void add_frame(Extremes *most, const Sums *sums, bool first)
{
    const double potential = sums->exact_energy - sums->exact_kinetic;
    if (first) most->start = potential;
    most->lowest = first ? sums->energy : fmin(most->lowest, sums->energy);
    raise(&most->errors[SHV_TRAJECTORY_ENERGY_GAIN], sums->energy - most->lowest);
    raise(&most->errors[SHV_TRAJECTORY_ENERGY], fabs(sums->energy - sums->exact_energy));
    raise(&most->errors[SHV_TRAJECTORY_LINEAR_MOMENTUM], shv_norm(shv_sub(sums->momentum, sums->exact_momentum)));
    raise(&most->kinetic, sums->exact_kinetic);
    raise(&most->fallen, fabs(potential - most->start));
    raise(&most->momentum, shv_norm(sums->exact_momentum));
}

static int32_t first_chosen(const ShvBodies *bodies)
{
    int32_t i = 0;
    while (!bodies->items[i].chosen) i++;
    return i;
}

/* `reference` NULL, or shorter: the closed form, or the run itself. */
static void follow_frame(ShvTrajectoryError *trajectory, const ShvOutcomeList *track, const ShvOutcomeList *reference,
                         double time, Extremes *most)
{
    const int32_t count = trajectory->bodies.count, frame = trajectory->track.count;
    const int32_t first = first_chosen(&trajectory->bodies);
    Sums sums = {.energy = 0.0};
    for (int32_t i = first; i < count; i++) {
        const ShvBody *body = &trajectory->bodies.items[i];
        if (!body->chosen) continue;
        const ShvBodyState state = state_at(track, count, frame, i);
        ShvBodyState exact = state;
        if (!reference)
            exact = shv_closed_form_at(&trajectory->forms[i], time);
        else if ((int64_t)(frame + 1) * count * SHV_BODY_NUMBERS <= reference->count)
            exact = state_at(reference, count, frame, i);
        add_body(&sums, most, body, &state, &exact, shv_load3(trajectory->scene->gravity));
        if (i == first) trajectory->track.rows[frame] = (ShvTrackRow){time, state};
        if (i == first) trajectory->exact.rows[frame] = (ShvTrackRow){time, exact};
    }
    trajectory->exact.count = ++trajectory->track.count;
    add_frame(most, &sums, frame == 0);
}

/* ---- figures ---- */

/* What energies are measured by: the largest kinetic energy of the reference or change of its potential energy; of what stays
   at rest, the weight times the radius. */
static double energy_scale(const ShvTrajectoryError *trajectory, const Extremes *most)
{
    const double gravity = shv_norm(shv_load3(trajectory->scene->gravity)), largest = fmax(most->kinetic, most->fallen);
    double weight = 0.0;
    for (int32_t i = 0; i < trajectory->bodies.count; i++)
        if (trajectory->bodies.items[i].chosen)
            weight += trajectory->bodies.items[i].mass * gravity * trajectory->bodies.items[i].radius;
    return largest > 1e-12 * weight ? largest : weight;
}

static double over(double value, double scale)
{
    return scale > 0.0 ? value / scale : (double)NAN;
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

static void find_event_times(const ShvTrajectoryError *trajectory, double errors[SHV_TRAJECTORY_MEASURES])
{
    double found[MOST_MOMENTS], exact[MOST_MOMENTS];
    const ShvTrack *track = &trajectory->track, *exact_track = &trajectory->exact;
    const int32_t body = first_chosen(&trajectory->bodies);
    const ShvClosedForm *form = &trajectory->forms[body];
    const ShvMat3 *inertia = &trajectory->bodies.items[body].inertia;
    const bool bounce = form->law == SHV_REFERENCE_BOUNCE;
    const ShvVec3 up = form->direction, g = form->gravity;
    if (!bounce && form->law != SHV_REFERENCE_FLIGHT) return;
    const int count = bounce ? shv_track_impacts(track, up, g, found, MOST_MOMENTS)
                             : shv_track_flips(track, inertia, found, MOST_MOMENTS);
    const int wanted = bounce ? shv_track_impacts(exact_track, up, g, exact, MOST_MOMENTS)
                              : shv_track_flips(exact_track, inertia, exact, MOST_MOMENTS);
    errors[SHV_TRAJECTORY_EVENT_TIME] = largest_apart(found, count, exact, wanted, false);
    if (wanted > 0) errors[SHV_TRAJECTORY_EVENT_COUNT] = abs(count - wanted);
    if (!bounce || count != wanted) return;
    const int heights = shv_track_apices(track, up, g, found, MOST_MOMENTS);
    const int known = shv_track_apices(exact_track, up, g, exact, MOST_MOMENTS),
              least = heights < known ? heights : known;
    errors[SHV_TRAJECTORY_APEX] = largest_apart(found, least, exact, least, true);
}

/* ---- all ---- */

static ShvStatus check_frames(const ShvTrajectoryError *trajectory, const ShvOutcome *run, const ShvOutcome *reference,
                              ShvError *error)
{
    if (!shv_outcome_find(run, "track") || shv_outcome_number(run, "track.bodies") != trajectory->bodies.count)
        return shv_fail(error, SHV_BAD_INPUT, "the runs of this study do not have the same bodies; do not vary them");
    const ShvOutcomeList *a = shv_outcome_find(run, "frame.time");
    const ShvOutcomeList *b = reference ? shv_outcome_find(reference, "frame.time") : a;
    for (int64_t i = 0; i < a->count && i < b->count; i++)
        if (fabs(a->values[i] - b->values[i]) > 1e-9 * trajectory->scene->duration)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the frames of the runs are not at the same times; give all one output.rate and no "
                            "output.fracture_every");
    return SHV_OK;
}

ShvStatus shv_trajectory_error_measure(ShvTrajectoryError *trajectory, const ShvOutcome *run,
                                       const ShvOutcome *reference, double errors[SHV_TRAJECTORY_MEASURES],
                                       ShvError *error)
{
    const ShvOutcomeList *track = shv_outcome_find(run, "track"), *times = shv_outcome_find(run, "frame.time");
    const ShvOutcomeList *beside = reference ? shv_outcome_find(reference, "track") : NULL;
    for (int i = 0; i < SHV_TRAJECTORY_MEASURES; i++) errors[i] = (double)NAN;
    trajectory->track.count = 0;
    if (!times || times->count == 0 || (reference && !beside) || (!reference && !trajectory->forms)) return SHV_OK;
    SHV_TRY(check_frames(trajectory, run, reference, error));
    for (int32_t i = 0; trajectory->forms && i < trajectory->bodies.count; i++)
        trajectory->forms[i].top.time = trajectory->forms[i].top.turned = 0.0; /* closed forms start anew */
    SHV_RESIZE(trajectory->memory, SHV_PART_RECORD, trajectory->track.rows, 2 * (size_t)times->count,
               "a run to compare", 0, error);
    trajectory->exact.rows = trajectory->track.rows + times->count;
    Extremes most = {.lowest = 0.0};
    while (trajectory->track.count < times->count)
        follow_frame(trajectory, track, beside, times->values[trajectory->track.count], &most);
    const double scale = energy_scale(trajectory, &most);
    memcpy(errors, most.errors, SHV_TRAJECTORY_EVENT_TIME * sizeof *errors);
    errors[SHV_TRAJECTORY_ENERGY] = over(errors[SHV_TRAJECTORY_ENERGY], scale);
    errors[SHV_TRAJECTORY_ENERGY_GAIN] = over(errors[SHV_TRAJECTORY_ENERGY_GAIN], scale);
    errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM] = over(errors[SHV_TRAJECTORY_ANGULAR_MOMENTUM], most.spin);
    if (errors[SHV_TRAJECTORY_LINEAR_MOMENTUM] != 0.0)
        errors[SHV_TRAJECTORY_LINEAR_MOMENTUM] = over(errors[SHV_TRAJECTORY_LINEAR_MOMENTUM], most.momentum);
    if (trajectory->forms) find_event_times(trajectory, errors);
    return SHV_OK;
}
