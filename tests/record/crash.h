/* A writer that dies: what its file holds afterwards. */
#ifndef SHV_TESTS_CRASH_H
#define SHV_TESTS_CRASH_H

#include <stdint.h>

#include "fake_simulation.h"

/* 64 chunks fill a node of HDF5's chunk index: with one chunk a frame and series, frame 65 splits the nodes of all. */
enum { CRASH_FRAMES = 70 };
static const FakeSetup CRASH_SETUP = {.bricks = 64, .split_every = 3, .most = 127, .splits = 2, .probes = 2};

/* Whole frames told of by the writer, and writes done in all; shared with the parent. */
typedef struct CrashCounters {
    volatile int64_t frames, writes;
} CrashCounters;
CrashCounters *crash_counters(void);

/* Records up to `frames` frames in a child process, which is killed before its write number `at` (0-based, −1: never). Returns
   when the child is gone. */
void crash_record(const char *path, const FakeSetup *setup, int frames, int64_t at);
/* The same, killed from outside after `nanoseconds`. */
void crash_record_after(const char *path, const FakeSetup *setup, int frames, long nanoseconds);

/* Tells crash_check what a writer that was no child of crash_record has written. */
void crash_expect(int64_t frames);

/* Records CRASH_SETUP once for every `stride`-th write from number `first` on, each time killed before that write, and fails the
   test where the file is not whole. The writes of the last frames are left out: they end the file. Returns the kills. */
int64_t crash_at_writes(const void *folder, int64_t first, int64_t stride);
/* Writes of a whole run of CRASH_SETUP with this many frames. */
int64_t crash_writes(const void *folder, int frames);

/* NULL when the file holds all frames that the writer told of, or one more, each with all its numbers, or when there
   is no file and no frame was told of; else what is wrong. */
const char *crash_check(const char *path, const FakeSetup *setup);

#endif
