/* From the runs of a study to its rows. */
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "evaluate/study.h"

/* What one measuring works with. */
typedef struct Judge {
    ShvStudy *study;
    ShvDigest *references; /* one a member; a run file stands for all; none with a closed form */
    int32_t reference_count;
    double *samples; /* measures × members: errors, then values, then run times */
} Judge;

/* Bodies and closed forms of one setting, for measures that follow bodies. */
typedef struct Way {
    ShvScene *scene;
    ShvComparison comparison;
} Way;

/* ---- the way of bodies ---- */

static ShvStatus look_at_start(const ShvStudy *study, Way *way, ShvError *error)
{
    ShvSimulation *simulation;
    ShvSimulationOptions options = shv_simulation_options_default();
    ShvComparison *comparison = &way->comparison;
    options.folder = shv_scene_folder(way->scene);
    options.memory = study->memory;
    SHV_TRY(shv_simulation_create(&simulation, comparison->scene, &options, error));
    ShvStatus status = shv_simulation_advance(simulation, error);
    if (status == SHV_OK)
        status = shv_bodies_create(&comparison->bodies, comparison->scene, shv_simulation_frame(simulation),
                                   study->memory, error);
    if (status == SHV_OK && study->plan.reference == SHV_STUDY_CLOSED)
        status = shv_compare_with_closed_form(comparison, simulation, error);
    for (int32_t i = 0; i < comparison->bodies.count && study->plan.reference != SHV_STUDY_CLOSED; i++)
        comparison->bodies.items[i].chosen = true;
    shv_simulation_destroy(simulation);
    return status;
}

static void close_way(Way *way)
{
    shv_bodies_release(&way->comparison.bodies);
    shv_release(way->comparison.forms);
    shv_scene_destroy(way->scene);
}

static ShvStatus open_way(const ShvStudy *study, int32_t setting, Way *way, ShvError *error)
{
    *way = (Way){.comparison = {.memory = study->memory, .finest_run = -1}};
    SHV_TRY(shv_study_scene(study, setting, &way->scene, error));
    way->comparison.scene = shv_scene_definition(way->scene);
    ShvStatus status = SHV_OK;
    if (study->plan.reference == SHV_STUDY_CLOSED && way->comparison.scene->reference.law == SHV_REFERENCE_NONE)
        status = shv_fail(error, SHV_BAD_INPUT,
                          "the study's reference is the closed form, but the scene has no 'reference'; give it one");
    if (status == SHV_OK) status = look_at_start(study, way, error);
    if (status != SHV_OK) close_way(way);
    return status;
}

static ShvStatus follow(Way *way, const ShvDigest *digest, const ShvDigest *reference, double errors[], ShvError *error)
{
    ShvComparison *comparison = &way->comparison;
    if (reference) {
        comparison->finest = reference->states;
        comparison->finest_frames = reference->frame_count;
    }
    for (int32_t i = 0; reference && i < digest->frame_count && i < reference->frame_count; i++)
        if (fabs(digest->times[i] - reference->times[i]) > 1e-9 * comparison->scene->duration)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the frames of the runs are not at the same times; give all one output.rate and no "
                            "output.fracture_every");
    return shv_study_measure_way(errors, comparison, digest, error);
}

/* ---- one run ---- */

/* By measure of the study. `way` may be NULL. */
static ShvStatus judge_run(const ShvStudy *study, Way *way, const ShvDigest *digest, const ShvDigest *reference,
                           double *errors, ShvError *error)
{
    double by_kind[SHV_MEASURE_COUNT];
    for (int i = 0; i < SHV_MEASURE_COUNT; i++) by_kind[i] = (double)NAN;
    if (way && digest->frame_count > 0) SHV_TRY(follow(way, digest, reference, by_kind, error));
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasureKind kind = study->plan.measures[i];
        errors[i] =
            shv_study_measure_of(kind)->track ? by_kind[kind] : shv_study_measure_error(kind, digest, reference);
        if (digest->status != SHV_OK) errors[i] = (double)NAN;
    }
    return SHV_OK;
}

static const ShvDigest *reference_of(const Judge *judge, int32_t member)
{
    if (judge->reference_count == 0) return NULL;
    return &judge->references[judge->reference_count > 1 ? member : 0];
}

/* The first member stands for step and cost; the first failure for the setting. */
static void note_run(ShvStudyResult *result, const ShvDigest *digest, int32_t member)
{
    ShvStudyRow *row = &result->row;
    if (member == 0) {
        row->stable_step = digest->numbers[SHV_DIGEST_STABLE_STEP];
        row->step = digest->numbers[SHV_DIGEST_STEP];
        row->courant = digest->numbers[SHV_DIGEST_COURANT];
        memcpy(result->costs, digest->costs, sizeof result->costs);
    }
    for (int32_t i = 0; i < digest->repeats; i++) {
        row->seconds_low = fmin(row->seconds_low, digest->seconds[i]);
        row->seconds_high = fmax(row->seconds_high, digest->seconds[i]);
    }
    if (digest->status == SHV_OK || row->status != SHV_OK) return;
    row->status = digest->status;
    shv_format(row->message, sizeof row->message, "%s", digest->message);
}

