/* A verification case, as read and as it is judged; scenes/verification/README.md tells what the keys mean. */
#ifndef SHV_EVALUATE_CASE_H
#define SHV_EVALUATE_CASE_H

#include "evaluate/names.h"
#include "scene/schema.h"
#include "shiver/verify.h"

typedef struct ShvCaseRun {
    ShvItemHead head;
    const char *title, *scene, *set, *let; /* NULL: not given */
    const char *expect, *explained;
    bool full; /* only with the full set */
} ShvCaseRun;

typedef enum ShvCaseJudge {
    SHV_JUDGE_ALL,
    SHV_JUDGE_LAST,
    SHV_JUDGE_TOGETHER /* once, after all runs */
} ShvCaseJudge;

typedef struct ShvCaseQuantity {
    ShvItemHead head;
    const char *name, *measure, *reference, *unit, *source, *explained;
    ShvVerifyCompare compare;
    bool strict; /* of a line of `expect` alone */
    ShvCaseJudge judge;
    double tolerance, tolerance_absolute; /* NaN: not given */
} ShvCaseQuantity;

typedef struct ShvCaseItem {
    ShvItemHead head;
    int32_t version;
    const char *title, *scene, *source, *let, *remark;
    bool in_short;
    ShvItems runs, quantities; /* ShvCaseRun, ShvCaseQuantity */
} ShvCaseItem;

/* Reads a case; `work` gets items, `texts` what they point to. NULL after faults, which are in `diagnostics`, or when a pool has
   failed. */
ShvCaseItem *shv_case_read(const char *text, size_t length, ShvPool *work, ShvPool *texts, ShvDiagnostics *diagnostics);

/* What is kept of a run until the case is done. */
typedef struct ShvKeptRun {
    ShvNamedRun named;
    const char *title;
    ShvOutcome outcome;
} ShvKeptRun;

struct ShvVerification {
    ShvMemory *memory;
    ShvPool texts; /* what rows point to */
    ShvVerifyCase view;
    ShvVerifyRow *rows;
    int32_t row_capacity;
    /* until the case is done */
    const ShvVerifyOptions *options;
    const ShvCaseItem *item;
    char *folder;
    ShvPool work; /* lines, variables, series */
    ShvKeptRun *runs, *now;
    int32_t run_count;
    ShvNames names;
};

/* The next line that is not blank, without spaces around it; NULL at the end. `*at` moves on. */
char *shv_next_line(ShvPool *pool, const char **at);
/* s of the whole run, with set-up. */
double shv_run_seconds(const ShvOutcome *outcome);
/* judge.c: the rows of the run `now`, of which `last` is the last one; and those of all runs together, judged if these are `complete`. */
ShvStatus shv_judge_run(ShvVerification *made, const ShvCaseRun *run, bool last, ShvError *error);
ShvStatus shv_judge_together(ShvVerification *made, bool complete, ShvError *error);

#endif
