#include "cli/command.h"

#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "mesh/generate.h"
#include "mesh/surface.h"

extern char **environ;

enum { EDGE, OUTPUT, FORCE, JSON };

/* Files of one call, in a folder of its own that is removed at the end. */
typedef struct Workshop {
    char folder[2048], script[2080], surface[2080];
} Workshop;

static bool has_extension(const char *path, const char *extension)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, extension) == 0;
}

static bool is_surface(const char *path)
{
    return has_extension(path, ".stl") || has_extension(path, ".obj") || has_extension(path, ".ply");
}

static bool gmsh_on_path(void)
{
    const char *path = getenv("PATH");
    char candidate[4096];
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        if (length + 6 < sizeof candidate) {
            snprintf(candidate, sizeof candidate, "%.*s/gmsh", (int)length, path);
            if (access(candidate, X_OK) == 0) return true;
        }
        path += length + (path[length] == ':');
    }
    return false;
}

/* gmsh reads STL alone of the three surface formats: every closed surface goes to it as checked ASCII STL. */
static ShvStatus write_stl(const char *path, const ShvSurface *surface, ShvError *error)
{
    FILE *file = fopen(path, "w");
    if (!file) return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", path, strerror(errno));
    fprintf(file, "solid s\n");
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        fprintf(file, "facet normal 0 0 0\nouter loop\n");
        for (int i = 0; i < 3; i++) {
            const double *x = surface->positions + 3 * (int64_t)surface->triangles[3 * (int64_t)t + i];
            fprintf(file, "vertex %.17g %.17g %.17g\n", x[0], x[1], x[2]);
        }
        fprintf(file, "endloop\nendfacet\n");
    }
    fprintf(file, "endsolid s\n");
    if (fclose(file) != 0) return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", path, strerror(errno));
    return SHV_OK;
}

static ShvStatus convert_surface(const char *input, const char *stl, ShvError *error)
{
    ShvSurface surface;
    SHV_TRY(shv_surface_read(&surface, NULL, SHV_PART_MESH, input, 1.0, error));
    ShvStatus status = shv_surface_require_closed(&surface, input, error);
    if (status == SHV_OK) status = write_stl(stl, &surface, error);
    shv_surface_release(&surface);
    return status;
}

static ShvStatus write_script(const Workshop *workshop, const char *input, double edge, ShvError *error)
{
    FILE *file = fopen(workshop->script, "w");
    if (!file) return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", workshop->script, strerror(errno));
    if (is_surface(input)) {
        /* The triangles are cut into patches at sharp edges and parametrised, so that they can be remeshed at the size asked. */
        fprintf(file, "Merge \"%s\";\nClassifySurfaces{40*Pi/180, 1, 1, Pi};\nCreateGeometry;\n", workshop->surface);
        fprintf(file, "s() = Surface{:};\nSurface Loop(1) = s();\nVolume(1) = {1};\n");
    } else {
        fprintf(file, "Merge \"%s\";\n", input);
    }
    fprintf(file, "Mesh.CharacteristicLengthMin = %.17g;\nMesh.CharacteristicLengthMax = %.17g;\n", edge, edge);
    fprintf(
        file,
        "Mesh.CharacteristicLengthFromPoints = 0;\nMesh.Optimize = 1;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 1;\n");
    if (fclose(file) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", workshop->script, strerror(errno));
    return SHV_OK;
}

static ShvStatus call_gmsh(const Workshop *workshop, const char *output, ShvError *error)
{
    char *arguments[] = {(char[]){"gmsh"},
                         (char[]){"-3"},
                         (char[]){"-v"},
                         (char[]){"1"},
                         (char *)(uintptr_t)workshop->script,
                         (char[]){"-o"},
                         (char *)(uintptr_t)output,
                         NULL};
    pid_t child = 0;
    const int failure = posix_spawnp(&child, "gmsh", NULL, NULL, arguments, environ);
    if (failure != 0) return shv_fail(error, SHV_FILE_ERROR, "cannot start gmsh: %s", strerror(failure));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || access(output, R_OK) != 0)
        return shv_fail(error, SHV_FILE_ERROR,
                        "gmsh could not mesh it; its messages are above. Try another --edge, or mend the surface");
    return SHV_OK;
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
    printf("%s: %d tets, %d nodes, volume %.6g m³\n", output, (int)quality.element_count, (int)quality.node_count,
           quality.volume);
    printf("edges %.4g … %.4g … %.4g m (shortest, mean, longest); smallest altitude %.4g m (tet %d)\n",
           quality.shortest_edge, quality.mean_edge, quality.longest_edge, quality.smallest_altitude,
           (int)quality.smallest_altitude_element);
    printf("3 × inradius/circumradius: worst %.3f (tet %d), mean %.3f; dihedral angles %.1f … %.1f degrees\n",
           quality.worst_aspect, (int)quality.worst_element, quality.mean_aspect, quality.smallest_dihedral,
           quality.largest_dihedral);
}

