#include "cli/command.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/names.h"

/* What every command takes, as far as it applies and the command has no option of that name itself. */
enum { SET, OUTPUT, FORCE, QUIET, HELP, VERSION, COMMON_COUNT };

static const ShvOption common[COMMON_COUNT] = {
    {"--set", "KEY=VAL", "override any key of the scene, e.g. --set fracture.threshold=0.8; repeatable"},
    {"--output", "FILE", "write what is printed to this file"},
    {"--force", NULL, "replace existing files"},
    {"--quiet", NULL, "no progress and no report; errors, warnings and --json are still printed"},
    {"--help", NULL, "this text"},
    {"--version", NULL, "print the version"}};

static const struct {
    char letter;
    const char *name;
} letters[] = {{'o', "--output"}, {'j', "--jobs"},    {'q', "--quiet"},
               {'h', "--help"},   {'v', "--version"}, {'V', "--version"}};
enum { LETTER_COUNT = sizeof letters / sizeof letters[0] };

/* ---- tables ---- */

static bool has_option(const ShvCommand *command, const char *name)
{
    for (const ShvOption *option = command->options; option->name; option++)
        if (strcmp(option->name, name) == 0) return true;
    return false;
}

static bool applies(const ShvCommand *command, int k)
{
    return k == SET ? command->takes_scene : !has_option(command, common[k].name);
}

int shv_cli_options(const ShvCommand *command, const ShvOption *options[SHV_MOST_LISTED])
{
    int count = 0;
    for (const ShvOption *option = command->options; option->name; option++) options[count++] = option;
    for (int k = 0; k < COMMON_COUNT; k++)
        if (applies(command, k)) options[count++] = &common[k];
    return count;
}

bool shv_cli_is_common(const ShvOption *option)
{
    for (int k = 0; k < COMMON_COUNT; k++)
        if (option == &common[k]) return true;
    return false;
}

char shv_cli_letter(const ShvOption *option)
{
    for (int i = 0; i < LETTER_COUNT; i++)
        if (strcmp(letters[i].name, option->name) == 0) return letters[i].letter;
    return '\0';
}

void shv_cli_print_padded(const char *text, int width)
{
    int fill = abs(width);
    for (const char *c = text; *c; c++) fill -= ((unsigned char)*c & 0xc0) != 0x80; /* begins a character of UTF-8 */
    if (fill < 0) fill = 0;
    printf("%*s%s%*s", width < 0 ? fill : 0, "", text, width < 0 ? 0 : fill, "");
}

void shv_cli_print_help(const ShvCommand *command)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(command, options);
    printf("usage: shiver %s%s%s [options]\n\n%s\n\n", command->name, command->positional[0] ? " " : "",
           command->positional, command->details);
    for (int i = 0; i < count; i++) {
        const char letter = shv_cli_letter(options[i]);
        const char form[] = {letter ? '-' : ' ', letter ? letter : ' ', letter ? ',' : ' ', '\0'};
        printf("  %s %-12s ", form, options[i]->name);
        shv_cli_print_padded(options[i]->value ? options[i]->value : "", 8);
        printf(" %s\n", options[i]->help);
    }
}

/* ---- words of a command line ---- */

static int bad_usage(const ShvCommand *command, const char *problem, const char *word, const char *hint)
{
    fprintf(stderr, "shiver %s: %s%s%s%s%s\n", command->name, problem, word, hint ? "; did you mean " : "",
            hint ? hint : "", hint ? "?" : "");
    fprintf(stderr, "usage: shiver %s%s%s [options]; --help tells more\n", command->name,
            command->positional[0] ? " " : "", command->positional);
    return SHV_EXIT_INPUT;
}

/* `text` may go on with a value. */
static int unknown_option(const ShvCommand *command, const char *text)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const char *names[SHV_MOST_LISTED];
    char word[64];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(text, "="), text);
    const int count = shv_cli_options(command, options);
    for (int i = 0; i < count; i++) names[i] = options[i]->name;
    return bad_usage(command, "unknown option ", word, shv_nearest_name(word, names, count));
}

/* Of "--name", "--name=value", "-n", "-nvalue" and "-n=value": the text, the long name, its length, and the value or NULL. */
typedef struct Word {
    const char *text, *name, *value;
    size_t length;
} Word;

