/* From the runs of a study to its rows. */
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "evaluate/gather.h"
#include "evaluate/names.h"
#include "evaluate/study.h"

/* What one measuring works with. */
typedef struct Judge {
    ShvStudy *study;
    ShvOutcome *references; /* one a member; none with a closed form */
    double *samples;        /* measures × members: errors, then values, then run times */
} Judge;

/* What one judging works with. */
typedef struct Bench {
    ShvScene *scene;
    ShvWay way;
    ShvPool series;
} Bench;

static void close_bench(Bench *bench)
{
    shv_way_close(&bench->way);
    shv_scene_destroy(bench->scene);
    shv_pool_release(&bench->series);
}

static ShvStatus open_bench(const ShvStudy *study, int32_t setting, Bench *bench, ShvError *error)
{
    *bench = (Bench){.series = {.memory = study->memory}};
    if (!shv_study_tracks(study)) return SHV_OK;
    SHV_TRY(shv_study_scene(study, setting, &bench->scene, error));
    const ShvStatus status =
        shv_way_open(&bench->way, shv_scene_definition(bench->scene), shv_scene_folder(bench->scene),
                     study->plan.reference == SHV_STUDY_CLOSED, study->memory, error);
    if (status != SHV_OK) close_bench(bench);
    return status;
}

/* What a run lacks of a measure of ours is no number; a formula of the study's own must be right. */
static ShvStatus take(ShvNames *names, const ShvMeasure *measure, const char *formula, double *number, ShvError *error)
{
    const ShvFormulaNames lookup = shv_names(names);
    *number = (double)NAN;
    if (!formula) return SHV_OK;
    ShvError why;
    const ShvStatus status = shv_formula_number(formula, &lookup, number, &why);
    if (names->status != SHV_OK) return shv_fail(error, names->status, "%s", names->error.message);
    if (status == SHV_OK || (status == SHV_BAD_INPUT && measure->sentence)) return SHV_OK;
    return shv_fail(error, status, "measure %.60s: %.900s", measure->name, why.message);
}

/* By measure of the study. `values` may be NULL. */
static ShvStatus judge_run(const ShvStudy *study, Bench *bench, const ShvOutcome *outcome, const ShvOutcome *reference,
                           double *errors, double *values, ShvError *error)
{
    const ShvNamedRun own = {.name = "", .outcome = outcome}, other = {.name = "reference", .outcome = reference};
    ShvNames names = {.pool = &bench->series, .run = &own, .others = &other, .other_count = 1};
    if (bench->scene) names.way = &bench->way;
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasure *measure = &study->plan.measures[i];
        errors[i] = (double)NAN;
        if (values) values[i] = (double)NAN;
        if (outcome->status != SHV_OK) continue;
        SHV_TRY(take(&names, measure, measure->error, &errors[i], error));
        if (values) SHV_TRY(take(&names, measure, measure->value, &values[i], error));
    }
    return bench->series.failed ? shv_fail_memory(error, "the series of a run", 0) : SHV_OK;
}

/* ---- one run, in a row ---- */

/* Median of `count` numbers, those that are not finite left out; sorts them. NaN of none. */
static double median(double *values, int32_t count)
{
    int32_t finite = 0;
    for (int32_t i = 0; i < count; i++)
        if (isfinite(values[i])) values[finite++] = values[i];
    if (finite == 0) return (double)NAN;
    shv_sort_numbers(values, finite);
    return finite % 2 ? values[finite / 2] : 0.5 * (values[finite / 2 - 1] + values[finite / 2]);
}

/* Median of the run times; NaN without any. */
static double seconds_of(const ShvOutcome *outcome)
{
    enum { MOST = 64 };
    double copy[MOST];
    const ShvOutcomeList *list = shv_outcome_find(outcome, "run.seconds");
    const int64_t count = !list ? 0 : list->count < MOST ? list->count : MOST;
    for (int64_t i = 0; i < count; i++) copy[i] = list->values[i];
    return median(copy, (int32_t)count);
}

