/* Runs of a study: one file each, named by a hash of all that the run follows from, so that what is there is never stale. */
#include "evaluate/study.h"

#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/random.h"
#include "base/text.h"
#include "evaluate/trajectory.h"
#include "record/checkpoint.h"
#include "scene/inputs.h"
#include "scene/source.h"
#include "shiver/version.h"

ShvStudyOptions shv_study_default(void)
{
    return (ShvStudyOptions){.cookie = SHV_DEFINITION_COOKIE};
}

/* ---- scenes ---- */

ShvStatus shv_study_scene(const ShvStudy *study, int32_t index, ShvScene **scene, ShvError *error)
{
    const ShvStudySetting *setting = &study->plan.settings[index];
    return shv_scene_parse(scene, study->text, study->length, study->scene_path, study->folder, setting->overrides,
                           setting->override_count, study->memory, NULL, error);
}

ShvSceneDefinition shv_study_member(const ShvStudy *study, const ShvSceneDefinition *scene, int32_t member,
                                    ShvObjectDefinition *objects)
{
    ShvSceneDefinition changed = *scene;
    if (member == 0) return changed;
    if (study->plan.seeds) changed.seed += (uint64_t)member;
    for (int32_t i = 0; i < scene->object_count; i++) {
        objects[i] = scene->objects[i];
        for (int k = 0; k < 3; k++)
            objects[i].placement.position[k] +=
                study->plan.shift * (2.0 * shv_random_uniform((uint64_t)member, (uint64_t)(3 * i + k)) - 1.0);
    }
    changed.objects = objects;
    return changed;
}

/* ---- what a run follows from ---- */

static ShvStatus hash_setting(const ShvStudy *study, const ShvScene *scene, const ShvStudySetting *setting,
                              uint64_t *hash, ShvError *error)
{
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    *hash = shv_scene_hash(scene);
    *hash = shv_hash_text(*hash, shv_version());
    *hash = shv_hash_bytes(*hash, &setting->multiple, sizeof setting->multiple);
    *hash = shv_hash_bytes(*hash, &study->plan.repeats, sizeof study->plan.repeats);
    *hash = shv_hash_bytes(*hash, &study->plan.audit_wakes, sizeof study->plan.audit_wakes);
    return shv_inputs_hash(study->memory, study->folder, definition, hash, error);
}

static uint64_t hash_member(const ShvStudy *study, uint64_t hash, int32_t member)
{
    if (member == 0) return hash;
    hash = shv_hash_bytes(hash, &member, sizeof member);
    hash = shv_hash_bytes(hash, &study->plan.seeds, sizeof study->plan.seeds);
    return shv_hash_bytes(hash, &study->plan.shift, sizeof study->plan.shift);
}

/* Unless a setting is it. */
static void name_reference(ShvStudy *study, const ShvScene *scene)
{
    static const char *const laws[] = {"none", "flight", "bounce", "slide", "roll", "rest"};
    const ShvReferenceDefinition *form = &shv_scene_definition(scene)->reference;
    shv_format(study->reference_name, sizeof study->reference_name, "closed form (%s of %.60s%s%.60s)", laws[form->law],
               form->body ? form->body : "every body", form->on ? " on " : "", form->on ? form->on : "");
}

/* Reads every scene once, so that nothing is run of a study that cannot be run whole. */
static ShvStatus make_keys(ShvStudy *study, const char *file, ShvError *error)
{
    const int32_t members = study->plan.members;
    const size_t count = (size_t)study->setting_count * (size_t)members;
    study->keys = shv_pool_take(&study->pool, count, sizeof *study->keys);
    if (!study->keys) return shv_fail_memory(error, "the runs of a study", count * sizeof *study->keys);
    for (int32_t s = 0; s < study->setting_count; s++) {
        const ShvStudySetting *setting = &study->plan.settings[s];
        ShvScene *scene;
        const ShvStatus status = shv_study_scene(study, s, &scene, error);
        if (status != SHV_OK) return shv_fail_within(error, status, "%s:%d", file, (int)setting->line);
        if (s == 0) name_reference(study, scene);
        uint64_t hash = 0;
        const ShvStatus hashed = hash_setting(study, scene, setting, &hash, error);
        for (int32_t m = 0; m < members; m++) study->keys[s * members + m] = hash_member(study, hash, m);
        shv_scene_destroy(scene);
        if (hashed != SHV_OK) return hashed;
    }
    return SHV_OK;
}

/* ---- files ---- */

