#include "cli/command.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "cli/reserve.h"

/* What a scene is called that comes through standard input. */
static const char standard_input[] = "standard input";

/* ---- names of files ---- */

ShvStatus shv_cli_path(char path[SHV_CLI_PATH], ShvError *error, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(path, SHV_CLI_PATH, format, arguments);
    va_end(arguments);
    if (length >= 0 && length < SHV_CLI_PATH) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the name '%.60s…' is too long; names of files have at most %d bytes", path,
                    SHV_CLI_PATH - 1);
}

ShvStatus shv_cli_default_path(char path[SHV_CLI_PATH], const char *file, bool beside, const char *ending,
                               ShvError *error)
{
    const char *slash = strrchr(file, '/'), *name = slash ? slash + 1 : file, *dot = strrchr(name, '.');
    const char *begin = beside ? file : name;
    const size_t length = dot && dot != name ? (size_t)(dot - begin) : strlen(begin);
    if (length >= SHV_CLI_PATH) return shv_cli_path(path, error, "%s", begin);
    return shv_cli_path(path, error, "%.*s%s", (int)length, begin, ending);
}

bool shv_cli_is_stream(const char *argument)
{
    return strcmp(argument, "-") == 0;
}

ShvStatus shv_cli_scene_output(char path[SHV_CLI_PATH], const ShvArguments *arguments, const char *given,
                               const ShvSceneDefinition *scene, const char *ending, ShvError *error)
{
    const char *file = arguments->positional[0];
    if (given) return shv_cli_path(path, error, "%s", given);
    if (!shv_cli_is_stream(file)) return shv_cli_default_path(path, file, false, ending, error);
    const bool named = scene && strcmp(scene->name, standard_input) != 0 && !strchr(scene->name, '/');
    if (named) return shv_cli_path(path, error, "%s%s", scene->name, ending);
    return shv_fail(error, SHV_BAD_INPUT, "a scene on standard input gives the output no name; give --output%s",
                    scene ? ", or a 'name' without slashes in the scene" : "");
}

/* The program may have been installed anywhere, its scenes with it. */
ShvStatus shv_cli_scenes(char path[SHV_CLI_PATH], const char *folder, ShvError *error)
{
    char program[SHV_CLI_PATH];
    SHV_TRY(shv_cli_path(path, error, "scenes/%s", folder));
    if (access(path, R_OK) == 0) return SHV_OK;
    const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    const char *slash = strrchr(program, '/');
    if (slash)
        SHV_TRY(shv_cli_path(path, error, "%.*s/%s/scenes/%s", (int)(slash - program), program,
                             SHIVER_DATA_FROM_PROGRAM, folder));
    if (slash && access(path, R_OK) == 0) return SHV_OK;
    SHV_TRY(shv_cli_path(path, error, "%s/scenes/%s", SHIVER_DATA, folder)); /* where /proc is not mounted */
    if (access(path, R_OK) == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "there is no folder 'scenes/%s' here, and none was installed with the program; run from the source "
                    "tree, or name the folder",
                    folder);
}

ShvStatus shv_cli_keep_input(const char *output, const char *input, ShvError *error)
{
    if (!shv_same_file(output, input)) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is read by this command and would be replaced; choose another output",
                    input);
}

/* The controls U+0080 to U+009F are 0xc2 and 0x80 to 0x9f in UTF-8. */
void shv_cli_print_plain(FILE *stream, const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        const bool late = c[0] == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0;
        const bool control = (*c < 0x20 && *c != '\n') || *c == 0x7f || late;
        putc(control ? '?' : *c, stream);
        c += late;
    }
}

/* ---- ends ---- */

ShvStatus shv_cli_why_stopped(ShvError *error)
{
    if (!shv_reserve_used()) return shv_fail(error, SHV_INTERRUPTED, "%s", error->message);
    return shv_fail(error, SHV_NO_MEMORY,
                    "out of memory: stopped at a whole state while there was still room for it; use a coarser mesh, "
                    "fewer threads or a larger machine");
}