static void note_machine(ShvStudy *study, const ShvDigest *digest)
{
    if (study->processor[0] == '\0')
        shv_format(study->processor, sizeof study->processor, "%s", digest->processor);
    else if (strcmp(study->processor, digest->processor) != 0)
        study->same_processor = false;
    if (digest->shared || !study->same_processor) study->timings_valid = false;
}

/* ---- one setting ---- */

static double *sample(const Judge *judge, int32_t line, int32_t member)
{
    return judge->samples + (int64_t)line * judge->study->plan.members + member;
}

static ShvStatus judge_member(Judge *judge, Way *way, int32_t setting, int32_t member, ShvError *error)
{
    ShvStudy *study = judge->study;
    const int32_t measures = study->plan.measure_count;
    double errors[SHV_MEASURE_COUNT];
    ShvDigest digest;
    SHV_TRY(shv_study_load(study, setting * study->plan.members + member, &digest, error));
    note_run(&study->results[setting], &digest, member);
    note_machine(study, &digest);
    const ShvStatus status = judge_run(study, way, &digest, reference_of(judge, member), errors, error);
    for (int32_t i = 0; i < measures && status == SHV_OK; i++) {
        const bool good = digest.status == SHV_OK;
        *sample(judge, i, member) = errors[i];
        *sample(judge, measures + i, member) =
            good ? shv_study_measure_value(study->plan.measures[i], &digest) : (double)NAN;
    }
    *sample(judge, 2 * measures, member) = shv_digest_seconds(&digest);
    shv_digest_release(&digest);
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
        result->errors[i] = shv_median(sample(judge, i, 0), members);
        result->values[i] = shv_median(sample(judge, measures + i, 0), members);
    }
    result->row.seconds = shv_median(sample(judge, 2 * measures, 0), members);
}

static ShvStatus judge_setting(Judge *judge, int32_t setting, ShvError *error)
{
    ShvStudy *study = judge->study;
    const bool tracks = shv_study_tracks(study);
    Way way;
    start_result(study, setting);
    if (tracks) SHV_TRY(open_way(study, setting, &way, error));
    ShvStatus status = SHV_OK;
    for (int32_t m = 0; m < study->plan.members && status == SHV_OK; m++)
        status = judge_member(judge, tracks ? &way : NULL, setting, m, error);
    if (tracks) close_way(&way);
    if (status == SHV_OK) finish_result(judge, setting);
    return status;
}

/* ---- scatter ---- */

/* Of an error that needs no reference: how far two runs' are from each other. */
static void differ(const ShvStudy *study, const ShvDigest *a, const ShvDigest *b, double *errors)
{
    for (int32_t i = 0; i < study->plan.measure_count; i++) {
        const ShvMeasureKind kind = study->plan.measures[i];
        if (shv_study_measure_of(kind)->own)
            errors[i] = fabs(shv_study_measure_error(kind, a, NULL) - shv_study_measure_error(kind, b, NULL));
    }
}

static ShvStatus scatter_of(ShvStudy *study, const ShvDigest *members, Way *way, double *pairs, ShvError *error)
{
    const int32_t count = study->plan.members, all = count * (count - 1) / 2;
    int32_t pair = 0;
    for (int32_t a = 0; a < count; a++)
        for (int32_t b = a + 1; b < count; b++, pair++) {
            double errors[SHV_MEASURE_COUNT];
            SHV_TRY(judge_run(study, way, &members[a], &members[b], errors, error));
            differ(study, &members[a], &members[b], errors);
            for (int32_t i = 0; i < study->plan.measure_count; i++) pairs[(int64_t)i * all + pair] = errors[i];
        }
    for (int32_t i = 0; i < study->plan.measure_count; i++)
        study->scatter[i] = shv_median(pairs + (int64_t)i * all, all);
    return SHV_OK;
}

static ShvStatus find_scatter(ShvStudy *study, int32_t setting, const ShvDigest *members, ShvError *error)
{
    const int32_t count = study->plan.members;
    const size_t pairs = (size_t)count * (size_t)(count - 1) / 2 * (size_t)study->plan.measure_count;
    const bool tracks = shv_study_tracks(study);
    Way way;
    if (count == 1) return SHV_OK;
    double *samples = shv_allocate(study->memory, SHV_PART_GENERAL, pairs, sizeof *samples);
    if (!samples) return shv_fail_memory(error, "the scatter of an ensemble", pairs * sizeof *samples);
    ShvStatus status = tracks ? open_way(study, setting, &way, error) : SHV_OK;
    if (status == SHV_OK) {
        status = scatter_of(study, members, tracks ? &way : NULL, samples, error);
        if (tracks) close_way(&way);
    }
    shv_release(samples);
    return status;
}

/* ---- references ---- */

static void release_digests(ShvDigest *digests, int32_t count)
{
    for (int32_t i = 0; i < count; i++) shv_digest_release(&digests[i]);
    shv_release(digests);
}

