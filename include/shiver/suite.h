/* Suites of extreme scenes, each with what is expected of it. */
#ifndef SHIVER_SUITE_H
#define SHIVER_SUITE_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ShvSuiteVerdict {
    SHV_SUITE_PASS,
    SHV_SUITE_MISS,
    SHV_SUITE_EXPLAINED, /* a miss whose reason the scene states */
    SHV_SUITE_SKIPPED    /* marked long in a quick suite */
} ShvSuiteVerdict;
const char *shv_suite_verdict_name(ShvSuiteVerdict verdict);

enum { SHV_SUITE_TEXT = 768 };

typedef struct ShvSuiteRow {
    char number[16];                /* of the case; several rows may share one */
    char title[256], file[128];     /* what it is; scene file, or "tests/module/test_noun.c, function" */
    char overrides[SHV_SUITE_TEXT]; /* "key=value; key=value" */
    char expected[SHV_SUITE_TEXT], found[SHV_SUITE_TEXT], explained[SHV_SUITE_TEXT];
    ShvSuiteVerdict verdict;
    double seconds; /* of run time; 0 for tests, which are not run */
} ShvSuiteRow;

typedef struct ShvSuiteOptions {
    uint32_t cookie;
    bool quick;               /* leave out what is marked long */
    double most_seconds;      /* a case that takes longer is a miss; 120 */
    const char *tests;        /* folder of the tests that covered.txt names; NULL: "FOLDER/../../tests" */
    struct ShvMemory *memory; /* may be NULL */
    void (*begins)(void *data, const ShvSuiteRow *row); /* told before every run; may be NULL */
    void *data;
} ShvSuiteOptions;
ShvSuiteOptions shv_suite_default(void);

typedef struct ShvSuite ShvSuite;
/* Runs all cases of the scenes (*.yaml) in FOLDER, in the order of their file names, then looks up those of FOLDER/covered.txt. A scene states
   its cases in comments:

       #! case 3: a title                       begins a case; several a file
       #! set: key=value; key=value             overrides of it
       #! expect: finishes                      to the end, with finite numbers
       #! expect: told                          the same, or it stops on the way and says that it diverged
       #! expect: refused TEXT                  before it begins, with a message that contains the text
       #! expect: stops TEXT                    on the way, likewise
       #! expect: MEASURE < VALUE               or <=, >, >=, =; VALUE may be `N of FILE` for N times the figure of another scene
       #! expect: MEASURE = VALUE within SHARE  of VALUE; or `within X absolute`
       #! expect: hash = first                  the same bits as the first case of the file
       #! explained: TEXT                       why it misses
       #! long                                  not for quick suites

   and a line of covered.txt is `number | title | module/test_noun | function`: a test that covers a case that is no scene. It
   passes when that function stands in that test's source. SHV_BAD_INPUT for what is not of these forms, with the place. */
ShvStatus shv_suite_run(ShvSuite **suite, const char *folder, const ShvSuiteOptions *options, ShvError *error);
void shv_suite_destroy(ShvSuite *suite);
int32_t shv_suite_count(const ShvSuite *suite);
const ShvSuiteRow *shv_suite_row(const ShvSuite *suite, int32_t index);
/* How many rows have the verdict. */
int32_t shv_suite_verdicts(const ShvSuite *suite, ShvSuiteVerdict verdict);
/* Names of the measures, NULL at the end, and what they mean. */
const char *const *shv_suite_measures(void);

#ifdef __cplusplus
}
#endif
#endif