/* ---- scenes ---- */

/* All of it, up to one byte more than a scene may have. */
static ShvStatus read_standard_input(char **text, size_t *length, ShvError *error)
{
    const size_t most = SHV_SCENE_LARGEST_BYTES + 1;
    *text = shv_allocate(NULL, SHV_PART_SCENE, most, 1);
    if (!*text) return shv_fail_memory(error, "a scene", most);
    *length = fread(*text, 1, most, stdin);
    if (!ferror(stdin)) return SHV_OK;
    shv_release(*text);
    *text = NULL;
    return shv_fail(error, SHV_BAD_INPUT, "cannot read standard input: %s", strerror(errno));
}

static ShvStatus read_scene(ShvScene **scene, const ShvArguments *arguments, ShvDiagnostics **diagnostics,
                            ShvError *error)
{
    const char *file = arguments->positional[0];
    const int32_t count = (int32_t)arguments->override_count;
    if (!shv_cli_is_stream(file))
        return shv_scene_load(scene, file, arguments->overrides, count, NULL, diagnostics, error);
    char *text = NULL;
    size_t length = 0;
    *scene = NULL;
    SHV_TRY(read_standard_input(&text, &length, error));
    const ShvStatus status = shv_scene_parse(scene, text, length, standard_input, NULL, arguments->overrides, count,
                                             NULL, diagnostics, error);
    shv_release(text);
    return status;
}

bool shv_cli_print_faults(const ShvDiagnostics *diagnostics)
{
    const int32_t count = diagnostics ? shv_diagnostics_count(diagnostics) : 0;
    for (int32_t i = 0; i < count; i++) {
        shv_cli_print_plain(stderr, shv_diagnostics_get(diagnostics, i)->message);
        putc('\n', stderr);
    }
    return diagnostics && shv_diagnostics_errors(diagnostics) > 0;
}

int shv_cli_end_loading(ShvStatus status, ShvDiagnostics *diagnostics, const ShvError *error)
{
    const bool told = shv_cli_print_faults(diagnostics);
    shv_diagnostics_destroy(diagnostics);
    if (status == SHV_OK) return SHV_EXIT_DONE;
    if (told && status == SHV_BAD_INPUT) return SHV_EXIT_INPUT;
    const int exit_status = shv_cli_failed(status, error);
    return status == SHV_FILE_ERROR ? (int)SHV_EXIT_INPUT : exit_status; /* a scene that cannot be read is bad input */
}

int shv_cli_load_scene(ShvScene **scene, const ShvArguments *arguments)
{
    ShvDiagnostics *diagnostics = NULL;
    ShvError error;
    const ShvStatus status = read_scene(scene, arguments, &diagnostics, &error);
    return shv_cli_end_loading(status, diagnostics, &error);
}

bool shv_cli_can_break(const ShvSimulation *simulation)
{
    bool can = false;
    for (int32_t i = 0; i < shv_simulation_material_count(simulation) && !can; i++)
        can = shv_simulation_material(simulation, i).breakable;
    return can;
}

