/* From runs to the rows of a case: variables, what is expected of a run, quantities, rows of all runs together. */
#include <string.h>

#include "base/text.h"
#include "evaluate/case.h"

const char *shv_verdict_name(ShvVerdict verdict)
{
    static const char *const names[] = {"pass", "miss", "miss, explained", "shown", "failed"};
    return names[verdict];
}

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

/* Ends a text at `at` and the spaces before it. */
static void cut(char *text, char *at)
{
    while (at > text && (at[-1] == ' ' || at[-1] == '\t')) at--;
    *at = '\0';
}

/* ---- variables ---- */

/* A name that is defined by one of these lines, though not yet, is told apart from one that never is. */
static ShvStatus fail_variable(ShvVerification *made, const char *name, const char *rest, ShvStatus status,
                               ShvError *error)
{
    const ShvError why = *error;
    const char *at = rest, *quoted = strstr(why.message, "': '");
    bool later = false;
    for (char *line = shv_next_line(&made->work, &at); line && quoted; line = shv_next_line(&made->work, &at)) {
        const size_t length = strcspn(line, " \t=");
        later |= strncmp(quoted + 4, line, length) == 0 && strncmp(quoted + 4 + length, "' is unknown", 12) == 0;
    }
    return shv_fail(error, status, "variable %.60s: %.700s%s", name, why.message,
                    later ? " so far; definitions are taken from top to bottom, so that none can need itself" : "");
}

/* "name = formula", the first of these lines */
static ShvStatus define(ShvVerification *made, char *line, const char *from, ShvError *error)
{
    char *equals = strchr(line, '=');
    if (!equals) return shv_fail(error, SHV_BAD_INPUT, "'%.200s' in 'let' is not of the form name = formula", line);
    cut(line, equals);
    ShvNamedRun *named = &made->now->named;
    ShvVariable *variable = shv_pool_take(&made->work, 1, sizeof *variable);
    if (!variable) return shv_fail_memory(error, "variables", sizeof *variable);
    const ShvFormulaNames names = shv_names(&made->names);
    const ShvStatus status = shv_formula_evaluate(equals + 1, &names, &variable->value, error);
    if (status != SHV_OK) return fail_variable(made, line, from, status, error);
    variable->name = line;
    variable->before = named->variables;
    named->variables = variable;
    return SHV_OK;
}

static ShvStatus define_all(ShvVerification *made, const char *let, ShvError *error)
{
    const char *from = let;
    for (char *line = shv_next_line(&made->work, &let); line; line = shv_next_line(&made->work, &let)) {
        SHV_TRY(define(made, line, from, error));
        from = let;
    }
    return SHV_OK;
}

/* ---- rows ---- */

static ShvStatus append(ShvVerification *made, const ShvVerifyRow *row, ShvError *error)
{
    ShvVerifyCase *view = &made->view;
    if (view->row_count == made->row_capacity) {
        const size_t capacity = 2 * (size_t)made->row_capacity + 16;
        SHV_RESIZE(made->memory, SHV_PART_RECORD, made->rows, capacity, "rows", capacity * sizeof *row, error);
        view->rows = made->rows;
        made->row_capacity = (int32_t)capacity;
    }
    made->rows[view->row_count++] = *row;
    view->passes += row->verdict == SHV_VERDICT_PASS;
    view->explained += row->verdict == SHV_VERDICT_EXPLAINED;
    view->misses += row->verdict == SHV_VERDICT_MISS || row->verdict == SHV_VERDICT_FAILED;
    return SHV_OK;
}

/* Of nothing yet; not judged. */
static ShvVerifyRow row_of(const ShvVerification *made, const ShvCaseQuantity *quantity)
{
    const double none = (double)NAN;
    const bool together = quantity->judge == SHV_JUDGE_TOGETHER;
    return (ShvVerifyRow){.run = together ? "all runs" : made->now->title,
                          .quantity = quantity->name,
                          .unit = quantity->unit ? quantity->unit : "",
                          .source = quantity->source ? quantity->source : made->view.source,
                          .note = "",
                          .compare = quantity->compare,
                          .strict = quantity->strict,
                          .value = none,
                          .reference = none,
                          .error = none,
                          .tolerance = none,
                          .seconds = together ? none : shv_run_seconds(&made->now->outcome)};
}

