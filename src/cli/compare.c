#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/names.h"
#include "base/text.h"

enum { STEPS, ENGINES, OUTPUT, FORCE, JSON };

/* ---- lists ---- */

/* One number after another, commas between; text moves on. */
static ShvStatus read_steps(const char *text, ShvCompareOptions *options, ShvError *error)
{
    options->step_count = 0;
    for (const char *at = text;; at++) {
        if (options->step_count == SHV_MOST_COMPARED_STEPS)
            return shv_fail(error, SHV_BAD_INPUT, "--steps takes at most %d time steps", SHV_MOST_COMPARED_STEPS);
        char *end = NULL;
        double step = 0.0;
        if (strspn(at, "0123456789.") > 0) step = shv_text_to_double(at, &end);
        if (!end || (*end && *end != ',') || !(step > 0.0) || !isfinite(step))
            return shv_fail(error, SHV_BAD_INPUT, "--steps needs times in seconds, as in 1e-2,1e-3, not '%s'", text);
        options->steps[options->step_count++] = step;
        at = end;
        if (!*at) return SHV_OK;
    }
}

static ShvStatus read_engine(const char *word, ShvCompareOptions *options, ShvError *error)
{
    static const ShvRigidEngine engines[SHV_MOST_COMPARED_ENGINES] = {SHV_RIGID_BULLET, SHV_RIGID_BULLET_PLAIN,
                                                                      SHV_RIGID_PBD, SHV_RIGID_ANALYTIC};
    const char *names[SHV_MOST_COMPARED_ENGINES];
    for (int i = 0; i < SHV_MOST_COMPARED_ENGINES; i++) {
        names[i] = shv_rigid_engine_name(engines[i]);
        if (strcmp(word, names[i]) != 0) continue;
        options->engines[options->engine_count++] = engines[i];
        return SHV_OK;
    }
    const char *near = shv_nearest_name(word, names, SHV_MOST_COMPARED_ENGINES);
    return shv_fail(error, SHV_BAD_INPUT,
                    "there is no rigid engine '%s'%s%s%s; give bullet, bullet_plain, pbd or analytic", word,
                    near ? " (did you mean " : "", near ? near : "", near ? "?)" : "");
}

static ShvStatus read_engines(const char *text, ShvCompareOptions *options, ShvError *error)
{
    options->engine_count = 0;
    for (const char *at = text;; at++) {
        const size_t length = strcspn(at, ",");
        char word[64];
        snprintf(word, sizeof word, "%.*s", length < sizeof word ? (int)length : (int)sizeof word - 1, at);
        if (options->engine_count == SHV_MOST_COMPARED_ENGINES)
            return shv_fail(error, SHV_BAD_INPUT, "--engines takes at most %d engines", SHV_MOST_COMPARED_ENGINES);
        const ShvStatus status = read_engine(word, options, error);
        if (status != SHV_OK) return status;
        at += length;
        if (!*at) return SHV_OK;
    }
}

/* ---- what is printed ---- */

static void print_number(double value)
{
    if (isfinite(value))
        printf(" %10.2e", value);
    else
        printf(" %10s", "-");
}

static void print_run(const ShvComparedRun *run)
{
    const double numbers[] = {run->position, run->orientation, run->velocity,
                              run->energy,   run->energy_gain, run->angular_momentum};
    printf("%-12s %-8g", shv_rigid_engine_name(run->engine), run->step);
    if (run->status != SHV_OK) {
        printf(" failed: %s\n", run->message);
        return;
    }
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) print_number(numbers[i]);
    char moments[32] = "-";
    if (run->reference_moments > 0)
        snprintf(moments, sizeof moments, "%d/%d", (int)run->moments, (int)run->reference_moments);
    printf(" %7s", moments);
    print_number(run->moment);
    print_number(run->apex);
    print_number(run->seconds);
    print_number(run->seconds_per_step);
    printf("%s\n", run->is_reference ? "  (reference)" : "");
}

static void print_table(const ShvComparison *comparison)
{
    printf("errors from the %s\n", shv_comparison_reference(comparison));
    printf("%-12s %-8s %10s %10s %10s %10s %10s %10s %7s %10s %10s %10s %10s\n", "engine", "step", "position", "turn",
           "velocity", "energy", "gain", "|dL|/|L|", "moments", "moment", "apex", "run time", "per step");
    printf("%-12s %-8s %10s %10s %10s %10s %10s %10s %7s %10s %10s %10s %10s\n", "", "s", "m", "rad", "m/s", "", "", "",
           "", "s", "", "s", "s");
    for (int32_t i = 0; i < shv_comparison_count(comparison); i++) print_run(shv_comparison_run(comparison, i));
}

