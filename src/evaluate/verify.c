/* Verification: the runs of a case. */
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "evaluate/case.h"

enum { MOST_OVERRIDES = 64, LARGEST_CASE = 1 << 20 };

ShvVerifyOptions shv_verify_default(void)
{
    return (ShvVerifyOptions){.cookie = SHV_DEFINITION_COOKIE};
}

double shv_run_seconds(const ShvOutcome *outcome)
{
    const double seconds = shv_outcome_number(outcome, "run.seconds");
    return shv_outcome_number(outcome, "run.setup") + (isnan(seconds) ? 0.0 : seconds);
}

/* ---- runs ---- */

static ShvStatus load_scene(ShvVerification *made, const ShvCaseRun *run, ShvScene **scene, ShvError *error)
{
    const char *overrides[MOST_OVERRIDES], *at = run->set;
    ShvPool *work = &made->work;
    char *path;
    int32_t count = 0;
    for (char *line = shv_next_line(work, &at); line; line = shv_next_line(work, &at)) {
        if (count == MOST_OVERRIDES)
            return shv_fail(error, SHV_BAD_INPUT, "'set' has more than %d lines", (int)MOST_OVERRIDES);
        overrides[count++] = line;
    }
    if (work->failed) return shv_fail_memory(error, "overrides", 0);
    SHV_TRY(shv_path_join(made->memory, SHV_PART_SCENE, made->folder, run->scene ? run->scene : made->item->scene,
                          &path, error));
    const ShvStatus status = shv_scene_load(scene, path, overrides, count, made->memory, NULL, error);
    shv_release(path);
    return status;
}

/* A scene that is refused is a finding where something is expected of the run, else a fault of the case. */
static ShvStatus simulate(ShvVerification *made, const ShvCaseRun *run, ShvOutcome *outcome, ShvError *error)
{
    ShvScene *scene = NULL;
    const ShvStatus loaded = load_scene(made, run, &scene, error);
    if (loaded == SHV_BAD_INPUT && run->expect) {
        outcome->status = loaded;
        shv_format(outcome->message, sizeof outcome->message, "%s", error->message);
        shv_outcome_set(outcome, "run.setup", 0.0);
        return SHV_OK;
    }
    SHV_TRY(loaded);
    const ShvRunOrder order = {.scene = shv_scene_definition(scene),
                               .folder = shv_scene_folder(scene),
                               .memory = made->memory,
                               .multiple = (double)NAN,
                               .repeats = 1};
    const ShvStatus status = shv_run_scene(outcome, &order, error);
    shv_scene_destroy(scene);
    made->view.seconds += shv_run_seconds(outcome);
    return status;
}

static ShvStatus make_run(ShvVerification *made, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvKeptRun *now = made->now = &made->runs[made->run_count++];
    now->named.name = run->head.name;
    now->title = run->title ? run->title : run->head.name;
    now->outcome = (ShvOutcome){.memory = made->memory};
    now->named.outcome = &now->outcome;
    if (made->run_count > 1) now->named.before = &now[-1].named;
    SHV_TRY(simulate(made, run, &now->outcome, error));
    return shv_judge_run(made, run, last, error);
}

static ShvStatus make_runs(ShvVerification *made, ShvError *error)
{
    static const ShvCaseRun as_it_is = {.head = {.name = ""}};
    const bool any = made->item->runs.count > 0, full = made->options->full;
    const ShvCaseRun *runs = any ? made->item->runs.data : &as_it_is;
    const int32_t count = any ? made->item->runs.count : 1;
    int32_t last = -1;
    for (int32_t i = 0; i < count; i++)
        if (full || !runs[i].full) last = i;
    made->runs = shv_pool_take(&made->work, (size_t)count, sizeof *made->runs);
    if (!made->runs) return shv_fail_memory(error, "runs", (size_t)count * sizeof *made->runs);
    if (last < 0) return shv_fail(error, SHV_BAD_INPUT, "all runs of this case belong to the full set; give --full");
    for (int32_t i = 0; i < count; i++)
        if (full || !runs[i].full) SHV_TRY(make_run(made, &runs[i], i == last, error));
    return shv_judge_together(made, made->run_count == count, error);
}

/* ---- the case ---- */

/* "rod" of "a/rod.case.yaml". */
static const char *case_name(ShvPool *pool, const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    const char *dot = strchr(name, '.');
    return shv_pool_text(pool, name, dot && dot != name ? (size_t)(dot - name) : strlen(name));
}

static ShvStatus read_case(ShvVerification *made, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    char *text = NULL;
    size_t length = 0;
    ShvPool *work = &made->work, *texts = &made->texts;
    SHV_TRY(shv_read_file(work->memory, SHV_PART_SCENE, path, LARGEST_CASE, &text, &length, error));
    *diagnostics = shv_diagnostics_create(work->memory, path, NULL, 0);
    if (*diagnostics) made->item = shv_case_read(text, length, work, texts, *diagnostics);
    shv_release(text);
    if (!*diagnostics) return shv_fail_memory(error, "a verification case", length);
    return shv_diagnostics_end(*diagnostics, work->failed || texts->failed, "the case", length, error);
}

static ShvStatus verify(ShvVerification *made, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    SHV_TRY(read_case(made, path, diagnostics, error));
    const ShvCaseItem *item = made->item;
    if (made->options->short_set && !item->in_short) return SHV_OK;
    made->view = (ShvVerifyCase){.name = case_name(&made->texts, path),
                                 .title = item->title,
                                 .scene = item->scene,
                                 .source = item->source,
                                 .remark = item->remark ? item->remark : ""};
    if (!made->view.name) return shv_fail_memory(error, "a name", strlen(path));
    SHV_TRY(shv_path_folder(made->memory, SHV_PART_SCENE, path, &made->folder, error));
    const ShvStatus status = make_runs(made, error);
    return status == SHV_OK ? SHV_OK : shv_fail_within(error, status, "case %s", made->view.name);
}

ShvStatus shv_verify_run(ShvVerification **verification, const char *path, const ShvVerifyOptions *options,
                         ShvDiagnostics **diagnostics, ShvError *error)
{
    const ShvVerifyOptions defaults = shv_verify_default();
    ShvDiagnostics *own = NULL;
    *verification = NULL;
    if (!diagnostics) diagnostics = &own;
    *diagnostics = NULL;
    if (!options) options = &defaults;
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_verify_default()");
    ShvVerification *made = shv_allocate(options->memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a verification", sizeof *made);
    made->memory = made->texts.memory = made->work.memory = options->memory;
    made->options = options;
    const ShvStatus status = verify(made, path, diagnostics, error);
    for (int32_t i = 0; i < made->run_count; i++) shv_outcome_release(&made->runs[i].outcome);
    shv_pool_release(&made->work);
    shv_release(made->folder);
    shv_diagnostics_destroy(own);
    if (status == SHV_OK && made->view.name)
        *verification = made;
    else
        shv_verify_destroy(made);
    return status;
}

void shv_verify_destroy(ShvVerification *verification)
{
    if (!verification) return;
    shv_pool_release(&verification->texts);
    shv_release(verification->rows);
    shv_release(verification);
}

const ShvVerifyCase *shv_verification_case(const ShvVerification *verification)
{
    return &verification->view;
}
