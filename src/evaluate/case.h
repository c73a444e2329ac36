/* The YAML of a verification case, as read; scenes/verification/README.md tells what the keys mean. */
#ifndef SHV_EVALUATE_CASE_H
#define SHV_EVALUATE_CASE_H

#include "scene/schema.h"
#include "shiver/verify.h"

typedef struct ShvCaseRun {
    ShvItemHead head;
    const char *title, *scene, *set, *let; /* NULL: not given */
    const char *expect, *explained;
    bool full; /* only with the full set */
} ShvCaseRun;

typedef enum ShvCaseJudge { SHV_JUDGE_ALL, SHV_JUDGE_LAST } ShvCaseJudge;

typedef struct ShvCaseQuantity {
    ShvItemHead head;
    const char *name, *measure, *reference, *unit, *source, *explained, *step;
    ShvVerifyCompare compare;
    ShvCaseJudge judge;
    double tolerance, tolerance_absolute, order, order_tolerance; /* NaN: not given */
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

#endif
