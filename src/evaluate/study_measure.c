/* From the runs of a study to its rows. */
#include <string.h>

#include "base/text.h"
#include "evaluate/names.h"
#include "evaluate/sampler.h"
#include "evaluate/study.h"

_Static_assert((int)SHV_COST_COUNT <= (int)SHV_STUDY_MOST_COSTS, "a row has room for all costs");

/* What one measuring works with. */
typedef struct Judge {
    ShvStudy *study;
    ShvOutcome *references; /* one a member; NULL with a closed form */
    double *samples;        /* measures × members: errors, then values, then run times */
    ShvPool series;         /* of the run that is judged */
} Judge;

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

/* Errors and values (NULL: not wanted) by measure of the study, each `apart` from the next. */
static ShvStatus judge_run(Judge *judge, const ShvOutcome *outcome, const ShvOutcome *reference, double *errors,
                           double *values, int64_t apart, ShvError *error)
{
    const ShvStudyPlan *plan = &judge->study->plan;
    const ShvNamedRun other = {.name = "reference", .outcome = reference};
    const ShvNamedRun own = {.name = "", .outcome = outcome, .before = &other};
    const bool done = outcome->status == SHV_OK;
    ShvNames names = {.pool = &judge->series, .run = &own};
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < plan->measure_count && status == SHV_OK; i++) {
        const ShvMeasure *measure = &plan->measures[i];
        status = take(&names, measure, done ? measure->error : NULL, &errors[i * apart], error);
        if (values && status == SHV_OK)
            status = take(&names, measure, done ? measure->value : NULL, &values[i * apart], error);
    }
    if (judge->series.failed) status = shv_fail_memory(error, "the series of a run", 0);
    shv_pool_release(&judge->series);
    return status;
}

/* ---- one run, in a row ---- */

/* Median of `count` numbers, those that are not finite left out; sorts them. NaN of none. */
static double median(double *values, int64_t count)
{
    int64_t finite = 0;
    for (int64_t i = 0; i < count; i++)
        if (isfinite(values[i])) values[finite++] = values[i];
    if (finite == 0) return (double)NAN;
    shv_sort_numbers(values, finite);
    return finite % 2 ? values[finite / 2] : 0.5 * (values[finite / 2 - 1] + values[finite / 2]);
}

/* The first member stands for step and cost; the first failure for the setting. Returns the median of the run's times, which
   sorts them. */
static double note_run(ShvStudyRow *row, const ShvOutcome *outcome, int32_t member)
{
    const ShvOutcomeList *seconds = shv_outcome_find(outcome, "run.seconds"),
                         *costs = shv_outcome_find(outcome, "run.costs");
    const ShvOutcomeList *courant = shv_outcome_find(outcome, "frame.courant");
    if (member == 0) {
        row->stable_step = shv_outcome_number(outcome, "run.stable_step");
        row->step = shv_outcome_number(outcome, "frame.step");
        for (int64_t i = 0; courant && i < courant->count; i++) row->courant = fmax(row->courant, courant->values[i]);
        for (int64_t i = 0; costs && i < costs->count && i < SHV_COST_COUNT; i++) row->costs[i] = costs->values[i];
    }
    if (outcome->status != SHV_OK && row->status == SHV_OK) {
        row->status = outcome->status;
        shv_format(row->message, sizeof row->message, "%.255s", outcome->message);
    }
    if (!seconds || seconds->count == 0) return (double)NAN;
    const double middle = median(seconds->values, seconds->count);
    row->seconds_low = fmin(row->seconds_low, seconds->values[0]);
    row->seconds_high = fmax(row->seconds_high, seconds->values[seconds->count - 1]);
    return middle;
}

/* Times of runs beside others, or on different processors, say nothing. */
static void note_machine(ShvStudy *study, const ShvOutcome *outcome)
{
    if (study->processor[0] == '\0') shv_format(study->processor, sizeof study->processor, "%s", outcome->processor);
    if (outcome->shared || strcmp(study->processor, outcome->processor) != 0) study->view.timings_valid = false;
}

/* ---- one setting ---- */

static double *sample(const Judge *judge, int32_t line, int32_t member)
{
    return judge->samples + (int64_t)line * judge->study->plan.members + member;
}

