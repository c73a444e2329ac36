/* Runs the program in a folder of its own through the shell and keeps what it printed. */
#ifndef SHV_TESTS_CLI_SHELL_H
#define SHV_TESTS_CLI_SHELL_H

#include "check.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct Output {
    int status; /* exit status */
    char out[1 << 16], err[1 << 16];
} Output;

static Output output;

static inline void shell_read(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

/* `$shiver` stands for the program in the command. */
static inline int shell(const char *command)
{
    static char line[8192];
    snprintf(line, sizeof line, "shiver='%s'; scenes='%s'; { %s\n} >stdout.txt 2>stderr.txt </dev/null", SHIVER_PROGRAM,
             SHIVER_SCENES, command);
    const int status = system(line);
    assert_true(WIFEXITED(status));
    output.status = WEXITSTATUS(status);
    shell_read("stdout.txt", output.out, sizeof output.out);
    shell_read("stderr.txt", output.err, sizeof output.err);
    return output.status;
}

/* The command ends with `status`, and its errors hold `part`. */
static inline void shell_fails(const char *command, int expected, const char *part)
{
    if (shell(command) != expected) fail_msg("%s ended with %d: %s%s", command, output.status, output.out, output.err);
    if (!strstr(output.err, part)) fail_msg("%s: '%s' is missing in: %s", command, part, output.err);
}

static inline void shell_works(const char *command, const char *part)
{
    if (shell(command) != 0) fail_msg("%s ended with %d: %s%s", command, output.status, output.out, output.err);
    if (!strstr(output.out, part)) fail_msg("%s: '%s' is missing in: %s", command, part, output.out);
}

static inline void shell_write(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static char shell_folder[] = "/tmp/shiver-cli-XXXXXX";

static inline int shell_enter(void **state)
{
    (void)state;
    return mkdtemp(shell_folder) && chdir(shell_folder) == 0 ? 0 : -1;
}

static inline int shell_leave(void **state)
{
    (void)state;
    if (chdir("/") != 0) return -1;
    char line[128];
    snprintf(line, sizeof line, "chmod -R u+w %s; rm -r %s", shell_folder, shell_folder);
    return system(line);
}

#endif
