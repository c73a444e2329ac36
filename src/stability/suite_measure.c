#include <math.h>
#include <string.h>

#include "base/text.h"
#include "base/timer.h"
#include "base/vector.h"
#include "stability/suite.h"

static const char *const names[] = {
#define NAME_MEASURE(name, start) #name,
    SHV_MEASURES(NAME_MEASURE)
#undef NAME_MEASURE
        NULL};

const char *const *shv_suite_measures(void)
{
    return names;
}

int shv_suite_measure_number(const char *name, size_t length)
{
    for (int i = 0; i < SHV_MEASURE_COUNT; i++)
        if (strlen(names[i]) == length && strncmp(names[i], name, length) == 0) return i;
    return -1;
}

/* ---- one run ---- */

typedef struct Watch {
    ShvSuiteFound *found;
    const ShvSuiteOptions *options;
    double begun;
    double *corners;                                 /* 12 per element */
    int32_t *fragments;                              /* per element */
    double start_energy, start_motion, start_radius; /* J, J, m */
    double momentum[3], angular[3];                  /* at the start */
    double momentum_change, angular_change;          /* largest */
    double momentum_scale, angular_scale;            /* largest */
    bool started;
} Watch;

static bool out_of_time(void *data)
{
    const Watch *watch = data;
    return shv_now() - watch->begun > watch->options->most_seconds;
}

static double length_of(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double distance(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return length_of(d);
}

static void raise(double *most, double value)
{
    if (!(value <= *most)) *most = value; /* also what is not a number */
}

static void watch_energy(Watch *watch, const ShvLedgerView *ledger)
{
    double *values = watch->found->values;
    const double motion = ledger->kinetic + ledger->strain, energy = motion + ledger->gravity_potential;
    if (!watch->started) {
        watch->start_energy = energy;
        watch->start_motion = motion;
    }
    values[SHV_MEASURE_kept] = motion / watch->start_motion;
    if (!(ledger->largest > 0.0)) return;
    raise(&values[SHV_MEASURE_residual], fabs(ledger->residual) / ledger->largest);
    raise(&values[SHV_MEASURE_gain], (energy - watch->start_energy) / ledger->largest);
}

static void watch_momentum(Watch *watch, const ShvFrameView *frame)
{
    double scale = 0.0;
    for (int32_t i = 0; i < frame->fragment_count; i++)
        if (frame->fragments[i].mode != SHV_FRAGMENT_DEAD)
            scale += frame->fragments[i].mass * length_of(frame->fragments[i].velocity);
    if (!watch->started) {
        memcpy(watch->momentum, frame->ledger.momentum, sizeof watch->momentum);
        memcpy(watch->angular, frame->ledger.angular_momentum, sizeof watch->angular);
    }
    raise(&watch->momentum_scale, scale);
    raise(&watch->angular_scale, length_of(frame->ledger.angular_momentum));
    raise(&watch->momentum_change, distance(frame->ledger.momentum, watch->momentum));
    raise(&watch->angular_change, distance(frame->ledger.angular_momentum, watch->angular));
    double *values = watch->found->values;
    if (watch->momentum_scale > 0.0) values[SHV_MEASURE_momentum] = watch->momentum_change / watch->momentum_scale;
    if (watch->angular_scale > 0.0) values[SHV_MEASURE_angular] = watch->angular_change / watch->angular_scale;
}

static void watch_corners(Watch *watch, const ShvSimulation *simulation, const ShvFrameView *frame)
{
    double *values = watch->found->values;
    const int32_t count = shv_simulation_mesh(simulation).element_count;
    double radius = 0.0;
    shv_simulation_corner_positions(simulation, watch->corners);
    shv_simulation_element_state(simulation, watch->fragments, NULL);
    for (int64_t i = 0; i < 4 * (int64_t)count; i++) {
        const double *x = watch->corners + 3 * i;
        values[SHV_MEASURE_lowest] = fmin(values[SHV_MEASURE_lowest], x[2]);
        values[SHV_MEASURE_highest] = fmax(values[SHV_MEASURE_highest], x[2]);
        raise(&radius, distance(x, frame->fragments[watch->fragments[i / 4]].position));
    }
    if (!watch->started) watch->start_radius = radius;
    raise(&values[SHV_MEASURE_swelling], radius / watch->start_radius - 1.0);
}

static void watch_largest(Watch *watch, const ShvFrameView *frame)
{
    const ShvFragmentView *largest = NULL;
    double *values = watch->found->values, all = 0.0;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
        all += fragment->mass;
        if (!largest || fragment->mass > largest->mass) largest = fragment;
        watch->found->finite &= isfinite(length_of(fragment->position)) && isfinite(length_of(fragment->velocity)) &&
                                isfinite(length_of(fragment->angular_velocity));
    }
    if (!largest) return;
    for (int i = 0; i < 3; i++) {
        values[SHV_MEASURE_x + i] = largest->position[i];
        values[SHV_MEASURE_vx + i] = largest->velocity[i];
    }
    values[SHV_MEASURE_spin] = length_of(largest->angular_velocity);
    values[SHV_MEASURE_share] = largest->mass / all;
}

