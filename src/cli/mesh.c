#include "cli/command.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "base/file.h"
#include "base/publish.h"
#include "cli/programs.h"
#include "mesh/generate.h"
#include "mesh/surface.h"

enum { EDGE, OUTPUT, FORCE, JSON, SCRIPT };

/* Files of one call, in a folder of its own that is removed at the end. */
typedef struct Workshop {
    char folder[SHV_CLI_PATH], script[SHV_CLI_PATH], surface[SHV_CLI_PATH], input[SHV_CLI_PATH], output[SHV_CLI_PATH];
    double edge;
} Workshop;

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

/* ---- what may be meshed ---- */

static bool has_extension(const char *path, const char *extension)
{
    const char *dot = strrchr(path, '.');
    return dot && strcasecmp(dot, extension) == 0;
}

static bool is_surface(const char *path)
{
    return has_extension(path, ".stl") || has_extension(path, ".obj") || has_extension(path, ".ply");
}

/* gmsh takes a file whose ending it does not know, and so also one in mixed case, for a script of its own, and such a script
   may run any command. */
static bool is_cad(const char *path)
{
    static const char *const endings[] = {".step", ".STEP", ".stp", ".STP",  ".iges",
                                          ".IGES", ".igs",  ".IGS", ".brep", ".BREP"};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof endings / sizeof endings[0]; i++)
        if (strcmp(dot, endings[i]) == 0) return true;
    return false;
}

static ShvStatus check_kind(const char *path, bool script, ShvError *error)
{
    if (is_surface(path) || is_cad(path) || (script && has_extension(path, ".geo"))) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "%s is neither a surface (.stl, .obj, .ply) nor CAD (.step, .stp, .iges, .igs, .brep)%s", path,
                    has_extension(path, ".geo")
                        ? "; a .geo script can run any command on this machine: --script lets it, if you trust it"
                        : "");
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

/* A tet of equal edges has the volume edge³/(6√2). */
static ShvStatus check_count(const ShvSurface *surface, double edge, ShvError *error)
{
    const double volume = shv_surface_mass(surface).mass, tets = volume * 6.0 * sqrt(2.0) / (edge * edge * edge);
    if (tets <= SHV_MESH_LARGEST) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "--edge %g would make about %.2g tets, and a mesh can hold %.3g; choose an edge of at least %.2g",
                    edge, tets, (double)SHV_MESH_LARGEST, edge * cbrt(tets / SHV_MESH_LARGEST));
}

static ShvStatus convert_surface(const Workshop *workshop, ShvError *error)
{
    ShvSurface surface;
    SHV_TRY(shv_surface_read(&surface, NULL, SHV_PART_MESH, workshop->input, 1.0, error));
    ShvStatus status = shv_surface_require_closed(&surface, workshop->input, error);
    if (status == SHV_OK) status = check_count(&surface, workshop->edge, error);
    if (status == SHV_OK) status = write_stl(workshop->surface, &surface, error);
    shv_surface_release(&surface);
    return status;
}

