#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/jobs.h"

enum { OUTPUT, HEIGHTS, FIRST, SHOTS, UNTIL, STANDARD, STEP, FORCE, JOBS, TASK, MERGE, JSON };

static void say_shot(void *data, const ShvShot *shot)
{
    (void)data;
    fprintf(stderr, "shiver: specimen %llu from %.4g m: %s, %d piece%s, largest %.1f %%\n",
            (unsigned long long)shot->specimen, shot->height, shot->broken ? "broke" : "survived", (int)shot->pieces,
            shot->pieces == 1 ? "" : "s", 100.0 * shot->shares[0]);
}

/* ---- options ---- */

static ShvStatus read_number(const char *text, size_t length, const char *what, double *value, ShvError *error)
{
    if (shv_parse_double(text, length, false, value, NULL) == SHV_OK) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "%s, not '%.60s'", what, text);
}

static ShvStatus read_heights(const char *text, ShvSurviveOptions *options, ShvError *error)
{
    static const char what[] = "--heights needs LOWEST,HIGHEST in metres";
    const char *comma = strchr(text, ',');
    if (!comma) return shv_fail(error, SHV_BAD_INPUT, "%s, not '%.60s'", what, text);
    ShvStatus status = read_number(text, (size_t)(comma - text), what, &options->lowest, error);
    if (status == SHV_OK) status = read_number(comma + 1, strlen(comma + 1), what, &options->highest, error);
    if (status == SHV_OK) options->first = sqrt(options->lowest * options->highest);
    return status;
}

