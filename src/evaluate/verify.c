#include "shiver/verify.h"

#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/timer.h"
#include "evaluate/case.h"
#include "evaluate/recording.h"

enum { MOST_OVERRIDES = 64, LARGEST_CASE = 1 << 20 };

typedef struct Variable {
    const char *name;
    ShvFormulaValue value;
} Variable;

/* What is kept of a run when its series are gone. */
typedef struct KeptRun {
    const char *name;
    Variable *variables;
    int32_t variable_count;
    double *values, *references, *steps; /* per quantity; NaN where it failed */
    double seconds;
} KeptRun;

struct ShvVerification {
    ShvMemory *memory;
    ShvPool texts; /* what rows point to */
    ShvVerifyCase view;
    ShvVerifyRow *rows;
    int32_t row_capacity;
};

typedef struct Verifier {
    ShvVerification *made;
    const ShvVerifyOptions *options;
    ShvCaseItem *item;
    ShvPool work; /* of the whole case */
    char *folder, *scene_path;
    KeptRun *runs;
    int32_t run_count;
    /* of the run under way */
    ShvPool series;
    ShvScene *scene;
    ShvRecording recording;
    KeptRun *now;
} Verifier;

ShvVerifyOptions shv_verify_default(void)
{
    return (ShvVerifyOptions){.cookie = SHV_DEFINITION_COOKIE};
}

const char *shv_verdict_name(ShvVerdict verdict)
{
    static const char *const names[] = {"pass", "miss", "miss, explained", "shown", "failed"};
    return names[verdict];
}

static const char *text_or_empty(const char *text)
{
    return text ? text : "";
}

/* ---- names ---- */

static bool find_variable(const KeptRun *run, const char *name, ShvFormulaValue *value)
{
    for (int32_t i = run->variable_count - 1; i >= 0; i--) {
        if (strcmp(run->variables[i].name, name) != 0) continue;
        *value = run->variables[i].value;
        return true;
    }
    return false;
}

/* "runs.coarse.x": x of an earlier run. */
static bool find_earlier(const Verifier *verifier, const char *name, ShvFormulaValue *value)
{
    if (strncmp(name, "runs.", 5) != 0) return false;
    name += 5;
    for (int32_t i = 0; i < verifier->run_count; i++) {
        const KeptRun *run = &verifier->runs[i];
        const size_t length = strlen(run->name);
        if (run == verifier->now || strncmp(name, run->name, length) != 0 || name[length] != '.') continue;
        return find_variable(run, name + length + 1, value) && !value->series;
    }
    return false;
}

static bool find_name(void *data, const char *name, ShvFormulaValue *value)
{
    Verifier *verifier = data;
    return find_variable(verifier->now, name, value) || find_earlier(verifier, name, value) ||
           shv_recording_find(&verifier->recording, shv_scene_definition(verifier->scene), &verifier->series, name,
                              value);
}

static ShvFormulaNames names_of(Verifier *verifier)
{
    return (ShvFormulaNames){find_name, verifier, &verifier->series};
}

/* ---- lines ---- */

/* The next line that is not blank, without spaces around it; NULL at the end. `*at` moves on. */
static char *next_line(ShvPool *pool, const char **at)
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

static int32_t count_lines(const char *text)
{
    int32_t count = 1;
    for (; text && *text; text++) count += *text == '\n';
    return count;
}

/* "name = formula" */
static ShvStatus define(Verifier *verifier, char *line, ShvError *error)
{
    char *equals = strchr(line, '=');
    if (!equals) return shv_fail(error, SHV_BAD_INPUT, "'%.200s' in 'let' is not of the form name = formula", line);
    char *end = equals;
    while (end > line && (end[-1] == ' ' || end[-1] == '\t')) end--;
    *end = '\0';
    Variable *variable = &verifier->now->variables[verifier->now->variable_count];
    const ShvFormulaNames names = names_of(verifier);
    const ShvStatus status = shv_formula_evaluate(equals + 1, &names, &variable->value, error);
    if (status != SHV_OK) return shv_fail_within(error, status, "variable %.60s", line);
    variable->name = line;
    verifier->now->variable_count++;
    return SHV_OK;
}

