#include "evaluate/compare.h"

/* What the body is compared with at this frame. */
static ShvBodyState reference_state(ShvComparison *comparison, int32_t body, int32_t index, double time,
                                    const ShvBodyState *own)
{
    if (comparison->forms) return shv_closed_form_at(&comparison->forms[body], time);
    if (index >= comparison->finest_frames) return *own;
    return comparison->finest[(int64_t)index * comparison->bodies.count + body];
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

void shv_compare_states(ShvComparison *comparison, const ShvBodyState *states, double time, int32_t index,
                        ShvTrackRow *row)
{
    const ShvVec3 gravity = shv_load3(comparison->scene->gravity);
    *row = (ShvTrackRow){.time = time};
    bool any = false;
    for (int32_t i = 0; i < comparison->bodies.count; i++) {
        const ShvBody *body = &comparison->bodies.items[i];
        if (!body->chosen) continue;
        const ShvBodyState exact = reference_state(comparison, i, index, time, &states[i]);
        add_body(row, body, &states[i], &exact, gravity);
        if (any) continue;
        row->state = states[i];
        row->reference = exact;
        any = true;
    }
}

void shv_compare_rewind(ShvComparison *comparison)
{
    for (int32_t i = 0; comparison->forms && i < comparison->bodies.count; i++)
        comparison->forms[i].top.time = comparison->forms[i].top.turned = 0.0;
}

/* ---- figures of a run ---- */

static int32_t first_chosen(const ShvBodies *bodies)
{
    int32_t i = 0;
    while (!bodies->items[i].chosen) i++;
    return i;
}

/* What energies are measured by: the largest kinetic energy of the reference or change of its potential energy; of what stays
   at rest, the weight times the radius. */
static double energy_scale(const ShvComparison *comparison, const ShvTrack *track)
{
    const double gravity = shv_norm(shv_load3(comparison->scene->gravity));
    double largest = 0.0, weight = 0.0;
    for (int32_t i = 0; i < track->count; i++) {
        const ShvTrackRow *row = &track->rows[i], *start = &track->rows[0];
        const double potential = row->reference_energy - row->reference_kinetic;
        const double fallen = potential - (start->reference_energy - start->reference_kinetic);
        largest = fmax(largest, fmax(row->reference_kinetic, fabs(fallen)));
    }
    for (int32_t i = 0; i < comparison->bodies.count; i++) {
        const ShvBody *body = &comparison->bodies.items[i];
        if (body->chosen) weight += body->mass * gravity * body->radius;
    }
    return largest > 1e-12 * weight ? largest : weight;
}

static double over(double value, double scale)
{
    return scale > 0.0 ? value / scale : (double)NAN;
}

static void count_impacts(const ShvComparison *comparison, ShvComparedTrack *run)
{
    enum { MOST = 8 };
    const ShvClosedForm *form = &comparison->forms[first_chosen(&comparison->bodies)];
    double found[MOST], exact[MOST];
    const ShvTrack *track = &run->track;
    ShvComparedRun *view = &run->view;
    view->moments = shv_track_impacts(track, false, form->direction, form->gravity, found, MOST);
    view->reference_moments = shv_track_impacts(track, true, form->direction, form->gravity, exact, MOST);
    view->moment = view->moments > 0 ? 0.0 : (double)NAN;
    for (int i = 0; i < view->moments && i < view->reference_moments; i++)
        view->moment = fmax(view->moment, fabs(found[i] - exact[i]));
    const int heights = shv_track_apices(track, false, form->direction, form->gravity, found, MOST);
    const int wanted = shv_track_apices(track, true, form->direction, form->gravity, exact, MOST);
    view->apex = heights > 0 ? 0.0 : (double)NAN;
    for (int i = 0; i < heights && i < wanted; i++) view->apex = fmax(view->apex, fabs(found[i] - exact[i]) / exact[i]);
}

static void count_flips(const ShvComparison *comparison, ShvComparedTrack *run)
{
    enum { MOST = 8 };
    double found[MOST], exact[MOST];
    const ShvBody *body = &comparison->bodies.items[first_chosen(&comparison->bodies)];
    ShvComparedRun *view = &run->view;
    view->moments = shv_track_flips(&run->track, false, &body->inertia, found, MOST);
    view->reference_moments = shv_track_flips(&run->track, true, &body->inertia, exact, MOST);
    view->moment = view->moments > 0 ? 0.0 : (double)NAN;
    for (int i = 0; i < view->moments && i < view->reference_moments; i++)
        view->moment = fmax(view->moment, fabs(found[i] - exact[i]));
}

void shv_compare_summarise(const ShvComparison *comparison, ShvComparedTrack *run)
{
    ShvComparedRun *view = &run->view;
    const ShvTrack *track = &run->track;
    double energy = 0.0, spin = 0.0, largest_spin = 0.0;
    for (int32_t i = 0; i < track->count; i++) {
        const ShvTrackRow *row = &track->rows[i];
        view->position = fmax(view->position, row->position);
        view->orientation = fmax(view->orientation, row->orientation);
        view->velocity = fmax(view->velocity, row->velocity);
        view->surface = fmax(view->surface, row->surface);
        energy = fmax(energy, fabs(row->energy - row->reference_energy));
        spin = fmax(spin, row->spin);
        largest_spin = fmax(largest_spin, row->reference_spin);
    }
    const double scale = energy_scale(comparison, track);
    view->energy = over(energy, scale);
    view->energy_gain = over(shv_track_gain(track), scale);
    view->angular_momentum = over(spin, largest_spin);
    view->moment = view->apex = (double)NAN;
    if (!comparison->forms) return;
    if (comparison->scene->reference.law == SHV_REFERENCE_BOUNCE) count_impacts(comparison, run);
    if (comparison->scene->reference.law == SHV_REFERENCE_FLIGHT) count_flips(comparison, run);
}
