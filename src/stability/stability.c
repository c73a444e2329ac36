#include "stability/stability.h"

#include "base/text.h"
#include "scene/schema.h"

const char *shv_stability_class_name(ShvStabilityClass outcome)
{
    static const char *const names[] = {"stable", "growing", "overflow", "refused"};
    return outcome <= SHV_REFUSED ? names[outcome] : "unknown";
}

ShvStabilityOptions shv_stability_default(void)
{
    return (ShvStabilityOptions){.cookie = SHV_DEFINITION_COOKIE,
                                 .stiffness = {{1.0, 0.5, 0.1}, 3},
                                 .iterations = {{1.0, 4.0, 10.0}, 3},
                                 .multiples = {{0.5, 1.0, 2.0, 5.0, 10.0, 20.0}, 6},
                                 .steps = 10000,
                                 .most = 60.0,
                                 .seed = 3};
}

/* ---- what cannot be measured ---- */

static const struct {
    const char *what;
    size_t offset; /* of a ShvStabilityValues in the options */
    ShvRange range;
    bool whole;
} allowed[] = {
    {"a stiffness k of bars", offsetof(ShvStabilityOptions, stiffness), {0.0, 1.0, false, false}, false},
    {"a whole number of iterations", offsetof(ShvStabilityOptions, iterations), {1.0, 1e9, false, false}, true},
    {"a Young's modulus", offsetof(ShvStabilityOptions, moduli), {0.0, 1e300, true, false}, false},
    {"a multiple of the stable step", offsetof(ShvStabilityOptions, multiples), {0.0, 1e300, true, false}, false}};

static ShvStatus check_values(const ShvStabilityOptions *options, size_t kind, ShvError *error)
{
    const ShvStabilityValues *list = (const void *)((const char *)options + allowed[kind].offset);
    const int32_t most = list == &options->multiples ? SHV_MOST_STABILITY_POINTS - 1 : SHV_MOST_STABILITY_VALUES;
    char range[80];
    if (list->count < 0 || list->count > most)
        return shv_fail(error, SHV_BAD_INPUT, "at most %d values of each kind and %d multiples can be given",
                        SHV_MOST_STABILITY_VALUES, SHV_MOST_STABILITY_POINTS - 1);
    shv_range_describe(&allowed[kind].range, range, sizeof range);
    for (int32_t i = 0; i < list->count; i++)
        if (!shv_range_holds(&allowed[kind].range, list->values[i]) ||
            (allowed[kind].whole && list->values[i] != floor(list->values[i])))
            return shv_fail(error, SHV_BAD_INPUT, "%s is %s, not %g", allowed[kind].what, range, list->values[i]);
    return SHV_OK;
}

static ShvStatus check_options(const ShvStabilityOptions *options, ShvError *error)
{
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_stability_default()");
    if (options->steps < 100)
        return shv_fail(error, SHV_BAD_INPUT, "stability needs at least 100 steps, not %d", (int)options->steps);
    if (!(options->most >= 1.0 && options->most <= 1e6))
        return shv_fail(error, SHV_BAD_INPUT, "the largest multiple is at least 1 and at most 1e6, not %g",
                        options->most);
    for (size_t i = 0; i < sizeof allowed / sizeof *allowed; i++) SHV_TRY(check_values(options, i, error));
    return SHV_OK;
}

/* ---- rows ---- */

/* Without bars the program does not begin above the computed step: asked of the program itself, on both sides of it. One that
   is refused below is so for another reason, and the message says which. */
static ShvStatus find_refusal(const ShvSceneDefinition *given, const ShvProbe *probe,
                              const ShvStabilityOptions *options, ShvStabilityRow *row, ShvError *error)
{
    static const double tried[] = {0.999, 1.001};
    ShvSceneDefinition scene = *given;
    ShvSimulationOptions making = shv_simulation_options_default();
    making.folder = options->folder;
    making.memory = options->memory;
    scene.materials = probe->materials;
    scene.fracture.stabiliser = SHV_STABILISER_NONE;
    for (int i = 0; i < 2; i++) {
        ShvSimulation *simulation = NULL;
        scene.fracture.time_step = tried[i] * probe->hybrid.steps.stable;
        const ShvStatus status = shv_simulation_create(&simulation, &scene, &making, error);
        shv_simulation_destroy(simulation);
        if (i == 0 || status != SHV_BAD_INPUT) SHV_TRY(status);
        if (status == SHV_BAD_INPUT) row->refused_above = 1.0;
    }
    return SHV_OK;
}