ShvStatus shv_study_path(const ShvStudy *study, int32_t run, const char *file, char path[SHV_STUDY_PATH],
                         ShvError *error)
{
    char name[64];
    if (run >= 0) shv_format(name, sizeof name, "runs/%016llx.run", (unsigned long long)study->keys[run]);
    if (shv_format(path, SHV_STUDY_PATH, "%s/%s", study->options.output, run >= 0 ? name : file) < SHV_STUDY_PATH)
        return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the name of the folder '%.80s…' is too long", study->options.output);
}

/* A report that is not ours stays. */
static ShvStatus make_folders(const ShvStudy *study, ShvError *error)
{
    struct stat about;
    char runs[SHV_STUDY_PATH], report[SHV_STUDY_PATH];
    SHV_TRY(shv_study_path(study, -1, "runs", runs, error));
    SHV_TRY(shv_study_path(study, -1, "report.html", report, error));
    if (!study->options.force && stat(runs, &about) != 0 && stat(report, &about) == 0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%s' has a report but no runs of a study; name another folder, or --force",
                        study->options.output);
    SHV_TRY(shv_make_folder(study->options.output, error));
    return shv_make_folder(runs, error);
}

ShvStatus shv_study_load(const ShvStudy *study, int32_t run, ShvOutcome *outcome, ShvError *error)
{
    char path[SHV_STUDY_PATH];
    *outcome = (ShvOutcome){.memory = study->memory};
    SHV_TRY(shv_study_path(study, run, NULL, path, error));
    SHV_TRY(shv_outcome_load(outcome, path, study->memory, error));
    if (outcome->key == study->keys[run]) return SHV_OK;
    shv_outcome_release(outcome);
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is of another run; remove it", path);
}

/* A run that was timed beside others does not count where times matter. */
static bool is_done(const ShvStudy *study, int32_t run)
{
    ShvOutcome outcome;
    ShvError ignored;
    if (shv_study_load(study, run, &outcome, &ignored) != SHV_OK) return false;
    const bool done = study->options.shared || !outcome.shared;
    shv_outcome_release(&outcome);
    return done;
}

/* ---- what is asked for ---- */

static ShvStatus check_options(const ShvStudyOptions *options, ShvError *error)
{
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_study_default()");
    if (!options->output || options->output[0] == '\0')
        return shv_fail(error, SHV_BAD_INPUT, "a study needs a folder for its results");
    if (options->tasks < 0 || options->task < 0 || options->task > options->tasks ||
        (options->tasks > 0 && options->task < 1))
        return shv_fail(error, SHV_BAD_INPUT, "a task is 1 to the number of tasks, not %d of %d", (int)options->task,
                        (int)options->tasks);
    return SHV_OK;
}

/* A text that is given, or else that of a file. */
static ShvStatus read_text(const ShvStudy *study, const char *given, const char *file, char **text, size_t *length,
                           ShvError *error)
{
    if (!given) return shv_read_file(study->memory, SHV_PART_SCENE, file, SHV_SCENE_LARGEST_BYTES, text, length, error);
    *length = strlen(given);
    *text = shv_copy_text(study->memory, SHV_PART_SCENE, given);
    return *text ? SHV_OK : shv_fail_memory(error, "a study", *length);
}

static ShvStatus read_texts(ShvStudy *study, const char *scene, const char *file, ShvError *error)
{
    size_t length;
    const ShvStudyOptions *options = &study->options;
    SHV_TRY(read_text(study, options->scene_text, scene, &study->text, &study->length, error));
    SHV_TRY(shv_path_folder(study->memory, SHV_PART_SCENE, scene, &study->folder, error));
    SHV_TRY(read_text(study, file ? NULL : options->plan, file, &study->study_text, &length, error));
    if (!file) file = "the comparison";
    SHV_TRY(shv_study_plan_read(&study->plan, study->study_text, length, file, options->overrides,
                                options->override_count, study->memory, error));
    study->setting_count = study->plan.setting_count + (study->plan.reference == SHV_STUDY_SETTING ? 1 : 0);
    return make_keys(study, file, error);
}

/* A reference that is one of the settings is not run besides. */
static void find_reference(ShvStudy *study)
{
    const int32_t members = study->plan.members, own = study->plan.setting_count;
    study->reference = -1;
    if (study->plan.reference == SHV_STUDY_CLOSED) return;
    study->reference = 0;
    while (study->keys[study->reference * members] != study->keys[own * members]) study->reference++;
    if (study->reference < own) study->setting_count = own;
    shv_format(study->reference_name, sizeof study->reference_name, "run of %.220s",
               study->plan.settings[study->reference].title);
}

