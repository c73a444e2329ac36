/* Inside of a verification, for the files of this folder. */
#ifndef SHV_EVALUATE_VERIFY_H
#define SHV_EVALUATE_VERIFY_H

#include "evaluate/case.h"
#include "evaluate/names.h"

/* What is kept of a run until the case is done. */
typedef struct KeptRun {
    ShvNamedRun named;
    const char *title;
    ShvOutcome outcome;
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
    ShvPool work, series; /* of the whole case */
    char *folder;
    KeptRun *runs, *now;
    int32_t run_count;
    ShvNames names;
} Verifier;

/* The next line that is not blank, without spaces around it; NULL at the end. `*at` moves on. */
char *shv_next_line(ShvPool *pool, const char **at);
/* Of nothing yet; not judged. */
ShvVerifyRow shv_verify_row(const Verifier *verifier, const KeptRun *run, const char *quantity);
ShvStatus shv_verify_append(Verifier *verifier, const ShvVerifyRow *row, ShvError *error);
ShvStatus shv_verify_fail(Verifier *verifier, const char *quantity, const ShvError *why, ShvError *error);
/* Error and verdict by value, reference and tolerance; errors are shares of the reference unless `absolute` or it is 0. */
void shv_verify_judge(ShvVerifyRow *row, bool absolute, const char *explained);
/* expect.c: the rows of what is expected of the run under way. */
ShvStatus shv_verify_expect(Verifier *verifier, const ShvCaseRun *run, ShvError *error);

#endif
