/* The manual page, and completion for shells, from the tables that --help prints. */
#include <string.h>

#include "cli/command.h"

/* ---- what completion needs to know ---- */

/* What a value or an argument is called tells which files stand for it: those with this ending, any ("*"), or none (NULL). */
static const char *files_of(const char *kind)
{
    static const char *const files[][2] = {{"RUNFILE", "*.h5"}, {"SCENE", "*.yaml"}, {"FILE", "*"}, {"DIR", "*"},
                                           {"PREFIX", "*"},     {"SURFACE", "*"},    {"[CASE", "*"}};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (strncmp(kind, files[i][0], strlen(files[i][0])) == 0) return files[i][1];
    return NULL;
}

/* The length of "csv|xdmf|…" where a command begins with a choice of words; 0 where it does not. */
static int choice_length(const ShvCommand *command)
{
    const int length = (int)strcspn(command->positional, " ");
    const bool bar = memchr(command->positional, '|', (size_t)length) != NULL;
    return bar && command->positional[0] >= 'a' ? length : 0;
}

static void print_choice(const ShvCommand *command)
{
    for (int i = 0; i < choice_length(command); i++)
        putchar(command->positional[i] == '|' ? ' ' : command->positional[i]);
}

/* ---- bash ---- */

static void print_bash_command(const ShvCommand *command)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(command, options);
    printf("    %s) options='", command->name);
    for (int i = 0; i < count; i++) printf("%s%s", i ? " " : "", options[i]->name);
    printf("' words='");
    print_choice(command);
    printf("' ;;\n");
}

/* Where nothing is proposed, the names of files are. */
static void print_bash(void)
{
    printf("# Completion of shiver's commands and options for bash, made by `shiver generate bash`.\n_shiver() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} options='' words=''\n"
           "    if [ \"$COMP_CWORD\" -gt 1 ]; then case ${COMP_WORDS[1]} in\n");
    for (int i = 0; i < SHV_COMMANDS; i++) print_bash_command(shv_commands[i]);
    printf("    esac; else options='--help --version' words='");
    for (int i = 0; i < SHV_COMMANDS; i++) printf("%s%s", i ? " " : "", shv_commands[i]->name);
    printf("'; fi\n"
           "    case $current in -*) words=$options ;; *) [ \"$COMP_CWORD\" -gt 2 ] && words='' ;; esac\n"
           "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n}\n"
           "complete -o default -F _shiver shiver\n");
}

/* ---- zsh ---- */

/* Within '…' and, of `marks`, what would end a part of a specification. */
static void print_zsh_text(const char *text, const char *marks)
{
    for (; *text; text++)
        if (*text == '\'')
            printf("'\\''");
        else
            printf(strchr(marks, *text) ? "\\%c" : "%c", *text);
}

static void print_zsh_files(const char *kind)
{
    const char *files = files_of(kind);
    if (files)
        printf(":_files -g \"%s\"", files);
    else
        putchar(':');
}

static void print_zsh_option(const ShvOption *option)
{
    const char letter = shv_cli_letter(option);
    const char *more = strcmp(option->name, "--set") == 0 ? "*" : "";
    if (letter)
        printf(" \\\n            '(-%c %s)'{-%c%s,%s%s}'[", letter, option->name, letter, option->value ? "+" : "",
               option->name, option->value ? "=" : "");
    else
        printf(" \\\n            '%s%s%s[", more, option->name, option->value ? "=" : "");
    print_zsh_text(option->help, "[]\\");
    putchar(']');
    if (option->value) {
        putchar(':');
        print_zsh_text(option->value, ":\\");
        print_zsh_files(option->value);
    }
    putchar('\'');
}

static void print_zsh_command(const ShvCommand *command)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(command, options);
    const int choice = choice_length(command);
    printf("        %s) _arguments", command->name);
    for (int i = 0; i < count; i++) print_zsh_option(options[i]);
    if (choice > 0) {
        printf(" \\\n            '1:what:(");
        print_choice(command);
        printf(")'");
    }
    if (command->most_positional > (choice > 0)) {
        const char *kind = command->positional + choice + (choice > 0);
        printf(" \\\n            '*:");
        print_zsh_text(kind, ":\\");
        print_zsh_files(kind);
        putchar('\'');
    }
    printf(" ;;\n");
}

