#include "cli/command.h"

#include <errno.h>
#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/names.h"
#include "base/text.h"

const ShvCommand *const shv_commands[SHV_COMMANDS] = {
    &shv_command_run,     &shv_command_check,     &shv_command_plan,      &shv_command_mesh,    &shv_command_info,
    &shv_command_view,    &shv_command_export,    &shv_command_materials, &shv_command_compare, &shv_command_study,
    &shv_command_survive, &shv_command_stability, &shv_command_verify,    &shv_command_generate};

const ShvExitMeaning shv_exit_meanings[SHV_EXIT_MEANINGS] = {
    {SHV_EXIT_DONE, "done"},
    {SHV_EXIT_FAILED, "the work failed: a run diverged, a comparison misses, memory is out, a file cannot be written"},
    {SHV_EXIT_INPUT, "the command line, a scene or another input is wrong or cannot be read, an output exists, or a "
                     "program that it calls is not installed"},
    {SHV_EXIT_INTERRUPTED, "stopped by a signal; what was written is whole"}};

static void print_overview(FILE *stream)
{
    fprintf(stream,
            "shiver %s: scripted drops and impacts of brittle bodies, rigid in flight and cracking on impact\n\n"
            "usage: shiver COMMAND …\n\n",
            shv_version());
    for (int i = 0; i < SHV_COMMANDS; i++)
        fprintf(stream, "  %-9s %s\n", shv_commands[i]->name, shv_commands[i]->summary);
    fprintf(stream, "\n`shiver COMMAND --help` tells more, `shiver --version` the version. Exit status:\n");
    for (int i = 0; i < SHV_EXIT_MEANINGS; i++)
        fprintf(stream, "  %-9d %s\n", shv_exit_meanings[i].status, shv_exit_meanings[i].meaning);
}

static bool is_any(const char *word, const char *const *words)
{
    while (*words && strcmp(word, *words) != 0) words++;
    return *words != NULL;
}

static int run_command(const ShvCommand *command, int argc, char **argv)
{
    ShvArguments arguments = {.positional_count = 0};
    const int wrong = shv_cli_parse(command, &arguments, argc, argv);
    if (wrong >= 0) return wrong;
    const int status = shv_cli_run(command, &arguments);
    return status == SHV_EXIT_MISSED ? (int)SHV_EXIT_FAILED : status;
}

static int dispatch(int argc, char **argv)
{
    static const char *const help[] = {"--help", "-h", "help", NULL}, *const version[] = {"--version", "-v", "-V",
                                                                                          NULL};
    if (argc < 2 || is_any(argv[1], help)) {
        print_overview(argc < 2 ? stderr : stdout);
        return argc < 2 ? SHV_EXIT_INPUT : SHV_EXIT_DONE;
    }
    if (is_any(argv[1], version)) {
        printf("shiver %s\n", shv_version());
        return SHV_EXIT_DONE;
    }
    const char *names[SHV_COMMANDS];
    for (int i = 0; i < SHV_COMMANDS; i++) {
        names[i] = shv_commands[i]->name;
        if (strcmp(argv[1], names[i]) == 0) return run_command(shv_commands[i], argc - 2, argv + 2);
    }
    const char *near = shv_nearest_name(argv[1], names, SHV_COMMANDS);
    fprintf(stderr, "shiver: there is no command '%s'%s%s%s; `shiver --help` lists them\n", argv[1],
            near ? " (did you mean " : "", near ? near : "", near ? "?)" : "");
    return SHV_EXIT_INPUT;
}

/* A descriptor 0 to 2 that the caller has closed would be given to the next file that is opened, and what is printed would
   go there. Something takes its place that can be neither read nor written as the stream wants to. */
static void occupy_standard_streams(void)
{
    for (int descriptor = 0; descriptor <= STDERR_FILENO; descriptor++)
        if (fcntl(descriptor, F_GETFD) < 0) (void)!open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/* A limit of file sizes shows as a failed write with a message, not as a killed program. */
static void take_limits_as_failures(void)
{
#ifdef SIGXFSZ
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = SIG_IGN;
    sigemptyset(&action.sa_mask);
    sigaction(SIGXFSZ, &action, NULL);
#endif
}

/* What was printed must have arrived: a full disk behind standard output is a failure, too. */
int shv_program(int argc, char **argv)
{
    occupy_standard_streams();
    take_limits_as_failures();
    /* At the exit HDF5 closes what it could not close before, such as a damaged file, and may crash or loop over it. */
    H5dont_atexit();
    const int status = dispatch(argc, argv);
    const bool lost = fflush(stdout) != 0 || ferror(stdout) != 0;
    if (!lost || status != SHV_EXIT_DONE) return status;
    fprintf(stderr, "shiver: standard output could not be written: %s\n", strerror(errno));
    return SHV_EXIT_FAILED;
}

int shv_cli_failed(ShvStatus status, const ShvError *error)
{
    ShvError told = *error;
    if (status == SHV_INTERRUPTED) status = shv_cli_why_stopped(&told);
    fprintf(stderr, "shiver: ");
    shv_cli_print_plain(stderr, told.message);
    putc('\n', stderr);
    if (status == SHV_BAD_INPUT || status == SHV_UNSUPPORTED) return SHV_EXIT_INPUT;
    return status == SHV_INTERRUPTED ? SHV_EXIT_INTERRUPTED : SHV_EXIT_FAILED;
}

void shv_cli_print_json_text(const char *text)
{
    shv_print_json_text(stdout, text);
}

void shv_cli_print_json_number(double value)
{
    if (isfinite(value))
        printf("%.17g", value);
    else
        printf("null");
}