static ShvStatus write_script(const Workshop *workshop, ShvError *error)
{
    FILE *file = fopen(workshop->script, "w");
    if (!file) return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", workshop->script, strerror(errno));
    if (is_surface(workshop->input)) {
        /* The triangles are cut into patches at sharp edges and parametrised, so that they can be remeshed at the size asked. */
        fprintf(file, "Merge \"%s\";\nClassifySurfaces{40*Pi/180, 1, 1, Pi};\nCreateGeometry;\n", workshop->surface);
        fprintf(file, "s() = Surface{:};\nSurface Loop(1) = s();\nVolume(1) = {1};\n");
    } else {
        fprintf(file, "Merge \"%s\";\n", workshop->input);
    }
    fprintf(file, "Mesh.CharacteristicLengthMin = %.17g;\nMesh.CharacteristicLengthMax = %.17g;\n", workshop->edge,
            workshop->edge);
    fprintf(
        file,
        "Mesh.CharacteristicLengthFromPoints = 0;\nMesh.Optimize = 1;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 1;\n");
    if (fclose(file) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", workshop->script, strerror(errno));
    return SHV_OK;
}

/* ---- gmsh ---- */

/* In the child: gmsh ends with its parent, and runs into its own limit of memory before the machine's. */
static void become_gmsh(const Workshop *workshop, const char *output)
{
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    if (pages > 0 && size > 0) {
        const rlim_t most = (rlim_t)pages / 4 * 3 * (rlim_t)size;
        setrlimit(RLIMIT_AS, &(struct rlimit){most, most});
    }
    execlp("gmsh", "gmsh", "-3", "-v", "1", "-format", "msh41", workshop->script, "-o", output, (char *)NULL);
    fprintf(stderr, "shiver: cannot start gmsh: %s\n", strerror(errno));
    _exit(127);
}

static ShvStatus call_gmsh(const Workshop *workshop, const char *output, ShvError *error)
{
    fflush(NULL);
    const pid_t child = fork();
    if (child < 0) return shv_fail(error, SHV_FILE_ERROR, "cannot start gmsh: %s", strerror(errno));
    if (child == 0) become_gmsh(workshop, output);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        if (interrupted) kill(child, SIGKILL);
    if (interrupted) return shv_fail(error, SHV_INTERRUPTED, "stopped");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
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

static ShvStatus mesh_to(const Workshop *workshop, const char *temporary, bool json, ShvError *error)
{
    ShvMesh mesh;
    SHV_TRY(call_gmsh(workshop, temporary, error));
    SHV_TRY(shv_mesh_read_gmsh(&mesh, NULL, temporary, error));
    const ShvStatus status = shv_mesh_validate(&mesh, workshop->output, error);
    if (status == SHV_OK) report(workshop->output, &mesh, json);
    shv_mesh_release(&mesh);
    return status;
}

/* An existing mesh is replaced only by one that has been read back. */
static ShvStatus make(const Workshop *workshop, bool force, bool json, ShvError *error)
{
    char *temporary = NULL;
    int descriptor;
    if (is_surface(workshop->input)) SHV_TRY(convert_surface(workshop, error));
    SHV_TRY(write_script(workshop, error));
    SHV_TRY(shv_publish_begin(NULL, workshop->output, &temporary, &descriptor, error));
    ShvStatus status = mesh_to(workshop, temporary, json, error);
    if (status == SHV_OK) status = shv_publish_end(temporary, descriptor, workshop->output, force, error);
    if (status != SHV_OK) unlink(temporary);
    close(descriptor);
    shv_release(temporary);
    return status;
}

/* ---- the command ---- */

static ShvStatus read_edge(const char *text, double *edge, ShvError *error)
{
    if (!text) return shv_fail(error, SHV_BAD_INPUT, "give the edge length: --edge 0.005 (in the file's units)");
    if (shv_parse_double(text, strlen(text), false, edge, NULL) == SHV_OK && *edge > 0.0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "--edge must be a positive number, not '%s'", text);
}

/* gmsh takes names in a script as relative to the script: it gets the whole path. */
static ShvStatus find_input(Workshop *workshop, const char *path, ShvError *error)
{
    char folder[SHV_CLI_PATH];
    if (strpbrk(path, "\"\\\n"))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the name %s holds a quote, a backslash or a line break, which gmsh cannot read; "
                        "rename the file",
                        path);
    if (access(path, R_OK) != 0 || !getcwd(folder, sizeof folder))
        return shv_fail(error, SHV_FILE_ERROR, "cannot read %s: %s", path, strerror(errno));
    return path[0] == '/' ? shv_cli_path(workshop->input, error, "%s", path)
                          : shv_cli_path(workshop->input, error, "%s/%s", folder, path);
}

static ShvStatus check_input(Workshop *workshop, const ShvArguments *arguments, ShvError *error)
{
    const char *path = arguments->positional[0], *output = arguments->values[OUTPUT];
    SHV_TRY(read_edge(arguments->values[EDGE], &workshop->edge, error));
    SHV_TRY(find_input(workshop, path, error));
    SHV_TRY(check_kind(path, arguments->values[SCRIPT] != NULL, error));
    if (output)
        SHV_TRY(shv_cli_path(workshop->output, error, "%s", output));
    else
        SHV_TRY(shv_cli_default_path(workshop->output, path, true, ".msh", error));
    SHV_TRY(shv_cli_keep_input(workshop->output, path, error));
    SHV_TRY(shv_publish_check(workshop->output, arguments->values[FORCE] != NULL, error));
    if (!shv_on_path("gmsh"))
        return shv_fail(error, SHV_UNSUPPORTED,
                        "gmsh is not on the PATH; install it (Debian, Ubuntu: apt-get install gmsh) and try again");
    return SHV_OK;
}

static ShvStatus open_workshop(Workshop *workshop, ShvError *error)
{
    const char *temporary = getenv("TMPDIR");
    SHV_TRY(shv_cli_path(workshop->folder, error, "%s/shiver-XXXXXX", temporary && *temporary ? temporary : "/tmp"));
    if (!mkdtemp(workshop->folder))
        return shv_fail(error, SHV_FILE_ERROR, "cannot make a temporary folder like %s: %s", workshop->folder,
                        strerror(errno));
    SHV_TRY(shv_cli_path(workshop->script, error, "%s/mesh.geo", workshop->folder));
    return shv_cli_path(workshop->surface, error, "%s/surface.stl", workshop->folder);
}

static int run(const ShvArguments *arguments)
{
    ShvError error;
    Workshop workshop;
    ShvStatus status = check_input(&workshop, arguments, &error);
    if (status == SHV_OK) status = open_workshop(&workshop, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    shv_interrupt_waiting(on_signal); /* gmsh is ended */
    status = make(&workshop, arguments->values[FORCE] != NULL, arguments->values[JSON] != NULL, &error);
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
        "Fills a closed triangle surface (STL, OBJ, PLY) or a CAD file that gmsh reads (STEP, IGES, BREP) with\n"
        "tets of about the given edge length, and reports their quality. The file it writes is named in a scene\n"
        "as mesh: {gmsh: {file: …}}. A .geo script of gmsh needs --script, since it may run any command.",
    .least_positional = 1,
    .most_positional = 1,
    .options = {{"--edge", "LENGTH", "target edge length, in the units of the file (required)"},
                {"--output", "FILE", "the mesh to write; SURFACE with the ending .msh unless given"},
                {"--force", NULL, "replace an existing file"},
                {"--json", NULL, "report as JSON"},
                {"--script", NULL, "take a .geo script, too, and let it do what it says"}},
    .run = run,
};
