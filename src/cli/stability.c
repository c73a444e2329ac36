#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "cli/command.h"
#include "cli/verify.h"

enum { STIFFNESS, ITERATIONS, MODULI, MULTIPLES, STEPS, CSV, SVG, FORCE, JSON, SUITE, QUICK, MARKDOWN };

/* ---- lists ---- */

/* Numbers with commas between; returns how many, or −1 when there are too many or one is none. */
static int32_t read_list(const char *text, double *values, int32_t most)
{
    for (int32_t count = 0; count < most;) {
        char *end = NULL;
        if (strspn(text, "0123456789.") == 0) return -1;
        values[count++] = shv_text_to_double(text, &end);
        if (!*end) return count;
        if (*end != ',') return -1;
        text = end + 1;
    }
    return -1;
}

static ShvStatus read_option(const char *text, const char *name, double *values, int32_t most, int32_t *count,
                             ShvError *error)
{
    if (!text) return SHV_OK;
    *count = read_list(text, values, most);
    if (*count > 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "%s needs up to %d numbers with commas between, as in 1,0.5; not '%s'", name,
                    (int)most, text);
}

static ShvStatus read_whole(const char *text, const char *name, int32_t *values, int32_t most, int32_t *count,
                            ShvError *error)
{
    double numbers[SHV_MOST_STABILITY_VALUES];
    if (!text) return SHV_OK;
    if (read_option(text, name, numbers, most, count, error) != SHV_OK) return error->status;
    for (int32_t i = 0; i < *count; i++) {
        if (numbers[i] != floor(numbers[i]) || !(numbers[i] <= 1e9))
            return shv_fail(error, SHV_BAD_INPUT, "%s needs whole numbers, not '%s'", name, text);
        values[i] = (int32_t)numbers[i];
    }
    return SHV_OK;
}

static ShvStatus read_options(const ShvArguments *arguments, ShvStabilityOptions *options, ShvError *error)
{
    const char *const *values = arguments->values;
    int32_t one = 0;
    ShvStatus status = read_option(values[STIFFNESS], "--k", options->stiffness, SHV_MOST_STABILITY_VALUES,
                                   &options->stiffness_count, error);
    if (status == SHV_OK)
        status = read_whole(values[ITERATIONS], "--iterations", options->iterations, SHV_MOST_STABILITY_VALUES,
                            &options->iterations_count, error);
    if (status == SHV_OK)
        status = read_option(values[MODULI], "--moduli", options->moduli, SHV_MOST_STABILITY_VALUES,
                             &options->modulus_count, error);
    if (status == SHV_OK)
        status = read_option(values[MULTIPLES], "--at", options->multiples, SHV_MOST_STABILITY_POINTS - 1,
                             &options->multiple_count, error);
    if (status == SHV_OK) status = read_whole(values[STEPS], "--steps", &options->steps, 1, &one, error);
    return status;
}

/* ---- what is printed ---- */

static void print_number(double value, const char *format)
{
    char text[32];
    if (isnan(value))
        snprintf(text, sizeof text, "-");
    else if (isinf(value))
        snprintf(text, sizeof text, "inf");
    else
        shv_format(text, sizeof text, format, value);
    printf(" %9s", text);
}

static void print_setting(const ShvStabilityRow *row)
{
    if (row->iterations > 0)
        printf("%-10.3g %5.3g %4d", row->modulus, row->stiffness, (int)row->iterations);
    else
        printf("%-10.3g %5s %4s", row->modulus, "none", "-");
}

static void print_limits(const ShvStability *stability)
{
    printf("largest stable step, in computed stable steps\n");
    printf("%-10s %5s %4s %9s %9s %9s %9s  %-9s %-9s %s\n", "E, Pa", "k", "n", "step, s", "limit", "fails at",
           "of mesh", "there", "at 3x", "monotone");
    for (int32_t i = 0; i < shv_stability_count(stability); i++) {
        const ShvStabilityRow *row = shv_stability_row(stability, i);
        print_setting(row);
        print_number(row->stable_step, "%.3e");
        print_number(row->limit, "%.2f");
        print_number(row->failed, "%.2f");
        print_number(row->over_mesh, "%.2f");
        printf("  %-9s %-9s ", shv_stability_class_name(row->beyond), shv_stability_class_name(row->far));
        if (row->monotone) printf("yes");
        if (!isnan(row->unstable_below)) printf("NO: unstable at %.2f", row->unstable_below);
        if (!isnan(row->stable_again))
            printf("%sNO: stable again at %.2f", isnan(row->unstable_below) ? "" : ", ", row->stable_again);
        if (!isnan(row->refused_above))
            printf("; the program refuses steps above %.2f without bars", row->refused_above);
        printf("\n");
    }
}