static ShvStatus define_all(Verifier *verifier, const char *let, ShvError *error)
{
    for (char *line = next_line(&verifier->work, &let); line; line = next_line(&verifier->work, &let))
        SHV_TRY(define(verifier, line, error));
    return verifier->work.failed ? shv_fail_memory(error, "variables", 0) : SHV_OK;
}

/* ---- rows ---- */

static ShvStatus append_row(Verifier *verifier, const ShvVerifyRow *row, ShvError *error)
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

static ShvStatus append_failure(Verifier *verifier, const char *quantity, const ShvError *why, ShvError *error)
{
    const char *note = shv_pool_text(&verifier->made->texts, why->message, strlen(why->message));
    const ShvVerifyRow row = {.run = verifier->now->name,
                              .quantity = quantity,
                              .unit = "",
                              .source = verifier->made->view.source,
                              .note = text_or_empty(note),
                              .compare = SHV_VERIFY_SHOWN,
                              .verdict = SHV_VERDICT_FAILED,
                              .value = (double)NAN,
                              .reference = (double)NAN,
                              .error = (double)NAN,
                              .tolerance = (double)NAN,
                              .seconds = verifier->now->seconds};
    return append_row(verifier, &row, error);
}

/* A value that is not a number passes nothing. */
static bool within(const ShvVerifyRow *row)
{
    switch (row->compare) {
    case SHV_VERIFY_NEAR:
        return fabs(row->error) <= row->tolerance;
    case SHV_VERIFY_BELOW:
        return row->error <= row->tolerance;
    case SHV_VERIFY_ABOVE:
        return row->error >= -row->tolerance;
    case SHV_VERIFY_SHOWN:
        break;
    }
    return true;
}

static void judge(ShvVerifyRow *row, const char *explained)
{
    if (row->compare == SHV_VERIFY_SHOWN) {
        row->verdict = SHV_VERDICT_SHOWN;
    } else if (within(row)) {
        row->verdict = SHV_VERDICT_PASS;
    } else {
        row->verdict = explained ? SHV_VERDICT_EXPLAINED : SHV_VERDICT_MISS;
        row->note = text_or_empty(explained);
    }
}

static void set_error(ShvVerifyRow *row, const ShvCaseQuantity *quantity)
{
    row->absolute = !isnan(quantity->tolerance_absolute) || row->reference == 0.0;
    row->error = (row->value - row->reference) / (row->absolute ? 1.0 : fabs(row->reference));
    row->tolerance = row->absolute ? quantity->tolerance_absolute : quantity->tolerance;
    if (isnan(row->tolerance) && row->compare != SHV_VERIFY_NEAR && row->compare != SHV_VERIFY_SHOWN)
        row->tolerance = 0.0;
}

static ShvVerifyRow start_row(const Verifier *verifier, const KeptRun *run, const ShvCaseQuantity *quantity)
{
    return (ShvVerifyRow){.run = run->name,
                          .quantity = quantity->name,
                          .unit = text_or_empty(quantity->unit),
                          .source = quantity->source ? quantity->source : verifier->made->view.source,
                          .note = "",
                          .compare = quantity->compare,
                          .reference = (double)NAN,
                          .seconds = run->seconds};
}

static ShvStatus measure(Verifier *verifier, int32_t index, bool last, ShvVerifyRow *row, ShvError *error)
{
    const ShvCaseQuantity *quantity = (const ShvCaseQuantity *)verifier->item->quantities.data + index;
    const ShvFormulaNames names = names_of(verifier);
    KeptRun *run = verifier->now;
    *row = start_row(verifier, run, quantity);
    SHV_TRY(shv_formula_number(quantity->measure, &names, &row->value, error));
    if (quantity->reference) SHV_TRY(shv_formula_number(quantity->reference, &names, &row->reference, error));
    if (quantity->step) SHV_TRY(shv_formula_number(quantity->step, &names, &run->steps[index], error));
    set_error(row, quantity);
    if (quantity->judge == SHV_JUDGE_LAST && !last) row->compare = SHV_VERIFY_SHOWN;
    judge(row, quantity->explained);
    run->values[index] = row->value;
    run->references[index] = row->reference;
    return SHV_OK;
}

