#include "mesh/fill.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"
#include "mesh/generate.h"
#include "mesh/surface.h"

enum { LONGEST_PATH = SHV_TEMPORARY_PATH, LONGEST_COMPLAINT = 300, NO_PROGRAM = 127 };
enum { NAP = 5 * 1000 * 1000 }; /* ns between looks at gmsh */

/* Files of one call. */
typedef struct Workshop {
    const ShvTemporary *place;
    char script[LONGEST_PATH], surface[LONGEST_PATH], log[LONGEST_PATH], input[LONGEST_PATH];
    double edge; /* in the units of the file */
} Workshop;

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

ShvStatus shv_fill_check(const char *path, bool script, ShvError *error)
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
    return shv_fail(
        error, SHV_BAD_INPUT,
        "%g as edge length would make about %.2g tets, and a mesh can hold %.3g; choose an edge of at least %.2g", edge,
        tets, (double)SHV_MESH_LARGEST, edge * cbrt(tets / SHV_MESH_LARGEST));
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
    /* HXT (10) leaves the fewest slivers; the worst of its tets are bettered when the mesh is read (worst_tets.c). */
    fprintf(file, "Mesh.CharacteristicLengthFromPoints = 0;\nMesh.Algorithm3D = 10;\n");
    fprintf(file, "Mesh.Optimize = 1;\nMesh.OptimizeThreshold = 0.6;\nMesh.MshFileVersion = 4.1;\nMesh.Binary = 1;\n");
    if (fclose(file) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "cannot write %s: %s", workshop->script, strerror(errno));
    return SHV_OK;
}

/* ---- gmsh ---- */

/* In the child: gmsh runs into its own limit of memory before the machine's. */
static void become_gmsh(const Workshop *workshop, const char *output)
{
    shv_temporary_join(workshop->place);
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    if (pages > 0 && size > 0) {
        const rlim_t most = (rlim_t)pages / 4 * 3 * (rlim_t)size;
        setrlimit(RLIMIT_AS, &(struct rlimit){most, most});
    }
    const int log = open(workshop->log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (log >= 0) {
        dup2(log, STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
    }
    execlp("gmsh", "gmsh", "-3", "-v", "1", "-format", "msh41", workshop->script, "-o", output, (char *)NULL);
    _exit(NO_PROGRAM);
}

/* What gmsh said first, without its own mark of an error. */
static ShvStatus complain(const Workshop *workshop, ShvError *error)
{
    char text[LONGEST_COMPLAINT] = "";
    FILE *log = fopen(workshop->log, "r");
    if (log && !fgets(text, sizeof text, log)) text[0] = '\0';
    if (log) fclose(log);
    text[strcspn(text, "\r\n")] = '\0';
    const char *said = strncmp(text, "Error   : ", 10) == 0 ? text + 10 : text;
    return shv_fail(error, SHV_FILE_ERROR, "gmsh could not mesh %s%s%s: try another edge length, or mend the surface",
                    workshop->input, *said ? "; it says: " : "", said);
}

/* A signal may come at any moment, also just before a wait without end. */
static int wait_for(pid_t child, const volatile sig_atomic_t *interrupted)
{
    int status = 0;
    const struct timespec nap = {0, NAP};
    while (waitpid(child, &status, WNOHANG) == 0) {
        if (interrupted && *interrupted) kill(child, SIGKILL);
        nanosleep(&nap, NULL);
    }
    return status;
}

static ShvStatus call_gmsh(const Workshop *workshop, const char *output, const volatile sig_atomic_t *interrupted,
                           ShvError *error)
{
    fflush(NULL);
    const pid_t child = fork();
    if (child < 0) return shv_fail(error, SHV_FILE_ERROR, "cannot start gmsh: %s", strerror(errno));
    if (child == 0) become_gmsh(workshop, output);
    const int status = wait_for(child, interrupted);
    shv_temporary_end(workshop->place, child);
    if (interrupted && *interrupted) return shv_fail(error, SHV_INTERRUPTED, "stopped");
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return SHV_OK;
    if (WIFEXITED(status) && WEXITSTATUS(status) == NO_PROGRAM)
        return shv_fail(error, SHV_UNSUPPORTED,
                        "gmsh, which fills surfaces, is not on the PATH; install it (Debian, Ubuntu: apt-get install "
                        "gmsh) and try again");
    return complain(workshop, error);
}

/* ---- one call ---- */

static ShvStatus put_path(char *path, const char *folder, const char *name, ShvError *error)
{
    const int length = shv_format(path, LONGEST_PATH, "%s%s%s", folder, *folder ? "/" : "", name);
    if (length >= 0 && length < LONGEST_PATH - 1) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the name %s/%s is longer than %d characters", folder, name, LONGEST_PATH);
}

/* gmsh takes names in a script as relative to the script: it gets the whole path. */
static ShvStatus find_input(Workshop *workshop, const char *path, ShvError *error)
{
    char folder[LONGEST_PATH] = "";
    if (strpbrk(path, "\"\\\n"))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the name %s holds a quote, a backslash or a line break, which gmsh cannot read; "
                        "rename the file",
                        path);
    if (access(path, R_OK) != 0 || (path[0] != '/' && !getcwd(folder, sizeof folder)))
        return shv_fail(error, SHV_FILE_ERROR, "cannot read %s: %s", path, strerror(errno));
    return put_path(workshop->input, folder, path, error);
}

static ShvStatus open_workshop(Workshop *workshop, const ShvTemporary *place, ShvError *error)
{
    workshop->place = place;
    SHV_TRY(put_path(workshop->script, place->folder, "mesh.geo", error));
    SHV_TRY(put_path(workshop->log, place->folder, "log", error));
    return put_path(workshop->surface, place->folder, "surface.stl", error);
}

ShvStatus shv_fill_file(const char *input, double edge, const ShvTemporary *place, const char *output,
                        const volatile sig_atomic_t *interrupted, ShvError *error)
{
    Workshop workshop = {.edge = edge};
    SHV_TRY(find_input(&workshop, input, error));
    SHV_TRY(open_workshop(&workshop, place, error));
    if (is_surface(workshop.input)) SHV_TRY(convert_surface(&workshop, error));
    SHV_TRY(write_script(&workshop, error));
    return call_gmsh(&workshop, output, interrupted, error);
}

static ShvStatus fill_in(const ShvTemporary *place, ShvMesh *mesh, ShvMemory *memory,
                         const ShvMeshDefinition *definition, const char *path, ShvError *error)
{
    char output[LONGEST_PATH];
    SHV_TRY(put_path(output, place->folder, "filled.msh", error));
    SHV_TRY(shv_fill_file(path, definition->edge / definition->scale, place, output, NULL, error));
    return shv_mesh_read_gmsh(mesh, memory, output, error);
}

ShvStatus shv_mesh_fill(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                        ShvError *error)
{
    ShvTemporary place;
    SHV_TRY(shv_fill_check(path, false, error));
    SHV_TRY(shv_temporary_open(&place, NULL, error));
    const ShvStatus status = fill_in(&place, mesh, memory, definition, path, error);
    shv_temporary_close(&place);
    return status;
}
