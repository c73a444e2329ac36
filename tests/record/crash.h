/* A writer that dies: what its file holds afterwards. */
#ifndef SHV_TESTS_CRASH_H
#define SHV_TESTS_CRASH_H

#include <stdbool.h>
#include <stdint.h>

#include "fake_simulation.h"
#include "shiver/run_file.h"

/* 64 chunks fill a node of HDF5's chunk index: with one chunk a frame and series, frame 65 splits the nodes of all. */
enum { CRASH_FRAMES = 70 };
static const FakeSetup CRASH_SETUP = {.bricks = 64, .split_every = 3, .most = 127, .splits = 2, .probes = 2};
/* The same with everything in the journal until the end. */
static const FakeSetup CRASH_LAZY = {
    .bricks = 64, .split_every = 3, .most = 127, .splits = 2, .probes = 2, .sync_interval = 1e9};

/* Whole frames told of by the writer, and operations done in all; shared with the parent. */
typedef struct CrashCounters {
    volatile int64_t frames, operations;
} CrashCounters;
CrashCounters *crash_counters(void);

/* Records up to `frames` frames in a child process, which is killed at its operation number `at` (0-based, −1: never): before
   it, or of odd ones that write much in the middle. Returns when the child is gone. */
void crash_record(const char *path, const FakeSetup *setup, int frames, int64_t at);
/* The same, killed from outside after `nanoseconds`. */
void crash_record_after(const char *path, const FakeSetup *setup, int frames, long nanoseconds);

/* The same in a child process in which one operation, or all from it on, fails; returns its exit status (a ShvStatus), −1: it
   was ended by a signal. */
typedef struct CrashRefusal {
    int64_t at;
    int number; /* errno */
    bool always;
} CrashRefusal;
int crash_refuse(const char *path, const FakeSetup *setup, int frames, CrashRefusal refused);
/* Records in this process; returns a ShvStatus. */
int crash_frames(const char *path, const FakeSetup *setup, int frames, ShvError *error);

/* Tells crash_check what a writer that was no child of crash_record has written. */
void crash_expect(int64_t frames);

/* Records the setup once for every `stride`-th operation from number `first` on, each time killed at it, and fails the
   test where the file is not whole. Returns the kills. */
int64_t crash_at_operations(const void *folder, const FakeSetup *setup, int64_t first, int64_t stride);
/* Operations of a whole run with this many frames. */
int64_t crash_operations(const void *folder, const FakeSetup *setup, int frames);

/* NULL when the file holds all frames that the writer told of, or one more, each with all its numbers, or when there
   is no file and no frame was told of; else what is wrong. */
const char *crash_check(const char *path, const FakeSetup *setup);
/* The same when at least so many frames must be there. */
const char *crash_check_least(const char *path, const FakeSetup *setup, int64_t least);
/* The same of an open file. */
const char *crash_check_open(ShvRunFile *file, const FakeSetup *setup, int64_t least);

#endif