static void print_zsh(void)
{
    printf("#compdef shiver\n# Completion of shiver's commands and options for zsh, made by `shiver generate zsh`.\n"
           "_shiver() {\n    local -a commands=(\n");
    for (int i = 0; i < SHV_COMMANDS; i++) {
        printf("        '%s:", shv_commands[i]->name);
        print_zsh_text(shv_commands[i]->summary, ":\\");
        printf("'\n");
    }
    printf("    )\n    if (( CURRENT == 2 )); then\n        _describe command commands\n"
           "        _arguments --help --version\n        return\n    fi\n"
           "    shift words\n    (( CURRENT-- ))\n    case $words[1] in\n");
    for (int i = 0; i < SHV_COMMANDS; i++) print_zsh_command(shv_commands[i]);
    printf("    esac\n}\ncompdef _shiver shiver\nif [[ $funcstack[1] = _shiver ]]; then _shiver \"$@\"; fi\n");
}

/* ---- the manual page ---- */

/* roff: a backslash and a hyphen are spelt out, and no line of text begins with a request. */
static void print_roff(const char *text)
{
    bool begins = true;
    for (; *text; text++) {
        if (begins && *text == '\n') {
            printf(".PP\n");
            continue;
        }
        if (begins && (*text == '.' || *text == '\'')) printf("\\&");
        if (*text == '\\' || *text == '-')
            printf(*text == '-' ? "\\-" : "\\e");
        else
            putchar(*text);
        begins = *text == '\n';
    }
}

static void print_roff_option(const ShvOption *option)
{
    const char letter = shv_cli_letter(option);
    printf(".TP\n\\fB");
    if (letter) printf("\\-%c\\fR, \\fB", letter);
    print_roff(option->name);
    printf("\\fR");
    if (option->value) printf(" \\fI%s\\fR", option->value);
    putchar('\n');
    print_roff(option->help);
    putchar('\n');
}

static void print_roff_command(const ShvCommand *command)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(command, options);
    printf(".SS \"shiver %s %s\"\n", command->name, command->positional);
    print_roff(command->details);
    putchar('\n');
    for (int i = 0; i < count; i++)
        if (!shv_cli_is_common(options[i])) print_roff_option(options[i]);
}

static void print_roff_common(void)
{
    const ShvOption *options[SHV_MOST_LISTED];
    const int count = shv_cli_options(&shv_command_check, options);
    printf(
        ".SH OPTIONS\nThese are taken by every command; \\fB\\-\\-set\\fR by those that take a scene. A command that "
        "writes files has an\n\\fB\\-\\-output\\fR of its own. A value follows its option or, with =, belongs to the "
        "same word: \\fB\\-\\-set=\\fIKEY=VAL\\fR,\n\\fB\\-o\\fIFILE\\fR. What follows \\fB\\-\\-\\fR is no option. "
        "\\fB\\-\\fR in place of SCENE is a scene on standard input; files\nit names are sought in the working "
        "folder.\n");
    for (int i = 0; i < count; i++)
        if (shv_cli_is_common(options[i])) print_roff_option(options[i]);
}

static void print_manual(void)
{
    printf(
        ".TH SHIVER 1 \"\" \"shiver %s\" \"User Commands\"\n.SH NAME\nshiver \\- scripted drops and impacts of brittle "
        "bodies, rigid in flight and cracking on impact\n.SH SYNOPSIS\n.B shiver\n\\fICOMMAND\\fR ...\n.SH "
        "DESCRIPTION\n",
        shv_version());
    printf(
        "Simulates scripted drops and impacts of brittle bodies: rigid flight, tetrahedra with cohesive cracks while "
        "a body may break,\nand pieces that fly on.\n");
    print_roff_common();
    printf(".SH COMMANDS\n");
    for (int i = 0; i < SHV_COMMANDS; i++) print_roff_command(shv_commands[i]);
    printf(".SH EXIT STATUS\n");
    for (int i = 0; i < SHV_EXIT_MEANINGS; i++)
        printf(".TP\n\\fB%d\\fR\n%s\n", shv_exit_meanings[i].status, shv_exit_meanings[i].meaning);
}

/* ---- the command ---- */

static int run(const ShvArguments *arguments)
{
    static const struct {
        const char *name;
        void (*print)(void);
    } texts[] = {{"man", print_manual}, {"bash", print_bash}, {"zsh", print_zsh}};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (strcmp(arguments->positional[0], texts[i].name) != 0) continue;
        texts[i].print();
        return SHV_EXIT_DONE;
    }
    ShvError error;
    return shv_cli_failed(shv_fail(&error, SHV_BAD_INPUT, "there is no text '%s' to generate; give man, bash or zsh",
                                   arguments->positional[0]),
                          &error);
}

const ShvCommand shv_command_generate = {
    .name = "generate",
    .positional = "man|bash|zsh",
    .summary = "print the manual page, or completion for bash or zsh",
    .details = "Prints the manual page, or what makes a shell complete commands, options and files. An installed\n"
               "program has all three in their places; else: source <(shiver generate bash), or the same with zsh.",
    .least_positional = 1,
    .most_positional = 1,
    .first_input = 1,
    .run = run,
};
