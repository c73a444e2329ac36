#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "cli/command.h"
#include "cli/jobs.h"

enum { OUTPUT, FORCE, JOBS, TASK, MERGE, PICK, JSON };

static void say_run(void *data, const char *setting)
{
    (void)data;
    fprintf(stderr, "shiver: running %s\n", setting);
}

/* ---- the cheapest that is good enough ---- */

/* "error=0.05" takes the study's first measure. */
static ShvStatus read_pick(const ShvStudyView *study, const char *text, int32_t *measure, double *largest,
                           ShvError *error)
{
    const char *equals = strchr(text, '=');
    const int length = equals ? (int)(equals - text) : 0;
    if (!equals || shv_parse_double(equals + 1, strlen(equals + 1), false, largest, NULL) != SHV_OK)
        return shv_fail(error, SHV_BAD_INPUT, "--pick needs error=LARGEST or MEASURE=LARGEST, not '%.60s'", text);
    *measure = strncmp(text, "error=", 6) == 0 ? 0 : -1;
    for (int32_t i = 0; i < study->measure_count; i++)
        if ((int)strlen(study->measures[i]) == length && strncmp(study->measures[i], text, (size_t)length) == 0)
            *measure = i;
    if (*measure < 0)
        return shv_fail(error, SHV_BAD_INPUT, "the study does not measure '%.*s'; it measures %s and so on", length,
                        text, study->measures[0]);
    if (!study->timings_valid)
        return shv_fail(error, SHV_BAD_INPUT,
                        "run times of this study are not valid, so that nothing can be called cheapest; run it without "
                        "-j, on one machine");
    return SHV_OK;
}