static ShvStatus judge_member(Judge *judge, int32_t setting, int32_t member, ShvError *error)
{
    ShvStudy *study = judge->study;
    const int32_t measures = study->plan.measure_count, members = study->plan.members;
    ShvOutcome outcome;
    SHV_TRY(shv_study_load(study, setting * members + member, &outcome, error));
    *sample(judge, 2 * measures, member) = note_run(&study->rows[setting], &outcome, member);
    note_machine(study, &outcome);
    const ShvStatus status = judge_run(judge, &outcome, judge->references ? &judge->references[member] : NULL,
                                       sample(judge, 0, member), sample(judge, measures, member), members, error);
    shv_outcome_release(&outcome);
    return status;
}

static ShvStatus judge_setting(Judge *judge, int32_t index, ShvError *error)
{
    ShvStudy *study = judge->study;
    const ShvStudySetting *setting = &study->plan.settings[index];
    const int32_t measures = study->plan.measure_count, members = study->plan.members;
    ShvStudyRow *row = &study->rows[index];
    *row = (ShvStudyRow){.name = setting->name,
                         .series = setting->series,
                         .label = setting->label,
                         .is_reference = index == study->reference,
                         .seconds_low = HUGE_VAL};
    for (int32_t m = 0; m < members; m++) SHV_TRY(judge_member(judge, index, m, error));
    for (int32_t i = 0; i < measures; i++) {
        double low = (double)NAN, high = low;
        for (int32_t m = 0; m < members; m++) {
            low = fmin(low, *sample(judge, i, m));
            high = fmax(high, *sample(judge, i, m));
        }
        row->errors_low[i] = low;
        row->errors_high[i] = high;
        row->errors[i] = median(sample(judge, i, 0), members);
        row->values[i] = median(sample(judge, measures + i, 0), members);
    }
    row->seconds = median(sample(judge, 2 * measures, 0), members);
    return SHV_OK;
}

/* ---- reference and scatter ---- */

/* All members of the reference. */
static ShvStatus load_references(Judge *judge, ShvError *error)
{
    const ShvStudy *study = judge->study;
    const int32_t count = study->plan.members;
    judge->references = shv_pool_take(&judge->study->pool, (size_t)count, sizeof *judge->references);
    if (!judge->references) return shv_fail_memory(error, "reference runs", (size_t)count * sizeof *judge->references);
    for (int32_t m = 0; m < count; m++) {
        ShvOutcome *outcome = &judge->references[m];
        SHV_TRY(shv_study_load(study, study->reference * count + m, outcome, error));
        if (outcome->status != SHV_OK)
            return shv_fail(error, outcome->status, "the run that the others are to be compared with failed: %s",
                            outcome->message);
    }
    return SHV_OK;
}

/* Errors of a run against another, `apart` from each other; of an error that needs no reference how far the two are apart. */
static ShvStatus compare_pair(Judge *judge, const ShvOutcome *a, const ShvOutcome *b, double *errors, int64_t apart,
                              ShvError *error)
{
    double other[SHV_STUDY_MOST_MEASURES];
    const ShvStudyPlan *plan = &judge->study->plan;
    SHV_TRY(judge_run(judge, a, b, errors, NULL, apart, error));
    SHV_TRY(judge_run(judge, b, a, other, NULL, 1, error));
    for (int32_t i = 0; i < plan->measure_count; i++)
        if (shv_measure_is_own(&plan->measures[i])) errors[i * apart] = fabs(errors[i * apart] - other[i]);
    return SHV_OK;
}

static ShvStatus find_scatter(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    const int32_t count = study->plan.members, measures = study->plan.measure_count, all = count * (count - 1) / 2;
    double *pairs = shv_pool_take(&study->pool, (size_t)all * (size_t)measures, sizeof *pairs);
    int32_t pair = 0;
    if (!pairs) return shv_fail_memory(error, "the scatter of an ensemble", (size_t)all * sizeof *pairs);
    for (int32_t a = 0; a < count; a++)
        for (int32_t b = a + 1; b < count; b++, pair++)
            SHV_TRY(compare_pair(judge, &judge->references[a], &judge->references[b], pairs + pair, all, error));
    for (int32_t i = 0; i < measures; i++) study->view.scatter[i] = median(pairs + (int64_t)i * all, all);
    return SHV_OK;
}

/* ---- fronts ---- */

bool shv_study_counts(const ShvStudyRow *row, int32_t measure)
{
    return row->status == SHV_OK && !row->is_reference && isfinite(row->errors[measure]) && isfinite(row->seconds);
}

