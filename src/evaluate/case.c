#include "evaluate/case.h"

#include <math.h>

#include "scene/read.h"

#define LENGTH_OF(array) ((int)(sizeof(array) / sizeof *(array)))

_Static_assert(sizeof(ShvVerifyCompare) == sizeof(int) && sizeof(ShvCaseJudge) == sizeof(int),
               "an enum has the size of int");

static const ShvRange version = {1.0, 1.0, false, false}, not_negative = {0.0, (double)INFINITY, false, false};

#define RUN(member) offsetof(ShvCaseRun, member)
static const ShvKey run_keys[] = {
    {"title", SHV_KEY_TEXT, .offset = RUN(title), .sentence = "What the tables call it; its name unless given."},
    {"scene", SHV_KEY_TEXT, .offset = RUN(scene), .sentence = "Another scene file than the case's."},
    {"set", SHV_KEY_TEXT, .offset = RUN(set), .sentence = "Overrides of the scene, one a line."},
    {"expect", SHV_KEY_TEXT, .offset = RUN(expect), .sentence = "What must hold of this run, one a line."},
    {"explained", SHV_KEY_TEXT, .offset = RUN(explained), .sentence = "Why it does not."},
    {"let", SHV_KEY_TEXT, .offset = RUN(let), .sentence = "Variables of this run, one a line."},
    {"full", SHV_KEY_BOOLEAN, .offset = RUN(full), .sentence = "Left out of the short set."},
};
static void start_run(void *item)
{
    *(ShvCaseRun *)item = (ShvCaseRun){.full = false};
}
static const ShvTable run_table = {.name = "runs.<name>",
                                   .sentence = "One run of the scene.",
                                   .keys = run_keys,
                                   .key_count = LENGTH_OF(run_keys),
                                   .size = sizeof(ShvCaseRun),
                                   .start = start_run};

#define QUANTITY(member) offsetof(ShvCaseQuantity, member)
static const ShvChoice compare_choices[] = {{"near", SHV_VERIFY_NEAR},
                                            {"below", SHV_VERIFY_BELOW},
                                            {"above", SHV_VERIFY_ABOVE},
                                            {"shown", SHV_VERIFY_SHOWN},
                                            {NULL, 0}};
static const ShvChoice judge_choices[] = {{"all", SHV_JUDGE_ALL}, {"last", SHV_JUDGE_LAST}, {NULL, 0}};
static const ShvKey quantity_keys[] = {
    {"name", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = QUANTITY(name), .sentence = "What it is."},
    {"measure", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = QUANTITY(measure),
     .sentence = "Formula: what the run gave."},
    {"reference", SHV_KEY_TEXT, .offset = QUANTITY(reference), .sentence = "Formula: what it should be."},
    {"unit", SHV_KEY_TEXT, .offset = QUANTITY(unit), .sentence = "Unit of both."},
    {"compare", SHV_KEY_CHOICE, .choices = compare_choices, .offset = QUANTITY(compare),
     .sentence = "How it is judged."},
    {"tolerance", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(tolerance), .absent = "",
     .sentence = "Share of the reference."},
    {"tolerance_absolute", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(tolerance_absolute), .absent = "",
     .sentence = "The same in the unit."},
    {"judge", SHV_KEY_CHOICE, .choices = judge_choices, .offset = QUANTITY(judge),
     .sentence = "Which runs are judged."},
    {"order", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(order), .absent = "",
     .sentence = "Expected order of convergence over the runs."},
    {"order_tolerance", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(order_tolerance), .absent = "",
     .sentence = "How far the observed order may be from it."},
    {"step", SHV_KEY_TEXT, .offset = QUANTITY(step), .sentence = "Formula: what goes to zero over the runs."},
    {"source", SHV_KEY_TEXT, .offset = QUANTITY(source), .sentence = "Where the reference comes from."},
    {"explained", SHV_KEY_TEXT, .offset = QUANTITY(explained), .sentence = "Why it misses."},
};
static void start_quantity(void *item)
{
    *(ShvCaseQuantity *)item = (ShvCaseQuantity){.tolerance = (double)NAN,
                                                 .tolerance_absolute = (double)NAN,
                                                 .order = (double)NAN,
                                                 .order_tolerance = (double)NAN};
}
static const ShvTable quantity_table = {.name = "quantities.<index>",
                                        .sentence = "A number that is compared.",
                                        .keys = quantity_keys,
                                        .key_count = LENGTH_OF(quantity_keys),
                                        .size = sizeof(ShvCaseQuantity),
                                        .start = start_quantity};

