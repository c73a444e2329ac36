/* Verification: scenes whose outcome is known, run and compared. A case is a YAML file beside a scene; the format is told in
   scenes/verification/README.md. */
#ifndef SHIVER_VERIFY_H
#define SHIVER_VERIFY_H

#include <stdio.h>

#include "shiver/scene.h"
#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ShvVerifyCompare {
    SHV_VERIFY_NEAR,  /* |value − reference| within the tolerance */
    SHV_VERIFY_BELOW, /* at most the reference and the tolerance */
    SHV_VERIFY_ABOVE, /* at least the reference less the tolerance */
    SHV_VERIFY_SHOWN  /* not judged */
} ShvVerifyCompare;

typedef enum ShvVerdict {
    SHV_VERDICT_PASS,
    SHV_VERDICT_MISS,      /* not explained */
    SHV_VERDICT_EXPLAINED, /* a miss with an explanation */
    SHV_VERDICT_SHOWN,     /* not judged */
    SHV_VERDICT_FAILED     /* the run ended with an error: `note` */
} ShvVerdict;
const char *shv_verdict_name(ShvVerdict verdict);

/* One line of the table. Texts are never NULL. */
typedef struct ShvVerifyRow {
    const char *run, *quantity, *unit, *source;
    const char *note; /* why it misses, or the error */
    ShvVerifyCompare compare;
    ShvVerdict verdict;
    bool strict;                               /* below or above: and not equal */
    bool absolute;                             /* error and tolerance: in the unit; else shares of |reference| */
    double value, reference, error, tolerance; /* error: value − reference; NaN: does not apply */
    double seconds;                            /* run time of the run; of all runs together: NaN */
} ShvVerifyRow;

typedef struct ShvVerifyCase {
    const char *name, *title, *scene, *source; /* name: of the file without its endings */
    const char *remark;                        /* "" unless given */
    const ShvVerifyRow *rows;
    int32_t row_count;
    int32_t passes, misses, explained; /* misses: with failed runs, without the explained */
    double seconds;
} ShvVerifyCase;

/* Sums of all cases; names and rows stay empty. */
ShvVerifyCase shv_verify_sum(const ShvVerifyCase *const *cases, int32_t count);

typedef struct ShvVerifyOptions {
    uint32_t cookie;
    bool full;      /* also the runs that the short set leaves out */
    bool short_set; /* a case that is not of the short set is left out: *verification is NULL */
    struct ShvMemory *memory;
} ShvVerifyOptions;
ShvVerifyOptions shv_verify_default(void);

typedef struct ShvVerification ShvVerification;
/* Runs a case. What goes wrong within a run is a row; faults of the case file or its scenes are SHV_BAD_INPUT, and
   *diagnostics (may be NULL) lists those of the case file. On failure *verification is
   NULL. */
ShvStatus shv_verify_run(ShvVerification **verification, const char *path, const ShvVerifyOptions *options,
                         ShvDiagnostics **diagnostics, ShvError *error);
void shv_verify_destroy(ShvVerification *verification);
const ShvVerifyCase *shv_verification_case(const ShvVerification *verification);

/* The rows of a case, as `shiver verify` prints them; those of all cases, as with --json. */
void shv_verify_print(const ShvVerifyCase *verified, FILE *stream);
void shv_verify_print_json(const ShvVerifyCase *const *cases, int32_t count, FILE *stream);
/* All cases as a page of HTML, or else as the tables of a Markdown page; `force` replaces an existing file. */
ShvStatus shv_verify_write(const char *path, bool html, bool force, const ShvVerifyCase *const *cases, int32_t count,
                           ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