/* The exit status. */
static int pick(const ShvStudy *study, const char *text, bool quiet)
{
    int32_t measure = 0;
    double largest = 0.0;
    ShvError error;
    const ShvStudyView *view = shv_study_view(study);
    const ShvStatus status = read_pick(view, text, &measure, &largest, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    const int32_t best = shv_study_pick(study, measure, largest);
    const char *name = view->measures[measure], *unit = view->error_units[measure];
    if (best < 0) {
        fprintf(stderr, "shiver: no setting has an error of %s of at most %g\n", name, largest);
        return SHV_EXIT_FAILED;
    }
    const ShvStudyRow *row = &view->rows[best];
    FILE *stream = quiet ? stderr : stdout;
    fprintf(stream, "pick: %s: error of %s %.3g%s%s in %.3g s\n", row->name, name, row->errors[measure],
            unit[0] ? " " : "", unit, row->seconds);
    if (view->scatter[measure] > largest)
        fprintf(stream, "the scatter, %.3g, is more than that: such an error says little\n", view->scatter[measure]);
    return SHV_EXIT_DONE;
}

/* ---- the command ---- */

/* A study, with its share of the runs. */
typedef struct Order {
    const char *scene, *file; /* file NULL: the study is options->plan */
    ShvStudyOptions *options;
    int32_t jobs;
    bool merge, json;
    const char *pick;
} Order;

static ShvStatus run_share(const void *data, int32_t index, ShvError *error)
{
    const Order *order = data;
    ShvStudyOptions own = *order->options;
    ShvStudy *study = NULL;
    own.task = index;
    own.tasks = order->jobs;
    const ShvStatus status = shv_study_open(&study, order->scene, order->file, &own, error);
    return status == SHV_OK ? shv_study_run(study, error) : status;
}

static ShvStatus make_runs(ShvStudy *study, const Order *order, ShvError *error)
{
    if (order->merge) return SHV_OK;
    return order->jobs > 1 ? shv_jobs_run(order->jobs, run_share, order, error) : shv_study_run(study, error);
}

static ShvStatus show(ShvStudy *study, bool json, ShvError *error)
{
    SHV_TRY(shv_study_measure(study, error));
    SHV_TRY(shv_study_write(study, error));
    if (json)
        shv_study_print_json(study, stdout);
    else
        shv_study_print(study, stdout);
    return SHV_OK;
}

/* Returns the exit status. */
static int conduct(const Order *order, bool quiet)
{
    ShvError error;
    ShvStudy *study = NULL;
    ShvStudyOptions *options = order->options;
    const bool whole = options->tasks == 0;
    options->begins = quiet ? NULL : say_run;
    options->stop = shv_jobs_asked_to_stop;
    shv_jobs_catch_signals();
    ShvStatus status = shv_study_open(&study, order->scene, order->file, options, &error);
    if (status == SHV_OK) status = make_runs(study, order, &error);
    if (status == SHV_OK && whole) status = show(study, order->json, &error);
    int result = status != SHV_OK ? shv_cli_failed(status, &error) : SHV_EXIT_DONE;
    if (status == SHV_OK && order->pick) result = pick(study, order->pick, order->json);
    if (result == SHV_EXIT_DONE && whole && !order->json) printf("wrote %s/report.html\n", options->output);
    shv_study_close(study);
    return result;
}

int shv_cli_study(const ShvArguments *arguments, ShvStudyOptions *options, bool json)
{
    return conduct(&(Order){.scene = arguments->positional[0], .options = options, .json = json}, arguments->quiet);
}

static int run(const ShvArguments *arguments)
{
    char folder[SHV_CLI_PATH], command[2 * SHV_CLI_PATH];
    const char *const *values = arguments->values, *file = arguments->positional[1];
    ShvError error;
    ShvShare share;
    ShvStudyOptions options = shv_study_default();
    ShvStatus status = shv_jobs_read(values[JOBS], values[TASK], values[MERGE], &share, &error);
    if (status == SHV_OK && values[TASK] && values[PICK])
        status = shv_fail(&error, SHV_BAD_INPUT, "--pick needs all runs; give it with --merge once all tasks are done");
    if (status == SHV_OK) status = shv_cli_default_path(folder, file, false, "", &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    shv_cli_command_line(&shv_command_study, arguments, JOBS, JOBS, command, sizeof command);
    options.output = values[OUTPUT] ? values[OUTPUT] : folder;
    options.command = command;
    options.force = values[FORCE] != NULL;
    options.shared = share.jobs > 1;
    options.task = share.task;
    options.tasks = share.tasks;
    options.overrides = arguments->overrides;
    options.override_count = arguments->override_count;
    const Order order = {.scene = arguments->positional[0],
                         .file = file,
                         .options = &options,
                         .jobs = share.jobs,
                         .merge = values[MERGE] != NULL,
                         .json = values[JSON] != NULL,
                         .pick = values[PICK]};
    return conduct(&order, arguments->quiet);
}

const ShvCommand shv_command_study = {
    .name = "study",
    .positional = "SCENE STUDY",
    .summary = "vary keys of a scene; error of each run beside its run time",
    .details =
        "Runs a scene with all combinations of values that the study file lists, measures each run against a "
        "reference\n"
        "and shows what accuracy a second of computing buys. docs/study.md tells what a study file holds and how\n"
        "errors are measured. Each finished run is a file in DIR/runs: a study that was stopped goes on from there, "
        "and\n"
        "what was run with another scene, study or version is not used. Writes DIR/report.html, study.json, "
        "results.csv,\n"
        "timings.csv and figures. Run times are only valid one run at a time, on an idle machine.",
    .least_positional = 2,
    .most_positional = 2,
    .takes_scene = true,
    .options = {{"--output", "DIR", "folder of results; the study file's name unless given"},
                {"--force", NULL, "run again what has been run"},
                {"--jobs", "N", "N runs at a time; marks run times as invalid"},
                {"--task", "I/N", "run only share I of N, for batch arrays; no report"},
                {"--merge", NULL, "run nothing, report on the runs in DIR"},
                {"--pick", "M=ERROR",
                 "name the cheapest setting with at most this error of measure M; error=: the first"},
                {"--json", NULL, "print as JSON"}},
    .run = run,
};
