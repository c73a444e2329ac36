#include "cli/command.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/text.h"
#include "cli/verify.h"

enum { FULL, JSON, HTML, MARKDOWN, FOLDER, FORCE };

static const char ending[] = ".case.yaml";

/* ---- which cases ---- */

typedef struct Paths {
    char **items;
    int32_t count, capacity;
} Paths;

static ShvStatus add_path(Paths *paths, const char *folder, const char *name, const char *with, ShvError *error)
{
    char path[SHV_CLI_PATH];
    if (paths->count == paths->capacity) {
        const size_t capacity = 2 * (size_t)paths->capacity + 16;
        char **grown = shv_reallocate(NULL, SHV_PART_GENERAL, paths->items, capacity, sizeof *grown);
        if (!grown) return shv_fail_memory(error, "the list of cases", capacity * sizeof *grown);
        paths->items = grown;
        paths->capacity = (int32_t)capacity;
    }
    if (shv_format(path, sizeof path, "%s%s%s%s", folder, folder[0] ? "/" : "", name, with) >= (int)sizeof path)
        return shv_fail(error, SHV_BAD_INPUT, "the name of case '%.80s…' is too long", name);
    char *copy = shv_copy_text(NULL, SHV_PART_GENERAL, path);
    if (!copy) return shv_fail_memory(error, "the list of cases", strlen(path));
    paths->items[paths->count++] = copy;
    return SHV_OK;
}

static void release_paths(Paths *paths)
{
    for (int32_t i = 0; i < paths->count; i++) shv_release(paths->items[i]);
    shv_release(paths->items);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool ends_with(const char *text, const char *end)
{
    const size_t length = strlen(text), wanted = strlen(end);
    return length > wanted && strcmp(text + length - wanted, end) == 0;
}

static ShvStatus list_folder(Paths *paths, const char *folder, ShvError *error)
{
    DIR *stream = opendir(folder);
    ShvStatus status = SHV_OK;
    if (!stream)
        return shv_fail(error, SHV_BAD_INPUT, "the folder '%s' cannot be read; give the folder of cases with --folder",
                        folder);
    for (struct dirent *entry = readdir(stream); entry && status == SHV_OK; entry = readdir(stream))
        if (ends_with(entry->d_name, ending)) status = add_path(paths, folder, entry->d_name, "", error);
    closedir(stream);
    if (status == SHV_OK && paths->count == 0)
        return shv_fail(error, SHV_BAD_INPUT, "the folder '%s' has no files *%s", folder, ending);
    if (status == SHV_OK) qsort(paths->items, (size_t)paths->count, sizeof *paths->items, by_name);
    return status;
}

static ShvStatus find_folder(const ShvArguments *arguments, char folder[SHV_CLI_PATH], ShvError *error)
{
    const char *given = arguments->values[FOLDER];
    return given ? shv_cli_path(folder, error, "%s", given) : shv_cli_scenes(folder, "verification", error);
}

/* A case is named by its file, or by the name of a file in the folder. */
static ShvStatus list_cases(const ShvArguments *arguments, Paths *paths, ShvError *error)
{
    char folder[SHV_CLI_PATH] = "";
    if (arguments->positional_count == 0) {
        SHV_TRY(find_folder(arguments, folder, error));
        return list_folder(paths, folder, error);
    }
    for (int i = 0; i < arguments->positional_count; i++) {
        const char *name = arguments->positional[i];
        const bool file = strchr(name, '/') || ends_with(name, ".yaml");
        if (!file) SHV_TRY(find_folder(arguments, folder, error));
        SHV_TRY(add_path(paths, file ? "" : folder, name, file ? "" : ending, error));
        if (access(paths->items[i], R_OK) != 0)
            return shv_fail(error, SHV_BAD_INPUT, "there is no case '%s' (the file %s cannot be read)", name,
                            paths->items[i]);
    }
    return SHV_OK;
}

/* ---- text ---- */

static void print_row(const ShvVerifyRow *row)
{
    const double scale = row->absolute ? 1.0 : 100.0;
    const char *percent = row->absolute ? "" : " %", *verdict = shv_verdict_name(row->verdict);
    printf("  %s%s%s%s: ", row->quantity, row->run[0] ? " (" : "", row->run, row->run[0] ? ")" : "");
    if (row->verdict == SHV_VERDICT_FAILED) {
        printf("FAILED: %s\n", row->note);
        return;
    }
    if (!isnan(row->value) || !isnan(row->reference))
        printf("%.6g%s%s", row->value, row->unit[0] ? " " : "", row->unit);
    if (!isnan(row->reference))
        printf(", reference %s%.6g, error %+.3g%s", shv_verify_relation(row), row->reference, scale * row->error,
               percent);
    if (row->verdict == SHV_VERDICT_SHOWN) {
        printf("\n");
        return;
    }
    if (!isnan(row->tolerance)) printf(", tolerance %.3g%s: ", scale * row->tolerance, percent);
    printf("%s\n", row->verdict == SHV_VERDICT_MISS ? "MISS" : verdict);
    if (row->note[0]) printf("    %s\n", row->note);
}

static void print_case(const ShvVerifyCase *verified)
{
    printf("%s: %s (%.2f s)\n", verified->name, verified->title, verified->seconds);
    for (int32_t i = 0; i < verified->row_count; i++) print_row(&verified->rows[i]);
    fflush(stdout);
}

/* ---- JSON ---- */

static void print_member(const char *name, const char *text)
{
    printf(", \"%s\": ", name);
    shv_cli_print_json_text(text);
}

static void print_number(const char *name, double value)
{
    printf(", \"%s\": ", name);
    shv_cli_print_json_number(value);
}

static void print_json_row(const ShvVerifyCase *verified, const ShvVerifyRow *row, bool comma)
{
    static const char *const comparisons[] = {"near", "below", "above", "shown"};
    printf("%s\n  {\"case\": ", comma ? "," : "");
    shv_cli_print_json_text(verified->name);
    print_member("quantity", row->quantity);
    print_member("run", row->run);
    print_member("unit", row->unit);
    print_member("compare", comparisons[row->compare]);
    print_number("reference", row->reference);
    print_number("value", row->value);
    print_number("error", row->error);
    print_number("tolerance", row->tolerance);
    printf(", \"absolute\": %s", row->absolute ? "true" : "false");
    print_member("verdict", shv_verdict_name(row->verdict));
    print_number("seconds", row->seconds);
    print_member("source", row->source);
    print_member("note", row->note);
    printf("}");
}

static void print_json(const ShvVerifyCase *const *cases, int32_t count)
{
    bool comma = false;
    printf("[");
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = 0; k < cases[i]->row_count; k++) {
            print_json_row(cases[i], &cases[i]->rows[k], comma);
            comma = true;
        }
    printf("\n]\n");
}