static void watch_events(Watch *watch, const ShvFrameView *frame)
{
    double *values = watch->found->values;
    for (int32_t i = 0; i < frame->event_count; i++) {
        const ShvEventView *event = &frame->events[i];
        if (event->kind == SHV_RUN_WAKE && values[SHV_MEASURE_wakes]++ == 0.0)
            values[SHV_MEASURE_first_wake] = event->time;
        if (event->kind == SHV_RUN_SLEEP) values[SHV_MEASURE_rests]++;
        if (event->kind == SHV_RUN_INVERSION) values[SHV_MEASURE_inversions]++;
        if (event->kind == SHV_RUN_SQUEEZE) values[SHV_MEASURE_squeezes]++;
    }
}

static void watch_counters(Watch *watch, const ShvFrameView *frame)
{
    static const char *const parts[] = {"adjacency", "stress", "cohesive"};
    double *values = watch->found->values, bytes = 0.0;
    values[SHV_MEASURE_time] = frame->time;
    values[SHV_MEASURE_frames] += frame->animation ? 1.0 : 0.0;
    values[SHV_MEASURE_steps] = (double)frame->steps;
    values[SHV_MEASURE_fragments] = frame->alive_count;
    values[SHV_MEASURE_inserted] = frame->inserted;
    values[SHV_MEASURE_failed] = frame->failed;
    values[SHV_MEASURE_overshoot] = frame->worst_overshoot;
    raise(&values[SHV_MEASURE_courant], frame->courant);
    if (!isnan(frame->edge_strain)) raise(&values[SHV_MEASURE_edge_strain], frame->edge_strain);
    if (!isnan(frame->bar_work_share)) values[SHV_MEASURE_bar_work] = frame->bar_work_share;
    for (int32_t i = 0; i < frame->bytes_count; i++)
        for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
            if (strcmp(frame->bytes[i].name, parts[k]) == 0) bytes += (double)frame->bytes[i].peak;
    values[SHV_MEASURE_cohesive_bytes] = bytes;
}

static void watch_frame(Watch *watch, const ShvSimulation *simulation)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    watch_counters(watch, frame);
    watch_events(watch, frame);
    watch_energy(watch, &frame->ledger);
    watch_momentum(watch, frame);
    watch_largest(watch, frame);
    watch_corners(watch, simulation, frame);
    watch->found->finite &= isfinite(frame->ledger.residual);
    watch->started = true;
}

static ShvStatus reserve(Watch *watch, const ShvSimulation *simulation, ShvError *error)
{
    const size_t count = (size_t)shv_simulation_mesh(simulation).element_count;
    watch->corners = shv_allocate(watch->options->memory, SHV_PART_RECORD, 12 * count, sizeof(double));
    watch->fragments = shv_allocate(watch->options->memory, SHV_PART_RECORD, count, sizeof(int32_t));
    return watch->corners && watch->fragments ? SHV_OK : shv_fail_memory(error, "corners", 100 * count);
}

