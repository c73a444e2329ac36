#include "evaluate/verify.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/line.h"
#include "base/text.h"

enum { MOST_OVERRIDES = 64, LARGEST_CASE = 1 << 20 };

ShvVerifyOptions shv_verify_default(void)
{
    return (ShvVerifyOptions){.cookie = SHV_DEFINITION_COOKIE};
}

const char *shv_verdict_name(ShvVerdict verdict)
{
    static const char *const names[] = {"pass", "miss", "miss, explained", "shown", "failed"};
    return names[verdict];
}

/* ---- lines ---- */

char *shv_next_line(ShvPool *pool, const char **at)
{
    while (*at && **at) {
        const size_t length = strcspn(*at, "\n");
        const char *begin = *at, *end = *at + length;
        *at = *end ? end + 1 : end;
        while (begin < end && (*begin == ' ' || *begin == '\t')) begin++;
        while (end > begin && (end[-1] == ' ' || end[-1] == '\t' || end[-1] == '\r')) end--;
        if (begin < end) return shv_pool_text(pool, begin, (size_t)(end - begin));
    }
    return NULL;
}

/* A name that is defined by one of these lines, though not yet, is told apart from one that never is. */
static ShvStatus fail_variable(Verifier *verifier, const char *name, const char *rest, ShvStatus status,
                               ShvError *error)
{
    const char *at = rest;
    bool later = false;
    for (char *line = shv_next_line(&verifier->work, &at); line; line = shv_next_line(&verifier->work, &at)) {
        const size_t length = strcspn(line, " \t=");
        const char *quoted = strstr(error->message, "': '");
        later |=
            quoted && strncmp(quoted + 4, line, length) == 0 && strncmp(quoted + 4 + length, "' is unknown", 12) == 0;
    }
    if (!later) return shv_fail_within(error, status, "variable %.60s", name);
    const ShvError why = *error;
    return shv_fail(
        error, status,
        "variable %.60s: %.700s so far; definitions are taken from top to bottom, so that none can need itself", name,
        why.message);
}

/* "name = formula", the first of these lines */
static ShvStatus define(Verifier *verifier, char *line, const char *from, ShvError *error)
{
    char *equals = strchr(line, '=');
    if (!equals) return shv_fail(error, SHV_BAD_INPUT, "'%.200s' in 'let' is not of the form name = formula", line);
    char *end = equals;
    while (end > line && (end[-1] == ' ' || end[-1] == '\t')) end--;
    *end = '\0';
    ShvNamedRun *named = &verifier->now->named;
    ShvVariable *variable = shv_pool_take(&verifier->work, 1, sizeof *variable);
    if (!variable) return shv_fail_memory(error, "variables", sizeof *variable);
    const ShvFormulaNames names = shv_names(&verifier->names);
    const ShvStatus status = shv_formula_evaluate(equals + 1, &names, &variable->value, error);
    if (status != SHV_OK) return fail_variable(verifier, line, from, status, error);
    variable->name = line;
    variable->before = named->variables;
    named->variables = variable;
    return SHV_OK;
}

static ShvStatus define_all(Verifier *verifier, const char *let, ShvError *error)
{
    const char *from = let;
    for (char *line = shv_next_line(&verifier->work, &let); line; line = shv_next_line(&verifier->work, &let)) {
        SHV_TRY(define(verifier, line, from, error));
        from = let;
    }
    return verifier->work.failed ? shv_fail_memory(error, "variables", 0) : SHV_OK;
}

/* ---- rows ---- */

ShvStatus shv_verify_append(Verifier *verifier, const ShvVerifyRow *row, ShvError *error)
{
    ShvVerification *made = verifier->made;
    ShvVerifyCase *view = &made->view;
    if (view->row_count == made->row_capacity) {
        const size_t capacity = 2 * (size_t)made->row_capacity + 16;
        ShvVerifyRow *grown = shv_reallocate(made->memory, SHV_PART_RECORD, made->rows, capacity, sizeof *grown);
        if (!grown) return shv_fail_memory(error, "rows", capacity * sizeof *grown);
        view->rows = made->rows = grown;
        made->row_capacity = (int32_t)capacity;
    }
    made->rows[view->row_count++] = *row;
    view->passes += row->verdict == SHV_VERDICT_PASS;
    view->explained += row->verdict == SHV_VERDICT_EXPLAINED;
    view->misses += row->verdict == SHV_VERDICT_MISS || row->verdict == SHV_VERDICT_FAILED;
    return SHV_OK;
}

