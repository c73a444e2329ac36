#include "survive/survive.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "scene/inputs.h"
#include "shiver/version.h"

ShvSurviveOptions shv_survive_default(void)
{
    return (ShvSurviveOptions){.cookie = SHV_DEFINITION_COOKIE,
                               .first = 1.0,
                               .lowest = 1e-3,
                               .highest = 1e3,
                               .most_shots = 40,
                               .task = 1,
                               .tasks = 1};
}

const char *shv_fragility_law_name(ShvFragilityLaw law)
{
    static const char *const names[SHV_FRAGILITY_LAWS] = {"log-normal", "Weibull"};
    return law >= 0 && law < SHV_FRAGILITY_LAWS ? names[law] : "";
}

/* ---- opening ---- */

static ShvStatus check_options(const ShvSurviveOptions *options, ShvError *error)
{
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_survive_default()");
    if (!options->output || options->output[0] == '\0')
        return shv_fail(error, SHV_BAD_INPUT, "a search needs a folder for its shots");
    if (!(options->lowest > 0.0 && options->highest < HUGE_VAL && options->lowest < options->highest))
        return shv_fail(error, SHV_BAD_INPUT, "heights are positive and finite, the lowest first, not %g to %g m",
                        options->lowest, options->highest);
    if (!(options->first >= options->lowest && options->first <= options->highest))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the first height, %g m, is not between the lowest, %g m, and the highest, %g m",
                        options->first, options->lowest, options->highest);
    if (options->most_shots < 1 || options->most_shots > 1000000)
        return shv_fail(error, SHV_BAD_INPUT, "a search takes 1 to 1,000,000 shots, not %d", (int)options->most_shots);
    if (!(options->until == 0.0 || (options->until > 1.0 && options->until < HUGE_VAL)))
        return shv_fail(error, SHV_BAD_INPUT,
                        "the interval's width is a factor above 1, such as 1.3, not %g; 0 leaves it out",
                        options->until);
    if (!(options->staircase >= 0.0 && options->staircase < options->highest))
        return shv_fail(error, SHV_BAD_INPUT, "the staircase's step is a height below the highest one, not %g m",
                        options->staircase);
    if (options->tasks < 1 || options->task < 1 || options->task > options->tasks)
        return shv_fail(error, SHV_BAD_INPUT, "a task is 1 to the number of tasks, not %d of %d", (int)options->task,
                        (int)options->tasks);
    if (options->staircase > 0.0 && options->tasks > 1)
        return shv_fail(error, SHV_BAD_INPUT, "a staircase is one sequence: it cannot be shared by tasks");
    return SHV_OK;
}

static ShvStatus hash_all(ShvSurvive *survive, ShvError *error)
{
    survive->key = shv_hash_text(shv_scene_hash(survive->scene), shv_version());
    return shv_inputs_hash(survive->options.memory, shv_scene_folder(survive->scene),
                           shv_scene_definition(survive->scene), &survive->key, error);
}

static ShvStatus open_all(ShvSurvive *survive, ShvError *error)
{
    char name[64];
    const ShvSurviveOptions *options = &survive->options;
    SHV_TRY(shv_scene_load(&survive->scene, survive->scene_path, options->overrides, options->override_count,
                           options->memory, NULL, error));
    SHV_TRY(hash_all(survive, error));
    SHV_TRY(shv_drop_create(&survive->drop, shv_scene_definition(survive->scene), shv_scene_folder(survive->scene),
                            options, error));
    SHV_TRY(shv_make_folder(options->output, error));
    if (options->staircase > 0.0)
        shv_format(name, sizeof name, "staircase.csv");
    else
        shv_format(name, sizeof name, "shots-%d-of-%d.csv", (int)options->task, (int)options->tasks);
    return shv_path_join(options->memory, SHV_PART_GENERAL, options->output, name, &survive->path, error);
}

