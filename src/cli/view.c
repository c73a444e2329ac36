#include "cli/command.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "cli/elasticity.h"
#include "shiver/view.h"

enum { OUTPUT, TWO, EVERY, FORCE };

static ShvStatus write_page(const ShvArguments *arguments, const char *path, ShvRunFile *const files[2], int32_t count,
                            ShvError *error)
{
    ShvViewOptions options = shv_view_default();
    options.force = arguments->values[FORCE] != NULL;
    SHV_TRY(shv_cli_every(arguments->values[EVERY], &options.every, error));
    ShvElasticity *elasticity[2] = {NULL, NULL};
    ShvViewRun runs[2];
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < count && status == SHV_OK; i++) {
        status = shv_cli_elasticity(files[i], &elasticity[i], error);
        runs[i] = (ShvViewRun){files[i], elasticity[i], shv_cli_made_convex_pieces(files[i])};
    }
    if (status == SHV_OK) status = shv_view_write(runs, count, path, &options, error);
    for (int32_t i = 0; i < 2; i++) shv_release(elasticity[i]);
    return status;
}

static int run(const ShvArguments *arguments)
{
    char path[SHV_CLI_PATH];
    ShvError error;
    ShvRunFile *files[2] = {NULL, NULL};
    const char *const names[2] = {arguments->positional[0], arguments->values[TWO]};
    const int32_t count = names[1] ? 2 : 1;
    ShvStatus status = arguments->values[OUTPUT] ? shv_cli_path(path, &error, "%s", arguments->values[OUTPUT])
                                                 : shv_cli_default_path(path, names[0], true, ".html", &error);
    for (int32_t i = 0; i < count && status == SHV_OK; i++) {
        status = shv_cli_keep_input(path, names[i], &error);
        if (status == SHV_OK) status = shv_run_file_open(&files[i], names[i], NULL, &error);
        if (status == SHV_OK) shv_cli_tell_live(files[i], names[i]);
    }
    if (status == SHV_OK) status = write_page(arguments, path, files, count, &error);
    for (int32_t i = 0; i < 2; i++) shv_run_file_close(files[i]);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    struct stat written;
    const double megabytes = stat(path, &written) == 0 ? 1e-6 * (double)written.st_size : 0.0;
    printf("wrote %s, %.2f MB: open it in a browser\n", path, megabytes);
    return SHV_EXIT_DONE;
}

const ShvCommand shv_command_view = {
    .name = "view",
    .positional = "RUNFILE",
    .summary = "write a run file as a page that a browser plays",
    .details =
        "Writes one HTML file that any browser of the last years opens from the disk; it needs no network and no\n"
        "other file. Colours by piece, mode, age, speed, mass and, where the run recorded nodes, damage and stress;\n"
        "ledger, pieces and cost as curves; ? on the page lists the keys. docs/viewing.md tells more.",
    .least_positional = 1,
    .most_positional = 1,
    .options = {{"--output", "FILE", "name of the page; the run file's name with .html unless given"},
                {"--two", "RUNFILE", "a second run, beside the first and on the same clock"},
                {"--every", "N", "only every N-th frame and the last: for runs of very many"},
                {"--force", NULL, "replace an existing file"}},
    .run = run,
};
