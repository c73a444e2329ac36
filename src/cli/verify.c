#include "cli/command.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

enum { FULL, JSON, HTML, MARKDOWN, FOLDER, FORCE };

static const char ending[] = ".case.yaml";

/* ---- running ---- */

typedef struct Work {
    const ShvArguments *arguments;
    ShvVerification **made;
    const ShvVerifyCase **cases;
    int32_t count;
    bool told; /* what is wrong with a case has been printed */
} Work;

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), wanted = strlen(end);
    return length > wanted && strcmp(text + length - wanted, end) == 0;
}

static int is_case(const struct dirent *entry)
{
    return ends_with(entry->d_name, ending);
}

static ShvStatus find_folder(const ShvArguments *arguments, char folder[SHV_CLI_PATH], ShvError *error)
{
    const char *given = arguments->values[FOLDER];
    return given ? shv_cli_path(folder, error, "%s", given) : shv_cli_scenes(folder, "verification", error);
}

/* A case is named by its file, or by the name of a file in the folder. */
static ShvStatus find_case(const ShvArguments *arguments, const char *name, char path[SHV_CLI_PATH], ShvError *error)
{
    char folder[SHV_CLI_PATH];
    const bool file = strchr(name, '/') || ends_with(name, ".yaml");
    if (!file) SHV_TRY(find_folder(arguments, folder, error));
    SHV_TRY(file ? shv_cli_path(path, error, "%s", name) : shv_cli_path(path, error, "%s/%s%s", folder, name, ending));
    if (access(path, R_OK) == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "there is no case '%s' (the file %s cannot be read)", name, path);
}

static ShvStatus run_case(Work *work, const char *path, ShvError *error)
{
    ShvDiagnostics *diagnostics = NULL;
    ShvVerifyOptions options = shv_verify_default();
    options.full = work->arguments->values[FULL] != NULL;
    options.short_set = !options.full && work->arguments->positional_count == 0;
    ShvVerification *made = NULL;
    const ShvStatus status = shv_verify_run(&made, path, &options, &diagnostics, error);
    work->told = shv_cli_print_faults(diagnostics);
    shv_diagnostics_destroy(diagnostics);
    if (status != SHV_OK || !made) return status;
    work->made[work->count] = made;
    work->cases[work->count] = shv_verification_case(made);
    if (!work->arguments->values[JSON]) shv_verify_print(work->cases[work->count], stdout);
    fflush(stdout);
    work->count++;
    return SHV_OK;
}

static ShvStatus run_cases(Work *work, const char *folder, struct dirent **entries, int count, ShvError *error)
{
    const ShvArguments *arguments = work->arguments;
    char path[SHV_CLI_PATH];
    work->made = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof *work->made);
    work->cases = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof *work->cases);
    if (!work->made || !work->cases) return shv_fail_memory(error, "cases", (size_t)count * 16);
    /* All that are named must be there before the first is run. */
    for (int i = 0; i < count && !entries; i++) SHV_TRY(find_case(arguments, arguments->positional[i], path, error));
    for (int i = 0; i < count; i++) {
        SHV_TRY(entries ? shv_cli_path(path, error, "%s/%s", folder, entries[i]->d_name)
                        : find_case(arguments, arguments->positional[i], path, error));
        SHV_TRY(run_case(work, path, error));
    }
    return SHV_OK;
}

static ShvStatus run_all(Work *work, ShvError *error)
{
    char folder[SHV_CLI_PATH];
    struct dirent **entries = NULL;
    if (work->arguments->positional_count > 0)
        return run_cases(work, NULL, NULL, work->arguments->positional_count, error);
    SHV_TRY(find_folder(work->arguments, folder, error));
    const int count = scandir(folder, &entries, is_case, alphasort);
    if (count < 0)
        return shv_fail(error, SHV_BAD_INPUT, "the folder '%s' cannot be read; give the folder of cases with --folder",
                        folder);
    const ShvStatus status = count > 0
                                 ? run_cases(work, folder, entries, count, error)
                                 : shv_fail(error, SHV_BAD_INPUT, "the folder '%s' has no files *%s", folder, ending);
    for (int i = 0; i < count; i++) free(entries[i]);
    free(entries);
    return status;
}

static ShvStatus write_pages(const Work *work, ShvError *error)
{
    const bool force = work->arguments->values[FORCE] != NULL;
    const char *html = work->arguments->values[HTML], *markdown = work->arguments->values[MARKDOWN];
    if (html) SHV_TRY(shv_verify_write(html, true, force, work->cases, work->count, error));
    if (markdown) SHV_TRY(shv_verify_write(markdown, false, force, work->cases, work->count, error));
    if (!work->arguments->json && (html || markdown))
        printf("wrote %s%s%s\n", html ? html : "", html && markdown ? " and " : "", markdown ? markdown : "");
    return SHV_OK;
}

static int32_t finish(const Work *work)
{
    const ShvVerifyCase sum = shv_verify_sum(work->cases, work->count);
    if (work->arguments->values[JSON])
        shv_verify_print_json(work->cases, work->count, stdout);
    else
        printf("%d cases: %d pass, %d miss with an explanation, %d miss without one; %.1f s\n", (int)work->count,
               (int)sum.passes, (int)sum.explained, (int)sum.misses, sum.seconds);
    return sum.misses;
}

static int run(const ShvArguments *arguments)
{
    Work work = {.arguments = arguments};
    ShvError error;
    ShvStatus status = run_all(&work, &error);
    if (status == SHV_OK) status = write_pages(&work, &error);
    int exit_status = SHV_EXIT_DONE;
    if (status == SHV_BAD_INPUT && work.told)
        exit_status = SHV_EXIT_INPUT;
    else if (status != SHV_OK)
        exit_status = shv_cli_failed(status, &error);
    else if (finish(&work) > 0)
        exit_status = SHV_EXIT_MISSED;
    for (int32_t i = 0; i < work.count; i++) shv_verify_destroy(work.made[i]);
    shv_release(work.made);
    shv_release(work.cases);
    return exit_status;
}

int shv_cli_verify_folder(const ShvArguments *arguments, const char *folder, bool full, const char *markdown)
{
    ShvArguments own = *arguments;
    own.positional_count = 0;
    for (int i = 0; i < SHV_MOST_OPTIONS; i++) own.values[i] = NULL;
    own.values[FOLDER] = folder;
    own.values[FULL] = full ? "--full" : NULL;
    own.values[JSON] = arguments->json ? "--json" : NULL;
    own.values[FORCE] = arguments->force ? "--force" : NULL;
    own.values[MARKDOWN] = markdown;
    return run(&own);
}

const ShvCommand shv_command_verify = {
    .name = "verify",
    .positional = "[CASE …]",
    .summary = "run scenes whose outcome is known and compare",
    .details = "Runs verification cases and prints each quantity beside its reference: pass, or miss. A CASE is a "
               "file, or the\n"
               "name of one in the folder without .case.yaml. Without CASE: those of the short set. Exit status 1 when "
               "a quantity\n"
               "misses without an explanation. scenes/verification/README.md tells how a case is written.",
    .least_positional = 0,
    .most_positional = SHV_MOST_POSITIONAL,
    .first_input = SHV_MOST_POSITIONAL,
    .options = {{"--full", NULL, "all cases with all their runs"},
                {"--json", NULL, "print as JSON"},
                {"--html", "FILE", "also write a page of HTML"},
                {"--markdown", "FILE", "also write the tables as Markdown"},
                {"--folder", "DIR", "where the cases are; scenes/verification unless given, here or as installed"},
                {"--force", NULL, "replace existing files"}},
    .run = run,
};