static ShvStatus measure_all(Verifier *verifier, bool last, ShvError *error)
{
    for (int32_t i = 0; i < verifier->item->quantities.count; i++) {
        ShvVerifyRow row;
        ShvError why;
        const ShvStatus status = measure(verifier, i, last, &row, &why);
        if (verifier->series.failed || status == SHV_NO_MEMORY) return shv_fail_memory(error, "series", 0);
        if (status == SHV_OK)
            SHV_TRY(append_row(verifier, &row, error));
        else
            SHV_TRY(append_failure(verifier, ((const ShvCaseQuantity *)verifier->item->quantities.data)[i].name, &why,
                                   error));
    }
    return SHV_OK;
}

/* ---- order of convergence ---- */

/* Slope of log|error| over log step through all runs, least squares; NaN with fewer than two. */
static double observed_order(const Verifier *verifier, int32_t index)
{
    double count = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (int32_t i = 0; i < verifier->run_count; i++) {
        const KeptRun *run = &verifier->runs[i];
        const double step = log(run->steps[index]);
        const double error = log(fabs(run->values[index] / run->references[index] - 1.0));
        if (!isfinite(step) || !isfinite(error)) continue;
        count += 1.0;
        x += step;
        y += error;
        xx += step * step;
        xy += step * error;
    }
    const double spread = count * xx - x * x;
    return count > 1.0 && spread > 0.0 ? (count * xy - x * y) / spread : (double)NAN;
}

/* Judged when all runs of the case were made. */
static ShvStatus append_orders(Verifier *verifier, bool complete, ShvError *error)
{
    const ShvCaseQuantity *quantities = verifier->item->quantities.data;
    for (int32_t i = 0; i < verifier->item->quantities.count; i++) {
        const ShvCaseQuantity *quantity = &quantities[i];
        if (isnan(quantity->order) || verifier->run_count < 2) continue;
        const KeptRun all = {.name = "all runs", .seconds = (double)NAN};
        ShvVerifyRow row = start_row(verifier, &all, quantity);
        static const char what[] = ": observed order";
        char *name = shv_pool_take(&verifier->made->texts, strlen(quantity->name) + sizeof what, 1);
        if (!name) return shv_fail_memory(error, "rows", 0);
        strcat(strcpy(name, quantity->name), what);
        row.quantity = name;
        row.unit = "";
        row.compare = complete ? SHV_VERIFY_NEAR : SHV_VERIFY_SHOWN;
        row.value = observed_order(verifier, i);
        row.reference = quantity->order;
        row.absolute = true;
        row.error = row.value - row.reference;
        row.tolerance = quantity->order_tolerance;
        judge(&row, quantity->explained);
        SHV_TRY(append_row(verifier, &row, error));
    }
    return SHV_OK;
}

/* ---- runs ---- */

static ShvStatus load_scene(Verifier *verifier, const ShvCaseRun *run, ShvError *error)
{
    const char *overrides[MOST_OVERRIDES], *at = run ? run->set : NULL;
    int32_t count = 0;
    for (char *line = next_line(&verifier->work, &at); line; line = next_line(&verifier->work, &at)) {
        if (count == MOST_OVERRIDES)
            return shv_fail(error, SHV_BAD_INPUT, "'set' has more than %d lines", (int)MOST_OVERRIDES);
        overrides[count++] = line;
    }
    if (verifier->work.failed) return shv_fail_memory(error, "overrides", 0);
    return shv_scene_load(&verifier->scene, verifier->scene_path, overrides, count, verifier->options->memory, NULL,
                          error);
}

static ShvStatus pull(Verifier *verifier, ShvSimulation *simulation, ShvError *error)
{
    SHV_TRY(shv_recording_start(&verifier->recording, verifier->options->memory, simulation, error));
    do {
        SHV_TRY(shv_simulation_advance(simulation, error));
        SHV_TRY(shv_recording_add(&verifier->recording, simulation, error));
    } while (!shv_simulation_finished(simulation));
    return shv_recording_finish(&verifier->recording, simulation, error);
}