ShvVerifyRow shv_verify_row(const Verifier *verifier, const KeptRun *run, const char *quantity)
{
    const double none = (double)NAN;
    return (ShvVerifyRow){.run = run->title,
                          .quantity = quantity,
                          .unit = "",
                          .source = verifier->made->view.source,
                          .note = "",
                          .compare = SHV_VERIFY_SHOWN,
                          .value = none,
                          .reference = none,
                          .error = none,
                          .tolerance = none,
                          .step = none,
                          .seconds = run->seconds};
}

ShvStatus shv_verify_fail(Verifier *verifier, const char *quantity, const ShvError *why, ShvError *error)
{
    const char *note = shv_pool_text(&verifier->made->texts, why->message, strlen(why->message));
    ShvVerifyRow row = shv_verify_row(verifier, verifier->now, quantity);
    row.verdict = SHV_VERDICT_FAILED;
    if (note) row.note = note;
    return shv_verify_append(verifier, &row, error);
}

/* A value that is not a number passes nothing. */
static bool within(const ShvVerifyRow *row)
{
    switch (row->compare) {
    case SHV_VERIFY_NEAR:
        return fabs(row->error) <= row->tolerance;
    case SHV_VERIFY_BELOW:
        return row->strict ? row->error < row->tolerance : row->error <= row->tolerance;
    case SHV_VERIFY_ABOVE:
        return row->strict ? row->error > -row->tolerance : row->error >= -row->tolerance;
    case SHV_VERIFY_SHOWN:
        break;
    }
    return true;
}

void shv_verify_judge(ShvVerifyRow *row, bool absolute, const char *explained)
{
    row->absolute = absolute || row->reference == 0.0;
    row->error = (row->value - row->reference) / (row->absolute ? 1.0 : fabs(row->reference));
    row->verdict = row->compare == SHV_VERIFY_SHOWN ? SHV_VERDICT_SHOWN
                   : within(row)                    ? SHV_VERDICT_PASS
                   : explained                      ? SHV_VERDICT_EXPLAINED
                                                    : SHV_VERDICT_MISS;
    if (row->verdict == SHV_VERDICT_EXPLAINED) row->note = explained;
}

static ShvVerifyRow start_row(const Verifier *verifier, const KeptRun *run, const ShvCaseQuantity *quantity)
{
    ShvVerifyRow row = shv_verify_row(verifier, run, quantity->name);
    if (quantity->unit) row.unit = quantity->unit;
    if (quantity->source) row.source = quantity->source;
    row.compare = quantity->compare;
    return row;
}

static ShvStatus measure(Verifier *verifier, const ShvCaseQuantity *quantity, bool last, ShvVerifyRow *row,
                         ShvError *error)
{
    const ShvFormulaNames names = shv_names(&verifier->names);
    *row = start_row(verifier, verifier->now, quantity);
    SHV_TRY(shv_formula_number(quantity->measure, &names, &row->value, error));
    if (quantity->reference) SHV_TRY(shv_formula_number(quantity->reference, &names, &row->reference, error));
    if (quantity->step) SHV_TRY(shv_formula_number(quantity->step, &names, &row->step, error));
    const bool absolute = !isnan(quantity->tolerance_absolute) || row->reference == 0.0;
    row->tolerance = absolute ? quantity->tolerance_absolute : quantity->tolerance;
    if (isnan(row->tolerance) && (row->compare == SHV_VERIFY_BELOW || row->compare == SHV_VERIFY_ABOVE))
        row->tolerance = 0.0;
    if (quantity->judge == SHV_JUDGE_LAST && !last) row->compare = SHV_VERIFY_SHOWN;
    shv_verify_judge(row, absolute, quantity->explained);
    return SHV_OK;
}

static ShvStatus measure_all(Verifier *verifier, bool last, ShvError *error)
{
    const ShvCaseQuantity *quantities = verifier->item->quantities.data;
    for (int32_t i = 0; i < verifier->item->quantities.count; i++) {
        ShvVerifyRow row;
        ShvError why;
        const ShvStatus status = measure(verifier, &quantities[i], last, &row, &why);
        if (verifier->series.failed || status == SHV_NO_MEMORY) return shv_fail_memory(error, "series", 0);
        SHV_TRY(status == SHV_OK ? shv_verify_append(verifier, &row, error)
                                 : shv_verify_fail(verifier, quantities[i].name, &why, error));
    }
    return SHV_OK;
}

/* ---- order of convergence ---- */

/* Slope of log|error| over log step through the rows of a quantity, least squares; NaN with fewer than two. */
static double observed_order(const ShvVerifyCase *view, const char *quantity)
{
    ShvLine line = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (int32_t i = 0; i < view->row_count; i++) {
        const ShvVerifyRow *row = &view->rows[i];
        const double step = log(row->step), error = log(fabs(row->value / row->reference - 1.0));
        if (row->quantity == quantity && isfinite(step) && isfinite(error)) shv_line_add(&line, step, error);
    }
    return shv_line_slope(&line);
}