static void print_points(const ShvStability *stability)
{
    printf("\nhow far off: against no bars at a quarter of the stable step\n");
    printf("%-10s %5s %4s %9s  %-9s %9s %9s %9s %9s %9s\n", "E, Pa", "k", "n", "step", "class", "stiffness",
           "bars alone", "frequency", "displ.", "energy");
    for (int32_t i = 0; i < shv_stability_count(stability); i++) {
        const ShvStabilityRow *row = shv_stability_row(stability, i);
        for (int32_t k = 0; k < row->point_count; k++) {
            const ShvStabilityPoint *point = &row->points[k];
            print_setting(row);
            print_number(point->multiple, "%.2f");
            printf("  %-9s", shv_stability_class_name(point->outcome));
            print_number(point->stiffness, "%.4g");
            print_number(point->closed_form, "%.4g");
            print_number(point->frequency, "%.4f");
            print_number(point->displacement, "%.3g");
            print_number(point->energy_kept, "%.3g");
            printf("\n");
        }
    }
}

typedef struct Named {
    const char *name;
    double value;
} Named;

static void print_numbers_json(const Named *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        printf("%s\"%s\": ", i ? ", " : "", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
}

static void print_point_json(const ShvStabilityPoint *point)
{
    const Named numbers[] = {
        {"step", point->multiple},       {"stiffness", point->stiffness},       {"bars_alone", point->closed_form},
        {"frequency", point->frequency}, {"displacement", point->displacement}, {"energy_kept", point->energy_kept}};
    printf("{\"class\": \"%s\", ", shv_stability_class_name(point->outcome));
    print_numbers_json(numbers, sizeof numbers / sizeof numbers[0]);
    printf("}");
}

static void print_json(const ShvStability *stability)
{
    printf("{\"rows\": [");
    for (int32_t i = 0; i < shv_stability_count(stability); i++) {
        const ShvStabilityRow *row = shv_stability_row(stability, i);
        const Named numbers[] = {{"youngs_modulus", row->modulus},
                                 {"k", row->stiffness},
                                 {"iterations", row->iterations},
                                 {"stable_step", row->stable_step},
                                 {"limit", row->limit},
                                 {"failed", row->failed},
                                 {"over_mesh", row->over_mesh},
                                 {"unstable_below", row->unstable_below},
                                 {"stable_again", row->stable_again},
                                 {"refused_above", row->refused_above}};
        printf("%s{\"bars\": %s, ", i ? ",\n " : "", row->iterations > 0 ? "true" : "false");
        print_numbers_json(numbers, sizeof numbers / sizeof numbers[0]);
        printf(", \"beyond\": \"%s\", \"far\": \"%s\", \"monotone\": %s, \"points\": [",
               shv_stability_class_name(row->beyond), shv_stability_class_name(row->far),
               row->monotone ? "true" : "false");
        for (int32_t k = 0; k < row->point_count; k++) {
            if (k > 0) printf(",\n  ");
            print_point_json(&row->points[k]);
        }
        printf("]}");
    }
    printf("]}\n");
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
    const bool force = arguments->values[FORCE] != NULL;
    options->folder = shv_scene_folder(scene);
    options->begins = arguments->quiet ? NULL : say_setting;
    ShvStability *stability = NULL;
    ShvStatus status = shv_stability_check_files(csv, svg, force, error);
    if (status == SHV_OK) status = shv_stability(&stability, shv_scene_definition(scene), options, error);
    if (status != SHV_OK) return status;
    if (arguments->values[JSON]) {
        print_json(stability);
    } else {
        printf("load: velocities of up to 0.5e-6 bar speeds, drawn node by node, rigid motion taken out; %d steps\n",
               (int)options->steps);
        print_limits(stability);
        print_points(stability);
    }
    if (csv) status = shv_stability_write_csv(stability, csv, force, error);
    if (status == SHV_OK && svg) status = shv_stability_write_svg(stability, svg, force, error);
    if (status == SHV_OK && csv && !arguments->json) printf("wrote %s\n", csv);
    if (status == SHV_OK && svg && !arguments->json)
        printf("wrote %s_limit.svg, %s_stiffness.svg and %s_error.svg\n", svg, svg, svg);
    shv_stability_destroy(stability);
    return status;
}

static int run(const ShvArguments *arguments)
{
    ShvError error;
    if (arguments->values[SUITE]) return run_suite(arguments);
    if (arguments->positional_count == 0) {
        shv_fail(&error, SHV_BAD_INPUT, "stability needs a SCENE, or --suite");
        return shv_cli_failed(SHV_BAD_INPUT, &error);
    }
    ShvStabilityOptions options = shv_stability_default();
    ShvStatus status = read_options(arguments, &options, &error);
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