/* ---- running ---- */

static void tell(const ShvStudy *study, int32_t run)
{
    const ShvStudySetting *setting = &study->plan.settings[run / study->plan.members];
    char text[400], member[40] = "";
    if (!study->options.begins) return;
    if (study->plan.members > 1) shv_format(member, sizeof member, " (member %d)", (int)(run % study->plan.members));
    shv_format(text, sizeof text, "%s%s", setting->title, member);
    study->options.begins(study->options.begins_data, text);
}

/* `path` NULL: only the first frame, to see whether the closed form fits. */
static ShvStatus run_member(const ShvStudy *study, int32_t run, const ShvScene *scene, const char *path,
                            ShvOutcome *outcome, ShvError *error)
{
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    const size_t count = (size_t)definition->object_count;
    ShvObjectDefinition *objects = shv_allocate(study->memory, SHV_PART_GENERAL, count, sizeof *objects);
    if (!objects) return shv_fail_memory(error, "shifted objects", count * sizeof *objects);
    const ShvSceneDefinition member = shv_study_member(study, definition, run % study->plan.members, objects);
    const ShvRunOrder order = {.scene = &member,
                               .folder = shv_scene_folder(scene),
                               .memory = study->memory,
                               .multiple = study->plan.settings[run / study->plan.members].multiple,
                               .repeats = path ? study->plan.repeats : 1,
                               .repeat_below = study->options.repeat_below,
                               .audit_wakes = study->plan.audit_wakes,
                               .look = !path,
                               .checkpoint = path,
                               .key = study->keys[run],
                               .stop = study->options.stop,
                               .stop_data = study->options.stop_data};
    const ShvStatus status = shv_run_scene(outcome, &order, error);
    shv_release(objects);
    return status;
}

static ShvStatus do_run(const ShvStudy *study, int32_t run, const char *path, ShvError *error)
{
    ShvScene *scene;
    ShvOutcome outcome = {.memory = study->memory};
    double errors[SHV_TRAJECTORY_MEASURES];
    SHV_TRY(shv_study_scene(study, run / study->plan.members, &scene, error));
    ShvStatus status = run_member(study, run, scene, path, &outcome, error);
    outcome.shared = study->options.shared;
    if (status == SHV_OK && path) status = shv_outcome_save(&outcome, path, error);
    if (status == SHV_OK && path) shv_checkpoint_remove(path, study->memory, -1);
    if (status == SHV_OK && !path) status = shv_trajectory_errors(&outcome, NULL, errors, error);
    shv_outcome_release(&outcome);
    shv_scene_destroy(scene);
    return status;
}

ShvStatus shv_study_run(ShvStudy *study, ShvError *error)
{
    const ShvStudyOptions *options = &study->options;
    const int32_t count = study->setting_count * study->plan.members;
    char path[SHV_STUDY_PATH];
    for (int32_t i = 0; i < count; i++) {
        if (options->tasks > 0 && i % options->tasks != options->task - 1) continue;
        if (!options->force && is_done(study, i)) continue;
        if (options->stop && options->stop(options->stop_data))
            return shv_fail(error, SHV_INTERRUPTED, "stopped before run %d of %d", (int)i + 1, (int)count);
        tell(study, i);
        SHV_TRY(shv_study_path(study, i, NULL, path, error));
        SHV_TRY(do_run(study, i, path, error));
    }
    return SHV_OK;
}

/* ---- opening and closing ---- */

ShvStatus shv_study_open(ShvStudy **study, const char *scene, const char *file, const ShvStudyOptions *options,
                         ShvError *error)
{
    *study = NULL;
    SHV_TRY(check_options(options, error));
    ShvStudy *made = shv_allocate(options->memory, SHV_PART_GENERAL, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a study", sizeof *made);
    made->memory = made->pool.memory = options->memory;
    made->options = *options;
    made->scene_path = scene;
    ShvStatus status = read_texts(made, scene, file, error);
    if (status == SHV_OK) find_reference(made);
    /* The closed form must fit the scene before anything is run. */
    if (status == SHV_OK && made->reference < 0) status = do_run(made, 0, NULL, error);
    if (status == SHV_OK) status = make_folders(made, error);
    if (status == SHV_OK)
        *study = made;
    else
        shv_study_close(made);
    return status;
}

void shv_study_close(ShvStudy *study)
{
    if (!study) return;
    shv_study_plan_release(&study->plan);
    shv_release(study->text);
    shv_release(study->study_text);
    shv_release(study->folder);
    shv_pool_release(&study->pool);
    shv_release(study);
}