/* Judged when all runs of the case were made. */
static ShvStatus append_orders(Verifier *verifier, bool complete, ShvError *error)
{
    const ShvCaseQuantity *quantities = verifier->item->quantities.data;
    for (int32_t i = 0; i < verifier->item->quantities.count; i++) {
        const ShvCaseQuantity *quantity = &quantities[i];
        if (isnan(quantity->order) || verifier->run_count < 2) continue;
        const KeptRun all = {.title = "all runs", .seconds = (double)NAN};
        ShvVerifyRow row = start_row(verifier, &all, quantity);
        static const char what[] = ": observed order";
        char *name = shv_pool_take(&verifier->made->texts, strlen(quantity->name) + sizeof what, 1);
        if (!name) return shv_fail_memory(error, "rows", 0);
        row.quantity = strcat(strcpy(name, quantity->name), what);
        row.unit = "";
        row.compare = complete ? SHV_VERIFY_NEAR : SHV_VERIFY_SHOWN;
        row.value = observed_order(&verifier->made->view, quantity->name);
        row.reference = quantity->order;
        row.tolerance = quantity->order_tolerance;
        shv_verify_judge(&row, true, quantity->explained);
        SHV_TRY(shv_verify_append(verifier, &row, error));
    }
    return SHV_OK;
}

/* ---- runs ---- */

/* All faults of a scene in one message. */
static void join_faults(const ShvDiagnostics *diagnostics, ShvError *error)
{
    char text[sizeof error->message] = "";
    size_t length = 0;
    const int32_t count = diagnostics ? shv_diagnostics_count(diagnostics) : 0;
    for (int32_t i = 0; i < count && length + 1 < sizeof text; i++)
        length += (size_t)shv_format(text + length, sizeof text - length, "%s%s", i ? " " : "",
                                     shv_diagnostics_get(diagnostics, i)->message);
    if (count > 0) memcpy(error->message, text, sizeof text);
}

static ShvStatus load_scene(Verifier *verifier, const ShvCaseRun *run, ShvScene **scene, ShvError *error)
{
    const char *overrides[MOST_OVERRIDES], *at = run->set;
    ShvMemory *memory = verifier->options->memory;
    char *path;
    int32_t count = 0;
    for (char *line = shv_next_line(&verifier->work, &at); line; line = shv_next_line(&verifier->work, &at)) {
        if (count == MOST_OVERRIDES)
            return shv_fail(error, SHV_BAD_INPUT, "'set' has more than %d lines", (int)MOST_OVERRIDES);
        overrides[count++] = line;
    }
    if (verifier->work.failed) return shv_fail_memory(error, "overrides", 0);
    SHV_TRY(shv_path_join(memory, SHV_PART_SCENE, verifier->folder, run->scene ? run->scene : verifier->item->scene,
                          &path, error));
    ShvDiagnostics *diagnostics = NULL;
    const ShvStatus status = shv_scene_load(scene, path, overrides, count, memory, &diagnostics, error);
    if (status == SHV_BAD_INPUT && run->expect) join_faults(diagnostics, error);
    shv_diagnostics_destroy(diagnostics);
    shv_release(path);
    return status;
}

/* Variables of the run, of the case; then what is expected and what is compared. */
static ShvStatus evaluate(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvError why;
    ShvStatus status = define_all(verifier, run->let, &why);
    if (status == SHV_OK) status = define_all(verifier, verifier->item->let, &why);
    if (status == SHV_NO_MEMORY || verifier->series.failed) return shv_fail_memory(error, "variables", 0);
    if (status != SHV_OK) return shv_verify_fail(verifier, "variables", &why, error);
    if (run->expect) SHV_TRY(shv_verify_expect(verifier, run, error));
    return measure_all(verifier, last, error);
}

static ShvStatus judge_run(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    const ShvOutcome *outcome = &verifier->now->outcome;
    if (outcome->status == SHV_OK) return evaluate(verifier, run, last, error);
    if (run->expect) return shv_verify_expect(verifier, run, error);
    ShvError why;
    shv_fail(&why, outcome->status, "%s", outcome->message);
    return shv_verify_fail(verifier, "the run", &why, error);
}

