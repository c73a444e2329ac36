#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"
#include "shiver/export.h"

enum { OUTPUT, FORCE, ANIMATION, FRAMES, TIME, SIZE, IN_VIEW };

enum { MOST_PANELS = 24 };

/* ---- pictures ---- */

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

/* The first plane of the scene the run was made from. A scene that can no longer be read is drawn without. */
static void find_floor(const ShvRunFileInfo *info, ShvSvgOptions *options)
{
    const char *overrides[SHV_MOST_OVERRIDES];
    int32_t count = 0;
    ShvError ignored;
    ShvScene *scene = NULL;
    char *lines = shv_copy_text(NULL, SHV_PART_GENERAL, info->overrides), *rest = lines;
    for (char *line = lines ? strtok_r(lines, "\n", &rest) : NULL; line && count < SHV_MOST_OVERRIDES;
         line = strtok_r(NULL, "\n", &rest))
        overrides[count++] = line;
    if (lines && shv_scene_parse(&scene, info->scene_text, strlen(info->scene_text), info->scene_name, NULL, overrides,
                                 count, NULL, NULL, &ignored) == SHV_OK) {
        const ShvSceneDefinition *definition = shv_scene_definition(scene);
        for (int32_t i = 0; i < definition->obstacle_count && !options->floor; i++) {
            const ShvObstacleDefinition *obstacle = &definition->obstacles[i];
            if (obstacle->shape != SHV_OBSTACLE_PLANE) continue;
            options->floor = true;
            memcpy(options->floor_normal, obstacle->plane_normal, sizeof options->floor_normal);
            options->floor_offset = obstacle->plane_offset;
        }
    }
    shv_scene_destroy(scene);
    shv_release(lines);
}

static ShvStatus read_frames(const char *text, int64_t *frames, ShvSvgOptions *options, ShvError *error)
{
    double values[MOST_PANELS];
    SHV_TRY(read_numbers("--frames", text, values, &options->frame_count, error));
    for (int32_t i = 0; i < options->frame_count; i++) {
        if (!(fabs(values[i]) < 1e15) || floor(values[i]) != values[i])
            return shv_fail(error, SHV_BAD_INPUT, "--frames needs whole numbers; the first frame is 0");
        frames[i] = (int64_t)values[i];
    }
    options->frames = frames;
    return SHV_OK;
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

static ShvStatus export_svg(ShvRunFile *file, const char *prefix, const ShvArguments *arguments, ShvError *error)
{
    int64_t frames[MOST_PANELS];
    double times[MOST_PANELS], size = 0.0;
    ShvSvgOptions options = shv_svg_default();
    options.force = arguments->values[FORCE] != NULL;
    options.times = times;
    if (arguments->values[ANIMATION])
        return shv_fail(error, SHV_BAD_INPUT,
                        "--animation does not go with svg; choose frames with --frames or --time");
    if (arguments->values[FRAMES]) SHV_TRY(read_frames(arguments->values[FRAMES], frames, &options, error));
    if (arguments->values[TIME])
        SHV_TRY(read_numbers("--time", arguments->values[TIME], times, &options.time_count, error));
    if (arguments->values[IN_VIEW])
        SHV_TRY(read_single("--in-view", arguments->values[IN_VIEW], &options.mass_in_view, error));
    if (arguments->values[SIZE]) {
        SHV_TRY(read_single("--size", arguments->values[SIZE], &size, error));
        options.size = size >= 0.0 && size <= 1e6 ? (int32_t)size : -1;
    }
    find_floor(shv_run_file_info(file), &options);
    return shv_export_svg(file, prefix, &options, error);
}

/* ---- all formats ---- */

static ShvStatus export_as(const char *format, ShvRunFile *file, const char *prefix, const ShvArguments *arguments,
                           ShvError *error)
{
    ShvExportOptions options = shv_export_default();
    options.force = arguments->values[FORCE] != NULL;
    options.animation = arguments->values[ANIMATION] != NULL;
    if (strcmp(format, "svg") == 0) return export_svg(file, prefix, arguments, error);
    for (int i = FRAMES; i <= IN_VIEW; i++)
        if (arguments->values[i])
            return shv_fail(error, SHV_BAD_INPUT, "%s goes with svg only", shv_command_export.options[i].name);
    if (strcmp(format, "csv") == 0) return shv_export_csv(file, prefix, &options, error);
    if (strcmp(format, "xdmf") == 0) return shv_export_xdmf(file, prefix, &options, error);
    return shv_fail(error, SHV_BAD_INPUT, "there is no format '%s'; give csv, xdmf or svg", format);
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
    ShvRunFile *file = NULL;
    ShvStatus status = arguments->values[OUTPUT]
                           ? shv_cli_path(prefix, &error, "%s", arguments->values[OUTPUT])
                           : shv_cli_default_path(prefix, arguments->positional[1], true, "", &error);
    if (status == SHV_OK) status = keep_run_file(prefix, arguments->positional[1], &error);
    if (status == SHV_OK) status = shv_run_file_open(&file, arguments->positional[1], NULL, &error);
    if (status == SHV_OK) status = export_as(arguments->positional[0], file, prefix, arguments, &error);
    shv_run_file_close(file);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    printf("wrote %s%s\n", prefix, strcmp(arguments->positional[0], "svg") == 0 ? ".svg" : "_*");
    return SHV_EXIT_DONE;
}

const ShvCommand shv_command_export = {
    .name = "export",
    .positional = "csv|xdmf|svg RUNFILE",
    .summary = "write a run file as tables (csv), for ParaView (xdmf) or as a picture (svg)",
    .details = "csv: PREFIX_trajectories.csv, _genealogy.csv, _ledger.csv, _events.csv, _obstacles.csv; with\n"
               "probes _probes.csv.\n"
               "xdmf: PREFIX_fragments.xmf and PREFIX_mesh.xmf for ParaView, with their numbers in PREFIX_xdmf.h5.\n"
               "svg: PREFIX.svg, frames side by side; each fragment has a colour, the largest is of stone.",
    .least_positional = 2,
    .most_positional = 2,
    .options = {{"--output", "PREFIX", "beginning of the file names; the run file's name without .h5 unless given"},
                {"--force", NULL, "replace existing files"},
                {"--animation", NULL, "csv, xdmf: only frames on the animation grid"},
                {"--frames", "A,B,…", "svg: numbers of the frames to draw, from 0; four over the run unless given"},
                {"--time", "A,B,…", "svg: times of the frames to draw instead, s"},
                {"--size", "PIXELS", "svg: width of the picture; 1200 unless given"},
                {"--in-view", "SHARE", "svg: share of the mass around which the frame is drawn; 0.98 unless given"}},
    .run = run,
};
