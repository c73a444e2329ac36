#include "evaluate/sampler.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "evaluate/crack_surface.h"
#include "evaluate/trajectory.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- bodies ---- */

static ShvStatus describe_bodies(const ShvSampler *sampler, const ShvFrameView *frame, ShvBody *bodies, int32_t count,
                                 ShvError *error)
{
    const ShvSceneDefinition *scene = sampler->scene;
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacleDefinition *obstacle = shv_body_obstacle(scene, frame->fragment_count, i);
        const char *name = obstacle ? obstacle->name : scene->objects[frame->fragments[i].object].name;
        SHV_TRY(shv_body_describe(&bodies[i], scene, frame, i, error));
        bodies[i].chosen = !scene->reference.body || strcmp(name, scene->reference.body) == 0;
    }
    return SHV_OK;
}

/* Of the bodies chosen. `up`: the direction of the first one's motion. */
static ShvStatus make_forms(ShvSampler *sampler, const ShvSimulation *simulation, const ShvBody *bodies, ShvVec3 *up,
                            ShvError *error)
{
    const ShvSceneDefinition *scene = sampler->scene;
    const ShvReferenceDefinition *reference = &scene->reference;
    const size_t count = (size_t)sampler->body_count;
    bool any = false;
    if (reference->law == SHV_REFERENCE_NONE)
        return shv_fail(error, SHV_BAD_INPUT,
                        "the closed form is asked for, but the scene has no 'reference'; give it one");
    if (!reference->body && reference->law != SHV_REFERENCE_FLIGHT && reference->law != SHV_REFERENCE_REST)
        return shv_fail(error, SHV_BAD_INPUT, "this law of `reference` needs `body`");
    ShvClosedForm *forms = shv_pool_take(&sampler->pool, count, sizeof *forms);
    if (!forms) return shv_fail_memory(error, "bodies to compare", count * sizeof *forms);
    for (int32_t i = 0; i < sampler->body_count; i++) {
        if (bodies[i].chosen == 0.0) continue;
        SHV_TRY(shv_closed_form(&forms[i], scene, simulation, &bodies[i], i, error));
        if (!any) *up = forms[i].direction;
        any = true;
    }
    if (!any) return shv_fail(error, SHV_BAD_INPUT, "reference.body must name an object or a free obstacle");
    sampler->forms = forms;
    return SHV_OK;
}

static ShvStatus start_track(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvSceneDefinition *scene = sampler->scene;
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    ShvOutcome *outcome = sampler->outcome;
    const int32_t count = shv_body_count(scene, frame->fragment_count);
    ShvTrackScene head = {
        .law = scene->reference.law, .duration = scene->duration, .gravity = shv_load3(scene->gravity)};
    ShvBody *bodies = shv_pool_take(&sampler->pool, (size_t)count, sizeof *bodies);
    if (!bodies) return shv_fail_memory(error, "bodies to compare", (size_t)count * sizeof *bodies);
    SHV_TRY(describe_bodies(sampler, frame, bodies, count, error));
    sampler->begun = frame->fragment_count;
    sampler->body_count = count;
    const ShvStatus status = make_forms(sampler, simulation, bodies, &head.up, error);
    shv_outcome_set(outcome, "track.bodies", count);
    shv_outcome_add_all(outcome, "track.masses", SHV_CLOCK_NONE, bodies, (int64_t)count * SHV_BODY_NUMBERS);
    shv_outcome_add_all(outcome, "track.scene", SHV_CLOCK_NONE, &head, sizeof head / sizeof(double));
    return status;
}

static ShvBodyState *room_for_states(ShvOutcome *outcome, const char *name, int64_t count)
{
    return (void *)shv_outcome_room(outcome, name, SHV_CLOCK_NONE, count * SHV_STATE_NUMBERS);
}

static void track(ShvSampler *sampler, const ShvFrameView *frame)
{
    const int32_t count = sampler->body_count;
    ShvBodyState *room = count > 0 ? room_for_states(sampler->outcome, "track", count) : NULL;
    for (int32_t i = 0; i < count && room; i++) room[i] = shv_body_state(sampler->scene, frame, sampler->begun, i);
}

/* At the end, so that what was stopped in between has the same numbers. */
static void add_closed_forms(ShvSampler *sampler)
{
    const ShvOutcomeList times = *shv_outcome_find(sampler->outcome, "frame.time"); /* lists move when one is made */
    const int32_t count = sampler->body_count;
    ShvBodyState *room = room_for_states(sampler->outcome, "exact", times.count * count);
    for (int64_t frame = 0; room && frame < times.count; frame++)
        for (int32_t i = 0; i < count; i++, room++) *room = shv_closed_form_at(&sampler->forms[i], times.values[frame]);
}

/* ---- series ---- */

