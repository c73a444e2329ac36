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

static const ShvCommand *const commands[] = {&shv_command_run,    &shv_command_check,     &shv_command_plan,
                                             &shv_command_mesh,   &shv_command_info,      &shv_command_view,
                                             &shv_command_export, &shv_command_materials, &shv_command_compare,
                                             &shv_command_study,  &shv_command_stability, &shv_command_verify};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_overview(FILE *stream)
{
    fprintf(stream,
            "shiver %s: scripted drops and impacts of brittle bodies, rigid in flight and cracking on impact\n\n"
            "usage: shiver COMMAND …\n\n",
            shv_version());
    for (int i = 0; i < COMMAND_COUNT; i++) fprintf(stream, "  %-9s %s\n", commands[i]->name, commands[i]->summary);
    fprintf(
        stream,
        "\n`shiver COMMAND --help` tells more. Exit status: 0 done, 1 the run failed, 2 bad input, 130 interrupted.\n");
}

static void print_help(const ShvCommand *command)
{
    printf("usage: shiver %s %s [options]\n\n%s\n\n", command->name, command->positional, command->details);
    for (const ShvOption *option = command->options; option->name; option++)
        printf("  %-10s %-8s %s\n", option->name, option->value ? option->value : "", option->help);
    if (command->takes_scene)
        printf("  %-10s %-8s %s\n", "--set", "KEY=VAL",
               "override any key of the scene, e.g. --set fracture.threshold=0.8; repeatable");
    printf("  %-10s %-8s %s\n", "--help", "", "this text");
}

static int bad_usage(const ShvCommand *command, const char *problem, const char *word, const char *hint)
{
    fprintf(stderr, "shiver %s: %s%s%s%s%s\n", command->name, problem, word, hint ? "; did you mean " : "",
            hint ? hint : "", hint ? "?" : "");
    fprintf(stderr, "usage: shiver %s %s [options]; --help tells more\n", command->name, command->positional);
    return SHV_EXIT_INPUT;
}

static int unknown_option(const ShvCommand *command, const char *word)
{
    const char *names[SHV_MOST_OPTIONS + 2];
    int count = 0;
    for (const ShvOption *option = command->options; option->name; option++) names[count++] = option->name;
    names[count++] = "--help";
    if (command->takes_scene) names[count++] = "--set";
    return bad_usage(command, "unknown option ", word, shv_nearest_name(word, names, count));
}

/* Takes one option; *i moves over its value. Returns an exit status, or −1 to go on. */
static int take_option(const ShvCommand *command, ShvArguments *arguments, int argc, char **argv, int *i)
{
    const char *word = argv[*i];
    if (command->takes_scene && strcmp(word, "--set") == 0) {
        if (*i + 1 >= argc) return bad_usage(command, "--set needs KEY=VALUE", "", NULL);
        if (arguments->override_count == SHV_MOST_OVERRIDES) return bad_usage(command, "too many --set", "", NULL);
        arguments->overrides[arguments->override_count++] = argv[++*i];
        return -1;
    }
    for (int k = 0; command->options[k].name; k++) {
        if (strcmp(word, command->options[k].name) != 0) continue;
        if (command->options[k].value && *i + 1 >= argc) return bad_usage(command, word, " needs a value", NULL);
        arguments->values[k] = command->options[k].value ? argv[++*i] : word;
        return -1;
    }
    return unknown_option(command, word);
}

static int run_command(const ShvCommand *command, int argc, char **argv)
{
    ShvArguments arguments = {.positional_count = 0};
    for (int i = 0; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            print_help(command);
            return SHV_EXIT_DONE;
        }
        if (argv[i][0] == '-' && argv[i][1] != '\0') {
            const int status = take_option(command, &arguments, argc, argv, &i);
            if (status >= 0) return status;
        } else if (arguments.positional_count == command->most_positional) {
            return bad_usage(command, "one argument too many: ", argv[i], NULL);
        } else {
            arguments.positional[arguments.positional_count++] = argv[i];
        }
    }
    if (arguments.positional_count < command->least_positional)
        return bad_usage(command, "it needs ", command->positional, NULL);
    return command->run(&arguments);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
        print_overview(argc < 2 ? stderr : stdout);
        return argc < 2 ? SHV_EXIT_INPUT : SHV_EXIT_DONE;
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("shiver %s\n", shv_version());
        return SHV_EXIT_DONE;
    }
    const char *names[COMMAND_COUNT];
    for (int i = 0; i < COMMAND_COUNT; i++) {
        names[i] = commands[i]->name;
        if (strcmp(argv[1], names[i]) == 0) return run_command(commands[i], argc - 2, argv + 2);
    }
    const char *near = shv_nearest_name(argv[1], names, COMMAND_COUNT);
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
    fprintf(stderr, "shiver: ");
    shv_cli_print_plain(stderr, error->message);
    putc('\n', stderr);
    if (status == SHV_BAD_INPUT || status == SHV_UNSUPPORTED) return SHV_EXIT_INPUT;
    return status == SHV_INTERRUPTED ? SHV_EXIT_INTERRUPTED : SHV_EXIT_FAILED;
}

void shv_cli_print_json_text(const char *text)
{
    putchar('"');
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        if (*c == '"' || *c == '\\')
            printf("\\%c", *c);
        else if (*c < 0x20)
            printf("\\u%04x", *c);
        else
            putchar(*c);
    }
    putchar('"');
}

void shv_cli_print_json_number(double value)
{
    if (isfinite(value))
        printf("%.17g", value);
    else
        printf("null");
}