/* The views of a recording are the simulation's: formulas are evaluated while it lives. */
static ShvStatus evaluate(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvError why;
    ShvStatus status = define_all(verifier, run ? run->let : NULL, &why);
    if (status == SHV_OK) status = define_all(verifier, verifier->item->let, &why);
    if (status == SHV_NO_MEMORY || verifier->series.failed) return shv_fail_memory(error, "variables", 0);
    if (status != SHV_OK) return append_failure(verifier, "variables", &why, error);
    return measure_all(verifier, last, error);
}

static ShvStatus simulate(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    ShvSimulation *simulation = NULL;
    ShvError why;
    const double start = shv_now();
    ShvSimulationOptions options = shv_simulation_options_default();
    options.folder = shv_scene_folder(verifier->scene);
    options.memory = verifier->options->memory;
    options.stop = verifier->options->stop;
    options.stop_data = verifier->options->stop_data;
    ShvStatus status = shv_simulation_create(&simulation, shv_scene_definition(verifier->scene), &options, &why);
    if (status == SHV_OK) status = pull(verifier, simulation, &why);
    verifier->now->seconds = verifier->recording.wall_seconds = shv_now() - start;
    verifier->made->view.seconds += verifier->now->seconds;
    if (status == SHV_INTERRUPTED || status == SHV_NO_MEMORY)
        status = shv_fail(error, status, "%s", why.message);
    else if (status != SHV_OK)
        status = append_failure(verifier, "the run", &why, error);
    else
        status = evaluate(verifier, run, last, error);
    shv_simulation_destroy(simulation);
    return status;
}

/* Series go with the run; their variables must not be asked for afterwards. */
static void forget_series(Verifier *verifier)
{
    for (int32_t i = 0; i < verifier->now->variable_count; i++) {
        ShvFormulaValue *value = &verifier->now->variables[i].value;
        if (value->series) *value = (ShvFormulaValue){.series = true};
    }
    shv_pool_release(&verifier->series);
    verifier->series = (ShvPool){.memory = verifier->options->memory};
}

static ShvStatus start_run(Verifier *verifier, const ShvCaseRun *run, ShvError *error)
{
    const size_t quantities = (size_t)verifier->item->quantities.count;
    const size_t lines = (size_t)count_lines(run ? run->let : NULL) + (size_t)count_lines(verifier->item->let);
    KeptRun *now = verifier->now = &verifier->runs[verifier->run_count++];
    now->name = run ? run->head.name : "";
    now->variables = shv_pool_take(&verifier->work, lines, sizeof *now->variables);
    now->values = shv_pool_take(&verifier->work, 3 * quantities, sizeof *now->values);
    if (!now->variables || !now->values) return shv_fail_memory(error, "a run", quantities * 24);
    now->references = now->values + quantities;
    now->steps = now->references + quantities;
    for (size_t i = 0; i < 3 * quantities; i++) now->values[i] = (double)NAN;
    return SHV_OK;
}

static ShvStatus make_run(Verifier *verifier, const ShvCaseRun *run, bool last, ShvError *error)
{
    SHV_TRY(start_run(verifier, run, error));
    ShvStatus status = load_scene(verifier, run, error);
    if (status == SHV_OK) status = simulate(verifier, run, last, error);
    forget_series(verifier);
    shv_recording_release(&verifier->recording);
    shv_scene_destroy(verifier->scene);
    verifier->scene = NULL;
    return status;
}

