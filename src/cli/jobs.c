#include "cli/jobs.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/command.h"
#include "cli/reserve.h"

enum { MOST_JOBS = 256 };

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

bool shv_jobs_asked_to_stop(void *data)
{
    (void)data;
    return interrupted != 0 || shv_reserve_used();
}

void shv_jobs_catch_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = (int)SA_RESETHAND; /* the second Ctrl-C ends the program at once */
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

ShvStatus shv_jobs_read_number(const char *text, size_t length, int32_t least, int32_t most, const char *what,
                               int32_t *value, ShvError *error)
{
    int64_t read = 0;
    if (shv_parse_int64(text, length, &read, NULL) != SHV_OK || read < least || read > most)
        return shv_fail(error, SHV_BAD_INPUT, "%s, not '%.60s'", what, text);
    *value = (int32_t)read;
    return SHV_OK;
}

/* "I/N" */
static ShvStatus read_task(const char *text, ShvShare *share, ShvError *error)
{
    static const char what[] = "--task needs I/N, share I (from 1) of N";
    const char *slash = strchr(text, '/');
    if (!slash) return shv_fail(error, SHV_BAD_INPUT, "%s, not '%.60s'", what, text);
    SHV_TRY(shv_jobs_read_number(slash + 1, strlen(slash + 1), 1, 1000000, what, &share->tasks, error));
    return shv_jobs_read_number(text, (size_t)(slash - text), 1, share->tasks, what, &share->task, error);
}

ShvStatus shv_jobs_read(const char *jobs, const char *task, const char *merge, ShvShare *share, ShvError *error)
{
    *share = (ShvShare){0, 0, 0};
    if (jobs)
        SHV_TRY(shv_jobs_read_number(jobs, strlen(jobs), 1, MOST_JOBS,
                                     "--jobs needs a number of runs at a time, 1 to 256", &share->jobs, error));
    if ((task != NULL) + (merge != NULL) + (jobs != NULL) > 1)
        return shv_fail(error, SHV_BAD_INPUT, "of --jobs, --task and --merge only one can be given");
    return task ? read_task(task, share, error) : SHV_OK;
}

ShvStatus shv_jobs_run(int32_t jobs, ShvJob job, const void *data, ShvError *error)
{
    pid_t children[MOST_JOBS];
    int32_t started = 0;
    ShvStatus status = SHV_OK;
    fflush(stdout);
    for (; started < jobs; started++) {
        children[started] = fork();
        if (children[started] < 0) {
            status = shv_fail(error, SHV_NO_MEMORY, "cannot start a process: %s", strerror(errno));
            break;
        }
        if (children[started] > 0) continue;
        ShvError failure;
        const ShvStatus done = job(data, started + 1, &failure);
        if (done != SHV_OK) shv_cli_failed(done, &failure);
        _exit(done == SHV_OK ? 0 : 1);
    }
    for (int32_t i = 0; i < started; i++) {
        int code = 1;
        while (waitpid(children[i], &code, 0) < 0 && errno == EINTR) continue;
        if (status == SHV_OK && (!WIFEXITED(code) || WEXITSTATUS(code) != 0))
            status = interrupted ? shv_fail(error, SHV_INTERRUPTED, "stopped")
                                 : shv_fail(error, SHV_DIVERGED, "a job failed, see above");
    }
    return status;
}
