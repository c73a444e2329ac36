/* A comparison of rigid engines is a study that is made up here: all engines at all steps, tracked. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/names.h"
#include "base/text.h"
#include "cli/command.h"

enum { STEPS, ENGINES, OUTPUT, FORCE, JSON };

static const char *const engines[] = {"bullet", "bullet_plain", "pbd", "analytic"};
enum { ENGINE_COUNT = sizeof engines / sizeof engines[0], MOST_STEPS = 16 };

typedef struct Choice {
    double steps[MOST_STEPS], finest, coarsest;
    int32_t step_count;
    bool engine[ENGINE_COUNT];
} Choice;

/* ---- lists ---- */

static ShvStatus read_steps(const char *text, Choice *choice, ShvError *error)
{
    static const char option[] = "--steps", what[] = "times in seconds, as in 1e-2,1e-3";
    choice->coarsest = 0.0;
    choice->finest = HUGE_VAL;
    SHV_TRY(shv_cli_read_numbers(text, option, what, choice->steps, MOST_STEPS, &choice->step_count, error));
    for (int32_t i = 0; i < choice->step_count; i++) {
        const double step = choice->steps[i];
        if (!(step > 0.0)) return shv_fail(error, SHV_BAD_INPUT, "%s needs %s, not '%s'", option, what, text);
        for (int32_t k = 0; k < i; k++)
            if (choice->steps[k] == step)
                return shv_fail(error, SHV_BAD_INPUT, "the time step %g s is given twice", step);
        choice->coarsest = fmax(choice->coarsest, step);
        choice->finest = fmin(choice->finest, step);
    }
    return SHV_OK;
}

static ShvStatus read_engines(const char *text, Choice *choice, ShvError *error)
{
    for (const char *at = text;; at++) {
        const int length = (int)strcspn(at, ",");
        char word[64];
        int i = 0;
        snprintf(word, sizeof word, "%.*s", length < 63 ? length : 63, at);
        while (i < ENGINE_COUNT && strcmp(word, engines[i]) != 0) i++;
        const char *near = shv_nearest_name(word, engines, ENGINE_COUNT);
        if (i == ENGINE_COUNT)
            return shv_fail(error, SHV_BAD_INPUT,
                            "there is no rigid engine '%s'%s%s%s; give bullet, bullet_plain, pbd or analytic", word,
                            near ? " (did you mean " : "", near ? near : "", near ? "?)" : "");
        if (choice->engine[i]) return shv_fail(error, SHV_BAD_INPUT, "the engine %s is given twice", word);
        choice->engine[i] = true;
        at += length;
        if (!*at) return SHV_OK;
    }
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
    enum { BULLET = 0, ANALYTIC = 3 };
    int32_t bodies = scene->object_count;
    for (int32_t i = 0; i < scene->obstacle_count; i++) bodies += scene->obstacles[i].motion == SHV_OBSTACLE_FREE;
    int engine = bodies > 1 ? BULLET : ANALYTIC;
    if (!choice->engine[engine]) engine = BULLET + ANALYTIC - engine;
    if (scene->reference.law != SHV_REFERENCE_NONE) {
        shv_print(stream, "reference: closed form\n");
        return SHV_OK;
    }
    if (!choice->engine[engine])
        return shv_fail(error, SHV_BAD_INPUT,
                        "the scene names no `reference`, and none of the engines can stand for it; add bullet or "
                        "analytic");
    shv_print(stream, "reference: {rigid.engine: %s, rigid.time_step: %.17g}\n", engines[engine], choice->finest);
    return SHV_OK;
}

/* Nothing wakes, whatever the scene says: rigid motion alone. Frames are the same in all runs, and no step is cut by one. */
static ShvStatus put_study(FILE *stream, const ShvSceneDefinition *scene, const Choice *choice, ShvError *error)
{
    const char *between = "";
    shv_print(stream, "shiver_study: 1\nname: \"");
    for (const char *c = scene->name ? scene->name : "comparison"; *c; c++)
        shv_print(stream, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    shv_print(stream, "\"\nset: {rigid.wake: stress, output.fracture_every: 0, output.rate: %.17g}\n",
              fmin(scene->output.rate, 1.0 / choice->coarsest));
    shv_print(stream, "vary: {rigid.engine: [");
    for (int i = 0; i < ENGINE_COUNT; i++) {
        if (!choice->engine[i]) continue;
        shv_print(stream, "%s%s", between, engines[i]);
        between = ", ";
    }
    shv_print(stream, "], rigid.time_step: [");
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
    char *text = NULL, command[SHV_CLI_PATH];
    size_t length = 0;
    ShvError error;
    FILE *stream = open_memstream(&text, &length);
    ShvStatus status = stream ? check(definition, choice, &error) : shv_fail_memory(&error, "a study", 0);
    if (status == SHV_OK) status = put_study(stream, definition, choice, &error);
    if (stream) fclose(stream);
    snprintf(command, sizeof command, "shiver compare %s", arguments->positional[0]);
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
    Choice choice = {.step_count = 0};
    const char *steps = arguments->values[STEPS], *names = arguments->values[ENGINES];
    ShvStatus status = read_steps(steps ? steps : "1e-2,1e-3,1e-4", &choice, &error);
    if (status == SHV_OK) status = read_engines(names ? names : "bullet,bullet_plain,pbd,analytic", &choice, &error);
    if (status == SHV_OK) status = shv_cli_scene_output(folder, arguments, arguments->values[OUTPUT], NULL, "", &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    /* The engine that the scene names is not used; keys of pbd count. */
    ShvArguments loading = *arguments;
    if (loading.override_count < SHV_MOST_OVERRIDES) loading.overrides[loading.override_count++] = "rigid.engine=pbd";
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
