#include "base/temporary.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/text.h"

enum { MOST_GROUPS = 8, MOST_DESCRIPTORS = 4096 };
enum { NAP = 10 * 1000 * 1000, NAPS = 200 }; /* ns, times: two seconds */

/* What the keeper says first. */
typedef struct Answer {
    int number; /* errno, 0: the folder is there */
    char folder[SHV_TEMPORARY_PATH];
} Answer;

/* Kills a group until nobody is left in it. */
static void end_group(pid_t group)
{
    const struct timespec nap = {0, NAP};
    for (int i = 0; i < NAPS && kill(-group, SIGKILL) == 0; i++) nanosleep(&nap, NULL);
}

/* ---- the keeper: nothing but system calls, since other threads may have held any lock at the fork ---- */

/* Pipes and locks of the process are not kept open by it. */
static void leave_process(int line)
{
    setsid(); /* what the terminal sends does not reach it */
    const long most = sysconf(_SC_OPEN_MAX);
    const int nothing = open("/dev/null", O_RDWR);
    for (int i = 0; i <= STDERR_FILENO; i++)
        if (i != line) dup2(nothing, i);
    for (int i = STDERR_FILENO + 1; i < MOST_DESCRIPTORS && i < most; i++)
        if (i != line) close(i);
}

static void note_group(pid_t *groups, pid_t group)
{
    for (int i = 0; i < MOST_GROUPS; i++) {
        if (groups[i] != (group > 0 ? 0 : -group)) continue;
        groups[i] = group > 0 ? group : 0;
        return;
    }
}

static void keep(char *folder, const char *file, int line)
{
    Answer answer = {0};
    pid_t groups[MOST_GROUPS] = {0}, group;
    leave_process(line);
    if (!mkdtemp(folder)) answer.number = errno;
    memcpy(answer.folder, folder, strlen(folder) + 1);
    (void)send(line, &answer, sizeof answer, MSG_NOSIGNAL);
    if (answer.number != 0) _exit(1);
    while (read(line, &group, sizeof group) == (ssize_t)sizeof group) note_group(groups, group);
    for (int i = 0; i < MOST_GROUPS; i++)
        if (groups[i] > 0) end_group(groups[i]);
    execl("/bin/rm", "rm", "-rf", "--", file ? file : folder, folder, (char *)NULL);
    _exit(1);
}

/* ---- the process ---- */

static ShvStatus fail(ShvError *error, const char *folder, int number)
{
    return shv_fail(error, SHV_FILE_ERROR, "cannot make a temporary folder like %s: %s", folder, strerror(number));
}

static ShvStatus name_folder(char *folder, ShvError *error)
{
    const char *base = getenv("TMPDIR");
    const int length = shv_format(folder, SHV_TEMPORARY_PATH, "%s/shiver-XXXXXX", base && *base == '/' ? base : "/tmp");
    if (length >= 0 && length < SHV_TEMPORARY_PATH) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the name of the temporary folder, TMPDIR, is longer than %d characters",
                    SHV_TEMPORARY_PATH);
}

/* No signal reaches the keeper before it has left the process's session. */
static pid_t fork_keeper(char *folder, const char *file, const int ends[2])
{
    sigset_t all, before;
    sigfillset(&all);
    sigprocmask(SIG_SETMASK, &all, &before);
    const pid_t keeper = fork();
    if (keeper == 0) {
        close(ends[0]);
        keep(folder, file, ends[1]);
    }
    const int number = errno;
    sigprocmask(SIG_SETMASK, &before, NULL);
    errno = number;
    return keeper;
}

static bool receive(int line, void *data, size_t size)
{
    for (size_t done = 0; done < size;) {
        const ssize_t count = read(line, (char *)data + done, size - done);
        if (count == 0 || (count < 0 && errno != EINTR)) return false;
        if (count > 0) done += (size_t)count;
    }
    return true;
}

ShvStatus shv_temporary_open(ShvTemporary *temporary, const char *file, ShvError *error)
{
    int ends[2];
    Answer answer = {.number = ECHILD};
    *temporary = (ShvTemporary){.line = -1};
    SHV_TRY(name_folder(temporary->folder, error));
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return fail(error, temporary->folder, errno);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    const pid_t keeper = fork_keeper(temporary->folder, file, ends);
    const int number = errno;
    close(ends[1]);
    if (keeper < 0) {
        close(ends[0]);
        return fail(error, temporary->folder, number);
    }
    temporary->keeper = keeper;
    temporary->line = ends[0];
    if (receive(ends[0], &answer, sizeof answer) && answer.number == 0) {
        memcpy(temporary->folder, answer.folder, sizeof answer.folder);
        return SHV_OK;
    }
    shv_temporary_close(temporary);
    return fail(error, temporary->folder, answer.number);
}

void shv_temporary_join(const ShvTemporary *temporary)
{
    const pid_t own = getpid();
    setpgid(0, 0);
    setenv("TMPDIR", temporary->folder, 1);
    (void)send(temporary->line, &own, sizeof own, MSG_NOSIGNAL);
}

void shv_temporary_end(const ShvTemporary *temporary, pid_t child)
{
    const pid_t gone = -child; /* the number may become another's */
    end_group(child);
    (void)send(temporary->line, &gone, sizeof gone, MSG_NOSIGNAL);
}

void shv_temporary_close(ShvTemporary *temporary)
{
    if (temporary->keeper <= 0) return;
    close(temporary->line);
    while (waitpid(temporary->keeper, NULL, 0) < 0 && errno == EINTR) continue;
    temporary->keeper = 0;
}
