#include "evaluate/way.h"

#include <stdlib.h>
#include <string.h>

/* ---- opening ---- */

/* With a closed form: the body that it is of, or all. */
static ShvStatus choose_bodies(ShvWay *way, bool closed, ShvError *error)
{
    const ShvReferenceDefinition *reference = &way->scene->reference;
    bool any = false;
    for (int32_t i = 0; i < way->bodies.count; i++) {
        ShvBody *body = &way->bodies.items[i];
        body->chosen = !closed || !reference->body || strcmp(body->name, reference->body) == 0;
        any |= body->chosen;
    }
    if (any) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "reference.body must name an object or a free obstacle, not '%s'",
                    closed && reference->body ? reference->body : "");
}

static ShvStatus find_forms(ShvWay *way, const ShvSimulation *simulation, ShvError *error)
{
    const ShvReferenceDefinition *reference = &way->scene->reference;
    const size_t count = (size_t)way->bodies.count;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    if (reference->law == SHV_REFERENCE_NONE)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the closed form is asked for, but the scene has no 'reference'; give it one");
    if (!reference->body && reference->law != SHV_REFERENCE_FLIGHT && reference->law != SHV_REFERENCE_REST)
        return shv_fail(error, SHV_BAD_INPUT, "this law of `reference` needs `body`");
    way->forms = shv_allocate(way->memory, SHV_PART_RECORD, count, sizeof *way->forms);
    if (!way->forms) return shv_fail_memory(error, "closed forms", count * sizeof *way->forms);
    for (size_t i = 0; i < count; i++) {
        const ShvBody *body = &way->bodies.items[i];
        const ShvBodyState start = shv_body_state(body, shv_simulation_frame(simulation));
        if (body->chosen) SHV_TRY(shv_closed_form(&way->forms[i], way->scene, &mesh, body, &start, error));
    }
    return SHV_OK;
}

