/* A comparison of rigid engines is a study that is made up here: all engines at all steps, tracked. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "cli/command.h"

enum { STEPS, ENGINES, OUTPUT, FORCE, JSON, MOST_STEPS = 16 };

typedef struct Choice {
    double steps[MOST_STEPS], finest, coarsest;
    int32_t step_count;
    const char *engines; /* with commas between */
} Choice;

static ShvStatus read_steps(const char *text, Choice *choice, ShvError *error)
{
    static const char option[] = "--steps", what[] = "times in seconds, as in 1e-2,1e-3";
    SHV_TRY(shv_cli_read_numbers(text, option, what, choice->steps, MOST_STEPS, &choice->step_count, error));
    choice->coarsest = choice->finest = choice->steps[0];
    for (int32_t i = 0; i < choice->step_count; i++) {
        choice->coarsest = fmax(choice->coarsest, choice->steps[i]);
        choice->finest = fmin(choice->finest, choice->steps[i]);
    }
    return choice->finest > 0.0 ? SHV_OK : shv_fail(error, SHV_BAD_INPUT, "%s needs %s, not '%s'", option, what, text);
}

static bool has_engine(const Choice *choice, const char *engine)
{
    const size_t length = strlen(engine);
    for (const char *at = choice->engines; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
        if (strncmp(at, engine, length) == 0 && (at[length] == ',' || at[length] == '\0')) return true;
    return false;
}

/* ---- what a comparison cannot be made of ---- */

static const ShvMaterialDefinition *material_of(const ShvSceneDefinition *scene, const ShvObjectDefinition *object)
{
    for (int32_t i = 0; i < scene->material_count; i++)
        if (strcmp(scene->materials[i].name, object->material) == 0) return &scene->materials[i];
    return NULL;
}

static ShvStatus check(const ShvSceneDefinition *scene, const Choice *choice, ShvError *error)
{
    if (choice->coarsest > scene->duration)
        return shv_fail(error, SHV_BAD_INPUT, "a time step must be above 0 and at most the duration of %g s, not %g",
                        scene->duration, choice->coarsest);
    for (int32_t i = 0; i < scene->event_count; i++)
        if (scene->events[i].kind == SHV_EVENT_GRAVITY)
            return shv_fail(error, SHV_BAD_INPUT,
                            "gravity changes during the run, and energies could not be compared; remove that event");
    for (int32_t i = 0; i < scene->object_count && scene->fracture.enabled; i++) {
        const ShvMaterialDefinition *material = material_of(scene, &scene->objects[i]);
        if (material && material->breakable && !isinf(material->cohesive_strength))
            return shv_fail(error, SHV_BAD_INPUT,
                            "'%s' can break, and a comparison is of rigid motion; set fracture.enabled to false or its "
                            "material's breakable to false",
                            scene->objects[i].name);
    }
    return SHV_OK;
}

/* ---- the study ---- */

/* Without a closed form: the finest run of the engine that knows best; bodies that could meet need one in which they do. */
static ShvStatus put_reference(FILE *stream, const ShvSceneDefinition *scene, const Choice *choice, ShvError *error)
{
    static const char *const knowing[] = {"bullet", "analytic"};
    int32_t bodies = scene->object_count;
    for (int32_t i = 0; i < scene->obstacle_count; i++) bodies += scene->obstacles[i].motion == SHV_OBSTACLE_FREE;
    const char *first = knowing[bodies == 1], *second = knowing[bodies > 1];
    const char *engine = has_engine(choice, first) ? first : second;
    if (scene->reference.law != SHV_REFERENCE_NONE) {
        shv_print(stream, "reference: closed form\n");
        return SHV_OK;
    }
    if (!has_engine(choice, engine))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the scene names no `reference`, and none of the engines can stand for it; add bullet or "
                        "analytic");
    shv_print(stream, "reference: {rigid.engine: %s, rigid.time_step: %.17g}\n", engine, choice->finest);
    return SHV_OK;
}

