/* The suite of scenes/extreme as a test: no miss without an explanation. */
#ifndef SHV_TESTS_STABILITY_EXTREME_H
#define SHV_TESTS_STABILITY_EXTREME_H

#include "check.h"

#include "shiver/suite.h"

static inline void run_extreme(bool quick)
{
    ShvSuite *suite = NULL;
    ShvError error = {.message = ""};
    ShvSuiteOptions options = shv_suite_default();
    options.quick = quick;
    check_ok(shv_suite_run(&suite, "../scenes/extreme", &options, &error), error);
    for (int32_t i = 0; i < shv_suite_count(suite); i++) {
        const ShvSuiteRow *row = shv_suite_row(suite, i);
        if (row->verdict == SHV_SUITE_MISS)
            print_error("case %s, %s (%s %s): expected %s; found %s\n", row->number, row->title, row->file,
                        row->overrides, row->expected, row->found);
    }
    assert_int_equal(shv_suite_verdicts(suite, SHV_SUITE_MISS), 0);
    assert_true(shv_suite_verdicts(suite, SHV_SUITE_PASS) > 100);
    assert_int_equal(shv_suite_verdicts(suite, SHV_SUITE_SKIPPED) > 0, quick);
    shv_suite_destroy(suite);
}

#endif