static ShvStatus make(const Workshop *workshop, const char *input, double edge, const char *output, bool json,
                      ShvError *error)
{
    if (is_surface(input)) SHV_TRY(convert_surface(input, workshop->surface, error));
    SHV_TRY(write_script(workshop, input, edge, error));
    SHV_TRY(call_gmsh(workshop, output, error));
    ShvMesh mesh;
    SHV_TRY(shv_mesh_read_gmsh(&mesh, NULL, output, error));
    const ShvStatus status = shv_mesh_validate(&mesh, output, error);
    if (status == SHV_OK) report(output, &mesh, json);
    shv_mesh_release(&mesh);
    return status;
}

static ShvStatus check_input(const ShvArguments *arguments, double *edge, char output[4096], char input[4096],
                             ShvError *error)
{
    const char *path = arguments->positional[0];
    if (!arguments->values[EDGE])
        return shv_fail(error, SHV_BAD_INPUT, "give the edge length: --edge 0.005 (in the file's units)");
    const char *text = arguments->values[EDGE];
    if (shv_parse_double(text, strlen(text), false, edge, NULL) != SHV_OK || !(*edge > 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "--edge must be a positive number, not '%s'", text);
    if (strpbrk(path, "\"\\\n"))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the name %s holds a quote, a backslash or a line break, which gmsh cannot read; "
                        "rename the file",
                        path);
    /* gmsh takes names in a script as relative to the script: give it the whole path. */
    char folder[2048];
    if (access(path, R_OK) != 0 || !getcwd(folder, sizeof folder))
        return shv_fail(error, SHV_FILE_ERROR, "cannot read %s: %s", path, strerror(errno));
    snprintf(input, 4096, "%s%s%s", path[0] == '/' ? "" : folder, path[0] == '/' ? "" : "/", path);
    if (arguments->values[OUTPUT]) {
        snprintf(output, 4096, "%s", arguments->values[OUTPUT]);
    } else {
        const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
        if (slash && dot < slash) dot = NULL;
        snprintf(output, 4096, "%.*s.msh", dot ? (int)(dot - path) : (int)strlen(path), path);
    }
    if (access(output, F_OK) == 0 && !arguments->values[FORCE])
        return shv_fail(error, SHV_BAD_INPUT, "%s exists; --force replaces it, --output names another", output);
    if (!gmsh_on_path())
        return shv_fail(error, SHV_UNSUPPORTED,
                        "gmsh is not on the PATH; install it (Debian, Ubuntu: apt-get install gmsh) and try again");
    return SHV_OK;
}

static int run(const ShvArguments *arguments)
{
    ShvError error;
    double edge = 0.0;
    char output[4096], input[4096];
    ShvStatus status = check_input(arguments, &edge, output, input, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    const char *temporary = getenv("TMPDIR");
    Workshop workshop;
    snprintf(workshop.folder, sizeof workshop.folder, "%.2000s/shiver-XXXXXX",
             temporary && *temporary ? temporary : "/tmp");
    if (!mkdtemp(workshop.folder)) {
        fprintf(stderr, "shiver: cannot make a temporary folder like %s: %s\n", workshop.folder, strerror(errno));
        return SHV_EXIT_FAILED;
    }
    snprintf(workshop.script, sizeof workshop.script, "%s/mesh.geo", workshop.folder);
    snprintf(workshop.surface, sizeof workshop.surface, "%s/surface.stl", workshop.folder);
    status = make(&workshop, input, edge, output, arguments->values[JSON] != NULL, &error);
    unlink(workshop.script);
    unlink(workshop.surface);
    rmdir(workshop.folder);
    return status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
}

const ShvCommand shv_command_mesh = {
    .name = "mesh",
    .positional = "SURFACE",
    .summary = "fill a closed surface or a CAD file with tets (calls gmsh)",
    .details =
        "Fills a closed triangle surface (STL, OBJ, PLY) or a CAD file that gmsh reads (STEP, IGES, .geo) with\n"
        "tets of about the given edge length, and reports their quality. The file it writes is named in a scene\n"
        "as mesh: {gmsh: {file: …}}.",
    .least_positional = 1,
    .most_positional = 1,
    .options = {{"--edge", "LENGTH", "target edge length, in the units of the file (required)"},
                {"--output", "FILE", "the mesh to write; SURFACE with the ending .msh unless given"},
                {"--force", NULL, "replace an existing file"},
                {"--json", NULL, "report as JSON"}},
    .run = run,
};