int shv_cli_inspect(const ShvArguments *arguments, ShvInspection show)
{
    ShvScene *scene;
    const int loaded = shv_cli_load_scene(&scene, arguments);
    if (!scene) return loaded;
    ShvError error;
    ShvSimulation *simulation = NULL;
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(scene);
    ShvStatus status = shv_simulation_create(&simulation, shv_scene_definition(scene), &options, &error);
    if (status == SHV_OK) status = show(simulation, arguments, &error);
    shv_simulation_destroy(simulation);
    shv_scene_destroy(scene);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

ShvStatus shv_cli_warn_overlaps(const ShvSimulation *simulation, ShvError *error)
{
    ShvOverlap overlaps[16];
    const int32_t room = (int32_t)(sizeof overlaps / sizeof overlaps[0]);
    int32_t count;
    const ShvStatus status = shv_simulation_overlaps(simulation, overlaps, room, &count, error);
    if (status != SHV_OK) return status;
    for (int32_t i = 0; i < count && i < room; i++) {
        const ShvOverlap *o = &overlaps[i];
        fprintf(stderr, "warning: '%s' and the %s '%s' overlap at the start, %.3g m deep at (%.4g, %.4g, %.4g): %s\n",
                o->first, o->obstacle ? "obstacle" : "object", o->second, o->depth, o->point[0], o->point[1],
                o->point[2], shv_simulation_overlap_course(simulation, o));
    }
    if (count > room) fprintf(stderr, "warning: %d more pairs overlap at the start\n", (int)(count - room));
    return SHV_OK;
}

void shv_cli_tell_live(const ShvRunFile *file, const char *path)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (!info->live) return;
    fprintf(stderr, "note: '");
    shv_cli_print_plain(stderr, path);
    fprintf(stderr, "' is being written: these are its %lld frames so far, to %.6g s\n", (long long)info->frame_count,
            info->last_time);
}

void shv_cli_print_pieces(const int32_t pieces[3])
{
    printf("  pieces if a facet bonds down to 1, 10, 50 %% of its strength: %d, %d, %d\n", (int)pieces[0],
           (int)pieces[1], (int)pieces[2]);
}

/* Below this share of the strength, most loads that begin a crack drive it on wherever it points. */
static const double low_tip = 0.05;

static void print_tip(const ShvMaterialView *m)
{
    if (!(m->tip_strength < m->strength)) {
        printf("    ahead of cracks %.3g Pa would do, above the strength of %.3g Pa: this mesh needs no lower one\n",
               m->tip_strength, m->strength);
        return;
    }
    printf("    ahead of cracks %.3g Pa in place of the strength of %.3g Pa\n", m->tip_strength, m->strength);
    if (m->tip_strength < low_tip * m->strength)
        printf(
            "    warning: %.3g Pa is so far below %.3g Pa that cracks go on under nearly any load that begins one: on "
            "edges\n"
            "             this long it is a weaker material; use a finer mesh\n",
            m->tip_strength, m->strength);
}

/* Brittle materials bear ten times as much in compression as in tension; with less than this many times what is struck is crushed
   where it is struck, and that cushions the blow. */
static const double least_compressive = 4.0;

static void warn_of_crushing(const ShvMaterialView *m)
{
    const double times = m->compressive_strength / m->strength;
    if (!(times > 0.0 && times < least_compressive)) return;
    printf(
        "    warning: a column of it is crushed at %.3g Pa, %.2g times its strength in tension; brittle materials bear "
        "some\n"
        "             ten times as much: what is struck grinds to crumbs; give cohesive_strength_shear, half of the\n"
        "             strength in compression\n",
        m->compressive_strength, times);
}

void shv_cli_print_cohesion(const ShvMaterialView *m)
{
    if (!m->breakable) return;
    const bool resolved = m->mesh_edge <= m->resolved_edge;
    printf("  %s: strength %.4g Pa, G %.4g J/m²", m->name, m->strength, m->energy);
    if (m->strength < m->nominal_strength)
        printf(" (%s; %.4g Pa as given)", shv_unresolved_name(m->unresolved), m->nominal_strength);
    if (m->energy > m->nominal_energy)
        printf(" (%s; %.4g J/m² as given)", shv_unresolved_name(m->unresolved), m->nominal_energy);
    printf("; resolved up to edges of %.3g m as given, mean edge %.3g m: %s\n", m->resolved_edge, m->mesh_edge,
           resolved                                         ? "resolved"
           : m->unresolved == SHV_UNRESOLVED_SCALE_STRENGTH ? "UNDER-RESOLVED, strength lowered until it is"
           : m->unresolved == SHV_UNRESOLVED_SCALE_ENERGY   ? "UNDER-RESOLVED, energy raised until it is"
           : m->unresolved == SHV_UNRESOLVED_TIP_STRENGTH   ? "UNDER-RESOLVED, strength lowered ahead of cracks"
                                                            : "UNDER-RESOLVED, kept");
    if (!resolved && m->unresolved == SHV_UNRESOLVED_KEEP && m->tip_toughness > 1.0)
        printf("    a crack tip costs about %.2g G on this mesh; 'unresolved: tip_strength' lets cracks begin at the "
               "strength\n"
               "    and cost G (docs/glass.md)\n",
               m->tip_toughness);
    if (m->unresolved == SHV_UNRESOLVED_TIP_STRENGTH && m->tip_strength > 0.0) print_tip(m);
    warn_of_crushing(m);
}