/* What the run itself gives is found; what is left as a failure is ours. */
static ShvStatus pull(Watch *watch, ShvSimulation *simulation, ShvError *error)
{
    ShvError own = {.message = ""};
    SHV_TRY(reserve(watch, simulation, error));
    ShvStatus status = SHV_OK;
    do {
        status = shv_simulation_advance(simulation, &own);
        watch_frame(watch, simulation);
    } while (status == SHV_OK && !shv_simulation_finished(simulation));
    watch->found->status = status;
    watch->found->hash = shv_simulation_hash(simulation);
    shv_format(watch->found->message, sizeof watch->found->message, "%s",
               status == SHV_INTERRUPTED ? "it took too long" : own.message);
    return status == SHV_NO_MEMORY ? shv_fail(error, status, "%s", own.message) : SHV_OK;
}

static ShvStatus simulate(Watch *watch, const ShvScene *scene, ShvError *error)
{
    ShvError own = {.message = ""};
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    options.stop = out_of_time;
    options.stop_data = watch;
    ShvSuiteFound *found = watch->found;
    found->status = shv_simulation_create(&simulation, shv_scene_definition(scene), &options, &own);
    shv_format(found->message, sizeof found->message, "%s", own.message);
    if (found->status == SHV_NO_MEMORY) return shv_fail(error, found->status, "%s", own.message);
    if (found->status != SHV_OK) return SHV_OK;
    found->begun = true;
    const ShvStatus status = pull(watch, simulation, error);
    shv_simulation_destroy(simulation);
    return status;
}

/* ---- the scene ---- */

enum { MOST_OVERRIDES = 16 };

typedef struct Overrides {
    char text[SHV_SUITE_TEXT];
    const char *items[MOST_OVERRIDES];
    int32_t count;
} Overrides;

/* "a=b; c=d", taken apart. */
static ShvStatus split(Overrides *overrides, const char *text, ShvError *error)
{
    shv_format(overrides->text, sizeof overrides->text, "%s", text);
    overrides->count = 0;
    for (char *at = overrides->text; *at;) {
        at += strspn(at, " ");
        char *end = at + strcspn(at, ";");
        const bool more = *end == ';';
        *end = '\0';
        if (overrides->count == MOST_OVERRIDES)
            return shv_fail(error, SHV_BAD_INPUT, "a case takes at most %d overrides", MOST_OVERRIDES);
        if (*at) overrides->items[overrides->count++] = at;
        if (!more) break;
        at = end + 1;
    }
    return SHV_OK;
}

static void keep_faults(ShvSuiteFound *found, const ShvDiagnostics *diagnostics, const ShvError *error)
{
    size_t length = 0;
    const int32_t count = diagnostics ? shv_diagnostics_count(diagnostics) : 0;
    found->message[0] = '\0';
    for (int32_t i = 0; i < count && length + 1 < sizeof found->message; i++)
        length += (size_t)shv_format(found->message + length, sizeof found->message - length, "%s%s", i ? " " : "",
                                     shv_diagnostics_get(diagnostics, i)->message);
    if (count == 0) shv_format(found->message, sizeof found->message, "%s", error->message);
}

ShvStatus shv_suite_measure(ShvSuiteFound *found, const char *path, const char *text, const ShvSuiteOptions *options,
                            ShvError *error)
{
    static const double starts[] = {
#define START_MEASURE(name, start) (double)start,
        SHV_MEASURES(START_MEASURE)
#undef START_MEASURE
    };
    Watch watch = {.found = found, .options = options, .begun = shv_now()};
    Overrides overrides;
    ShvError own = {.message = ""};
    ShvScene *scene = NULL;
    ShvDiagnostics *diagnostics = NULL;
    *found = (ShvSuiteFound){.finite = true};
    memcpy(found->values, starts, sizeof found->values);
    SHV_TRY(split(&overrides, text, error));
    found->status = shv_scene_load(&scene, path, overrides.items, overrides.count, options->memory, &diagnostics, &own);
    ShvStatus status = SHV_OK;
    if (found->status == SHV_NO_MEMORY)
        status = shv_fail(error, found->status, "%s", own.message);
    else if (found->status != SHV_OK)
        keep_faults(found, diagnostics, &own);
    else
        status = simulate(&watch, scene, error);
    shv_diagnostics_destroy(diagnostics);
    shv_scene_destroy(scene);
    shv_release(watch.corners);
    shv_release(watch.fragments);
    found->seconds = shv_now() - watch.begun;
    return status;
}
