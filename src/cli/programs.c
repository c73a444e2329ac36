#include "cli/programs.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/command.h"

bool shv_on_path(const char *program)
{
    const char *path = getenv("PATH");
    char candidate[SHV_CLI_PATH];
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        const int written = snprintf(candidate, sizeof candidate, "%.*s/%s", (int)length, path, program);
        if (written > 0 && written < SHV_CLI_PATH && access(candidate, X_OK) == 0) return true;
        path += length + (path[length] == ':');
    }
    return false;
}

bool shv_run_program(const ShvTemporary *place, const char *const *arguments)
{
    const pid_t child = fork();
    if (child < 0) return false;
    if (child > 0) {
        int status = 0;
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
        shv_temporary_end(place, child);
        return status == 0;
    }
    shv_temporary_join(place);
    char *copies[32] = {NULL};
    for (int i = 0; i < 31 && arguments[i]; i++) copies[i] = strdup(arguments[i]);
    execvp(copies[0], copies);
    _exit(127);
}

void shv_interrupt_waiting(void (*handler)(int))
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) sigaction(numbers[i], &action, NULL);
}