void shv_cli_print_cohesion_json(const ShvMaterialView *m)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {
        {"mesh_edge", m->mesh_edge},         {"zone_edges", m->zone_edges},
        {"resolved_edge", m->resolved_edge}, {"nominal_strength", m->nominal_strength},
        {"strength", m->strength},           {"nominal_fracture_energy", m->nominal_energy},
        {"fracture_energy", m->energy},      {"tip_toughness", m->breakable ? m->tip_toughness : (double)NAN}};
    printf("\"resolved\": %s, \"unresolved\": \"%s\"",
           !m->breakable || m->mesh_edge <= m->resolved_edge ? "true" : "false", shv_unresolved_name(m->unresolved));
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        printf(", \"%s\": ", numbers[i].name);
        shv_cli_print_json_number(numbers[i].value);
    }
}

void shv_cli_print_materials(ShvMaterialList materials)
{
    for (int32_t i = 0; i < materials.count; i++) {
        const ShvMaterialView material = materials.get(materials.owner, i);
        shv_cli_print_cohesion(&material);
    }
}

void shv_cli_print_materials_json(ShvMaterialList materials)
{
    printf(", \"materials\": {");
    for (int32_t i = 0; i < materials.count; i++) {
        const ShvMaterialView material = materials.get(materials.owner, i);
        if (i > 0) printf(", ");
        shv_cli_print_json_text(material.name);
        printf(": {");
        shv_cli_print_cohesion_json(&material);
        printf("}");
    }
    printf("}");
}

void shv_cli_command_line(const ShvCommand *command, const ShvArguments *arguments, int first, int last, char *text,
                          size_t size)
{
    snprintf(text, size, "shiver %s", command->name);
    for (int i = 0; i < arguments->positional_count; i++) shv_append(text, size, "%s%s", " ", arguments->positional[i]);
    for (int i = 0; i < arguments->override_count; i++)
        shv_append(text, size, " %s '%s'", "--set", arguments->overrides[i]);
    for (int i = first; i <= last; i++)
        if (arguments->values[i]) shv_append(text, size, " %s %s", command->options[i].name, arguments->values[i]);
}

ShvStatus shv_cli_read_numbers(const char *text, const char *option, const char *what, double *values, int32_t most,
                               int32_t *count, ShvError *error)
{
    if (!text) return SHV_OK;
    *count = 0;
    for (const char *at = text;; at++) {
        char *end = NULL;
        if (*count == most) return shv_fail(error, SHV_BAD_INPUT, "%s takes at most %d values", option, (int)most);
        if (strspn(at, "0123456789.") > 0) values[(*count)++] = shv_text_to_double(at, &end);
        if (!end || (*end && *end != ',') || !isfinite(values[*count - 1]))
            return shv_fail(error, SHV_BAD_INPUT, "%s needs %s, not '%s'", option, what, text);
        if (!*end) return SHV_OK;
        at = end;
    }
}

ShvStatus shv_cli_every(const char *text, int32_t *every, ShvError *error)
{
    int64_t number = 0;
    if (!text) return SHV_OK;
    ShvError ignored;
    if (shv_parse_int64(text, strlen(text), &number, &ignored) == SHV_OK && number >= 1 && number <= INT32_MAX) {
        *every = (int32_t)number;
        return SHV_OK;
    }
    return shv_fail(error, SHV_BAD_INPUT, "--every takes a whole number from 1 on; '%s' is none", text);
}
