#include "stability/suite.h"

#include <string.h>

#include "base/text.h"

const char *shv_suite_verdict_name(ShvSuiteVerdict verdict)
{
    static const char *const names[] = {"pass", "MISS", "explained", "skipped"};
    return verdict <= SHV_SUITE_SKIPPED ? names[verdict] : "unknown";
}

ShvSuiteOptions shv_suite_default(void)
{
    return (ShvSuiteOptions){.cookie = SHV_DEFINITION_COOKIE, .most_seconds = 120.0};
}

static ShvStatus run_case(ShvSuite *suite, int32_t index, ShvError *error)
{
    ShvSuiteCase *item = &suite->cases[index];
    if (item->has_run) return SHV_OK;
    if (suite->options.quick && item->is_long) {
        item->row.verdict = SHV_SUITE_SKIPPED;
        return SHV_OK;
    }
    if (suite->options.begins) suite->options.begins(suite->options.data, &item->row);
    SHV_TRY(shv_suite_measure(&item->found, item->path, item->row.overrides, &suite->options, error));
    item->has_run = true;
    item->row.seconds = item->found.seconds;
    return shv_suite_judge(suite, index, error);
}

static ShvStatus run_all(ShvSuite *suite, ShvError *error)
{
    SHV_TRY(shv_suite_read(suite, error));
    for (int32_t i = 0; i < suite->count; i++) SHV_TRY(run_case(suite, i, error));
    return SHV_OK;
}

ShvStatus shv_suite_run(ShvSuite **suite, const char *folder, const ShvSuiteOptions *given, ShvError *error)
{
    *suite = NULL;
    const ShvSuiteOptions options = given ? *given : shv_suite_default();
    if (options.cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the options did not start from shv_suite_default()");
    ShvSuite *made = shv_allocate(options.memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the suite", sizeof *made);
    made->options = options;
    ShvStatus status = SHV_OK;
    if (shv_format(made->folder, sizeof made->folder, "%s", folder) >= (int)sizeof made->folder)
        status = shv_fail(error, SHV_BAD_INPUT, "the name of the suite's folder is too long");
    if (status == SHV_OK) status = run_all(made, error);
    if (status != SHV_OK) {
        shv_suite_destroy(made);
        return status;
    }
    *suite = made;
    return SHV_OK;
}

void shv_suite_destroy(ShvSuite *suite)
{
    if (!suite) return;
    shv_release(suite->cases);
    shv_release(suite);
}

int32_t shv_suite_count(const ShvSuite *suite)
{
    return suite->count;
}

const ShvSuiteRow *shv_suite_row(const ShvSuite *suite, int32_t index)
{
    return &suite->cases[index].row;
}

int32_t shv_suite_verdicts(const ShvSuite *suite, ShvSuiteVerdict verdict)
{
    int32_t count = 0;
    for (int32_t i = 0; i < suite->count; i++) count += suite->cases[i].row.verdict == verdict;
    return count;
}