ShvStatus shv_survive_open(ShvSurvive **survive, const char *scene, const ShvSurviveOptions *options, ShvError *error)
{
    *survive = NULL;
    SHV_TRY(check_options(options, error));
    ShvSurvive *made = shv_allocate(options->memory, SHV_PART_GENERAL, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a search", sizeof *made);
    made->options = *options;
    made->scene_path = scene;
    made->shots.memory = options->memory;
    const ShvStatus status = open_all(made, error);
    if (status == SHV_OK)
        *survive = made;
    else
        shv_survive_close(made);
    return status;
}

void shv_survive_close(ShvSurvive *survive)
{
    if (!survive) return;
    shv_drop_release(&survive->drop);
    shv_scene_destroy(survive->scene);
    shv_shots_release(&survive->shots);
    shv_release(survive->specimens);
    shv_release(survive->path);
    shv_release(survive);
}

/* ---- shooting ---- */

static ShvStatus reserve_specimens(ShvSurvive *survive, ShvError *error)
{
    const int32_t wanted = survive->shots.count + 1;
    if (wanted <= survive->room) return SHV_OK;
    ShvSpecimen *specimens = shv_reallocate(survive->options.memory, SHV_PART_GENERAL, survive->specimens,
                                            2 * (size_t)wanted, sizeof *specimens);
    if (!specimens) return shv_fail_memory(error, "the specimens", 2 * (size_t)wanted * sizeof *specimens);
    survive->specimens = specimens;
    survive->room = 2 * wanted;
    return SHV_OK;
}

static ShvStatus next_shot(ShvSurvive *survive, ShvNextShot *next, ShvError *error)
{
    const ShvSurviveOptions *options = &survive->options;
    const ShvDesign design = {.first = options->first,
                              .lowest = options->lowest,
                              .highest = options->highest,
                              .most_shots = options->most_shots,
                              .until = options->until,
                              .first_specimen = (uint64_t)(options->task - 1),
                              .every = (uint64_t)options->tasks};
    SHV_TRY(reserve_specimens(survive, error));
    *next = options->staircase > 0.0
                ? shv_staircase_next(&design, options->staircase, survive->shots.items, survive->shots.count)
                : shv_design_next(&design, survive->shots.items, survive->shots.count, survive->specimens);
    return SHV_OK;
}

static ShvStatus shoot_on(ShvSurvive *survive, ShvShotTable *table, ShvError *error)
{
    const ShvSurviveOptions *options = &survive->options;
    for (;;) {
        ShvNextShot next;
        ShvShot shot;
        SHV_TRY(next_shot(survive, &next, error));
        if (next.done) return SHV_OK;
        SHV_TRY(shv_drop_shoot(&survive->drop, next.specimen, next.height, &shot, error));
        SHV_TRY(shv_shot_table_append(table, &shot, error));
        SHV_TRY(shv_shots_add(&survive->shots, &shot, error));
        if (options->tell) options->tell(options->tell_data, &shot);
    }
}

ShvStatus shv_survive_run(ShvSurvive *survive, ShvError *error)
{
    ShvShotTable table;
    survive->shots.count = 0;
    SHV_TRY(shv_shot_table_open(&table, &survive->shots, survive->path, survive->key, survive->options.force, error));
    const ShvStatus status = shoot_on(survive, &table, error);
    shv_shot_table_close(&table);
    SHV_TRY(status);
    return shv_survive_fit(survive, error);
}

/* ---- all tasks together ---- */

static bool is_table(const char *name)
{
    const size_t length = strlen(name);
    return strncmp(name, "shots-", 6) == 0 && length > 4 && strcmp(name + length - 4, ".csv") == 0;
}

/* By specimen, then height: one order whatever the tasks were. */
static bool comes_before(const ShvShot *a, const ShvShot *b)
{
    return a->specimen < b->specimen || (a->specimen == b->specimen && a->height < b->height);
}

/* Sorts the shots from `begin` on into those before; one that is there already (of another division into tasks) goes. */
static void sort_in(ShvShots *shots, int32_t begin)
{
    int32_t count = begin;
    for (int32_t i = begin; i < shots->count; i++) {
        const ShvShot shot = shots->items[i];
        int32_t k = count;
        while (k > 0 && comes_before(&shot, &shots->items[k - 1])) k--;
        if (k > 0 && !comes_before(&shots->items[k - 1], &shot)) continue;
        memmove(shots->items + k + 1, shots->items + k, (size_t)(count - k) * sizeof *shots->items);
        shots->items[k] = shot;
        count++;
    }
    shots->count = count;
}

static ShvStatus read_tables(ShvSurvive *survive, DIR *folder, ShvError *error)
{
    for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
        char *path;
        if (!is_table(entry->d_name)) continue;
        const int32_t begin = survive->shots.count;
        SHV_TRY(shv_path_join(survive->options.memory, SHV_PART_GENERAL, survive->options.output, entry->d_name, &path,
                              error));
        const ShvStatus status = shv_shots_read(&survive->shots, path, survive->key, NULL, error);
        shv_release(path);
        SHV_TRY(status);
        sort_in(&survive->shots, begin);
    }
    if (survive->shots.count > 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "there are no shots in '%s'", survive->options.output);
}