static void measure_points(ShvProbe *probe, const ShvStabilityOptions *options, ShvStabilityRow *row)
{
    for (int32_t i = 0; i <= options->multiples.count; i++) {
        const bool last = i == options->multiples.count;
        if (last && !(row->limit > 0.0)) break;
        ShvStabilityPoint *point = &row->points[row->point_count++];
        *point = (ShvStabilityPoint){.multiple = last ? row->limit : options->multiples.values[i],
                                     .stiffness = (double)NAN,
                                     .frequency = (double)NAN,
                                     .displacement = (double)NAN,
                                     .energy_kept = (double)NAN};
        point->closed_form =
            shv_probe_bars_alone(probe, row->stiffness, row->iterations, point->multiple * row->stable_step);
        point->outcome = last ? SHV_STABLE : shv_probe_judge(probe, row, point->multiple, options->steps);
        if (point->outcome == SHV_STABLE) shv_probe_measure(probe, row, point);
        if (point->multiple > row->refused_above) point->outcome = SHV_REFUSED;
    }
}

/* Without bars, then k by k, iterations by iterations. */
static ShvStatus measure_rows(ShvStability *stability, const ShvSceneDefinition *scene, ShvProbe *probe,
                              ShvError *error)
{
    const ShvStabilityOptions *options = &stability->options;
    const int32_t each = options->iterations.count, bars = options->stiffness.count * each;
    ShvStabilityRow *plain = &stability->rows[stability->count];
    for (int32_t i = -1; i < bars; i++) {
        ShvStabilityRow *row = &stability->rows[stability->count++];
        *row = (ShvStabilityRow){.modulus = probe->modulus, .refused_above = (double)NAN};
        if (i >= 0) row->stiffness = options->stiffness.values[i / each];
        if (i >= 0) row->iterations = (int32_t)options->iterations.values[i % each];
        if (i < 0) SHV_TRY(find_refusal(scene, probe, options, row, error));
        if (options->begins) options->begins(options->data, row->modulus, row->stiffness, row->iterations);
        shv_probe_search(probe, options, row);
        row->over_mesh = row->limit / plain->limit;
        measure_points(probe, options, row);
    }
    return SHV_OK;
}

static ShvStatus measure_all(ShvStability *stability, const ShvSceneDefinition *scene, ShvError *error)
{
    const ShvStabilityOptions *options = &stability->options;
    const int32_t moduli = options->moduli.count > 0 ? options->moduli.count : 1;
    const size_t rows = (size_t)moduli * (1 + (size_t)options->stiffness.count * (size_t)options->iterations.count);
    stability->rows = shv_allocate(stability->memory, SHV_PART_GENERAL, rows, sizeof *stability->rows);
    if (!stability->rows) return shv_fail_memory(error, "the table of stability", rows * sizeof *stability->rows);
    for (int32_t i = 0; i < moduli; i++) {
        ShvProbe probe;
        const double modulus = options->moduli.count > 0 ? options->moduli.values[i] : (double)NAN;
        ShvStatus status = shv_probe_create(&probe, scene, options, modulus, error);
        if (status == SHV_OK) status = shv_probe_refer(&probe, error);
        if (status == SHV_OK) status = measure_rows(stability, scene, &probe, error);
        shv_probe_release(&probe);
        SHV_TRY(status);
    }
    return SHV_OK;
}

ShvStatus shv_stability(ShvStability **stability, const ShvSceneDefinition *scene, const ShvStabilityOptions *given,
                        ShvError *error)
{
    *stability = NULL;
    const ShvStabilityOptions options = given ? *given : shv_stability_default();
    SHV_TRY(check_options(&options, error));
    ShvStability *made = shv_allocate(options.memory, SHV_PART_GENERAL, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the measurement", sizeof *made);
    shv_format(made->name, sizeof made->name, "%.127s", scene->name ? scene->name : "largest stable step");
    made->options = options;
    made->memory = options.memory;
    const ShvStatus status = measure_all(made, scene, error);
    if (status != SHV_OK) {
        shv_stability_destroy(made);
        return status;
    }
    *stability = made;
    return SHV_OK;
}

void shv_stability_destroy(ShvStability *stability)
{
    if (!stability) return;
    shv_release(stability->rows);
    shv_release(stability);
}

int32_t shv_stability_count(const ShvStability *stability)
{
    return stability->count;
}

const ShvStabilityRow *shv_stability_row(const ShvStability *stability, int32_t index)
{
    return &stability->rows[index];
}