/* ---- running ---- */

typedef struct Work {
    const ShvArguments *arguments;
    Paths paths;
    ShvVerification **made; /* per path; NULL: left out */
    const ShvVerifyCase **cases;
    int32_t count;
    bool told; /* what is wrong with a case has been printed */
} Work;

static ShvStatus run_case(Work *work, int32_t index, ShvError *error)
{
    const char *path = work->paths.items[index];
    const bool named = work->arguments->positional_count > 0;
    ShvDiagnostics *diagnostics = NULL;
    ShvVerifyOptions options = shv_verify_default();
    options.full = work->arguments->values[FULL] != NULL;
    bool wanted = options.full || named;
    ShvStatus status = SHV_OK;
    if (!wanted) status = shv_verify_in_short_set(path, &wanted, &diagnostics, error);
    if (status == SHV_OK && wanted) {
        shv_diagnostics_destroy(diagnostics);
        status = shv_verify_run(&work->made[index], path, &options, &diagnostics, error);
    }
    work->told = shv_cli_print_faults(diagnostics);
    shv_diagnostics_destroy(diagnostics);
    if (status != SHV_OK || !wanted) return status;
    const ShvVerifyCase *verified = work->cases[work->count++] = shv_verification_case(work->made[index]);
    if (!work->arguments->values[JSON]) print_case(verified);
    return SHV_OK;
}

static ShvStatus run_cases(Work *work, ShvError *error)
{
    ShvStatus status = list_cases(work->arguments, &work->paths, error);
    if (status != SHV_OK) return status;
    const size_t count = (size_t)work->paths.count;
    work->made = shv_allocate(NULL, SHV_PART_GENERAL, count, sizeof *work->made);
    work->cases = shv_allocate(NULL, SHV_PART_GENERAL, count, sizeof *work->cases);
    if (!work->made || !work->cases) return shv_fail_memory(error, "cases", count * 16);
    for (int32_t i = 0; i < work->paths.count && status == SHV_OK; i++) status = run_case(work, i, error);
    return status;
}

static ShvStatus write_pages(const Work *work, ShvError *error)
{
    const bool force = work->arguments->values[FORCE] != NULL;
    const char *html = work->arguments->values[HTML], *markdown = work->arguments->values[MARKDOWN];
    ShvStatus status = SHV_OK;
    if (html) status = shv_verify_write_html(html, force, work->cases, work->count, error);
    if (status == SHV_OK && markdown)
        status = shv_verify_write_markdown(markdown, force, work->cases, work->count, error);
    if (status == SHV_OK && !work->arguments->json && (html || markdown))
        printf("wrote %s%s%s\n", html ? html : "", html && markdown ? " and " : "", markdown ? markdown : "");
    return status;
}

static int32_t finish(const Work *work)
{
    const ShvVerifyCase sum = shv_verify_sum(work->cases, work->count);
    if (work->arguments->values[JSON])
        print_json(work->cases, work->count);
    else
        printf("%d cases: %d pass, %d miss with an explanation, %d miss without one; %.1f s\n", (int)work->count,
               (int)sum.passes, (int)sum.explained, (int)sum.misses, sum.seconds);
    return sum.misses;
}

static int run(const ShvArguments *arguments)
{
    Work work = {.arguments = arguments};
    ShvError error;
    ShvStatus status = run_cases(&work, &error);
    if (status == SHV_OK) status = write_pages(&work, &error);
    int exit_status = SHV_EXIT_DONE;
    if (status == SHV_BAD_INPUT && work.told)
        exit_status = SHV_EXIT_INPUT;
    else if (status != SHV_OK)
        exit_status = shv_cli_failed(status, &error);
    else if (finish(&work) > 0)
        exit_status = SHV_EXIT_MISSED;
    for (int32_t i = 0; work.made && i < work.paths.count; i++) shv_verify_destroy(work.made[i]);
    shv_release(work.made);
    shv_release(work.cases);
    release_paths(&work.paths);
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
