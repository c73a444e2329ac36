#include "check.h"

#include "crash.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "files.h"
#include "shiver/run_file.h"

static CrashCounters *counters;
static int64_t kill_at = -1;

CrashCounters *crash_counters(void)
{
    return counters;
}

ssize_t pwrite(int descriptor, const void *data, size_t size, off_t offset);

/* Stands before the C library's: the run file's bytes all pass here, so that a test can end the process at each. */
ssize_t pwrite(int descriptor, const void *data, size_t size, off_t offset)
{
    const bool last = counters && kill_at >= 0 && counters->writes == kill_at;
    if (counters) counters->writes++;
    if (lseek(descriptor, offset, SEEK_SET) < 0) return -1;
    if (last) kill(getpid(), SIGKILL);
    return write(descriptor, data, size);
}

static void record_child(const char *path, const FakeSetup *setup, int frames)
{
    ShvError error;
    ShvRecord *record;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.force = true;
    ShvSimulation *simulation = fake_create(setup);
    if (shv_record_create(&record, &definition, simulation, &error) != SHV_OK) _exit(1);
    for (int i = 0; i < frames; i++) {
        fake_advance(simulation);
        if (shv_record_frame(record, simulation, &error) != SHV_OK) _exit(2);
        counters->frames++;
    }
    shv_record_close(record, SHV_OK, "", &error);
    _exit(0);
}

static void share_counters(void)
{
    if (counters) return;
    char name[] = "/tmp/shiver_counters_XXXXXX";
    const int descriptor = mkstemp(name);
    unlink(name);
    if (ftruncate(descriptor, sizeof *counters) != 0) abort();
    counters = mmap(NULL, sizeof *counters, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    close(descriptor);
}

void crash_expect(int64_t frames)
{
    share_counters();
    counters->frames = frames;
}

static pid_t start_child(const char *path, const FakeSetup *setup, int frames, int64_t at)
{
    share_counters();
    counters->frames = counters->writes = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child != 0) return child;
    kill_at = at;
    record_child(path, setup, frames);
    return 0;
}

void crash_record(const char *path, const FakeSetup *setup, int frames, int64_t at)
{
    waitpid(start_child(path, setup, frames, at), NULL, 0);
}

void crash_record_after(const char *path, const FakeSetup *setup, int frames, long nanoseconds)
{
    const pid_t child = start_child(path, setup, frames, -1);
    nanosleep(&(struct timespec){nanoseconds / 1000000000L, nanoseconds % 1000000000L}, NULL);
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
}

/* ---- what is left ---- */

static const char *check_frame(ShvRunFile *file, int64_t index, const ShvFrameView *frame, double *values,
                               uint8_t *alive)
{
    static char text[1200];
    ShvError error;
    double time;
    ShvLedgerView ledger;
    if (shv_run_file_frame(file, index, &time, NULL, alive, values, NULL, NULL, NULL, &error) != SHV_OK ||
        shv_run_file_ledger(file, index, &ledger, &error) != SHV_OK) {
        snprintf(text, sizeof text, "frame %lld: %s", (long long)index, error.message);
        return text;
    }
    snprintf(text, sizeof text, "frame %lld of %lld is not what was written", (long long)index,
             (long long)shv_run_file_info(file)->frame_count);
    if (time != frame->time || memcmp(&ledger, &frame->ledger, sizeof ledger) != 0) return text;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const bool lives = frame->fragments[i].mode != SHV_FRAGMENT_DEAD;
        if (alive[i] != lives || (lives && memcmp(values + 3 * i, frame->fragments[i].position, 24) != 0)) return text;
    }
    return NULL;
}

static const char *check_frames(ShvRunFile *file, const FakeSetup *setup)
{
    static char text[1200];
    ShvError error;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (info->frame_count < counters->frames || info->frame_count > counters->frames + 1) {
        snprintf(text, sizeof text, "%lld frames in the file, %lld were told of", (long long)info->frame_count,
                 (long long)counters->frames);
        return text;
    }
    int64_t rows = 0; /* of probes, at least those of the frames */
    const size_t count = (size_t)info->fragment_count;
    double *values = calloc(3 * count, sizeof *values);
    uint8_t *alive = calloc(count, 1);
    ShvFragmentView *fragments = calloc(count, sizeof *fragments);
    const char *wrong = NULL;
    ShvSimulation *again = fake_create(setup);
    for (int64_t i = 0; i < info->frame_count && !wrong; i++) {
        fake_advance(again);
        rows += shv_simulation_frame(again)->probe_row_count;
        if (shv_simulation_frame(again)->fragment_count > info->fragment_count)
            wrong = "a fragment is missing";
        else if (rows > info->probe_row_count)
            wrong = "rows of probes are missing";
        else
            wrong = check_frame(file, i, shv_simulation_frame(again), values, alive);
    }
    if (!wrong && shv_run_file_fragments(file, fragments, &error) != SHV_OK) {
        snprintf(text, sizeof text, "%s", error.message);
        wrong = text;
    }
    fake_destroy(again);
    free(values);
    free(alive);
    free(fragments);
    return wrong;
}

const char *crash_check(const char *path, const FakeSetup *setup)
{
    static char text[1200];
    ShvError error;
    ShvRunFile *file;
    if (access(path, F_OK) != 0) return counters->frames == 0 ? NULL : "no file";
    if (shv_run_file_open(&file, path, NULL, &error) != SHV_OK) {
        snprintf(text, sizeof text, "%s", error.message);
        return text;
    }
    const char *wrong = check_frames(file, setup);
    shv_run_file_close(file);
    return wrong;
}

int64_t crash_writes(const void *folder, int frames)
{
    const char *path = file_in(folder, "count.h5");
    crash_record(path, &CRASH_SETUP, frames, -1);
    unlink(path);
    return crash_counters()->writes;
}

int64_t crash_at_writes(const void *folder, int64_t first, int64_t stride)
{
    enum { END = 8 };
    int64_t kills = 0;
    const int64_t all = crash_writes(folder, CRASH_FRAMES);
    for (int64_t at = first; at < all - END; at += stride, kills++) {
        const char *path = file_in(folder, "run.h5");
        unlink(path);
        crash_record(path, &CRASH_SETUP, CRASH_FRAMES, at);
        assert_true(crash_counters()->writes == at + 1);
        const char *wrong = crash_check(path, &CRASH_SETUP);
        if (wrong) fail_msg("killed before write %lld: %s", (long long)at, wrong);
    }
    return kills;
}
