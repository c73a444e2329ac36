/* A writer that dies: what its file holds afterwards. */
#ifndef SHV_TESTS_CRASH_H
#define SHV_TESTS_CRASH_H

#include <stdbool.h>
#include <stdint.h>

#include "fake_simulation.h"

/* Whole frames told of by the writer, and writes done in all; shared with the parent. */
typedef struct CrashCounters {
    volatile int64_t frames, writes;
} CrashCounters;
CrashCounters *crash_counters(void);

/* Records up to `frames` frames in a child process, which is killed within its write number `at` (0-based, −1: never), half
   of whose bytes are still written when `torn`. Returns when the child is gone. */
void crash_record(const char *path, const FakeSetup *setup, int frames, int64_t at, bool torn);
/* The same, killed from outside after `nanoseconds`. */
void crash_record_after(const char *path, const FakeSetup *setup, int frames, long nanoseconds);

/* Tells crash_check what a writer that was no child of crash_record has written. */
void crash_expect(int64_t frames);

/* NULL when the file holds all frames that the writer told of, or one more, each with all its numbers, or when there
   is no file and no frame was told of; else what is wrong. */
const char *crash_check(const char *path, const FakeSetup *setup);

#endif