ShvStatus shv_survive_merge(ShvSurvive *survive, ShvError *error)
{
    DIR *folder = opendir(survive->options.output);
    if (!folder)
        return shv_fail(error, SHV_FILE_ERROR, "cannot read the folder '%s': %s", survive->options.output,
                        strerror(errno));
    survive->shots.count = 0;
    const ShvStatus status = read_tables(survive, folder, error);
    closedir(folder);
    SHV_TRY(status);
    return shv_survive_fit(survive, error);
}

/* ---- what is known ---- */

static ShvFragilityView fit_law(ShvFragilityLaw law, const ShvFragilityData *data)
{
    const ShvFragilityFit fit = shv_fragility_fit(law, data);
    ShvFragilityView view = {.location = fit.location,
                             .scale = fit.scale,
                             .likelihood = fit.likelihood,
                             .h50 = shv_fragility_height(law, &fit, 0.5),
                             .h10 = shv_fragility_height(law, &fit, 0.1)};
    shv_fragility_interval(law, data, 0.5, &view.h50_low, &view.h50_high);
    shv_fragility_interval(law, data, 0.1, &view.h10_low, &view.h10_high);
    return view;
}

/* All specimens did the same: the share that does otherwise is below this with 95 % confidence (0.05 = (1 − share)ⁿ). */
static void view_one_outcome(const ShvSurvive *survive, ShvSurviveView *view)
{
    const bool broke = view->broken > 0;
    double extreme = broke ? HUGE_VAL : 0.0;
    int32_t there = 0;
    for (int32_t i = 0; i < view->shot_count; i++)
        extreme = broke ? fmin(extreme, view->shots[i].height) : fmax(extreme, view->shots[i].height);
    for (int32_t i = 0; i < view->specimens; i++) {
        const ShvSpecimen *specimen = &survive->specimens[i];
        there += broke ? specimen->broken <= extreme : specimen->survived >= extreme;
    }
    *(broke ? &view->all_broke_from : &view->all_survived_from) = extreme;
    view->bound = 1.0 - pow(0.05, 1.0 / there);
}

ShvStatus shv_survive_fit(ShvSurvive *survive, ShvError *error)
{
    const double none = (double)NAN;
    SHV_TRY(reserve_specimens(survive, error));
    const int32_t count = survive->shots.count;
    const ShvFragilityData data = {.shots = survive->shots.items,
                                   .specimens = survive->specimens,
                                   .specimen_count = shv_specimens(survive->shots.items, count, survive->specimens)};
    ShvSurviveView view = {.shots = survive->shots.items,
                           .shot_count = count,
                           .specimens = data.specimen_count,
                           .overlap = shv_fragility_overlap(&data),
                           .all_survived_from = none,
                           .all_broke_from = none,
                           .bound = none,
                           .staircase_mean = none,
                           .staircase_deviation = none};
    for (int32_t i = 0; i < count; i++) view.broken += view.shots[i].broken;
    for (int32_t i = 0; i < data.specimen_count; i++) {
        view.checked += survive->specimens[i].shots > 2;
        view.contradictory += survive->specimens[i].contradictory;
    }
    const bool both = view.broken > 0 && view.broken < count;
    for (int law = 0; law < SHV_FRAGILITY_LAWS; law++)
        view.laws[law] =
            both ? fit_law(law, &data) : (ShvFragilityView){none, none, none, none, none, none, none, none, none};
    if (!both && count > 0) view_one_outcome(survive, &view);
    if (survive->options.staircase > 0.0)
        shv_staircase_mean(view.shots, count, survive->options.staircase, &view.staircase_mean,
                           &view.staircase_deviation);
    survive->view = view;
    return SHV_OK;
}

ShvSurviveView shv_survive_view(const ShvSurvive *survive)
{
    return survive->view;
}