/* The first member stands for step and cost; the first failure for the setting. */
static void note_run(ShvStudyResult *result, const ShvOutcome *outcome, int32_t member)
{
    ShvStudyRow *row = &result->row;
    const ShvOutcomeList *seconds = shv_outcome_find(outcome, "run.seconds"),
                         *costs = shv_outcome_find(outcome, "run.costs");
    const ShvOutcomeList *courant = shv_outcome_find(outcome, "frame.courant");
    if (member == 0) {
        row->stable_step = shv_outcome_number(outcome, "run.stable_step");
        row->step = shv_outcome_number(outcome, "frame.step");
        for (int64_t i = 0; courant && i < courant->count; i++) row->courant = fmax(row->courant, courant->values[i]);
        for (int64_t i = 0; costs && i < costs->count && i < SHV_COST_COUNT; i++) result->costs[i] = costs->values[i];
    }
    for (int64_t i = 0; seconds && i < seconds->count; i++) {
        row->seconds_low = fmin(row->seconds_low, seconds->values[i]);
        row->seconds_high = fmax(row->seconds_high, seconds->values[i]);
    }
    if (outcome->status == SHV_OK || row->status != SHV_OK) return;
    row->status = outcome->status;
    shv_format(row->message, sizeof row->message, "%.255s", outcome->message);
}

static void note_machine(ShvStudy *study, const ShvOutcome *outcome)
{
    if (study->processor[0] == '\0')
        shv_format(study->processor, sizeof study->processor, "%s", outcome->processor);
    else if (strcmp(study->processor, outcome->processor) != 0)
        study->same_processor = false;
    if (outcome->shared || !study->same_processor) study->timings_valid = false;
}

/* ---- one setting ---- */

static double *sample(const Judge *judge, int32_t line, int32_t member)
{
    return judge->samples + (int64_t)line * judge->study->plan.members + member;
}

static ShvStatus judge_member(Judge *judge, Bench *bench, int32_t setting, int32_t member, ShvError *error)
{
    ShvStudy *study = judge->study;
    const int32_t measures = study->plan.measure_count;
    double errors[SHV_STUDY_MOST_MEASURES], values[SHV_STUDY_MOST_MEASURES];
    ShvOutcome outcome;
    SHV_TRY(shv_study_load(study, setting * study->plan.members + member, &outcome, error));
    note_run(&study->results[setting], &outcome, member);
    note_machine(study, &outcome);
    const ShvStatus status =
        judge_run(study, bench, &outcome, judge->references ? &judge->references[member] : NULL, errors, values, error);
    for (int32_t i = 0; i < measures && status == SHV_OK; i++) {
        *sample(judge, i, member) = errors[i];
        *sample(judge, measures + i, member) = values[i];
    }
    *sample(judge, 2 * measures, member) = seconds_of(&outcome);
    shv_outcome_release(&outcome);
    return status;
}

static const char *name_of(ShvStudy *study, int32_t index)
{
    const ShvStudySetting *setting = shv_study_setting(study, index);
    char text[1024] = "";
    size_t length = 0;
    for (int32_t i = 0; i < study->plan.key_count && setting->values && length < sizeof text - 1; i++) {
        if (setting->values[i][0] == '\0') continue;
        shv_format(text + length, sizeof text - length, "%s%s=%s", length > 0 ? " " : "", study->plan.keys[i],
                   setting->values[i]);
        length = strlen(text);
    }
    const char *copy = shv_pool_text(&study->plan.pool, text, length);
    return copy && length > 0 ? copy : "reference";
}

static void start_result(ShvStudy *study, int32_t index)
{
    ShvStudyResult *result = &study->results[index];
    const ShvStudySetting *setting = shv_study_setting(study, index);
    result->row = (ShvStudyRow){.name = name_of(study, index),
                                .series = setting->series,
                                .label = setting->label,
                                .is_reference = index == study->reference,
                                .seconds_low = HUGE_VAL,
                                .values = result->values,
                                .errors = result->errors,
                                .errors_low = result->errors_low,
                                .errors_high = result->errors_high,
                                .on_front = result->on_front,
                                .costs = result->costs};
}

static void finish_result(const Judge *judge, int32_t index)
{
    const ShvStudy *study = judge->study;
    ShvStudyResult *result = &study->results[index];
    const int32_t measures = study->plan.measure_count, members = study->plan.members;
    for (int32_t i = 0; i < measures; i++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int32_t m = 0; m < members; m++) {
            low = fmin(low, *sample(judge, i, m));
            high = fmax(high, *sample(judge, i, m));
        }
        result->errors_low[i] = low <= high ? low : (double)NAN;
        result->errors_high[i] = low <= high ? high : (double)NAN;
        result->errors[i] = median(sample(judge, i, 0), members);
        result->values[i] = median(sample(judge, measures + i, 0), members);
    }
    result->row.seconds = median(sample(judge, 2 * measures, 0), members);
}