static void print_run_json(const ShvComparedRun *run)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"step", run->step},
                   {"position", run->position},
                   {"orientation", run->orientation},
                   {"velocity", run->velocity},
                   {"surface", run->surface},
                   {"energy", run->energy},
                   {"energy_gain", run->energy_gain},
                   {"angular_momentum", run->angular_momentum},
                   {"moment", run->moment},
                   {"apex", run->apex},
                   {"seconds", run->seconds},
                   {"seconds_per_step", run->seconds_per_step}};
    printf("{\"engine\": \"%s\", \"status\": \"%s\", \"message\": ", shv_rigid_engine_name(run->engine),
           run->status == SHV_OK ? "finished" : "failed");
    shv_cli_print_json_text(run->message);
    printf(", \"reference\": %s, \"moments\": %d, \"reference_moments\": %d", run->is_reference ? "true" : "false",
           (int)run->moments, (int)run->reference_moments);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
    printf("}");
}

static void print_json(const ShvComparison *comparison)
{
    printf("{\"reference\": ");
    shv_cli_print_json_text(shv_comparison_reference(comparison));
    printf(", \"runs\": [");
    for (int32_t i = 0; i < shv_comparison_count(comparison); i++) {
        if (i > 0) printf(",\n ");
        print_run_json(shv_comparison_run(comparison, i));
    }
    printf("]}\n");
}

/* ---- the command ---- */

static void say_run(void *data, ShvRigidEngine engine, double step)
{
    (void)data;
    fprintf(stderr, "shiver: running %s at %g s\n", shv_rigid_engine_name(engine), step);
}

static ShvStatus compare(const ShvArguments *arguments, const ShvScene *scene, ShvCompareOptions *options,
                         const char *prefix, ShvError *error)
{
    const bool force = arguments->values[FORCE] != NULL;
    options->folder = shv_scene_folder(scene);
    options->begins = arguments->quiet ? NULL : say_run;
    ShvComparison *comparison = NULL;
    ShvStatus status = shv_comparison_check_files(prefix, force, error);
    if (status == SHV_OK) status = shv_compare(&comparison, shv_scene_definition(scene), options, error);
    if (status != SHV_OK) return status;
    (arguments->values[JSON] ? print_json : print_table)(comparison);
    status = shv_comparison_write(comparison, prefix, force, error);
    if (status == SHV_OK && !arguments->values[JSON]) printf("wrote %s_compare.csv and .svg\n", prefix);
    shv_comparison_destroy(comparison);
    return status;
}

static int run(const ShvArguments *arguments)
{
    char prefix[SHV_CLI_PATH];
    ShvError error;
    ShvCompareOptions options = shv_compare_default();
    ShvStatus status = SHV_OK;
    if (arguments->values[STEPS]) status = read_steps(arguments->values[STEPS], &options, &error);
    if (status == SHV_OK && arguments->values[ENGINES])
        status = read_engines(arguments->values[ENGINES], &options, &error);
    if (status == SHV_OK) status = shv_cli_scene_output(prefix, arguments, arguments->values[OUTPUT], NULL, "", &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    /* The engine that the scene names is not used; keys of pbd count. */
    ShvArguments loading = *arguments;
    if (loading.override_count < SHV_MOST_OVERRIDES) loading.overrides[loading.override_count++] = "rigid.engine=pbd";
    ShvScene *scene;
    const int loaded = shv_cli_load_scene(&scene, &loading);
    if (!scene) return loaded;
    status = compare(arguments, scene, &options, prefix, &error);
    shv_scene_destroy(scene);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

const ShvCommand shv_command_compare = {
    .name = "compare",
    .positional = "SCENE",
    .summary = "run a rigid scene under each engine and time step; errors beside run times",
    .details =
        "Runs a scene in which nothing can break with each rigid engine at each time step, and prints the largest\n"
        "errors of position, orientation (turn) and velocity, of energy and angular momentum (relative), and of the\n"
        "times of impacts or flips (moment) and the heights between impacts (apex, relative), beside the run time.\n"
        "`gain` is the largest rise of the mechanical energy. Errors are taken from the motion that the scene's\n"
        "`reference` names, else from the finest run. A free obstacle is moved by one and the same code under pbd\n"
        "and analytic. Writes PREFIX_compare.csv, frame by frame, and PREFIX_compare.svg, error against run time.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--steps", "A,B,…", "time steps of rigid flight, s; 1e-2,1e-3,1e-4 unless given"},
                {"--engines", "A,B,…", "among bullet, bullet_plain, pbd, analytic; all unless given"},
                {"--output", "PREFIX", "beginning of the file names; the scene file's name unless given"},
                {"--force", NULL, "replace existing files"},
                {"--json", NULL, "print as JSON"}},
    .run = run,
};