static ShvStatus fail(ShvVerification *made, const char *what, const ShvError *why, ShvError *error)
{
    const char *note = shv_pool_text(&made->texts, why->message, strlen(why->message));
    ShvVerifyRow row = row_of(made, &(ShvCaseQuantity){.name = what, .compare = SHV_VERIFY_SHOWN});
    row.verdict = SHV_VERDICT_FAILED;
    if (note) row.note = note;
    return append(made, &row, error);
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

static void give(ShvVerifyRow *row, bool good, const char *explained)
{
    row->verdict = good ? SHV_VERDICT_PASS : explained ? SHV_VERDICT_EXPLAINED : SHV_VERDICT_MISS;
    if (row->verdict == SHV_VERDICT_EXPLAINED) row->note = explained;
}

/* By value, reference and tolerance; errors are shares of the reference unless `absolute` or it is 0. */
static void decide(ShvVerifyRow *row, bool absolute, const char *explained)
{
    row->absolute = absolute || row->reference == 0.0;
    row->error = (row->value - row->reference) / (row->absolute ? 1.0 : fabs(row->reference));
    if (row->compare == SHV_VERIFY_SHOWN)
        row->verdict = SHV_VERDICT_SHOWN;
    else
        give(row, within(row), explained);
}

/* ---- quantities ---- */

static ShvStatus measure(ShvVerification *made, const ShvCaseQuantity *quantity, ShvVerifyRow *row, ShvError *error)
{
    const ShvFormulaNames names = shv_names(&made->names);
    SHV_TRY(shv_formula_number(quantity->measure, &names, &row->value, error));
    if (quantity->reference) SHV_TRY(shv_formula_number(quantity->reference, &names, &row->reference, error));
    const ShvStatus status = made->names.status;
    made->names.status = SHV_OK;
    return status == SHV_OK ? SHV_OK : shv_fail(error, status, "%s", made->names.error.message);
}

/* What a run that did not come to its end lacks is a miss, and no fault of the formula. */
static ShvStatus put_quantity(ShvVerification *made, const ShvCaseQuantity *quantity, ShvError *error)
{
    ShvVerifyRow row = row_of(made, quantity);
    ShvError why;
    const ShvStatus status = measure(made, quantity, &row, &why);
    if (made->work.failed || status == SHV_NO_MEMORY) return shv_fail_memory(error, "series", 0);
    if (status != SHV_OK && made->now->outcome.status == SHV_OK) return fail(made, quantity->name, &why, error);
    const bool absolute = !isnan(quantity->tolerance_absolute) || row.reference == 0.0;
    row.tolerance = absolute ? quantity->tolerance_absolute : quantity->tolerance;
    if (isnan(row.tolerance) && quantity->compare != SHV_VERIFY_NEAR && quantity->compare != SHV_VERIFY_SHOWN)
        row.tolerance = 0.0;
    decide(&row, absolute, quantity->explained);
    return append(made, &row, error);
}

static ShvStatus put_quantities(ShvVerification *made, bool last, ShvError *error)
{
    const ShvCaseQuantity *quantities = made->item->quantities.data;
    for (int32_t i = 0; i < made->item->quantities.count; i++) {
        ShvCaseQuantity quantity = quantities[i];
        if (quantity.judge == SHV_JUDGE_LAST && !last) quantity.compare = SHV_VERIFY_SHOWN;
        if (quantity.judge != SHV_JUDGE_TOGETHER) SHV_TRY(put_quantity(made, &quantity, error));
    }
    return SHV_OK;
}

/* ---- what is expected of a run, a line each: "finishes", "told", "refused TEXT", "stops TEXT", or two formulas with < <= > >= or
   = between them, the last one with "within SHARE" or "within X absolute" ---- */

static bool begins_with(const char *text, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(text, word, length) == 0 && (text[length] == ' ' || text[length] == '\0');
}

/* Whether the run ended as such a line says; -1: it is none of these lines. */
static int ended_so(const ShvOutcome *outcome, const char *line)
{
    const bool begun = shv_outcome_number(outcome, "run.begun") == 1.0, done = outcome->status == SHV_OK;
    const ShvOutcomeList *list = shv_outcome_find(outcome, "frame.finite");
    bool finite = true;
    for (int64_t i = 0; list && i < list->count; i++) finite &= list->values[i] == 1.0;
    const char *part = line + strcspn(line, " ");
    part += strspn(part, " ");
    if (begins_with(line, "finishes")) return done && finite;
    if (begins_with(line, "told")) return done ? finite : outcome->status == SHV_DIVERGED && outcome->message[0];
    if (begins_with(line, "refused")) return !done && !begun && strstr(outcome->message, part);
    if (begins_with(line, "stops")) return !done && begun && strstr(outcome->message, part);
    return -1;
}

/* A line with a relation is a quantity. `text` is cut into its formulas. */
static ShvStatus read_relation(ShvVerification *made, char *text, ShvCaseQuantity *quantity, ShvError *error)
{
    static const struct {
        const char *sign;
        ShvVerifyCompare compare;
        bool strict;
    } relations[] = {{"<=", SHV_VERIFY_BELOW, false},
                     {">=", SHV_VERIFY_ABOVE, false},
                     {"<", SHV_VERIFY_BELOW, true},
                     {">", SHV_VERIFY_ABOVE, true},
                     {"=", SHV_VERIFY_NEAR, false}};
    const ShvFormulaNames names = shv_names(&made->names);
    char *sign = NULL;
    size_t i = 0;
    while (i < sizeof relations / sizeof relations[0] && !(sign = strstr(text, relations[i].sign))) i++;
    if (!sign)
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%.100s' is none of finishes, told, refused, stops, and lacks one of < <= > >= =", text);
    char *right = sign + strlen(relations[i].sign), *tolerance = strstr(right, " within ");
    char *absolute = tolerance ? strstr(tolerance, " absolute") : NULL;
    cut(text, sign);
    if (tolerance) *tolerance = '\0';
    if (absolute) *absolute = '\0';
    quantity->measure = text;
    quantity->reference = right;
    quantity->compare = relations[i].compare;
    quantity->strict = relations[i].strict;
    double *share = tolerance && !absolute ? &quantity->tolerance : &quantity->tolerance_absolute;
    *share = 0.0;
    return tolerance ? shv_formula_number(tolerance + strlen(" within "), &names, share, error) : SHV_OK;
}

static ShvStatus expect_line(ShvVerification *made, char *line, const ShvCaseRun *run, ShvError *error)
{
    ShvPool *texts = &made->texts;
    const ShvOutcome *outcome = &made->now->outcome;
    const int so = ended_so(outcome, line);
    const char *message = shv_pool_text(texts, outcome->message, strlen(outcome->message));
    ShvCaseQuantity quantity = {.name = shv_pool_text(texts, line, strlen(line)),
                                .explained = run->explained,
                                .tolerance = (double)NAN,
                                .tolerance_absolute = (double)NAN};
    ShvError why;
    if (!quantity.name || !message) return shv_fail_memory(error, "rows", 0);
    if (so < 0) {
        const ShvStatus status = read_relation(made, line, &quantity, &why);
        if (status == SHV_NO_MEMORY) return shv_fail_memory(error, "rows", 0);
        return status == SHV_OK ? put_quantity(made, &quantity, error) : fail(made, quantity.name, &why, error);
    }
    ShvVerifyRow row = row_of(made, &quantity);
    if (!so) row.note = message[0] ? message : "it ran to its end";
    give(&row, so, run->explained);
    return append(made, &row, error);
}

static ShvStatus expect(ShvVerification *made, const ShvCaseRun *run, ShvError *error)
{
    const char *at = run->expect;
    for (char *line = shv_next_line(&made->work, &at); line; line = shv_next_line(&made->work, &at))
        SHV_TRY(expect_line(made, line, run, error));
    return made->work.failed ? shv_fail_memory(error, "rows", 0) : SHV_OK;
}

/* ---- all of a run ---- */

/* Variables of the run, of the case; then what is expected and what is compared. */
ShvStatus shv_judge_run(ShvVerification *made, const ShvCaseRun *run, bool last, ShvError *error)
{
    const ShvOutcome *outcome = &made->now->outcome;
    ShvError why;
    made->names = (ShvNames){.pool = &made->work, .run = &made->now->named};
    if (outcome->status != SHV_OK && run->expect) return expect(made, run, error);
    if (outcome->status != SHV_OK) {
        shv_fail(&why, outcome->status, "%s", outcome->message);
        return fail(made, "the run", &why, error);
    }
    ShvStatus status = define_all(made, run->let, &why);
    if (status == SHV_OK) status = define_all(made, made->item->let, &why);
    if (status == SHV_NO_MEMORY || made->work.failed) return shv_fail_memory(error, "variables", 0);
    if (status != SHV_OK) return fail(made, "variables", &why, error);
    if (run->expect) SHV_TRY(expect(made, run, error));
    return put_quantities(made, last, error);
}

ShvStatus shv_judge_together(ShvVerification *made, bool complete, ShvError *error)
{
    const ShvCaseQuantity *quantities = made->item->quantities.data;
    for (int32_t i = 0; i < made->item->quantities.count && made->run_count > 1; i++) {
        ShvCaseQuantity quantity = quantities[i];
        if (!complete) quantity.compare = SHV_VERIFY_SHOWN;
        if (quantity.judge == SHV_JUDGE_TOGETHER) SHV_TRY(put_quantity(made, &quantity, error));
    }
    return SHV_OK;
}
