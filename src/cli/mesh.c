#include "cli/command.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/publish.h"
#include "cli/programs.h"
#include "mesh/fill.h"
#include "mesh/generate.h"

enum { EDGE, OUTPUT, FORCE, JSON, SCRIPT };

typedef struct Job {
    const char *input;
    char output[SHV_CLI_PATH];
    double edge;
    bool force, json;
} Job;

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

/* A name of other than letters, digits and '_' needs quotes in YAML; one with a quote of its own goes by its number. */
static void print_group(const ShvMeshGroup *group)
{
    const bool quote = strchr(group->name, '"') || strchr(group->name, '\\');
    if (quote)
        printf("      - {name: %d, material: stoneware}\n", (int)group->tag);
    else
        printf("      - {name: \"%s\", material: stoneware}\n", group->name);
}

/* The lines of a scene that name the new mesh; a body of more than a few metres was most likely drawn in millimetres. */
static void print_object(const char *output, const ShvMesh *mesh)
{
    const double most_likely_metres = 5.0;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, size = 0.0;
    for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) {
        low[i % 3] = fmin(low[i % 3], mesh->positions[i]);
        high[i % 3] = fmax(high[i % 3], mesh->positions[i]);
    }
    for (int k = 0; k < 3; k++) size = fmax(size, high[k] - low[k]);
    const char *scale = size > most_likely_metres ? ", scale: 0.001" : "";
    printf("\nobjects:\n  body:\n    mesh: {gmsh: {file: %s%s, improve: true}}   # improves its worst tets, which set "
           "the time step\n    material: stoneware\n",
           output, scale);
    if (mesh->group_count > 0) printf("    groups:   # physical volumes; material is that of the rest\n");
    for (int32_t i = 0; i < mesh->group_count; i++) print_group(&mesh->groups[i]);
    printf("    position: [0, 0, %.4g]\n", 0.0 - low[2] * (*scale ? 0.001 : 1.0));
    if (*scale)
        printf("# It is %.4g units long: scale 0.001 takes them for millimetres. A scene is in metres.\n", size);
}

static void report(const char *output, const ShvMesh *mesh, bool json)
{
    const ShvMeshQuality quality = shv_mesh_quality(mesh);
    if (json) {
        printf("{\"file\": ");
        shv_cli_print_json_text(output);
        printf(", \"tets\": %d, \"nodes\": %d, \"volume\": %.17g, \"mean_edge\": %.17g, \"shortest_edge\": %.17g, "
               "\"longest_edge\": %.17g, \"worst_aspect\": %.17g, \"smallest_dihedral\": %.17g}\n",
               (int)quality.element_count, (int)quality.node_count, quality.volume, quality.mean_edge,
               quality.shortest_edge, quality.longest_edge, quality.worst_aspect, quality.smallest_dihedral);
        return;
    }
    printf("%s, in the units of the surface: %d tets, %d nodes, volume %.6g\n", output, (int)quality.element_count,
           (int)quality.node_count, quality.volume);
    printf("edges %.4g … %.4g … %.4g (shortest, mean, longest); smallest altitude %.4g (tet %d)\n",
           quality.shortest_edge, quality.mean_edge, quality.longest_edge, quality.smallest_altitude,
           (int)quality.smallest_altitude_element);
    printf("3 × inradius/circumradius: worst %.3f (tet %d), mean %.3f; dihedral angles %.1f … %.1f degrees\n",
           quality.worst_aspect, (int)quality.worst_element, quality.mean_aspect, quality.smallest_dihedral,
           quality.largest_dihedral);
    print_object(output, mesh);
}

static ShvStatus read_back(const Job *job, const char *path, ShvError *error)
{
    ShvMesh mesh;
    SHV_TRY(shv_mesh_read_gmsh(&mesh, NULL, path, error));
    const ShvStatus status = shv_mesh_validate(&mesh, job->output, error);
    if (status == SHV_OK) report(job->output, &mesh, job->json);
    shv_mesh_release(&mesh);
    return status;
}

/* An existing mesh is replaced only by one that has been read back. */
static ShvStatus mesh_to(const Job *job, const char *unfinished, int descriptor, ShvError *error)
{
    ShvTemporary place;
    SHV_TRY(shv_temporary_open(&place, unfinished, error));
    ShvStatus status = shv_fill_file(job->input, job->edge, &place, unfinished, &interrupted, error);
    if (status == SHV_OK) status = read_back(job, unfinished, error);
    if (status == SHV_OK) status = shv_publish_end(unfinished, descriptor, job->output, job->force, error);
    shv_temporary_close(&place);
    return status;
}

static ShvStatus make(const Job *job, ShvError *error)
{
    char *unfinished = NULL;
    int descriptor;
    SHV_TRY(shv_publish_begin(NULL, job->output, &unfinished, &descriptor, error));
    const ShvStatus status = mesh_to(job, unfinished, descriptor, error);
    if (status != SHV_OK) unlink(unfinished);
    close(descriptor);
    shv_release(unfinished);
    return status;
}

/* ---- the command ---- */

static ShvStatus read_edge(const char *text, double *edge, ShvError *error)
{
    if (!text) return shv_fail(error, SHV_BAD_INPUT, "give the edge length: --edge 0.005 (in the file's units)");
    if (shv_parse_double(text, strlen(text), false, edge, NULL) == SHV_OK && *edge > 0.0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "--edge must be a positive number, not '%s'", text);
}

static ShvStatus check_input(Job *job, const ShvArguments *arguments, ShvError *error)
{
    const char *path = arguments->positional[0], *output = arguments->values[OUTPUT];
    *job = (Job){.input = path, .force = arguments->values[FORCE] != NULL, .json = arguments->values[JSON] != NULL};
    SHV_TRY(read_edge(arguments->values[EDGE], &job->edge, error));
    if (access(path, R_OK) != 0) return shv_fail(error, SHV_FILE_ERROR, "cannot read %s: %s", path, strerror(errno));
    SHV_TRY(shv_fill_check(path, arguments->values[SCRIPT] != NULL, error));
    if (output)
        SHV_TRY(shv_cli_path(job->output, error, "%s", output));
    else
        SHV_TRY(shv_cli_default_path(job->output, path, true, ".msh", error));
    SHV_TRY(shv_cli_keep_input(job->output, path, error));
    return shv_publish_check(job->output, job->force, error);
}

static int run(const ShvArguments *arguments)
{
    ShvError error;
    Job job;
    ShvStatus status = check_input(&job, arguments, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    shv_interrupt_waiting(on_signal); /* gmsh is ended */
    status = make(&job, &error);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

const ShvCommand shv_command_mesh = {
    .name = "mesh",
    .positional = "SURFACE",
    .summary = "fill a closed surface or a CAD file with tets (calls gmsh)",
    .details =
        "Fills a closed triangle surface (STL, OBJ, PLY) or a CAD file that gmsh reads (STEP, IGES, BREP) with\n"
        "tets of about the given edge length, and reports their quality and the lines of a scene that name the new\n"
        "file. A scene may also name the surface itself: mesh: {stl: {file: …, edge: …}}. A .geo\n"
        "script of gmsh needs --script, since it may run any command.",
    .least_positional = 1,
    .most_positional = 1,
    .options = {{"--edge", "LENGTH", "target edge length, in the units of the file (required)"},
                {"--output", "FILE", "the mesh to write; SURFACE with the ending .msh unless given"},
                {"--force", NULL, "replace an existing file"},
                {"--json", NULL, "report as JSON"},
                {"--script", NULL, "take a .geo script, too, and let it do what it says"}},
    .run = run,
};
