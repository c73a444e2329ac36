/* Status codes and messages: every function of Shiver that can fail returns a ShvStatus. */
#ifndef SHIVER_STATUS_H
#define SHIVER_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ShvStatus {
    SHV_OK = 0,
    SHV_BAD_INPUT,   /* the caller or the scene must change something; the message says what */
    SHV_NO_MEMORY,   /* an allocation failed; everything made so far has been released */
    SHV_FILE_ERROR,  /* a file could not be read or written */
    SHV_DIVERGED,    /* the solution left its stated bound or met a non-finite value */
    SHV_INTERRUPTED, /* the caller asked to stop; results so far are valid */
    SHV_UNSUPPORTED  /* a valid request that this build or method does not serve */
} ShvStatus;

/* The message that belongs to the last failure. `message` is always terminated; it is a whole
   sentence that tells the user what to change. */
typedef struct ShvError {
    ShvStatus status;
    char message[1024];
} ShvError;

/* Short name of a status ("bad input"), never NULL. */
const char *shv_status_name(ShvStatus status);

/* Fills `error` (may be NULL) printf-style and returns `status`, so that a failing function ends
   with `return shv_fail(error, SHV_BAD_INPUT, "…", …);`. */
ShvStatus shv_fail(ShvError *error, ShvStatus status, const char *format, ...);

/* Puts a context in front of the message: "context: message". Returns `error->status`. */
ShvStatus shv_fail_within(ShvError *error, ShvStatus status, const char *context, ...);

#ifdef __cplusplus
}
#endif
#endif
