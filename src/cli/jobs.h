/* Commands that run many scenes: how they are shared among processes and batch tasks, and how they are stopped. */
#ifndef SHV_CLI_JOBS_H
#define SHV_CLI_JOBS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shiver/status.h"

/* From now on the first SIGINT or SIGTERM asks to stop, the second ends the program. */
void shv_jobs_catch_signals(void);
/* As the `stop` of options. */
bool shv_jobs_asked_to_stop(void *data);

/* A whole number from `least` to `most`; `what` says what is needed. */
ShvStatus shv_jobs_read_number(const char *text, size_t length, int32_t least, int32_t most, const char *what,
                               int32_t *value, ShvError *error);
/* What --jobs N, --task I/N and --merge say, of which one may be given (NULL: not given); 0 where it is not. */
typedef struct ShvShare {
    int32_t jobs, task, tasks; /* task: from 1 */
} ShvShare;
ShvStatus shv_jobs_read(const char *jobs, const char *task, const char *merge, ShvShare *share, ShvError *error);

/* Runs `job` in `jobs` processes at a time, each with its index from 1 on, and waits for all of them. */
typedef ShvStatus (*ShvJob)(const void *data, int32_t index, ShvError *error);
ShvStatus shv_jobs_run(int32_t jobs, ShvJob job, const void *data, ShvError *error);

#endif