static ShvStatus judge_setting(Judge *judge, int32_t setting, ShvError *error)
{
    Bench bench;
    start_result(judge->study, setting);
    SHV_TRY(open_bench(judge->study, setting, &bench, error));
    ShvStatus status = SHV_OK;
    for (int32_t m = 0; m < judge->study->plan.members && status == SHV_OK; m++)
        status = judge_member(judge, &bench, setting, m, error);
    close_bench(&bench);
    if (status == SHV_OK) finish_result(judge, setting);
    return status;
}

/* ---- scatter ---- */

/* Of an error that needs no reference: how far two runs' are from each other. */
static ShvStatus compare_pair(const ShvStudy *study, Bench *bench, const ShvOutcome *a, const ShvOutcome *b,
                              double *errors, ShvError *error)
{
    double other[SHV_STUDY_MOST_MEASURES];
    SHV_TRY(judge_run(study, bench, a, b, errors, NULL, error));
    SHV_TRY(judge_run(study, bench, b, a, other, NULL, error));
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        if (shv_measure_is_own(&study->plan.measures[i])) errors[i] = fabs(errors[i] - other[i]);
    return SHV_OK;
}

static ShvStatus scatter_of(ShvStudy *study, const ShvOutcome *members, Bench *bench, double *pairs, ShvError *error)
{
    const int32_t count = study->plan.members, all = count * (count - 1) / 2;
    int32_t pair = 0;
    for (int32_t a = 0; a < count; a++)
        for (int32_t b = a + 1; b < count; b++, pair++) {
            double errors[SHV_STUDY_MOST_MEASURES];
            SHV_TRY(compare_pair(study, bench, &members[a], &members[b], errors, error));
            for (int32_t i = 0; i < study->plan.measure_count; i++) pairs[(int64_t)i * all + pair] = errors[i];
        }
    for (int32_t i = 0; i < study->plan.measure_count; i++) study->scatter[i] = median(pairs + (int64_t)i * all, all);
    return SHV_OK;
}

static ShvStatus find_scatter(ShvStudy *study, int32_t setting, const ShvOutcome *members, ShvError *error)
{
    const int32_t count = study->plan.members;
    const size_t pairs = (size_t)count * (size_t)(count - 1) / 2 * (size_t)study->plan.measure_count;
    Bench bench;
    if (count == 1) return SHV_OK;
    double *samples = shv_allocate(study->memory, SHV_PART_GENERAL, pairs, sizeof *samples);
    if (!samples) return shv_fail_memory(error, "the scatter of an ensemble", pairs * sizeof *samples);
    ShvStatus status = open_bench(study, setting, &bench, error);
    if (status == SHV_OK) {
        status = scatter_of(study, members, &bench, samples, error);
        close_bench(&bench);
    }
    shv_release(samples);
    return status;
}

/* ---- references ---- */

static void release_outcomes(ShvOutcome *outcomes, int32_t count)
{
    for (int32_t i = 0; outcomes && i < count; i++) shv_outcome_release(&outcomes[i]);
    shv_release(outcomes);
}

/* All members of a setting. */
static ShvStatus load_members(const ShvStudy *study, int32_t setting, ShvOutcome **outcomes, ShvError *error)
{
    const int32_t count = study->plan.members;
    *outcomes = shv_allocate(study->memory, SHV_PART_GENERAL, (size_t)count, sizeof **outcomes);
    if (!*outcomes) return shv_fail_memory(error, "reference runs", (size_t)count * sizeof **outcomes);
    ShvStatus status = SHV_OK;
    for (int32_t m = 0; m < count && status == SHV_OK; m++) {
        ShvOutcome *outcome = &(*outcomes)[m];
        status = shv_study_load(study, setting * count + m, outcome, error);
        if (status == SHV_OK && outcome->status != SHV_OK)
            status = shv_fail(error, outcome->status, "the run that the others are to be compared with failed: %s",
                              outcome->message);
    }
    if (status == SHV_OK) return SHV_OK;
    release_outcomes(*outcomes, count);
    *outcomes = NULL;
    return status;
}

static void name_closed_form(char *text, size_t size, const ShvReferenceDefinition *reference)
{
    static const char *const laws[] = {"none", "flight", "bounce", "slide", "roll", "rest"};
    shv_format(text, size, "closed form (%s of %.60s%s%.60s)", laws[reference->law],
               reference->body ? reference->body : "every body", reference->on ? " on " : "",
               reference->on ? reference->on : "");
}