static void add_probes(ShvOutcome *outcome, const ShvFrameView *frame)
{
    static const char *const names[SHV_PROBE_NUMBERS] = {
        "displacement.x", "displacement.y", "displacement.z", "velocity.x", "velocity.y", "velocity.z",
        "stress.xx",      "stress.yy",      "stress.zz",      "stress.yz",  "stress.xz",  "stress.xy",
        "contact.x",      "contact.y",      "contact.z",      "reaction.x", "reaction.y", "reaction.z"};
    const int64_t rows = frame->probe_row_count;
    char name[96];
    shv_outcome_add_all(outcome, "probe.time", SHV_CLOCK_PROBE, frame->probe_times, rows);
    for (int32_t p = 0; p < frame->probe_count; p++)
        for (int k = 0; k < SHV_PROBE_NUMBERS; k++) {
            shv_format(name, sizeof name, "%.63s.%s", frame->probes[p].name, names[k]);
            double *room = shv_outcome_room(outcome, name, SHV_CLOCK_PROBE, rows);
            for (int64_t r = 0; r < rows && room; r++) {
                double numbers[SHV_PROBE_NUMBERS];
                memcpy(numbers, &frame->probe_samples[r * frame->probe_count + p], sizeof numbers);
                room[r] = numbers[k];
            }
        }
}

static void add_ledger(ShvOutcome *outcome, const ShvLedgerView *ledger)
{
#define NUMBER(member, unit) shv_outcome_add(outcome, "ledger." #member, SHV_CLOCK_FRAME, ledger->member);
#define VECTOR(member, unit) shv_outcome_add_vector(outcome, "ledger." #member, SHV_CLOCK_FRAME, ledger->member);
    SHV_LEDGER_COLUMNS(NUMBER, NUMBER, VECTOR)
    NUMBER(residual, "J")
    NUMBER(largest, "J")
#undef NUMBER
#undef VECTOR
}

static double events_of(const ShvFrameView *frame, ShvRunEvent kind)
{
    double number = 0.0;
    for (int32_t i = 0; i < frame->event_count; i++) number += frame->events[i].kind == kind;
    return number;
}

static void add_numbers(ShvOutcome *outcome, const ShvFrameView *frame)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"frame.time", frame->time},
                   {"frame.step", frame->step},
                   {"frame.courant", frame->courant},
                   {"frame.inserted", frame->inserted},
                   {"frame.failed", frame->failed},
                   {"frame.alive", frame->alive_count},
                   {"frame.steps", (double)frame->steps},
                   {"frame.animation", frame->animation},
                   {"frame.edge_strain", frame->edge_strain},
                   {"frame.bar_share", frame->bar_work_share},
                   {"frame.wakes", events_of(frame, SHV_RUN_WAKE)},
                   {"frame.rests", events_of(frame, SHV_RUN_SLEEP)},
                   {"frame.inversions", events_of(frame, SHV_RUN_INVERSION)},
                   {"frame.squeezes", events_of(frame, SHV_RUN_SQUEEZE)}};
    for (size_t i = 0; i < COUNT(numbers); i++)
        shv_outcome_add(outcome, numbers[i].name, SHV_CLOCK_FRAME, numbers[i].value);
}

static double length_of(const double v[3])
{
    return shv_norm(shv_load3(v));
}

/* Σ m|v|, and whether all numbers are finite. */
static void add_motion(ShvOutcome *outcome, const ShvFrameView *frame)
{
    double scale = 0.0, all = frame->ledger.residual;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        scale += fragment->mass * length_of(fragment->velocity);
        all += length_of(fragment->position) + length_of(fragment->angular_velocity);
    }
    shv_outcome_add(outcome, "frame.momentum_scale", SHV_CLOCK_FRAME, scale);
    shv_outcome_add(outcome, "frame.finite", SHV_CLOCK_FRAME, isfinite(scale + all) ? 1.0 : 0.0);
}

/* How far corners of tets reach: least and largest z; the largest distance from their fragment's centre. */
static void add_corners(ShvSampler *sampler, const ShvSimulation *simulation)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    const int64_t count = shv_simulation_mesh(simulation).element_count;
    double lowest = HUGE_VAL, highest = -HUGE_VAL, radius = 0.0;
    shv_simulation_corner_positions(simulation, sampler->corners);
    shv_simulation_element_state(simulation, sampler->fragments, sampler->damage);
    for (int64_t i = 0; i < 4 * count; i++) {
        const ShvVec3 x = shv_load3(sampler->corners + 3 * i);
        const ShvVec3 centre = shv_load3(frame->fragments[sampler->fragments[i / 4]].position);
        lowest = fmin(lowest, x.z);
        highest = fmax(highest, x.z);
        const double distance = shv_norm(shv_sub(x, centre));
        if (!(distance <= radius)) radius = distance; /* also what is not a number */
    }
    shv_outcome_add(sampler->outcome, "frame.lowest", SHV_CLOCK_FRAME, lowest);
    shv_outcome_add(sampler->outcome, "frame.highest", SHV_CLOCK_FRAME, highest);
    shv_outcome_add(sampler->outcome, "frame.radius", SHV_CLOCK_FRAME, radius);
}