ShvStatus shv_way_open(ShvWay *way, const ShvSceneDefinition *scene, const char *folder, bool closed, ShvMemory *memory,
                       ShvError *error)
{
    *way = (ShvWay){.scene = scene, .memory = memory};
    ShvSimulation *simulation;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = folder;
    options.memory = memory;
    SHV_TRY(shv_simulation_create(&simulation, scene, &options, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    if (status == SHV_OK)
        status = shv_bodies_create(&way->bodies, scene, shv_simulation_frame(simulation), memory, error);
    if (status == SHV_OK) status = choose_bodies(way, closed, error);
    if (status == SHV_OK && closed) status = find_forms(way, simulation, error);
    shv_simulation_destroy(simulation);
    return status;
}

void shv_way_close(ShvWay *way)
{
    shv_bodies_release(&way->bodies);
    shv_release(way->forms);
    shv_release(way->track.rows);
    way->forms = NULL;
    way->track.rows = NULL;
}

/* ---- frame by frame ---- */

static ShvBodyState state_at(const ShvOutcomeList *track, int32_t bodies, int32_t frame, int32_t body)
{
    ShvBodyState state;
    memcpy(&state, track->values + ((int64_t)frame * bodies + body) * SHV_BODY_NUMBERS, sizeof state);
    return state;
}

static double energy_of(const ShvBody *body, const ShvBodyState *state, ShvVec3 gravity)
{
    return shv_body_kinetic(body, state) - body->mass * shv_dot(gravity, state->position);
}

static void add_body(ShvTrackRow *row, const ShvBody *body, const ShvBodyState *state, const ShvBodyState *exact,
                     ShvVec3 gravity)
{
    const double moved = shv_norm(shv_sub(state->position, exact->position));
    const double turned = shv_turn_between(state->orientation, exact->orientation);
    const ShvVec3 spin = shv_body_spin_momentum(body, state), linear = shv_scale(state->velocity, body->mass);
    row->position = fmax(row->position, moved);
    row->orientation = fmax(row->orientation, turned);
    row->velocity = fmax(row->velocity, shv_norm(shv_sub(state->velocity, exact->velocity)));
    row->surface = fmax(row->surface, moved + body->radius * turned);
    row->spin = fmax(row->spin, shv_norm(shv_sub(spin, shv_body_spin_momentum(body, exact))));
    row->energy += energy_of(body, state, gravity);
    row->reference_energy += energy_of(body, exact, gravity);
    row->reference_kinetic += shv_body_kinetic(body, exact);
    row->reference_spin = fmax(row->reference_spin, shv_norm(shv_body_spin_momentum(body, exact)));
    row->momentum = shv_add(row->momentum, linear);
    row->reference_momentum = shv_madd(row->reference_momentum, body->mass, exact->velocity);
    row->angular_momentum = shv_add(row->angular_momentum, shv_add(spin, shv_cross(state->position, linear)));
}

/* `reference` NULL, or shorter: the closed form, or the run itself. */
static ShvTrackRow row_of(ShvWay *way, const ShvOutcomeList *track, const ShvOutcomeList *reference, int32_t frame,
                          double time)
{
    const ShvVec3 gravity = shv_load3(way->scene->gravity);
    const int32_t count = way->bodies.count;
    ShvTrackRow row = {.time = time};
    bool any = false;
    for (int32_t i = 0; i < count; i++) {
        const ShvBody *body = &way->bodies.items[i];
        if (!body->chosen) continue;
        const ShvBodyState state = state_at(track, count, frame, i);
        ShvBodyState exact = state;
        if (!reference)
            exact = shv_closed_form_at(&way->forms[i], time);
        else if ((int64_t)(frame + 1) * count * SHV_BODY_NUMBERS <= reference->count)
            exact = state_at(reference, count, frame, i);
        add_body(&row, body, &state, &exact, gravity);
        if (any) continue;
        row.state = state;
        row.reference = exact;
        any = true;
    }
    return row;
}

/* ---- figures ---- */

static int32_t first_chosen(const ShvBodies *bodies)
{
    int32_t i = 0;
    while (!bodies->items[i].chosen) i++;
    return i;
}

/* What energies are measured by: the largest kinetic energy of the reference or change of its potential energy; of what stays
   at rest, the weight times the radius. */
static double energy_scale(const ShvWay *way)
{
    const ShvTrack *track = &way->track;
    const double gravity = shv_norm(shv_load3(way->scene->gravity));
    double largest = 0.0, weight = 0.0;
    for (int32_t i = 0; i < track->count; i++) {
        const ShvTrackRow *row = &track->rows[i], *start = &track->rows[0];
        const double potential = row->reference_energy - row->reference_kinetic;
        const double fallen = potential - (start->reference_energy - start->reference_kinetic);
        largest = fmax(largest, fmax(row->reference_kinetic, fabs(fallen)));
    }
    for (int32_t i = 0; i < way->bodies.count; i++) {
        const ShvBody *body = &way->bodies.items[i];
        if (body->chosen) weight += body->mass * gravity * body->radius;
    }
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

static void find_moments(const ShvWay *way, double errors[SHV_WAY_ERRORS])
{
    double found[MOST_MOMENTS], exact[MOST_MOMENTS];
    const ShvTrack *track = &way->track;
    const int32_t body = first_chosen(&way->bodies);
    const ShvClosedForm *form = &way->forms[body];
    const ShvMat3 *inertia = &way->bodies.items[body].inertia;
    const bool bounce = form->law == SHV_REFERENCE_BOUNCE;
    int count[2];
    if (!bounce && form->law != SHV_REFERENCE_FLIGHT) return;
    for (int k = 0; k < 2; k++) {
        double *times = k ? exact : found;
        count[k] = bounce ? shv_track_impacts(track, k, form->direction, form->gravity, times, MOST_MOMENTS)
                          : shv_track_flips(track, k, inertia, times, MOST_MOMENTS);
    }
    errors[SHV_WAY_MOMENT] = largest_apart(found, count[0], exact, count[1], false);
    if (count[1] > 0) errors[SHV_WAY_MOMENTS] = abs(count[0] - count[1]);
    if (!bounce || count[0] != count[1]) return;
    const int heights = shv_track_apices(track, false, form->direction, form->gravity, found, MOST_MOMENTS);
    const int wanted = shv_track_apices(track, true, form->direction, form->gravity, exact, MOST_MOMENTS);
    errors[SHV_WAY_APEX] =
        largest_apart(found, heights < wanted ? heights : wanted, exact, heights < wanted ? heights : wanted, true);
}

static void summarise(const ShvWay *way, double errors[SHV_WAY_ERRORS])
{
    double energy = 0.0, spin = 0.0, largest_spin = 0.0, momentum = 0.0, largest_momentum = 0.0;
    for (int i = 0; i <= SHV_WAY_SURFACE; i++) errors[i] = 0.0;
    for (int i = SHV_WAY_MOMENT; i < SHV_WAY_ERRORS; i++) errors[i] = (double)NAN;
    for (int32_t i = 0; i < way->track.count; i++) {
        const ShvTrackRow *row = &way->track.rows[i];
        const double own[] = {row->position, row->orientation, row->velocity, row->surface};
        for (int k = 0; k <= SHV_WAY_SURFACE; k++) errors[k] = fmax(errors[k], own[k]);
        energy = fmax(energy, fabs(row->energy - row->reference_energy));
        spin = fmax(spin, row->spin);
        largest_spin = fmax(largest_spin, row->reference_spin);
        momentum = fmax(momentum, shv_norm(shv_sub(row->momentum, row->reference_momentum)));
        largest_momentum = fmax(largest_momentum, shv_norm(row->reference_momentum));
    }
    const double scale = energy_scale(way);
    errors[SHV_WAY_ENERGY] = over(energy, scale);
    errors[SHV_WAY_ENERGY_GAIN] = over(shv_track_gain(&way->track), scale);
    errors[SHV_WAY_ANGULAR_MOMENTUM] = over(spin, largest_spin);
    errors[SHV_WAY_LINEAR_MOMENTUM] = momentum == 0.0 ? 0.0 : over(momentum, largest_momentum);
    if (way->forms) find_moments(way, errors);
}

/* ---- all ---- */

static ShvStatus check_frames(const ShvWay *way, const ShvOutcome *run, const ShvOutcome *reference, ShvError *error)
{
    if (!shv_outcome_find(run, "track") || shv_outcome_number(run, "track.bodies") != way->bodies.count)
        return shv_fail(error, SHV_BAD_INPUT, "the runs of this study do not have the same bodies; do not vary them");
    const ShvOutcomeList *a = shv_outcome_find(run, "frame.time");
    const ShvOutcomeList *b = reference ? shv_outcome_find(reference, "frame.time") : a;
    for (int64_t i = 0; i < a->count && i < b->count; i++)
        if (fabs(a->values[i] - b->values[i]) > 1e-9 * way->scene->duration)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the frames of the runs are not at the same times; give all one output.rate and no "
                            "output.fracture_every");
    return SHV_OK;
}

ShvStatus shv_way_follow(ShvWay *way, const ShvOutcome *run, const ShvOutcome *reference, double errors[SHV_WAY_ERRORS],
                         ShvError *error)
{
    const ShvOutcomeList *track = shv_outcome_find(run, "track"), *times = shv_outcome_find(run, "frame.time");
    const ShvOutcomeList *beside = reference ? shv_outcome_find(reference, "track") : NULL;
    for (int i = 0; i < SHV_WAY_ERRORS; i++) errors[i] = (double)NAN;
    way->track.count = 0;
    if (!times || times->count == 0 || (reference && !beside) || (!reference && !way->forms)) return SHV_OK;
    SHV_TRY(check_frames(way, run, reference, error));
    for (int32_t i = 0; way->forms && i < way->bodies.count; i++)
        way->forms[i].top.time = way->forms[i].top.turned = 0.0; /* closed forms start anew */
    SHV_RESIZE(way->memory, SHV_PART_RECORD, way->track.rows, (size_t)times->count, "a run to compare", 0, error);
    for (; way->track.count < times->count; way->track.count++)
        way->track.rows[way->track.count] =
            row_of(way, track, beside, way->track.count, times->values[way->track.count]);
    summarise(way, errors);
    return SHV_OK;
}