#define CASE(member) offsetof(ShvCaseItem, member)
static const ShvKey case_keys[] = {
    {"verification", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &version, .offset = CASE(version), .absent = "",
     .sentence = "Version of the format."},
    {"title", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(title), .sentence = "What is shown."},
    {"scene", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(scene), .sentence = "Scene file."},
    {"source", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(source),
     .sentence = "Where references come from."},
    {"remark", SHV_KEY_TEXT, .offset = CASE(remark), .sentence = "What to know when reading the table."},
    {"short", SHV_KEY_BOOLEAN, .offset = CASE(in_short), .sentence = "Part of the short set."},
    {"let", SHV_KEY_TEXT, .offset = CASE(let), .sentence = "Variables, one a line."},
    {"runs", SHV_KEY_NAMED, .table = &run_table, .offset = CASE(runs), .sentence = "Runs by name."},
    {"quantities", SHV_KEY_LIST, .table = &quantity_table, .offset = CASE(quantities), .sentence = "What is compared."},
};
static void start_case(void *item)
{
    *(ShvCaseItem *)item = (ShvCaseItem){.version = 0};
}
static const ShvTable case_table = {.name = "the verification case",
                                    .sentence = "The top level.",
                                    .keys = case_keys,
                                    .key_count = LENGTH_OF(case_keys),
                                    .size = sizeof(ShvCaseItem),
                                    .start = start_case};

/* What a table cannot say. */
static void check_quantity(const ShvCaseQuantity *quantity, ShvDiagnostics *diagnostics)
{
    const ShvPlace place = quantity->head.node->place;
    const bool tolerance = !isnan(quantity->tolerance) || !isnan(quantity->tolerance_absolute);
    if (!quantity->head.good) return;
    if (quantity->compare != SHV_VERIFY_SHOWN && !quantity->reference)
        shv_error(diagnostics, place, "a quantity that is judged needs 'reference'; give it, or 'compare: shown'");
    if (quantity->compare == SHV_VERIFY_NEAR && !tolerance)
        shv_error(diagnostics, place, "'compare: near' needs 'tolerance' or 'tolerance_absolute'");
    if (!isnan(quantity->tolerance) && !isnan(quantity->tolerance_absolute))
        shv_error(diagnostics, place, "give one of 'tolerance' and 'tolerance_absolute'");
    if (!isnan(quantity->order) && (!quantity->step || isnan(quantity->order_tolerance)))
        shv_error(diagnostics, place, "'order' needs 'step' and 'order_tolerance'");
}

ShvCaseItem *shv_case_read(const char *text, size_t length, ShvPool *work, ShvPool *texts, ShvDiagnostics *diagnostics)
{
    const ShvNode *root = shv_tree_read(work, diagnostics, text, length, 0);
    ShvCaseItem *item = root ? shv_pool_take(work, 1, sizeof *item) : NULL;
    if (!item) return NULL;
    ShvReader reader = {work, texts, diagnostics, NULL};
    shv_read_document(&reader, &case_table, root, item);
    if (work->failed || texts->failed) return NULL;
    const ShvCaseQuantity *quantities = item->quantities.data;
    for (int32_t i = 0; i < item->quantities.count; i++) check_quantity(&quantities[i], diagnostics);
    const ShvCaseRun *runs = item->runs.data;
    bool any = item->quantities.count > 0;
    for (int32_t i = 0; i < item->runs.count; i++) any |= runs[i].expect != NULL;
    if (!any) shv_error(diagnostics, root->place, "the case compares nothing; give it 'quantities', or runs 'expect'");
    return shv_diagnostics_errors(diagnostics) > 0 ? NULL : item;
}
