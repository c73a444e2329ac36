#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "cli/elasticity.h"
#include "cli/pictures.h"
#include "shiver/export.h"

enum { OUTPUT, FORCE, ANIMATION, EVERY, FRAMES, TIME, SIZE, COLOUR, LASTS, STRETCH };

enum { MOST_PANELS = 24, PICTURE_WIDTH = 1280, LAST = 10 }; /* pixels; s */

/* What an export is asked for. */
typedef struct Request {
    ShvRunFile *file;
    const char *prefix;
    const char *const *values; /* of the options */
    double frames[MOST_PANELS], times[MOST_PANELS];
    int32_t frame_count, time_count;
    double size, lasts; /* 0: not given */
    int32_t every;
} Request;

typedef struct Format {
    const char *name, *result; /* what is written, behind the prefix */
    const char *ending;        /* of its files, or of that which is opened */
    const char *options; /* letters of those it takes: animation, every, frames, time, size, colour, lasts, stretch */
    ShvStatus (*write)(const Request *request, ShvError *error);
} Format;

/* ---- options ---- */

/* Numbers between commas; SHV_BAD_INPUT for anything else. */
static ShvStatus read_numbers(const char *option, const char *text, double *values, int32_t *count, ShvError *error)
{
    for (*count = 0; *count < MOST_PANELS; text++) {
        char *end;
        if (strspn(text, "0123456789.+-") == 0)
            return shv_fail(error, SHV_BAD_INPUT, "%s needs numbers separated by commas, such as 0.1,0.2", option);
        values[(*count)++] = shv_text_to_double(text, &end);
        if (end == text || (*end && *end != ','))
            return shv_fail(error, SHV_BAD_INPUT, "%s needs numbers separated by commas; '%s' is none", option, text);
        text = end;
        if (!*text) return SHV_OK;
    }
    return shv_fail(error, SHV_BAD_INPUT, "%s takes at most %d numbers", option, (int)MOST_PANELS);
}

static ShvStatus read_single(const char *option, const char *text, double *value, ShvError *error)
{
    double values[MOST_PANELS];
    int32_t count;
    SHV_TRY(read_numbers(option, text, values, &count, error));
    if (count != 1) return shv_fail(error, SHV_BAD_INPUT, "%s takes one number", option);
    *value = values[0];
    return SHV_OK;
}

static ShvStatus read_options(Request *request, ShvError *error)
{
    const char *const *values = request->values;
    SHV_TRY(shv_cli_every(values[EVERY], &request->every, error));
    if (values[FRAMES])
        SHV_TRY(read_numbers("--frames", values[FRAMES], request->frames, &request->frame_count, error));
    for (int32_t i = 0; i < request->frame_count; i++)
        if (!(fabs(request->frames[i]) < 1e15) || floor(request->frames[i]) != request->frames[i])
            return shv_fail(error, SHV_BAD_INPUT, "--frames needs whole numbers; the first frame is 0");
    if (values[TIME]) SHV_TRY(read_numbers("--time", values[TIME], request->times, &request->time_count, error));
    if (values[SIZE]) {
        SHV_TRY(read_single("--size", values[SIZE], &request->size, error));
        if (!(request->size >= 1.0 && request->size <= 1e6))
            return shv_fail(error, SHV_BAD_INPUT, "--size is a number of pixels; %s is none", values[SIZE]);
    }
    return values[LASTS] ? read_single("--lasts", values[LASTS], &request->lasts, error) : SHV_OK;
}

/* ---- formats ---- */