static void name_reference(ShvStudy *study)
{
    char *text = study->reference_name;
    const size_t size = sizeof study->reference_name;
    ShvScene *scene = NULL;
    ShvError ignored;
    if (study->reference >= 0) {
        const ShvStudySetting *setting = shv_study_setting(study, study->reference);
        shv_format(text, size, "run of %.160s%s%.60s", setting->series, setting->label[0] ? ", " : "", setting->label);
    } else if (shv_study_scene(study, 0, &scene, &ignored) == SHV_OK) {
        name_closed_form(text, size, &shv_scene_definition(scene)->reference);
    }
    shv_scene_destroy(scene);
}

static ShvStatus find_references(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    name_reference(study);
    if (study->reference >= 0) {
        SHV_TRY(load_members(study, study->reference, &judge->references, error));
        return find_scatter(study, study->reference, judge->references, error);
    }
    if (study->plan.members == 1) return SHV_OK;
    int32_t finest;
    ShvOutcome *members;
    SHV_TRY(shv_study_finest(study, &finest, error));
    SHV_TRY(load_members(study, finest, &members, error));
    const ShvStatus status = find_scatter(study, finest, members, error);
    release_outcomes(members, study->plan.members);
    return status;
}

/* ---- all ---- */

static ShvStatus judge_all(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    SHV_TRY(find_references(judge, error));
    for (int32_t i = 0; i < study->setting_count; i++) SHV_TRY(judge_setting(judge, i, error));
    for (int32_t i = 0; i < study->plan.measure_count; i++) shv_study_mark_front(study, i);
    return SHV_OK;
}

static ShvStatus reserve(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    const size_t samples = (size_t)(2 * study->plan.measure_count + 1) * (size_t)study->plan.members;
    const size_t settings = (size_t)study->setting_count;
    shv_release(study->results);
    study->results = shv_allocate(study->memory, SHV_PART_GENERAL, settings, sizeof *study->results);
    judge->samples = shv_allocate(study->memory, SHV_PART_GENERAL, samples, sizeof(double));
    if (study->results && judge->samples) return shv_study_figure_reserve(study, error);
    return shv_fail_memory(error, "the rows of a study", settings * sizeof *study->results);
}

ShvStatus shv_study_measure(ShvStudy *study, ShvError *error)
{
    Judge judge = {.study = study};
    int32_t missing = 0;
    for (int32_t i = 0; i < shv_study_run_count(study); i++) {
        ShvOutcome outcome;
        const ShvStatus loaded = shv_study_load(study, i, &outcome, error);
        if (loaded == SHV_NO_MEMORY) return loaded;
        missing += loaded != SHV_OK;
        shv_outcome_release(&outcome);
    }
    if (missing > 0)
        return shv_fail(error, SHV_BAD_INPUT, "%d of %d runs are missing in '%s'; run the study, or its other tasks",
                        (int)missing, (int)shv_study_run_count(study), study->options.output);
    study->timings_valid = study->same_processor = true;
    study->processor[0] = '\0';
    ShvStatus status = reserve(&judge, error);
    if (status == SHV_OK) status = judge_all(&judge, error);
    if (status == SHV_OK && study->plan.pool.failed) status = shv_fail_memory(error, "names of settings", 0);
    release_outcomes(judge.references, study->plan.members);
    shv_release(judge.samples);
    if (status == SHV_OK) return SHV_OK;
    shv_release(study->results);
    study->results = NULL;
    return status;
}

/* ---- views ---- */

int32_t shv_study_row_count(const ShvStudy *study)
{
    return study->results ? study->setting_count : 0;
}

const ShvStudyRow *shv_study_row(const ShvStudy *study, int32_t index)
{
    return &study->results[index].row;
}

const char *shv_study_reference(const ShvStudy *study)
{
    return study->reference_name;
}

bool shv_study_timings_valid(const ShvStudy *study)
{
    return study->timings_valid;
}

int32_t shv_study_measure_count(const ShvStudy *study)
{
    return study->plan.measure_count;
}

const char *shv_study_measure_name(const ShvStudy *study, int32_t measure)
{
    return study->plan.measures[measure].name;
}

const char *shv_study_error_unit(const ShvStudy *study, int32_t measure)
{
    return study->plan.measures[measure].error_unit;
}

double shv_study_scatter(const ShvStudy *study, int32_t measure)
{
    return study->scatter[measure];
}