int32_t shv_study_pick(const ShvStudy *study, int32_t measure, double largest)
{
    int32_t best = -1;
    for (int32_t i = 0; i < study->view.row_count; i++) {
        const ShvStudyRow *row = &study->rows[i], *other = best < 0 ? NULL : &study->rows[best];
        if (!shv_study_counts(row, measure) || !(row->errors[measure] <= largest)) continue;
        if (!other || row->seconds < other->seconds ||
            (row->seconds == other->seconds && row->errors[measure] < other->errors[measure]))
            best = i;
    }
    return best;
}

/* From the cheapest row on, each that is better than the last one marked by more than the scatter: a difference below that is
   none, and of equals the cheaper counts. */
void shv_study_mark_front(ShvStudy *study, int32_t measure)
{
    const double scatter = isnan(study->view.scatter[measure]) ? 0.0 : study->view.scatter[measure];
    double limit = HUGE_VAL;
    for (int32_t i; (i = shv_study_pick(study, measure, nextafter(limit, -HUGE_VAL))) >= 0;) {
        study->rows[i].on_front[measure] = true;
        limit = study->rows[i].errors[measure] - scatter;
    }
}

/* ---- all ---- */

static ShvStatus judge_all(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    if (study->reference >= 0) SHV_TRY(load_references(judge, error));
    if (study->plan.members > 1) SHV_TRY(find_scatter(judge, error));
    for (int32_t i = 0; i < study->setting_count; i++) SHV_TRY(judge_setting(judge, i, error));
    study->view.rows = study->rows;
    study->view.row_count = study->setting_count;
    for (int32_t i = 0; i < study->plan.measure_count; i++) shv_study_mark_front(study, i);
    return SHV_OK;
}

static ShvStatus reserve(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    ShvPool *pool = &study->pool;
    const size_t settings = (size_t)study->setting_count;
    study->rows = shv_pool_take(pool, settings, sizeof *study->rows);
    study->figure.draft.points = shv_pool_take(pool, settings, sizeof *study->figure.draft.points);
    study->figure.front = shv_pool_take(pool, settings, sizeof *study->figure.front);
    study->figure.draft.lines = shv_pool_take(pool, settings, sizeof *study->figure.draft.lines);
    study->figure.spans = shv_pool_take(pool, settings, sizeof *study->figure.spans);
    judge->samples = shv_pool_take(pool, (size_t)(2 * study->plan.measure_count + 1) * (size_t)study->plan.members,
                                   sizeof *judge->samples);
    return pool->failed ? shv_fail_memory(error, "the rows of a study", settings * sizeof *study->rows) : SHV_OK;
}

static ShvStatus check_missing(const ShvStudy *study, ShvError *error)
{
    const int32_t count = study->setting_count * study->plan.members;
    int32_t missing = 0;
    for (int32_t i = 0; i < count; i++) {
        ShvOutcome outcome;
        const ShvStatus loaded = shv_study_load(study, i, &outcome, error);
        if (loaded == SHV_NO_MEMORY) return loaded;
        missing += loaded != SHV_OK;
        shv_outcome_release(&outcome);
    }
    if (missing == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "%d of %d runs are missing in '%s'; run the study, or its other tasks",
                    (int)missing, (int)count, study->options.output);
}

ShvStatus shv_study_measure(ShvStudy *study, ShvError *error)
{
    Judge judge = {.study = study, .series = {.memory = study->memory}};
    SHV_TRY(check_missing(study, error));
    study->view = (ShvStudyView){.measure_count = study->plan.measure_count, .timings_valid = true};
    shv_format(study->view.reference, sizeof study->view.reference, "%s", study->reference_name);
    study->processor[0] = '\0';
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        study->view.measures[i] = study->plan.measures[i].name;
        study->view.error_units[i] = study->plan.measures[i].error_unit;
    }
    ShvStatus status = reserve(&judge, error);
    if (status == SHV_OK) status = judge_all(&judge, error);
    for (int32_t m = 0; judge.references && m < study->plan.members; m++) shv_outcome_release(&judge.references[m]);
    if (status != SHV_OK) study->view.rows = NULL;
    if (status != SHV_OK) study->view.row_count = 0;
    return status;
}

const ShvStudyView *shv_study_view(const ShvStudy *study)
{
    return &study->view;
}
