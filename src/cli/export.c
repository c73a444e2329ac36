#include "cli/command.h"

#include <stdio.h>
#include <string.h>

#include "shiver/export.h"

enum { OUTPUT, FORCE, ANIMATION };

static void default_prefix(const char *path, char *prefix, size_t size)
{
    const char *dot = strrchr(path, '.');
    const char *slash = strrchr(path, '/');
    const int length = dot && (!slash || dot > slash) ? (int)(dot - path) : (int)strlen(path);
    snprintf(prefix, size, "%.*s", length, path);
}

static ShvStatus export_as(const char *format, ShvRunFile *file, const char *prefix, const ShvExportOptions *options,
                           ShvError *error)
{
    if (strcmp(format, "csv") == 0) return shv_export_csv(file, prefix, options, error);
    if (strcmp(format, "xdmf") == 0) return shv_export_xdmf(file, prefix, options, error);
    return shv_fail(error, SHV_BAD_INPUT, "there is no format '%s'; give csv or xdmf", format);
}

static int run(const ShvArguments *arguments)
{
    char prefix[4096];
    ShvError error;
    ShvRunFile *file = NULL;
    ShvExportOptions options = shv_export_default();
    options.force = arguments->values[FORCE] != NULL;
    options.animation = arguments->values[ANIMATION] != NULL;
    if (arguments->values[OUTPUT])
        snprintf(prefix, sizeof prefix, "%s", arguments->values[OUTPUT]);
    else
        default_prefix(arguments->positional[1], prefix, sizeof prefix);
    ShvStatus status = shv_run_file_open(&file, arguments->positional[1], NULL, &error);
    if (status == SHV_OK) status = export_as(arguments->positional[0], file, prefix, &options, &error);
    shv_run_file_close(file);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    printf("wrote %s_*\n", prefix);
    return SHV_EXIT_DONE;
}

const ShvCommand shv_command_export = {
    .name = "export",
    .positional = "csv|xdmf RUNFILE",
    .summary = "write a run file as tables (csv) or for ParaView (xdmf)",
    .details = "csv: PREFIX_trajectories.csv, _genealogy.csv, _ledger.csv, _events.csv.\n"
               "xdmf: PREFIX_fragments.xmf and PREFIX_mesh.xmf for ParaView, with their numbers in PREFIX_xdmf.h5.",
    .least_positional = 2,
    .most_positional = 2,
    .options = {{"--output", "PREFIX", "beginning of the file names; the run file's name without .h5 unless given"},
                {"--force", NULL, "replace existing files"},
                {"--animation", NULL, "only frames on the animation grid"}},
    .run = run,
};
