/* What is expected of a run, a line each: "finishes", "told", "refused TEXT", "stops TEXT", or two formulas with < <= > >= or =
   between them, the last one with "within SHARE" or "within X absolute". */
#include <string.h>

#include "base/text.h"
#include "evaluate/verify.h"

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

typedef struct Relation {
    const char *sign;
    ShvVerifyCompare compare;
    bool strict;
} Relation;

static const Relation *find_relation(const char *line, char **at)
{
    static const Relation relations[] = {{"<=", SHV_VERIFY_BELOW, false},
                                         {">=", SHV_VERIFY_ABOVE, false},
                                         {"<", SHV_VERIFY_BELOW, true},
                                         {">", SHV_VERIFY_ABOVE, true},
                                         {"=", SHV_VERIFY_NEAR, false}};
    for (size_t i = 0; i < sizeof relations / sizeof relations[0]; i++)
        if ((*at = strstr(line, relations[i].sign))) return &relations[i];
    return NULL;
}

/* "X within Y absolute", cut into its formulas. */
static char *cut_tolerance(char *text, bool *absolute)
{
    static const char word[] = " within ", last[] = " absolute";
    char *within = strstr(text, word);
    *absolute = within == NULL;
    if (!within) return NULL;
    *within = '\0';
    within += strlen(word);
    char *end = strstr(within, last);
    *absolute = end != NULL;
    if (end) *end = '\0';
    return within;
}

static ShvStatus compare(Verifier *verifier, char *line, ShvVerifyRow *row, ShvError *error)
{
    const ShvFormulaNames names = shv_names(&verifier->names);
    char *sign = NULL;
    const Relation *relation = find_relation(line, &sign);
    if (!relation)
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%.100s' is none of finishes, told, refused, stops, and lacks one of < <= > >= =", line);
    char *right = sign + strlen(relation->sign), *end = sign;
    while (end > line && end[-1] == ' ') end--;
    *end = '\0';
    const char *within = cut_tolerance(right, &row->absolute);
    row->compare = relation->compare;
    row->strict = relation->strict;
    double tolerance = 0.0;
    if (within) SHV_TRY(shv_formula_number(within, &names, &tolerance, error));
    SHV_TRY(shv_formula_number(line, &names, &row->value, error));
    SHV_TRY(shv_formula_number(right, &names, &row->reference, error));
    row->tolerance = tolerance;
    return SHV_OK;
}

static ShvStatus expect_line(Verifier *verifier, char *line, const ShvCaseRun *run, ShvError *error)
{
    const KeptRun *now = verifier->now;
    ShvPool *texts = &verifier->made->texts;
    ShvVerifyRow row = shv_verify_row(verifier, now, shv_pool_text(texts, line, strlen(line)));
    row.compare = SHV_VERIFY_NEAR;
    const char *message = shv_pool_text(texts, now->outcome.message, strlen(now->outcome.message));
    if (!row.quantity || !message) return shv_fail_memory(error, "rows", 0);
    const int so = ended_so(&now->outcome, line);
    ShvError why;
    if (so < 0) {
        const ShvStatus status = compare(verifier, line, &row, &why);
        if (status == SHV_NO_MEMORY) return shv_fail_memory(error, "rows", 0);
        if (status != SHV_OK && now->outcome.status == SHV_OK)
            return shv_verify_fail(verifier, row.quantity, &why, error);
        shv_verify_judge(&row, row.absolute, run->explained); /* what the run did not come to is a miss */
    } else {
        row.verdict = so ? SHV_VERDICT_PASS : run->explained ? SHV_VERDICT_EXPLAINED : SHV_VERDICT_MISS;
        if (!so) row.note = run->explained ? run->explained : message[0] ? message : "it ran to its end";
    }
    return shv_verify_append(verifier, &row, error);
}

ShvStatus shv_verify_expect(Verifier *verifier, const ShvCaseRun *run, ShvError *error)
{
    const char *at = run->expect;
    for (char *line = shv_next_line(&verifier->work, &at); line; line = shv_next_line(&verifier->work, &at))
        SHV_TRY(expect_line(verifier, line, run, error));
    return verifier->work.failed ? shv_fail_memory(error, "rows", 0) : SHV_OK;
}