/* Nothing wakes, whatever the scene says: rigid motion alone. Frames are the same in all runs, and no step is cut by one. */
static ShvStatus put_study(FILE *stream, const ShvSceneDefinition *scene, const Choice *choice, ShvError *error)
{
    shv_print(stream, "shiver_study: 1\nname: \"");
    for (const char *c = scene->name ? scene->name : "comparison"; *c; c++)
        shv_print(stream, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    shv_print(stream, "\"\nset: {rigid.wake: stress, output.fracture_every: 0, output.rate: %.17g}\n",
              fmin(scene->output.rate, 1.0 / choice->coarsest));
    shv_print(stream, "vary: {rigid.engine: [%s], rigid.time_step: [", choice->engines);
    for (int32_t i = 0; i < choice->step_count; i++) shv_print(stream, "%s%g", i ? ", " : "", choice->steps[i]);
    shv_print(stream, "]}\nrepeats: 3\nmeasures: [position, orientation, velocity, surface, energy, energy_gain, "
                      "angular_momentum, missed_events, event_time, apex]\n");
    return put_reference(stream, scene, choice, error);
}

/* The exit status. */
static int compare(const ShvArguments *arguments, const ShvScene *scene, const Choice *choice, const char *folder)
{
    /* Of runs that take less than this the best of up to three counts, in s. */
    static const double short_run = 0.1;
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    ShvStudyOptions options = shv_study_default();
    char *text = NULL, command[2 * SHV_CLI_PATH];
    size_t length = 0;
    ShvError error;
    FILE *stream = open_memstream(&text, &length);
    ShvStatus status = stream ? check(definition, choice, &error) : shv_fail_memory(&error, "a study", 0);
    if (status == SHV_OK) status = put_study(stream, definition, choice, &error);
    if (stream) fclose(stream);
    shv_cli_command_line(&shv_command_compare, arguments, STEPS, ENGINES, command, sizeof command);
    options.output = folder;
    options.plan = text;
    options.scene_text = shv_scene_text(scene);
    options.command = command;
    options.repeat_below = short_run;
    options.force = arguments->values[FORCE] != NULL;
    options.overrides = arguments->overrides;
    options.override_count = arguments->override_count;
    const int result = status == SHV_OK ? shv_cli_study(arguments, &options, arguments->values[JSON] != NULL)
                                        : shv_cli_failed(status, &error);
    free(text);
    return result;
}

static int run(const ShvArguments *arguments)
{
    char folder[SHV_CLI_PATH];
    ShvError error;
    const char *steps = arguments->values[STEPS], *engines = arguments->values[ENGINES];
    Choice choice = {.engines = engines ? engines : "bullet,bullet_plain,pbd,analytic"};
    ShvStatus status = read_steps(steps ? steps : "1e-2,1e-3,1e-4", &choice, &error);
    if (status == SHV_OK) status = shv_cli_scene_output(folder, arguments, arguments->values[OUTPUT], NULL, "", &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    /* The engine that the scene names is not used; keys of pbd count where it is one of those compared. */
    char engine[64];
    const char *first = has_engine(&choice, "pbd") || !choice.engines[0] ? "pbd" : choice.engines;
    shv_format(engine, sizeof engine, "rigid.engine=%.*s", (int)strcspn(first, ","), first);
    ShvArguments loading = *arguments;
    if (loading.override_count < SHV_MOST_OVERRIDES) loading.overrides[loading.override_count++] = engine;
    ShvScene *scene;
    int result = shv_cli_load_scene(&scene, &loading);
    if (scene) result = compare(arguments, scene, &choice, folder);
    shv_scene_destroy(scene);
    return result;
}

const ShvCommand shv_command_compare = {
    .name = "compare",
    .positional = "SCENE",
    .summary = "run a rigid scene under each engine and time step; errors beside run times",
    .details =
        "Runs a scene in which nothing can break with each rigid engine at each time step, and prints the largest\n"
        "errors of position, orientation and velocity, of energy and angular momentum (relative), and of the times of\n"
        "impacts or flips (event_time; missed_events: how many) and the heights between impacts (apex), beside the\n"
        "run time. `energy_gain` is the largest rise of the mechanical energy. Errors are taken from the motion that\n"
        "the scene's `reference` names, else from the finest run. A free obstacle is moved by one and the same code\n"
        "under pbd and analytic. It is a study of engines and steps: DIR has its report, figures, and the runs, which\n"
        "are not made again unless they are asked for with --force.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--steps", "A,B,…", "time steps of rigid flight, s; 1e-2,1e-3,1e-4 unless given"},
                {"--engines", "A,B,…", "among bullet, bullet_plain, pbd, analytic; all unless given"},
                {"--output", "DIR", "folder of results; the scene file's name unless given"},
                {"--force", NULL, "run again what has been run"},
                {"--json", NULL, "print as JSON"}},
    .run = run,
};