/* All members of a setting. */
static ShvStatus load_members(const ShvStudy *study, int32_t setting, ShvDigest **digests, ShvError *error)
{
    const int32_t count = study->plan.members;
    *digests = shv_allocate(study->memory, SHV_PART_GENERAL, (size_t)count, sizeof **digests);
    if (!*digests) return shv_fail_memory(error, "reference runs", (size_t)count * sizeof **digests);
    ShvStatus status = SHV_OK;
    for (int32_t m = 0; m < count && status == SHV_OK; m++) {
        ShvDigest *digest = &(*digests)[m];
        status = shv_study_load(study, setting * count + m, digest, error);
        if (status == SHV_OK && digest->status != SHV_OK)
            status = shv_fail(error, digest->status, "the run that the others are to be compared with failed: %s",
                              digest->message);
    }
    if (status == SHV_OK) return SHV_OK;
    release_digests(*digests, count);
    *digests = NULL;
    return status;
}

static ShvStatus load_file(Judge *judge, ShvError *error)
{
    const ShvStudy *study = judge->study;
    judge->references = shv_allocate(study->memory, SHV_PART_GENERAL, 1, sizeof *judge->references);
    if (!judge->references) return shv_fail_memory(error, "a reference run", sizeof *judge->references);
    judge->reference_count = 1;
    char *path;
    SHV_TRY(
        shv_path_join(study->memory, SHV_PART_GENERAL, study->study_folder, study->plan.reference_file, &path, error));
    const ShvStatus status = shv_digest_of_run_file(judge->references, path, study->memory, error);
    shv_release(path);
    return status;
}

static void name_reference(ShvStudy *study)
{
    static const char *const laws[] = {"none", "flight", "bounce", "slide", "roll", "rest"};
    char *text = study->reference_name;
    const size_t size = sizeof study->reference_name;
    ShvScene *scene = NULL;
    ShvError ignored;
    if (study->plan.reference == SHV_STUDY_FILE) {
        shv_format(text, size, "run file %.200s", study->plan.reference_file);
    } else if (study->reference >= 0) {
        const ShvStudySetting *setting = shv_study_setting(study, study->reference);
        shv_format(text, size, "run of %.160s%s%.60s", setting->series, setting->label[0] ? ", " : "", setting->label);
    } else if (shv_study_scene(study, 0, &scene, &ignored) == SHV_OK) {
        shv_format(text, size, "closed form (%s)", laws[shv_scene_definition(scene)->reference.law]);
    }
    shv_scene_destroy(scene);
}

static ShvStatus find_references(Judge *judge, ShvError *error)
{
    ShvStudy *study = judge->study;
    name_reference(study);
    if (study->plan.reference == SHV_STUDY_FILE) SHV_TRY(load_file(judge, error));
    if (study->reference >= 0) {
        SHV_TRY(load_members(study, study->reference, &judge->references, error));
        judge->reference_count = study->plan.members;
        return find_scatter(study, study->reference, judge->references, error);
    }
    if (study->plan.members == 1) return SHV_OK;
    int32_t finest;
    ShvDigest *members;
    SHV_TRY(shv_study_finest(study, &finest, error));
    SHV_TRY(load_members(study, finest, &members, error));
    const ShvStatus status = find_scatter(study, finest, members, error);
    release_digests(members, study->plan.members);
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
        ShvDigest digest;
        const ShvStatus loaded = shv_study_load(study, i, &digest, error);
        if (loaded == SHV_NO_MEMORY) return loaded;
        missing += loaded != SHV_OK;
        shv_digest_release(&digest);
    }
    if (missing > 0)
        return shv_fail(error, SHV_BAD_INPUT, "%d of %d runs are missing in '%s'; run the study, or its other tasks",
                        (int)missing, (int)shv_study_run_count(study), study->options.output);
    study->timings_valid = study->same_processor = true;
    study->processor[0] = '\0';
    ShvStatus status = reserve(&judge, error);
    if (status == SHV_OK) status = judge_all(&judge, error);
    if (status == SHV_OK && study->plan.pool.failed) status = shv_fail_memory(error, "names of settings", 0);
    release_digests(judge.references, judge.reference_count);
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

const char *shv_study_name(const ShvStudy *study)
{
    return study->plan.name;
}

const char *shv_study_reference(const ShvStudy *study)
{
    return study->reference_name;
}

const char *shv_study_processor(const ShvStudy *study)
{
    return study->processor;
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
    return shv_study_measure_of(study->plan.measures[measure])->name;
}

const char *shv_study_error_unit(const ShvStudy *study, int32_t measure)
{
    return shv_study_measure_of(study->plan.measures[measure])->error_unit;
}

double shv_study_scatter(const ShvStudy *study, int32_t measure)
{
    return study->scatter[measure];
}

int32_t shv_study_cost_count(void)
{
    return SHV_COST_COUNT;
}

const char *shv_study_cost_name(int32_t cost)
{
    return shv_cost_name((ShvCost)cost);
}
