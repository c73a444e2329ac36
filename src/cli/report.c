/* Where the standard output of a command goes. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "base/publish.h"
#include "cli/command.h"

static ShvStatus fail_to_gather(ShvError *error)
{
    return shv_fail(error, SHV_FILE_ERROR, "cannot gather what is printed: %s", strerror(errno));
}

/* Standard output gets another descriptor behind it; *kept is the one before. */
static ShvStatus redirect(int descriptor, int *kept, ShvError *error)
{
    fflush(stdout);
    *kept = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (*kept >= 0 && dup2(descriptor, STDOUT_FILENO) >= 0) return SHV_OK;
    const ShvStatus status = fail_to_gather(error);
    if (*kept >= 0) close(*kept);
    return status;
}

static ShvStatus restore(int kept, ShvError *error)
{
    const bool lost = fflush(stdout) != 0 || ferror(stdout) != 0;
    const ShvStatus status = lost ? fail_to_gather(error) : SHV_OK;
    dup2(kept, STDOUT_FILENO);
    close(kept);
    return status;
}

static ShvStatus copy(FILE *from, int to, const char *path, ShvError *error)
{
    char block[1 << 14];
    rewind(from);
    for (size_t size; (size = fread(block, 1, sizeof block, from)) > 0;)
        for (size_t done = 0; done < size;) {
            const ssize_t written = write(to, block + done, size - done);
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) return shv_fail(error, SHV_FILE_ERROR, "cannot write '%s': %s", path, strerror(errno));
            done += (size_t)written;
        }
    return ferror(from) ? fail_to_gather(error) : SHV_OK;
}

static ShvStatus publish(FILE *gathered, const ShvArguments *arguments, ShvError *error)
{
    char *temporary = NULL;
    int descriptor;
    SHV_TRY(shv_publish_begin(NULL, arguments->report, &temporary, &descriptor, error));
    ShvStatus status = copy(gathered, descriptor, arguments->report, error);
    if (status == SHV_OK) status = shv_publish_end(temporary, descriptor, arguments->report, arguments->force, error);
    if (status != SHV_OK) unlink(temporary);
    close(descriptor);
    shv_release(temporary);
    return status;
}

static ShvStatus check_report(const ShvArguments *arguments, ShvError *error)
{
    for (int i = 0; i < arguments->positional_count; i++)
        SHV_TRY(shv_cli_keep_input(arguments->report, arguments->positional[i], error));
    return shv_publish_check(arguments->report, arguments->force, error);
}

/* What is printed is gathered first: the file appears when it is whole, and not after an error. */
static int run_to_file(const ShvCommand *command, const ShvArguments *arguments)
{
    ShvError error;
    int kept = -1, exit_status = SHV_EXIT_FAILED;
    ShvStatus status = check_report(arguments, &error);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    FILE *gathered = tmpfile();
    status = gathered ? redirect(fileno(gathered), &kept, &error) : fail_to_gather(&error);
    if (status == SHV_OK) {
        exit_status = command->run(arguments);
        status = restore(kept, &error);
    }
    const bool whole = exit_status == SHV_EXIT_DONE || exit_status == SHV_EXIT_MISSED;
    if (status == SHV_OK && whole) status = publish(gathered, arguments, &error);
    if (gathered) fclose(gathered);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    if (whole && !arguments->quiet) printf("wrote %s\n", arguments->report);
    return exit_status;
}

static int run_in_silence(const ShvCommand *command, const ShvArguments *arguments)
{
    ShvError error;
    int kept = -1;
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    const ShvStatus status = nowhere >= 0 ? redirect(nowhere, &kept, &error) : fail_to_gather(&error);
    if (nowhere >= 0) close(nowhere);
    if (status != SHV_OK) return shv_cli_failed(status, &error);
    const int exit_status = command->run(arguments);
    return restore(kept, &error) == SHV_OK ? exit_status : shv_cli_failed(SHV_FILE_ERROR, &error);
}

int shv_cli_run(const ShvCommand *command, const ShvArguments *arguments)
{
    if (arguments->report) return run_to_file(command, arguments);
    if (arguments->quiet && !arguments->json) return run_in_silence(command, arguments);
    return command->run(arguments);
}
