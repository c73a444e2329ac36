#include <math.h>
#include <stdio.h>

#include "base/memory.h"
#include "cli/command.h"

enum { STIFFNESS, ITERATIONS, MODULI, MULTIPLES, STEPS, CSV, SVG, FORCE, JSON, SUITE, QUICK, MARKDOWN };

static ShvStatus read_options(const ShvArguments *arguments, ShvStabilityOptions *options, ShvError *error)
{
    ShvStabilityValues *const lists[] = {&options->stiffness, &options->iterations, &options->moduli,
                                         &options->multiples};
    static const char *const names[] = {"--k", "--iterations", "--moduli", "--at"};
    double steps = options->steps;
    int32_t one = 0;
    for (int i = STIFFNESS; i <= MULTIPLES; i++) {
        const int32_t most = i == MULTIPLES ? SHV_MOST_STABILITY_POINTS - 1 : SHV_MOST_STABILITY_VALUES;
        SHV_TRY(shv_cli_read_numbers(arguments->values[i], names[i], "numbers, as in 1,0.5", lists[i]->values, most,
                                     &lists[i]->count, error));
    }
    SHV_TRY(shv_cli_read_numbers(arguments->values[STEPS], "--steps", "a number", &steps, 1, &one, error));
    if (steps != floor(steps) || !(steps <= 1e9))
        return shv_fail(error, SHV_BAD_INPUT, "--steps needs a whole number, not '%s'", arguments->values[STEPS]);
    options->steps = (int32_t)steps;
    return SHV_OK;
}

/* ---- a suite ---- */

/* The cases of a folder, verified. */
static int run_suite(const ShvArguments *arguments)
{
    char folder[SHV_CLI_PATH];
    ShvError error;
    const ShvStatus status = arguments->positional_count > 0
                                 ? shv_cli_path(folder, &error, "%s", arguments->positional[0])
                                 : shv_cli_scenes(folder, "extreme", &error);
    return status == SHV_OK
               ? shv_cli_verify_folder(arguments, folder, arguments->values[QUICK] == NULL, arguments->values[MARKDOWN])
               : shv_cli_failed(status, &error);
}

/* ---- the command ---- */

static void say_setting(void *data, double modulus, double stiffness, int32_t iterations)
{
    (void)data;
    if (iterations > 0)
        fprintf(stderr, "shiver: E = %g Pa, k = %g, %d iterations\n", modulus, stiffness, (int)iterations);
    else
        fprintf(stderr, "shiver: E = %g Pa, no bars\n", modulus);
}

static ShvStatus measure(const ShvArguments *arguments, const ShvScene *scene, ShvStabilityOptions *options,
                         ShvError *error)
{
    const char *csv = arguments->values[CSV], *svg = arguments->values[SVG];
    const bool force = arguments->values[FORCE] != NULL, json = arguments->values[JSON] != NULL;
    ShvStability *stability = NULL;
    options->folder = shv_scene_folder(scene);
    options->begins = arguments->quiet ? NULL : say_setting;
    ShvStatus status = shv_stability_check_files(csv, svg, force, error);
    if (status == SHV_OK) status = shv_stability(&stability, shv_scene_definition(scene), options, error);
    if (status != SHV_OK) return status;
    (json ? shv_stability_print_json : shv_stability_print)(stability, stdout);
    status = shv_stability_write(stability, csv, svg, force, error);
    if (status == SHV_OK && csv && !json) printf("wrote %s\n", csv);
    if (status == SHV_OK && svg && !json)
        printf("wrote %s_limit.svg, %s_stiffness.svg and %s_error.svg\n", svg, svg, svg);
    shv_stability_destroy(stability);
    return status;
}

static int run(const ShvArguments *arguments)
{
    ShvError error;
    ShvStabilityOptions options = shv_stability_default();
    if (arguments->values[SUITE]) return run_suite(arguments);
    ShvStatus status = arguments->positional_count > 0
                           ? read_options(arguments, &options, &error)
                           : shv_fail(&error, SHV_BAD_INPUT, "stability needs a SCENE, or --suite");
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    ShvScene *scene;
    const int loaded = shv_cli_load_scene(&scene, arguments);
    if (!scene) return loaded;
    status = measure(arguments, scene, &options, &error);
    shv_scene_destroy(scene);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

const ShvCommand shv_command_stability = {
    .name = "stability",
    .positional = "SCENE | --suite [FOLDER]",
    .summary = "largest stable step of a scene's bodies with bars, and how far off each step is",
    .details =
        "Takes the bodies of a scene alone (no obstacles, conditions, gravity, cracks), shakes them with small random\n"
        "velocities, and finds the largest step that stays bounded, without bars and for every k and number of\n"
        "iterations, in units of the computed stable step. Then stretches the first body: its static stiffness, the\n"
        "frequency, displacement and energy of its vibration at each step, against no bars at a quarter of the\n"
        "stable step. `bars alone`: the stiffness by the closed form, if bars did not share nodes. The form of bars\n"
        "is the scene's pbd.form.\n"
        "With --suite: verifies all cases of FOLDER (scenes/extreme unless given, here or as installed), as "
        "`shiver verify` does.",
    .least_positional = 0,
    .most_positional = 1,
    .takes_scene = true,
    .takes_stream = true,
    .options = {{"--k", "A,B,…", "stiffnesses of bars; 1,0.5,0.1 unless given"},
                {"--iterations", "A,B,…", "sweeps a step; 1,4,10 unless given"},
                {"--moduli", "A,B,…", "Young's moduli, Pa; the scene's own unless given"},
                {"--at", "A,B,…", "multiples where errors are measured; 0.5,1,2,5,10,20 unless given"},
                {"--steps", "N", "steps that a stable step must last; 10000 unless given"},
                {"--csv", "FILE", "writes all figures"},
                {"--svg", "PREFIX", "writes PREFIX_limit.svg, PREFIX_stiffness.svg, PREFIX_error.svg"},
                {"--force", NULL, "replace existing files"},
                {"--json", NULL, "print as JSON"},
                {"--suite", NULL, "verify a suite of extreme scenes"},
                {"--quick", NULL, "suite: leave out runs of the full set"},
                {"--markdown", "FILE", "suite: also write the tables as Markdown"}},
    .run = run,
};