static Word take_apart(const char *text)
{
    Word word = {text, text, NULL, strcspn(text, "=")};
    if (text[1] == '-') {
        if (text[word.length] == '=') word.value = text + word.length + 1;
        return word;
    }
    for (int i = 0; i < LETTER_COUNT; i++) {
        if (letters[i].letter != text[1]) continue;
        word.name = letters[i].name;
        word.length = strlen(word.name);
        if (text[2]) word.value = text + 2 + (text[2] == '=');
    }
    return word;
}

static int keep_value(const ShvCommand *command, ShvArguments *arguments, const ShvOption *option, const char *value)
{
    if (option == &common[SET]) {
        if (arguments->override_count == SHV_MOST_OVERRIDES) return bad_usage(command, "too many --set", "", NULL);
        arguments->overrides[arguments->override_count++] = value;
        return -1;
    }
    const bool output = strcmp(option->name, "--output") == 0, to_stream = output && strcmp(value, "-") == 0;
    if (to_stream && option != &common[OUTPUT])
        return bad_usage(command, "what it writes cannot go to standard output; give --output a name", "", NULL);
    if (option == &common[OUTPUT]) arguments->report = to_stream ? NULL : value;
    if (!shv_cli_is_common(option)) arguments->values[option - command->options] = value;
    arguments->force = arguments->force || strcmp(option->name, "--force") == 0;
    arguments->json = arguments->json || strcmp(option->name, "--json") == 0;
    arguments->quiet = arguments->quiet || option == &common[QUIET];
    return -1;
}

/* Takes one option; *i moves over its value. Returns an exit status, or −1 to go on. */
static int take_option(const ShvCommand *command, ShvArguments *arguments, int argc, char **argv, int *i)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(command, options);
    Word word = take_apart(argv[*i]);
    int k = 0;
    while (k < count && (strncmp(options[k]->name, word.name, word.length) != 0 || options[k]->name[word.length])) k++;
    if (k == count) return unknown_option(command, word.text);
    const ShvOption *option = options[k];
    if (!option->value && word.value) return bad_usage(command, option->name, " takes no value", NULL);
    if (option->value && !word.value && *i + 1 >= argc) {
        char problem[64];
        snprintf(problem, sizeof problem, "%s needs a value: ", option->name);
        return bad_usage(command, problem, option->value, NULL);
    }
    if (option == &common[HELP]) {
        shv_cli_print_help(command);
        return SHV_EXIT_DONE;
    }
    if (option == &common[VERSION]) {
        printf("shiver %s\n", shv_version());
        return SHV_EXIT_DONE;
    }
    if (option->value && !word.value) word.value = argv[++*i];
    return keep_value(command, arguments, option, option->value ? word.value : option->name);
}

/* ---- files that are read ---- */

/* Found missing here, an input ends every command with the same status and words. */
static int check_input(const char *path)
{
    if (access(path, R_OK) == 0) return -1;
    ShvError error;
    const ShvStatus status = shv_fail(&error, SHV_BAD_INPUT, "cannot read '%s': %s; check the name and the permissions",
                                      path, strerror(errno));
    return shv_cli_failed(status, &error);
}

static int check_inputs(const ShvCommand *command, const ShvArguments *arguments)
{
    int status = -1;
    for (int i = command->first_input; i < arguments->positional_count && status < 0; i++)
        if (!(command->takes_stream && shv_cli_is_stream(arguments->positional[i])))
            status = check_input(arguments->positional[i]);
    for (int k = 0; command->options[k].name && status < 0; k++) {
        const char *kind = command->options[k].value;
        if (kind && arguments->values[k] && strcmp(kind, "RUNFILE") == 0) status = check_input(arguments->values[k]);
    }
    return status;
}

int shv_cli_parse(const ShvCommand *command, ShvArguments *arguments, int argc, char **argv)
{
    bool only_names = false; /* after -- */
    for (int i = 0; i < argc; i++) {
        if (!only_names && strcmp(argv[i], "--") == 0) {
            only_names = true;
        } else if (!only_names && argv[i][0] == '-' && argv[i][1] != '\0') {
            const int status = take_option(command, arguments, argc, argv, &i);
            if (status >= 0) return status;
        } else if (arguments->positional_count == command->most_positional) {
            return bad_usage(command, "one argument too many: ", argv[i], NULL);
        } else {
            arguments->positional[arguments->positional_count++] = argv[i];
        }
    }
    if (arguments->positional_count < command->least_positional)
        return bad_usage(command, "it needs ", command->positional, NULL);
    return check_inputs(command, arguments);
}