/* ---- the tip of a crack ---- */

static const double opened = 0.5; /* damage */

/* Centroid of the face opposite to a corner, in the reference mesh. */
static ShvVec3 face_centre(const ShvMeshView *mesh, int64_t element, int corner)
{
    ShvVec3 sum = shv_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < 4; k++)
        if (k != corner) sum = shv_add(sum, shv_load3(mesh->positions + 3 * (int64_t)mesh->elements[4 * element + k]));
    return shv_scale(sum, 1.0 / 3.0);
}

/* The tip of the first crack: of the facets that are half opened the one that is farthest from where it began. */
static ShvStatus add_tip(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    const bool cracked = shv_simulation_frame(simulation)->inserted > 0;
    ShvCrackView crack;
    double length = 0.0, tip[3] = {(double)NAN, (double)NAN, (double)NAN};
    if (cracked) SHV_TRY(shv_simulation_crack(simulation, &crack, error));
    for (int64_t i = 0; cracked && i < 4 * (int64_t)mesh.element_count; i++) {
        if (sampler->damage[i] < opened) continue;
        const ShvVec3 centre = face_centre(&mesh, i / 4, (int)(i % 4));
        const double distance = shv_norm(shv_sub(centre, shv_load3(crack.origin)));
        if (distance <= length) continue;
        length = distance;
        shv_store3(tip, centre);
    }
    shv_outcome_add_vector(sampler->outcome, "crack.tip", SHV_CLOCK_FRAME, tip);
    shv_outcome_add(sampler->outcome, "crack.length", SHV_CLOCK_FRAME, length);
    return SHV_OK;
}

/* ---- the frame ---- */

ShvStatus shv_sample_start(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const size_t count = (size_t)shv_simulation_mesh(simulation).element_count;
    sampler->corners = shv_pool_take(&sampler->pool, 12 * count, sizeof *sampler->corners);
    sampler->fragments = shv_pool_take(&sampler->pool, count, sizeof *sampler->fragments);
    sampler->damage = shv_pool_take(&sampler->pool, 4 * count, sizeof *sampler->damage);
    if (sampler->pool.failed) return shv_fail_memory(error, "corners", 132 * count);
    /* Why there is no way of bodies, or no closed form of it, is told to whoever asks for it. */
    const ShvStatus status = start_track(sampler, simulation, error);
    if (status == SHV_NO_MEMORY) return status;
    if (status != SHV_OK)
        shv_format(sampler->outcome->no_motion, sizeof sampler->outcome->no_motion, "%.500s", error->message);
    return SHV_OK;
}

ShvStatus shv_sample_frame(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    ShvOutcome *outcome = sampler->outcome;
    add_numbers(outcome, frame);
    add_motion(outcome, frame);
    add_ledger(outcome, &frame->ledger);
    add_corners(sampler, simulation);
    SHV_TRY(add_tip(sampler, simulation, error));
    add_probes(outcome, frame);
    track(sampler, frame);
    return outcome->failed ? shv_fail_memory(error, "what is kept of a run", 0) : SHV_OK;
}

/* ---- the end ---- */

static int compare_doubles(const void *first, const void *second)
{
    const double a = *(const double *)first, b = *(const double *)second;
    return (a > b) - (a < b);
}

void shv_sort_numbers(double *values, int64_t count)
{
    if (count > 1) qsort(values, (size_t)count, sizeof *values, compare_doubles);
}

/* Masses and momenta of living fragments; "pieces.mass" ascending. */
static void add_pieces(ShvOutcome *outcome, const ShvFragmentView *fragments, int32_t count)
{
    double mass = 0.0;
    ShvVec3 momentum = shv_vec3(0.0, 0.0, 0.0);
    const ShvFragmentView *largest = NULL;
    shv_outcome_add_all(outcome, "pieces.mass", SHV_CLOCK_NONE, NULL, 0);
    for (int32_t i = 0; i < count; i++) {
        const ShvFragmentView *fragment = &fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        shv_outcome_add(outcome, "pieces.mass", SHV_CLOCK_NONE, fragment->mass);
        momentum = shv_madd(momentum, fragment->mass, shv_load3(fragment->velocity));
        mass += fragment->mass;
        if (!largest || fragment->mass > largest->mass) largest = fragment;
    }
    const ShvOutcomeList *masses = shv_outcome_find(outcome, "pieces.mass");
    if (outcome->failed) return;
    shv_sort_numbers(masses->values, masses->count);
    shv_outcome_set(outcome, "end.fragments", (double)masses->count);
    shv_outcome_set(outcome, "end.mass", mass);
    shv_outcome_set(outcome, "end.largest_mass", largest ? largest->mass : 0.0);
    const double sum[3] = {momentum.x, momentum.y, momentum.z};
    shv_outcome_add_vector(outcome, "end.momentum", SHV_CLOCK_NONE, sum);
    if (!largest) return;
    shv_outcome_add_vector(outcome, "end.position", SHV_CLOCK_NONE, largest->position);
    shv_outcome_add_vector(outcome, "end.velocity", SHV_CLOCK_NONE, largest->velocity);
    shv_outcome_set(outcome, "end.spin", length_of(largest->angular_velocity));
}

