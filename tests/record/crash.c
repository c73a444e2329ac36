#include "check.h"

#include "crash.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "files.h"
#include "operations.h"
#include "shiver/run_file.h"

static CrashCounters *counters;
static int64_t kill_at = -1;
static bool torn;
static CrashRefusal refusal;

CrashCounters *crash_counters(void)
{
    return counters;
}

/* Ends the process before the operation of that number, or within it: what it writes then is torn at a page. */
static int count_and_kill(const Operation *operation, size_t *size)
{
    enum { PAGE = 4096 };
    const bool last = kill_at >= 0 && counters->operations == kill_at;
    counters->operations++;
    if (!last) return 0;
    if (operation->kind == OPERATION_WRITE && kill_at % 2 == 1 && *size > PAGE) {
        *size = (*size / 2 + PAGE - operation->offset % PAGE) / PAGE * PAGE;
        torn = true;
        return 0;
    }
    kill(getpid(), SIGKILL);
    return 0;
}

/* The rest of a torn write is asked for next. */
static int kill_after_torn(const Operation *operation, size_t *size)
{
    if (torn) kill(getpid(), SIGKILL);
    return count_and_kill(operation, size);
}

static int refuse_one(const Operation *operation, size_t *size)
{
    (void)operation, (void)size;
    const int64_t number = counters->operations++;
    return number == refusal.at || (refusal.always && number > refusal.at) ? refusal.number : 0;
}

int crash_frames(const char *path, const FakeSetup *setup, int frames, ShvError *error)
{
    ShvRecord *record;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.force = true;
    definition.sync_interval = setup->sync_interval;
    ShvSimulation *simulation = fake_create(setup);
    ShvStatus status = shv_record_create(&record, &definition, simulation, error);
    for (int i = 0; i < frames && status == SHV_OK; i++) {
        fake_advance(simulation);
        status = shv_record_frame(record, simulation, error);
        if (status == SHV_OK) counters->frames++;
    }
    ShvError closing;
    const ShvStatus closed = shv_record_close(record, status, "", &closing);
    if (status == SHV_OK && closed != SHV_OK) *error = closing;
    fake_destroy(simulation);
    return status == SHV_OK ? (int)closed : (int)status;
}

static void record_child(const char *path, const FakeSetup *setup, int frames)
{
    ShvError error;
    operations_hook(kill_after_torn);
    _exit(crash_frames(path, setup, frames, &error));
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
    counters->frames = counters->operations = 0;
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

int crash_refuse(const char *path, const FakeSetup *setup, int frames, CrashRefusal refused)
{
    int status = 0;
    share_counters();
    counters->frames = counters->operations = 0;
    fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        ShvError error;
        refusal = refused;
        operations_hook(refuse_one);
        _exit(crash_frames(path, setup, frames, &error));
    }
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
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

const char *crash_check_open(ShvRunFile *file, const FakeSetup *setup, int64_t least)
{
    static char text[1200];
    ShvError error;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (info->frame_count < least || info->frame_count > counters->frames + 1) {
        snprintf(text, sizeof text, "%lld frames in the file, %lld were told of", (long long)info->frame_count,
                 (long long)counters->frames);
        return text;
    }
    if (shv_run_file_verify(file, &error) != SHV_OK) {
        snprintf(text, sizeof text, "%s", error.message);
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

const char *crash_check_least(const char *path, const FakeSetup *setup, int64_t least)
{
    static char text[1200];
    ShvError error;
    ShvRunFile *file;
    if (access(path, F_OK) != 0) return least == 0 ? NULL : "no file";
    if (shv_run_file_open(&file, path, NULL, &error) != SHV_OK) {
        snprintf(text, sizeof text, "%s", error.message);
        return text;
    }
    const char *wrong = crash_check_open(file, setup, least);
    shv_run_file_close(file);
    return wrong;
}

const char *crash_check(const char *path, const FakeSetup *setup)
{
    return crash_check_least(path, setup, counters->frames);
}

int64_t crash_operations(const void *folder, const FakeSetup *setup, int frames)
{
    const char *path = file_in(folder, "count.h5");
    crash_record(path, setup, frames, -1);
    unlink(path);
    return crash_counters()->operations;
}

/* The journals of those that were killed before lie in the way: they do no harm. */
int64_t crash_at_operations(const void *folder, const FakeSetup *setup, int64_t first, int64_t stride)
{
    int64_t kills = 0;
    const int64_t all = crash_operations(folder, setup, CRASH_FRAMES);
    for (int64_t at = first; at < all; at += stride, kills++) {
        const char *path = file_in(folder, "run.h5");
        unlink(path);
        crash_record(path, setup, CRASH_FRAMES, at);
        assert_true(crash_counters()->operations == at + 1);
        const char *wrong = crash_check(path, setup);
        if (wrong) fail_msg("killed at operation %lld: %s", (long long)at, wrong);
    }
    return kills;
}
