/* What optional parts cost: bench_parts SCENE [KEY=VALUE …] runs a scene as it is and with parts left out or put in, one after
   another, and prints, beside what the plan says before the run, bytes by part from the program's own counters and run time.
   KEY=VALUE are overrides of all runs, as of `shiver --set`.

   CSV, a line for each variant and part of the memory, and one for their sum: bytes that the plan tells, that are held before
   the first crack, and at most; run time of the whole run, steps of fracture mode, and what the plan expects of both. A variant
   that the scene refuses has a line with the reason. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "base/timer.h"
#include "shiver/plan.h"
#include "shiver/scene.h"

enum { MOST_OVERRIDES = 32 };

typedef struct Variant {
    const char *name, *overrides[2];
} Variant;

static const Variant variants[] = {
    {"as it is", {NULL, NULL}},
    {"no fracture", {"fracture.enabled=false", NULL}},
    {"rigid engine analytic", {"rigid.engine=analytic", NULL}},
    {"rigid engine bullet", {"rigid.engine=bullet", NULL}},
    {"rigid engine pbd", {"rigid.engine=pbd", NULL}},
    {"principal criterion", {"fracture.criterion=principal", NULL}},
    {"bars", {"fracture.stabiliser=bars", "fracture.energy_bound=1e9"}},
    {"every contact wakes", {"rigid.wake=contact", NULL}},
};

typedef struct Figures {
    size_t planned, before[SHV_PART_COUNT + 1], peak[SHV_PART_COUNT + 1]; /* the last: of all parts */
    double seconds, predicted_seconds, predicted_steps;
    int64_t steps;
    int32_t inserted;
} Figures;

static void note(size_t bytes[SHV_PART_COUNT + 1], const ShvMemory *memory)
{
    for (int i = 0; i <= SHV_PART_COUNT; i++) bytes[i] = shv_memory_bytes(memory, (ShvPart)i);
}

static ShvStatus make(const ShvScene *scene, const ShvSceneDefinition *definition, ShvMemory *memory,
                      ShvSimulation **simulation, ShvError *error)
{
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    options.memory = memory;
    return shv_simulation_create(simulation, definition, &options, error);
}

/* Step by step up to the first crack, for the bytes alone. */
static ShvStatus approach(const ShvScene *scene, ShvMemory *memory, Figures *figures, ShvError *error)
{
    ShvSceneDefinition definition = *shv_scene_definition(scene);
    ShvSimulation *simulation = NULL;
    definition.output.fracture_every = 1;
    SHV_TRY(make(scene, &definition, memory, &simulation, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    while (status == SHV_OK && shv_simulation_frame(simulation)->inserted == 0) {
        note(figures->before, memory);
        if (shv_simulation_finished(simulation)) break;
        status = shv_simulation_advance(simulation, error);
    }
    shv_simulation_destroy(simulation);
    return status;
}

/* As `shiver plan` makes it, with a trial of its usual length. */
static ShvStatus plan(const ShvScene *scene, Figures *figures, ShvError *error)
{
    ShvPlan plan;
    ShvSimulation *simulation = NULL;
    SHV_TRY(make(scene, shv_scene_definition(scene), NULL, &simulation, error));
    ShvStatus status = shv_simulation_plan(simulation, &plan, error);
    if (status == SHV_OK) status = shv_simulation_try(simulation, 2.0, &plan, error);
    shv_simulation_destroy(simulation);
    if (status == SHV_DIVERGED) status = SHV_OK; /* the run will tell */
    figures->planned = plan.bytes;
    figures->predicted_seconds = plan.predicted_seconds;
    figures->predicted_steps = plan.predicted_steps;
    return status;
}

static ShvStatus follow(const ShvScene *scene, ShvMemory *memory, Figures *figures, ShvError *error)
{
    ShvSimulation *simulation = NULL;
    SHV_TRY(plan(scene, figures, error));
    SHV_TRY(make(scene, shv_scene_definition(scene), memory, &simulation, error));
    ShvStatus status = SHV_OK;
    const double start = shv_now();
    while (status == SHV_OK && !shv_simulation_finished(simulation)) {
        status = shv_simulation_advance(simulation, error);
        figures->steps = shv_simulation_frame(simulation)->steps;
        figures->inserted = shv_simulation_frame(simulation)->inserted;
    }
    figures->seconds = shv_now() - start;
    for (int i = 0; i <= SHV_PART_COUNT; i++) figures->peak[i] = shv_memory_peak_bytes(memory, (ShvPart)i);
    shv_simulation_destroy(simulation);
    return status;
}

static ShvStatus run(const ShvScene *scene, Figures *figures, ShvError *error)
{
    ShvStatus status = SHV_OK;
    for (int i = 0; i < 2 && status == SHV_OK; i++) {
        ShvMemory *memory = shv_memory_create();
        if (!memory) return shv_fail_memory(error, "a counter", 0);
        status = (i ? follow : approach)(scene, memory, figures, error);
        shv_memory_destroy(memory);
    }
    return status;
}

static void print_figures(const char *scene, const char *variant, const Figures *figures)
{
    for (int i = 0; i < SHV_PART_COUNT; i++)
        shv_print(stdout, "%s,%s,%s,,%zu,%zu,,,,,,\n", scene, variant, shv_part_name((ShvPart)i), figures->before[i],
                  figures->peak[i]);
    shv_print(stdout, "%s,%s,all,%zu,%zu,%zu,%.3f,%.3f,%lld,%.0f,%d,\n", scene, variant, figures->planned,
              figures->before[SHV_PART_COUNT], figures->peak[SHV_PART_COUNT], figures->seconds,
              figures->predicted_seconds, (long long)figures->steps, figures->predicted_steps, (int)figures->inserted);
    fflush(stdout);
}

static void try_variant(const char *path, const Variant *variant, char **given, int given_count)
{
    const char *overrides[MOST_OVERRIDES];
    int count = 0;
    for (int i = 0; i < given_count && count < MOST_OVERRIDES - 2; i++) overrides[count++] = given[i];
    for (int i = 0; i < 2 && variant->overrides[i]; i++) overrides[count++] = variant->overrides[i];
    ShvError error;
    ShvScene *scene = NULL;
    Figures figures = {.seconds = 0.0};
    ShvStatus status = shv_scene_load(&scene, path, overrides, count, NULL, NULL, &error);
    if (status == SHV_OK) status = run(scene, &figures, &error);
    if (status == SHV_OK)
        print_figures(path, variant->name, &figures);
    else
        shv_print(stdout, "%s,%s,,,,,,,,,,\"%s\"\n", path, variant->name, error.message);
    shv_scene_destroy(scene);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fputs("bench_parts SCENE [KEY=VALUE …]\n", stderr);
        return 2;
    }
    puts("scene,variant,part,planned [B],before the first crack [B],peak [B],run time [s],expected fracture time [s],"
         "steps,expected steps,inserted,failure");
    for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++)
        try_variant(argv[1], &variants[i], argv + 2, argc - 2);
    return 0;
}