typedef ShvStatus (*Export)(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

static ShvStatus export_with(const Request *request, Export write, const ShvElasticity *elasticity, ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = request->values[FORCE] != NULL;
    options.animation = request->values[ANIMATION] != NULL;
    options.every = request->every;
    options.elasticity = elasticity;
    return write(request->file, request->prefix, &options, error);
}

static ShvStatus write_csv(const Request *request, ShvError *error)
{
    return export_with(request, shv_export_csv, NULL, error);
}

static ShvStatus write_xdmf(const Request *request, ShvError *error)
{
    return export_with(request, shv_export_xdmf, NULL, error);
}

static ShvStatus write_vtk(const Request *request, ShvError *error)
{
    ShvElasticity *elasticity = NULL;
    SHV_TRY(shv_cli_elasticity(request->file, &elasticity, error));
    const ShvStatus status = export_with(request, shv_export_vtk, elasticity, error);
    shv_release(elasticity);
    return status;
}

static ShvStatus write_gltf(const Request *request, ShvError *error)
{
    return export_with(request, shv_export_gltf, NULL, error);
}

static ShvStatus write_usd(const Request *request, ShvError *error)
{
    return export_with(request, shv_export_usd, NULL, error);
}

static ShvStatus write_svg(const Request *request, ShvError *error)
{
    int64_t frames[MOST_PANELS];
    ShvSvgOptions options = shv_svg_default();
    for (int32_t i = 0; i < request->frame_count; i++) frames[i] = (int64_t)request->frames[i];
    options.force = request->values[FORCE] != NULL;
    options.frames = frames;
    options.frame_count = request->frame_count;
    options.times = request->times;
    options.time_count = request->time_count;
    if (request->size > 0.0) options.size = (int32_t)request->size;
    return shv_export_svg(request->file, request->prefix, &options, error);
}

static ShvPictures pictures_of(const Request *request)
{
    return (ShvPictures){.prefix = request->prefix,
                         .force = request->values[FORCE] != NULL,
                         .stretch = request->values[STRETCH] != NULL,
                         .colour = request->values[COLOUR],
                         .every = request->every,
                         .frames = request->frames,
                         .times = request->times,
                         .frame_count = request->frame_count,
                         .time_count = request->time_count,
                         .width = request->size > 0.0 ? (int32_t)request->size : (int32_t)PICTURE_WIDTH,
                         .lasts = request->values[LASTS] ? request->lasts : (double)LAST};
}

static ShvStatus write_png(const Request *request, ShvError *error)
{
    const ShvPictures pictures = pictures_of(request);
    return shv_write_png(request->file, &pictures, error);
}

static ShvStatus write_mp4(const Request *request, ShvError *error)
{
    const ShvPictures pictures = pictures_of(request);
    return shv_write_film(request->file, &pictures, false, error);
}

static ShvStatus write_webp(const Request *request, ShvError *error)
{
    const ShvPictures pictures = pictures_of(request);
    return shv_write_film(request->file, &pictures, true, error);
}

static const Format FORMATS[] = {
    {"csv", "_*", ".csv", "ae", write_csv},         {"xdmf", "_*", ".xmf", "ae", write_xdmf},
    {"vtk", ".pvd", ".pvd", "ae", write_vtk},       {"gltf", ".glb", ".glb", "ae", write_gltf},
    {"usd", ".usda", ".usda", "ae", write_usd},     {"svg", ".svg", ".svg", "fts", write_svg},
    {"png", "_*.png", ".png", "ftsc", write_png},   {"mp4", ".mp4", ".mp4", "esclx", write_mp4},
    {"webp", ".webp", ".webp", "esclx", write_webp}};
enum { FORMAT_COUNT = sizeof FORMATS / sizeof FORMATS[0] };

static ShvStatus find_format(const char *name, const char *const *values, const Format **format, ShvError *error)
{
    static const char letters[] = "aeftsclx";
    for (int i = 0; i < FORMAT_COUNT; i++) {
        if (strcmp(FORMATS[i].name, name) != 0) continue;
        *format = &FORMATS[i];
        for (int k = ANIMATION; k <= STRETCH; k++)
            if (values[k] && !strchr(FORMATS[i].options, letters[k - ANIMATION]))
                return shv_fail(error, SHV_BAD_INPUT, "%s does not go with %s", shv_command_export.options[k].name,
                                name);
        return SHV_OK;
    }
    return shv_fail(error, SHV_BAD_INPUT,
                    "there is no format '%s'; give csv, xdmf, vtk, gltf, usd, svg, png, mp4 or webp", name);
}

static bool drop_end(char *text, const char *end)
{
    const size_t length = strlen(text), size = strlen(end);
    const bool ends = length >= size && strcmp(text + length - size, end) == 0;
    if (ends) text[length - size] = '\0';
    return ends;
}

/* A name that already ends as the format's files do, or in the format's name, does not get its ending twice. */
static void drop_ending(char *prefix, const Format *format)
{
    char dotted[8];
    snprintf(dotted, sizeof dotted, ".%s", format->name);
    if (!drop_end(prefix, format->ending)) drop_end(prefix, dotted);
}

/* One name of an export may be that of a run file. */
static ShvStatus keep_run_file(const char *prefix, const char *input, ShvError *error)
{
    char path[SHV_CLI_PATH];
    const ShvStatus status = shv_cli_path(path, error, "%s_xdmf.h5", prefix);
    return status == SHV_OK ? shv_cli_keep_input(path, input, error) : status;
}

static int run(const ShvArguments *arguments)
{
    char prefix[SHV_CLI_PATH];
    ShvError error;
    const Format *format = NULL;
    Request request = {.prefix = prefix, .values = arguments->values, .every = 1};
    ShvStatus status = arguments->values[OUTPUT]
                           ? shv_cli_path(prefix, &error, "%s", arguments->values[OUTPUT])
                           : shv_cli_default_path(prefix, arguments->positional[1], true, "", &error);
    if (status == SHV_OK) status = find_format(arguments->positional[0], arguments->values, &format, &error);
    if (status == SHV_OK && arguments->values[OUTPUT]) drop_ending(prefix, format);
    if (status == SHV_OK) status = read_options(&request, &error);
    if (status == SHV_OK) status = keep_run_file(prefix, arguments->positional[1], &error);
    if (status == SHV_OK) status = shv_run_file_open(&request.file, arguments->positional[1], NULL, &error);
    if (status == SHV_OK) shv_cli_tell_live(request.file, arguments->positional[1]);
    if (status == SHV_OK) status = format->write(&request, &error);
    shv_run_file_close(request.file);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    printf("wrote %s%s\n", prefix, format->result);
    return SHV_EXIT_DONE;
}

const ShvCommand shv_command_export = {
    .name = "export",
    .positional = "csv|xdmf|vtk|gltf|usd|svg|png|mp4|webp RUNFILE",
    .summary = "write a run file as tables, for other programs, or as pictures and films",
    .details =
        "Metres, seconds, z up and right-handed axes unless said otherwise. Pieces are named by their line of "
        "descent.\n\n"
        "PREFIX may end as the format's files do, or in the format's name: x.svg and x make the same x.svg, x.glb,\n"
        "x.gltf and x the same x.glb, x.png and x the same x_NNNNNN.png.\n\n"
        "  csv   PREFIX_trajectories.csv with Houdini's names (P, orient as w, x, y, z, v, w), _genealogy, _ledger, "
        "_events,\n"
        "        _obstacles, with probes _probes; shapes of the pieces as PREFIX_pieces.obj. Opens in: spreadsheets, "
        "pandas,\n"
        "        Houdini (Table Import), and the shapes in any 3D program\n"
        "  xdmf  PREFIX_mesh.xmf, _fragments.xmf (orientation as w, x, y, z), _obstacles.xmf, numbers in _xdmf.h5. "
        "Opens in:\n"
        "        ParaView (any of its XDMF readers; from Python give an absolute name)\n"
        "  vtk   PREFIX.pvd with the times, PREFIX_NNNNNN.vtu and _obstacles_NNNNNN.vtu. Opens in: ParaView, VTK, "
        "PyVista\n"
        "  gltf  PREFIX.glb; a node turns z up to glTF's y up; rotations x, y, z, w. Opens in: Blender, Houdini, "
        "ParaView,\n"
        "        three.js, Windows and Apple viewers through converters\n"
        "  usd   PREFIX.usda; z up, metres; orientations w, x, y, z. Opens in: usdview, Houdini, Omniverse, Maya, "
        "Unreal,\n"
        "        Blender (official builds)\n"
        "  svg   PREFIX.svg, frames side by side. Opens in: browsers\n"
        "  png   PREFIX_NNNNNN.png, one a frame; drawn by `shiver view` in Chromium (Debian's package chromium)\n"
        "  mp4   PREFIX.mp4, H.264; webp: PREFIX.webp, a small moving picture for pages; takes ffmpeg, too",
    .least_positional = 2,
    .most_positional = 2,
    .first_input = 1,
    .options = {{"--output", "PREFIX", "beginning of the file names; the run file's name without .h5 unless given"},
                {"--force", NULL, "replace existing files"},
                {"--animation", NULL, "csv, xdmf, vtk, gltf, usd: only frames on the animation grid"},
                {"--every", "N", "all but svg, png: only every N-th frame and the last: for runs of very many"},
                {"--frames", "A,B,…",
                 "svg, png: numbers of the frames, from 0; svg: four over the run unless given, png: all"},
                {"--time", "A,B,…", "svg, png: times of the frames instead, s"},
                {"--size", "PIXELS", "svg, png, mp4, webp: width of the picture; 1200 and 1280 unless given"},
                {"--colour", "NAME",
                 "png, mp4, webp: piece, mode, age, speed, mass, damage or stress; piece unless given"},
                {"--lasts", "SECONDS", "mp4, webp: how long it takes on the screen; 10 unless given"},
                {"--stretch", NULL, "mp4, webp: every frame of the run gets the same time on the screen"}},
    .run = run,
};