/* Steps of a tenth of the first height, unless given. */
static ShvStatus read_standard(const char *const *values, ShvSurviveOptions *options, ShvError *error)
{
    if (!values[STANDARD] && values[STEP])
        return shv_fail(error, SHV_BAD_INPUT, "--step is the step of --standard d2463");
    if (!values[STANDARD]) return SHV_OK;
    if (strcmp(values[STANDARD], "d2463") != 0)
        return shv_fail(error, SHV_BAD_INPUT, "--standard knows d2463, not '%.60s'", values[STANDARD]);
    options->staircase = 0.1 * options->first;
    if (!values[STEP]) return SHV_OK;
    const ShvStatus status =
        read_number(values[STEP], strlen(values[STEP]), "--step needs a height in metres", &options->staircase, error);
    if (status == SHV_OK && !(options->staircase > 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "--step needs a height above 0 m, not '%.60s'", values[STEP]);
    return status;
}

static ShvStatus read_search(const char *const *values, ShvSurviveOptions *options, ShvError *error)
{
    ShvStatus status = values[HEIGHTS] ? read_heights(values[HEIGHTS], options, error) : SHV_OK;
    if (status == SHV_OK && values[FIRST])
        status = read_number(values[FIRST], strlen(values[FIRST]), "--first needs a height in metres", &options->first,
                             error);
    if (status == SHV_OK && values[SHOTS])
        status = shv_jobs_read_number(values[SHOTS], strlen(values[SHOTS]), 1, 1000000,
                                      "--shots needs a number of shots, 1 to 1000000", &options->most_shots, error);
    if (status == SHV_OK && values[UNTIL])
        status = read_number(values[UNTIL], strlen(values[UNTIL]), "--until needs a factor such as 1.3",
                             &options->until, error);
    return status == SHV_OK ? read_standard(values, options, error) : status;
}

static ShvStatus read_options(const ShvArguments *arguments, ShvSurviveOptions *options, ShvShare *share,
                              ShvError *error)
{
    const char *const *values = arguments->values;
    options->force = values[FORCE] != NULL;
    options->overrides = arguments->overrides;
    options->override_count = arguments->override_count;
    options->tell = arguments->quiet ? NULL : say_shot;
    options->stop = shv_jobs_asked_to_stop;
    ShvStatus status = read_search(values, options, error);
    if (status == SHV_OK) status = shv_jobs_read(values[JOBS], values[TASK], values[MERGE], share, error);
    if (status == SHV_OK && share->jobs > 1 && options->staircase > 0.0)
        return shv_fail(error, SHV_BAD_INPUT, "a staircase is one sequence: leave out --jobs");
    if (!values[TASK]) return status;
    options->task = share->task;
    options->tasks = share->tasks;
    return status;
}

/* ---- what is printed ---- */

static void print_height(const char *name, double height, double low, double high)
{
    printf("  %s %.3g m (95 %%: ", name, height);
    printf(low > 0.0 ? "%.3g to " : "no lower bound, ", low);
    printf(isfinite(high) ? "%.3g m)" : "no upper bound)", high);
}

static void print_view(const ShvSurviveView *view)
{
    printf("%d shots at %d specimens, %d broke\n", (int)view->shot_count, (int)view->specimens, (int)view->broken);
    if (isfinite(view->all_survived_from))
        printf("never: all survived, even %.3g m; at most %.2g of all specimens break from there (95 %%)\n",
               view->all_survived_from, view->bound);
    if (isfinite(view->all_broke_from))
        printf("always: all broke, even from %.3g m; at most %.2g of all specimens survive that (95 %%)\n",
               view->all_broke_from, view->bound);
    for (int law = 0; law < SHV_FRAGILITY_LAWS && isfinite(view->laws[law].h50); law++) {
        const ShvFragilityView *fit = &view->laws[law];
        printf("%-10s", shv_fragility_law_name(law));
        print_height("half break from", fit->h50, fit->h50_low, fit->h50_high);
        print_height("; a tenth from", fit->h10, fit->h10_low, fit->h10_high);
        printf("; log-likelihood %.2f\n", fit->likelihood);
    }
    if (isfinite(view->staircase_mean))
        printf("ASTM D2463, procedure B: mean failure height %.3g m, standard deviation %.2g m\n", view->staircase_mean,
               view->staircase_deviation);
    if (isfinite(view->laws[0].h50) && !view->overlap)
        printf("no specimen survived from as high as another one broke: of the spread nothing is known yet\n");
    if (view->checked > 0)
        printf("%d of %d specimens that were dropped again survived higher and broke lower\n", (int)view->contradictory,
               (int)view->checked);
}

static int show(ShvSurvive *survive, const ShvArguments *arguments, const char *folder)
{
    ShvError error;
    const ShvStatus status = shv_survive_write(survive, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    const ShvSurviveView view = shv_survive_view(survive);
    if (arguments->values[JSON])
        shv_survive_print_json(survive, stdout);
    else
        print_view(&view);
    if (!arguments->values[JSON]) printf("wrote %s/report.html\n", folder);
    return SHV_EXIT_DONE;
}

/* ---- the command ---- */

/* A search with its share of the specimens and of the shots. */
typedef struct Search {
    const char *scene;
    const ShvSurviveOptions *options;
    int32_t jobs;
} Search;

static ShvStatus run_share(const void *data, int32_t index, ShvError *error)
{
    const Search *search = data;
    ShvSurviveOptions own = *search->options;
    ShvSurvive *survive = NULL;
    own.task = index;
    own.tasks = search->jobs;
    own.most_shots = (own.most_shots + search->jobs - 1) / search->jobs;
    const ShvStatus status = shv_survive_open(&survive, search->scene, &own, error);
    return status == SHV_OK ? shv_survive_run(survive, error) : status;
}

static ShvStatus shoot(ShvSurvive *survive, const ShvArguments *arguments, const ShvSurviveOptions *options,
                       int32_t jobs, ShvError *error)
{
    const Search search = {.scene = arguments->positional[0], .options = options, .jobs = jobs};
    if (arguments->values[MERGE]) return shv_survive_merge(survive, error);
    if (jobs <= 1) return shv_survive_run(survive, error);
    const ShvStatus status = shv_jobs_run(jobs, run_share, &search, error);
    return status == SHV_OK ? shv_survive_merge(survive, error) : status;
}

static int run(const ShvArguments *arguments)
{
    char folder[SHV_CLI_PATH], command[2 * SHV_CLI_PATH];
    ShvError error;
    ShvShare share;
    ShvSurvive *survive = NULL;
    ShvSurviveOptions options = shv_survive_default();
    ShvStatus status = read_options(arguments, &options, &share, &error);
    if (status == SHV_OK) status = shv_cli_default_path(folder, arguments->positional[0], false, "_survive", &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    shv_cli_command_line(&shv_command_survive, arguments, HEIGHTS, STEP, command, sizeof command);
    options.output = arguments->values[OUTPUT] ? arguments->values[OUTPUT] : folder;
    options.command = command;
    shv_jobs_catch_signals();
    status = shv_survive_open(&survive, arguments->positional[0], &options, &error);
    if (status == SHV_OK) status = shoot(survive, arguments, &options, share.jobs, &error);
    int result = status == SHV_OK ? SHV_EXIT_DONE : shv_cli_failed(status, &error);
    if (status == SHV_OK && !arguments->values[TASK]) result = show(survive, arguments, options.output);
    shv_survive_close(survive);
    return result;
}

const ShvCommand shv_command_survive = {
    .name = "survive",
    .positional = "SCENE",
    .summary = "from what height does it break, and into what?",
    .details =
        "Drops the scene's body again and again: its speed at the start is that of a fall from the height, all else "
        "is\n"
        "as the scene says. Each specimen has strengths (seed) of its own and, with 'survival: {turn: true}', an\n"
        "orientation; it is dropped twice, whole each time, from heights that tell most. Fits the share that breaks "
        "by\n"
        "height, with 95 % intervals. Each shot is a line of a table in DIR at once: a search that was stopped goes "
        "on\n"
        "from there. Writes DIR/report.html, shots.csv, survive.json, curve.svg. docs/survive.md tells more.",
    .least_positional = 1,
    .most_positional = 1,
    .takes_scene = true,
    .options = {{"--output", "DIR", "folder of results; the scene's name with _survive unless given"},
                {"--heights", "LO,HI", "lowest and highest height, m; 0.001,1000 unless given"},
                {"--first", "H", "height of the first shot, m; 1, or the middle of --heights"},
                {"--shots", "N", "shots in all; 40 unless given"},
                {"--until", "FACTOR", "ends earlier, once the 95 % interval of the middle spans at most this factor"},
                {"--standard", "NAME", "d2463: the staircase of ASTM D2463, procedure B, in place of two shots each"},
                {"--step", "H", "its step, m; a tenth of the first height unless given"},
                {"--force", NULL, "begin anew"},
                {"--jobs", "N", "N searches at a time, each with its share of specimens and shots"},
                {"--task", "I/N", "be search I of N, for batch arrays; no report"},
                {"--merge", NULL, "shoot nothing, report on all shots in DIR"},
                {"--json", NULL, "print as JSON"}},
    .run = run,
};