static ShvStatus simulate(Verifier *verifier, const ShvScene *scene, ShvError *error)
{
    const ShvVerifyOptions *options = verifier->options;
    const ShvRunOrder order = {.scene = shv_scene_definition(scene),
                               .folder = shv_scene_folder(scene),
                               .memory = options->memory,
                               .multiple = (double)NAN,
                               .repeats = 1};
    KeptRun *now = verifier->now;
    const ShvStatus status = shv_run_scene(&now->outcome, &order, error);
    const double seconds = shv_outcome_number(&now->outcome, "run.seconds");
    now->seconds = shv_outcome_number(&now->outcome, "run.setup") + (isnan(seconds) ? 0.0 : seconds);
    verifier->made->view.seconds += now->seconds;
    return status;
}

static void start_run(Verifier *verifier, const ShvCaseRun *run)
{
    KeptRun *now = verifier->now = &verifier->runs[verifier->run_count++];
    now->named.name = now->title = run->head.name;
    if (run->title) now->title = run->title;
    now->outcome = (ShvOutcome){.memory = verifier->options->memory};
    now->named.outcome = &now->outcome;
    if (verifier->run_count > 1) now->named.before = &now[-1].named;
}

/* A scene that is refused is a finding where something is expected of the run, else a fault of the case. */
static ShvStatus make_run(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvScene *scene = NULL;
    start_run(verifier, run);
    ShvStatus status = load_scene(verifier, run, &scene, error);
    if (status == SHV_BAD_INPUT && run->expect) {
        verifier->now->outcome.status = status;
        memcpy(verifier->now->outcome.message, error->message, sizeof error->message);
        status = SHV_OK;
    } else if (status == SHV_OK) {
        status = simulate(verifier, scene, error);
    }
    verifier->names = (ShvNames){.pool = &verifier->series, .run = &verifier->now->named};
    if (status == SHV_OK) status = judge_run(verifier, run, last, error);
    shv_scene_destroy(scene);
    return status;
}

static ShvStatus make_runs(Verifier *verifier, ShvError *error)
{
    static const ShvCaseRun as_it_is = {.head = {.name = ""}};
    const bool any = verifier->item->runs.count > 0;
    const ShvCaseRun *runs = any ? verifier->item->runs.data : &as_it_is;
    const int32_t count = any ? verifier->item->runs.count : 1;
    int32_t last = -1, made = 0;
    for (int32_t i = 0; i < count; i++)
        if (verifier->options->full || !runs[i].full) last = i;
    verifier->runs = shv_pool_take(&verifier->work, (size_t)count, sizeof *verifier->runs);
    if (!verifier->runs) return shv_fail_memory(error, "runs", (size_t)count * sizeof *verifier->runs);
    if (last < 0) return shv_fail(error, SHV_BAD_INPUT, "all runs of this case belong to the full set; give --full");
    for (int32_t i = 0; i < count; i++) {
        if (!verifier->options->full && runs[i].full) continue;
        SHV_TRY(make_run(verifier, &runs[i], i == last, error));
        made++;
    }
    return append_orders(verifier, made == count, error);
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
    ShvPool *work = &verifier->work, *texts = &verifier->made->texts;
    SHV_TRY(shv_read_file(work->memory, SHV_PART_SCENE, path, LARGEST_CASE, &text, &length, error));
    *diagnostics = shv_diagnostics_create(work->memory, path, NULL, 0);
    if (*diagnostics) verifier->item = shv_case_read(text, length, work, texts, *diagnostics);
    shv_release(text);
    if (!*diagnostics) return shv_fail_memory(error, "a verification case", length);
    return shv_diagnostics_end(*diagnostics, work->failed || texts->failed, "the case", length, error);
}

static ShvStatus verify(Verifier *verifier, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    ShvVerification *made = verifier->made;
    SHV_TRY(read_case(verifier, path, diagnostics, error));
    if (verifier->options->short_set && !verifier->item->in_short) return SHV_OK;
    made->view.name = case_name(&made->texts, path);
    made->view.title = verifier->item->title;
    made->view.scene = verifier->item->scene;
    made->view.source = verifier->item->source;
    made->view.remark = verifier->item->remark ? verifier->item->remark : "";
    if (!made->view.name) return shv_fail_memory(error, "a name", strlen(path));
    SHV_TRY(shv_path_folder(made->memory, SHV_PART_SCENE, path, &verifier->folder, error));
    const ShvStatus status = make_runs(verifier, error);
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
    made->memory = made->texts.memory = options->memory;
    Verifier verifier = {.made = made, .options = options, .work = {.memory = options->memory}};
    verifier.series.memory = options->memory;
    const ShvStatus status = verify(&verifier, path, diagnostics, error);
    for (int32_t i = 0; i < verifier.run_count; i++) shv_outcome_release(&verifier.runs[i].outcome);
    shv_pool_release(&verifier.series);
    shv_pool_release(&verifier.work);
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
