/* Verification: the runs of a case. */
#include <string.h>

#include "base/file.h"
#include "base/text.h"
#include "evaluate/case.h"

enum { MOST_OVERRIDES = 64, LARGEST_CASE = 1 << 20 };

/* A case that is run. */
typedef struct Verifier {
    ShvJudge judge;
    const ShvVerifyOptions *options;
    char *folder;
} Verifier;

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

static ShvStatus load_scene(Verifier *verifier, const ShvCaseRun *run, ShvScene **scene, ShvError *error)
{
    const char *overrides[MOST_OVERRIDES], *at = run->set;
    ShvMemory *memory = verifier->options->memory;
    ShvPool *work = &verifier->judge.work;
    char *path;
    int32_t count = 0;
    for (char *line = shv_next_line(work, &at); line; line = shv_next_line(work, &at)) {
        if (count == MOST_OVERRIDES)
            return shv_fail(error, SHV_BAD_INPUT, "'set' has more than %d lines", (int)MOST_OVERRIDES);
        overrides[count++] = line;
    }
    if (work->failed) return shv_fail_memory(error, "overrides", 0);
    SHV_TRY(shv_path_join(memory, SHV_PART_SCENE, verifier->folder,
                          run->scene ? run->scene : verifier->judge.item->scene, &path, error));
    const ShvStatus status = shv_scene_load(scene, path, overrides, count, memory, NULL, error);
    shv_release(path);
    return status;
}

/* A scene that is refused is a finding where something is expected of the run, else a fault of the case. */
static ShvStatus simulate(Verifier *verifier, const ShvCaseRun *run, ShvOutcome *outcome, ShvError *error)
{
    ShvScene *scene = NULL;
    const ShvStatus loaded = load_scene(verifier, run, &scene, error);
    if (loaded == SHV_BAD_INPUT && run->expect) {
        outcome->status = loaded;
        shv_format(outcome->message, sizeof outcome->message, "%s", error->message);
        shv_outcome_set(outcome, "run.setup", 0.0);
        return SHV_OK;
    }
    SHV_TRY(loaded);
    const ShvRunOrder order = {.scene = shv_scene_definition(scene),
                               .folder = shv_scene_folder(scene),
                               .memory = verifier->options->memory,
                               .multiple = (double)NAN,
                               .repeats = 1};
    const ShvStatus status = shv_run_scene(outcome, &order, error);
    shv_scene_destroy(scene);
    verifier->judge.made->view.seconds += shv_run_seconds(outcome);
    return status;
}

static ShvStatus make_run(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvJudge *judge = &verifier->judge;
    ShvKeptRun *now = judge->now = &judge->runs[judge->run_count++];
    now->named.name = run->head.name;
    now->title = run->title ? run->title : run->head.name;
    now->outcome = (ShvOutcome){.memory = verifier->options->memory};
    now->named.outcome = &now->outcome;
    if (judge->run_count > 1) now->named.before = &now[-1].named;
    SHV_TRY(simulate(verifier, run, &now->outcome, error));
    return shv_judge_run(judge, run, last, error);
}

static ShvStatus make_runs(Verifier *verifier, ShvError *error)
{
    static const ShvCaseRun as_it_is = {.head = {.name = ""}};
    ShvJudge *judge = &verifier->judge;
    const bool any = judge->item->runs.count > 0, full = verifier->options->full;
    const ShvCaseRun *runs = any ? judge->item->runs.data : &as_it_is;
    const int32_t count = any ? judge->item->runs.count : 1;
    int32_t last = -1;
    for (int32_t i = 0; i < count; i++)
        if (full || !runs[i].full) last = i;
    judge->runs = shv_pool_take(&judge->work, (size_t)count, sizeof *judge->runs);
    if (!judge->runs) return shv_fail_memory(error, "runs", (size_t)count * sizeof *judge->runs);
    if (last < 0) return shv_fail(error, SHV_BAD_INPUT, "all runs of this case belong to the full set; give --full");
    for (int32_t i = 0; i < count; i++)
        if (full || !runs[i].full) SHV_TRY(make_run(verifier, &runs[i], i == last, error));
    return shv_judge_orders(judge, judge->run_count == count, error);
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

static ShvStatus read_case(Verifier *verifier, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    char *text = NULL;
    size_t length = 0;
    ShvPool *work = &verifier->judge.work, *texts = &verifier->judge.made->texts;
    SHV_TRY(shv_read_file(work->memory, SHV_PART_SCENE, path, LARGEST_CASE, &text, &length, error));
    *diagnostics = shv_diagnostics_create(work->memory, path, NULL, 0);
    if (*diagnostics) verifier->judge.item = shv_case_read(text, length, work, texts, *diagnostics);
    shv_release(text);
    if (!*diagnostics) return shv_fail_memory(error, "a verification case", length);
    return shv_diagnostics_end(*diagnostics, work->failed || texts->failed, "the case", length, error);
}

static ShvStatus verify(Verifier *verifier, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    ShvVerification *made = verifier->judge.made;
    ShvVerifyCase *view = &made->view;
    SHV_TRY(read_case(verifier, path, diagnostics, error));
    const ShvCaseItem *item = verifier->judge.item;
    if (verifier->options->short_set && !item->in_short) return SHV_OK;
    *view = (ShvVerifyCase){.name = case_name(&made->texts, path),
                            .title = item->title,
                            .scene = item->scene,
                            .source = item->source,
                            .remark = item->remark ? item->remark : ""};
    if (!view->name) return shv_fail_memory(error, "a name", strlen(path));
    SHV_TRY(shv_path_folder(made->memory, SHV_PART_SCENE, path, &verifier->folder, error));
    const ShvStatus status = make_runs(verifier, error);
    return status == SHV_OK ? SHV_OK : shv_fail_within(error, status, "case %s", view->name);
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
    made->memory = made->texts.memory = options->memory;
    Verifier verifier = {.judge = {.made = made, .work = {.memory = options->memory}}, .options = options};
    const ShvStatus status = verify(&verifier, path, diagnostics, error);
    for (int32_t i = 0; i < verifier.judge.run_count; i++) shv_outcome_release(&verifier.judge.runs[i].outcome);
    shv_pool_release(&verifier.judge.work);
    shv_release(verifier.folder);
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