static ShvStatus make_runs(Verifier *verifier, ShvError *error)
{
    const ShvCaseRun *runs = verifier->item->runs.data;
    const int32_t count = verifier->item->runs.count;
    int32_t last = -1, made = 0;
    for (int32_t i = 0; i < count; i++)
        if (verifier->options->full || !runs[i].full) last = i;
    verifier->runs = shv_pool_take(&verifier->work, (size_t)count + 1, sizeof *verifier->runs);
    if (!verifier->runs) return shv_fail_memory(error, "runs", (size_t)count * sizeof *verifier->runs);
    if (count == 0) return make_run(verifier, NULL, true, error);
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

static ShvStatus report_faults(const ShvDiagnostics *diagnostics, ShvError *error)
{
    for (int32_t i = 0; i < shv_diagnostics_count(diagnostics); i++) {
        const ShvDiagnostic *first = shv_diagnostics_get(diagnostics, i);
        if (first->severity == SHV_SEVERITY_ERROR) return shv_fail(error, SHV_BAD_INPUT, "%s", first->message);
    }
    return shv_fail_memory(error, "a verification case", 0);
}

static ShvStatus read_case(ShvCaseItem **item, const char *path, ShvPool *work, ShvPool *texts,
                           ShvDiagnostics **diagnostics, ShvError *error)
{
    char *text = NULL;
    size_t length = 0;
    SHV_TRY(shv_read_file(work->memory, SHV_PART_SCENE, path, LARGEST_CASE, &text, &length, error));
    *diagnostics = shv_diagnostics_create(work->memory, path, NULL, 0);
    if (*diagnostics) *item = shv_case_read(text, length, work, texts, *diagnostics);
    shv_release(text);
    if (!*diagnostics || work->failed || texts->failed) return shv_fail_memory(error, "a verification case", length);
    if (*item) return SHV_OK;
    shv_diagnostics_sort(*diagnostics);
    return report_faults(*diagnostics, error);
}

static ShvStatus verify(Verifier *verifier, const char *path, ShvDiagnostics **diagnostics, ShvError *error)
{
    ShvVerification *made = verifier->made;
    SHV_TRY(read_case(&verifier->item, path, &verifier->work, &made->texts, diagnostics, error));
    made->view.name = case_name(&made->texts, path);
    made->view.title = verifier->item->title;
    made->view.scene = verifier->item->scene;
    made->view.source = verifier->item->source;
    made->view.remark = text_or_empty(verifier->item->remark);
    if (!made->view.name) return shv_fail_memory(error, "a name", strlen(path));
    SHV_TRY(shv_path_folder(made->memory, SHV_PART_SCENE, path, &verifier->folder, error));
    SHV_TRY(shv_path_join(made->memory, SHV_PART_SCENE, verifier->folder, verifier->item->scene, &verifier->scene_path,
                          error));
    const ShvStatus status = make_runs(verifier, error);
    return status == SHV_OK ? SHV_OK : shv_fail_within(error, status, "case %s", made->view.name);
}

ShvStatus shv_verify_run(ShvVerification **verification, const char *path, const ShvVerifyOptions *options,
                         ShvDiagnostics **diagnostics, ShvError *error)
{
    const ShvVerifyOptions defaults = shv_verify_default();
    ShvDiagnostics *list = NULL;
    *verification = NULL;
    if (diagnostics) *diagnostics = NULL;
    if (!options) options = &defaults;
    if (options->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_verify_default()");
    ShvVerification *made = shv_allocate(options->memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a verification", sizeof *made);
    made->memory = made->texts.memory = options->memory;
    Verifier verifier = {.made = made, .options = options, .work = {.memory = options->memory}};
    verifier.series.memory = options->memory;
    const ShvStatus status = verify(&verifier, path, &list, error);
    shv_pool_release(&verifier.work);
    shv_release(verifier.folder);
    shv_release(verifier.scene_path);
    if (diagnostics)
        *diagnostics = list;
    else
        shv_diagnostics_destroy(list);
    if (status == SHV_OK)
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

ShvStatus shv_verify_in_short_set(const char *path, bool *in_short, ShvDiagnostics **diagnostics, ShvError *error)
{
    ShvPool work = {.memory = NULL}, texts = {.memory = NULL};
    ShvCaseItem *item = NULL;
    ShvDiagnostics *list = NULL;
    const ShvStatus status = read_case(&item, path, &work, &texts, &list, error);
    if (status == SHV_OK) *in_short = item->in_short;
    shv_pool_release(&work);
    shv_pool_release(&texts);
    if (diagnostics)
        *diagnostics = list;
    else
        shv_diagnostics_destroy(list);
    return status;
}