/* The failed facets. */
static ShvStatus add_crack(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    ShvOutcome *outcome = sampler->outcome;
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    uint8_t *bonds = shv_pool_take(&sampler->pool, 4 * (size_t)mesh.element_count, 1);
    if (!bonds) return shv_fail_memory(error, "bonds of facets", 4 * (size_t)mesh.element_count);
    shv_simulation_bonds(simulation, bonds);
    const ShvCrackSurface surface = shv_crack_surface(&mesh, bonds, &sampler->pool);
    const double halves[2] = {(double)(uint32_t)(surface.mesh >> 32), (double)(uint32_t)surface.mesh};
    shv_outcome_add_all(outcome, "crack.mesh", SHV_CLOCK_NONE, halves, 2);
    shv_outcome_add_all(outcome, "crack.facets", SHV_CLOCK_NONE, surface.facets,
                        (int64_t)surface.count * SHV_FACET_NUMBERS);
    return outcome->failed || sampler->pool.failed ? shv_fail_memory(error, "failed facets", 0) : SHV_OK;
}

/* Corners of the facets that are half opened, in the reference mesh; where both of its tets see it, a facet is there twice. */
static void add_opened(ShvSampler *sampler, const ShvSimulation *simulation)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    shv_outcome_add_all(sampler->outcome, "crack.opened", SHV_CLOCK_NONE, NULL, 0);
    for (int64_t i = 0; i < 4 * (int64_t)mesh.element_count; i++) {
        if (sampler->damage[i] < opened) continue;
        for (int k = 0; k < 4; k++)
            if (k != i % 4)
                shv_outcome_add_all(sampler->outcome, "crack.opened", SHV_CLOCK_NONE,
                                    mesh.positions + 3 * (int64_t)mesh.elements[4 * (i / 4) + k], 3);
    }
}

/* A double holds 53 bits of the hash: equal for equal runs. */
static double hash_number(uint64_t hash)
{
    return (double)(hash >> 11);
}

static void add_end(ShvOutcome *outcome, const ShvFrameView *frame)
{
    static const char *const parts[] = {"adjacency", "stress", "cohesive"};
    double bytes = 0.0;
    for (int32_t i = 0; i < frame->bytes_count; i++)
        for (size_t k = 0; k < COUNT(parts); k++)
            if (strcmp(frame->bytes[i].name, parts[k]) == 0) bytes += (double)frame->bytes[i].peak;
    shv_outcome_set(outcome, "run.cohesive_bytes", bytes);
    shv_outcome_set(outcome, "end.worst_overshoot", frame->worst_overshoot);
    shv_outcome_add_vector(outcome, "run.impulse", SHV_CLOCK_NONE, frame->contact_impulse);
    shv_outcome_set(outcome, "run.contact_time", frame->contact_time);
    shv_outcome_set(outcome, "run.first_contact", frame->first_contact);
    shv_outcome_set(outcome, "run.audited", frame->audited);
    shv_outcome_set(outcome, "run.missed", frame->missed);
    for (int32_t i = 0; i < frame->cost_count; i++)
        shv_outcome_add(outcome, "run.costs", SHV_CLOCK_NONE, frame->costs[i].seconds);
}

ShvStatus shv_sample_end(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    ShvOutcome *outcome = sampler->outcome;
    ShvCrackView crack;
    SHV_TRY(shv_simulation_crack(simulation, &crack, error));
    if (sampler->forms) add_closed_forms(sampler);
    add_pieces(outcome, frame->fragments, frame->fragment_count);
    shv_outcome_set(outcome, "end.crack_facets", crack.facets);
    shv_outcome_add_vector(outcome, "end.crack_origin", SHV_CLOCK_NONE, crack.origin);
    shv_outcome_add_vector(outcome, "end.crack_centre", SHV_CLOCK_NONE, crack.centre);
    shv_outcome_add_vector(outcome, "end.crack_normal", SHV_CLOCK_NONE, crack.normal);
    shv_outcome_set(outcome, "end.hash", hash_number(shv_simulation_hash(simulation)));
    add_end(outcome, frame);
    add_opened(sampler, simulation);
    return add_crack(sampler, simulation, error);
}
