#include "evaluate/case.h"

#include <math.h>

#include "scene/read.h"

#define LENGTH_OF(array) ((int)(sizeof(array) / sizeof *(array)))

_Static_assert(sizeof(ShvVerifyCompare) == sizeof(int) && sizeof(ShvCaseJudge) == sizeof(int),
               "an enum has the size of int");

static const ShvRange version = {1.0, 1.0, false, false}, not_negative = {0.0, (double)INFINITY, false, false};

#define RUN(member) offsetof(ShvCaseRun, member)
static const ShvKey run_keys[] = {
    {"title", SHV_KEY_TEXT, .offset = RUN(title)},
    {"scene", SHV_KEY_TEXT, .offset = RUN(scene)},
    {"set", SHV_KEY_TEXT, .offset = RUN(set)},
    {"expect", SHV_KEY_TEXT, .offset = RUN(expect)},
    {"explained", SHV_KEY_TEXT, .offset = RUN(explained)},
    {"let", SHV_KEY_TEXT, .offset = RUN(let)},
    {"full", SHV_KEY_BOOLEAN, .offset = RUN(full)},
};
static const ShvTable run_table = {
    .name = "runs.<name>", .keys = run_keys, .key_count = LENGTH_OF(run_keys), .size = sizeof(ShvCaseRun)};

#define QUANTITY(member) offsetof(ShvCaseQuantity, member)
static const ShvChoice compare_choices[] = {{"near", SHV_VERIFY_NEAR},
                                            {"below", SHV_VERIFY_BELOW},
                                            {"above", SHV_VERIFY_ABOVE},
                                            {"shown", SHV_VERIFY_SHOWN},
                                            {NULL, 0}};
static const ShvChoice judge_choices[] = {
    {"all", SHV_JUDGE_ALL}, {"last", SHV_JUDGE_LAST}, {"together", SHV_JUDGE_TOGETHER}, {NULL, 0}};
static const ShvKey quantity_keys[] = {
    {"name", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = QUANTITY(name)},
    {"measure", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = QUANTITY(measure)},
    {"reference", SHV_KEY_TEXT, .offset = QUANTITY(reference)},
    {"unit", SHV_KEY_TEXT, .offset = QUANTITY(unit)},
    {"compare", SHV_KEY_CHOICE, .choices = compare_choices, .offset = QUANTITY(compare)},
    {"tolerance", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(tolerance), .absent = ""},
    {"tolerance_absolute", SHV_KEY_NUMBER, .range = &not_negative, .offset = QUANTITY(tolerance_absolute),
     .absent = ""},
    {"judge", SHV_KEY_CHOICE, .choices = judge_choices, .offset = QUANTITY(judge)},
    {"source", SHV_KEY_TEXT, .offset = QUANTITY(source)},
    {"explained", SHV_KEY_TEXT, .offset = QUANTITY(explained)},
};
static void start_quantity(void *item)
{
    *(ShvCaseQuantity *)item = (ShvCaseQuantity){.tolerance = (double)NAN, .tolerance_absolute = (double)NAN};
}
static const ShvTable quantity_table = {.name = "quantities.<index>",
                                        .keys = quantity_keys,
                                        .key_count = LENGTH_OF(quantity_keys),
                                        .size = sizeof(ShvCaseQuantity),
                                        .start = start_quantity};

#define CASE(member) offsetof(ShvCaseItem, member)
static const ShvKey case_keys[] = {
    {"verification", SHV_KEY_INT32, .flags = SHV_KEY_REQUIRED, .range = &version, .offset = CASE(version),
     .absent = ""},
    {"title", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(title)},
    {"scene", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(scene)},
    {"source", SHV_KEY_TEXT, .flags = SHV_KEY_REQUIRED, .offset = CASE(source)},
    {"remark", SHV_KEY_TEXT, .offset = CASE(remark)},
    {"short", SHV_KEY_BOOLEAN, .offset = CASE(in_short)},
    {"let", SHV_KEY_TEXT, .offset = CASE(let)},
    {"runs", SHV_KEY_NAMED, .table = &run_table, .offset = CASE(runs)},
    {"quantities", SHV_KEY_LIST, .table = &quantity_table, .offset = CASE(quantities)},
};
static const ShvTable case_table = {
    .name = "the verification case", .keys = case_keys, .key_count = LENGTH_OF(case_keys), .size = sizeof(ShvCaseItem)};

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
