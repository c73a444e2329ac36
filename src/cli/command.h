/* Commands of the program: each a table of its options and a function. */
#ifndef SHV_CLI_COMMAND_H
#define SHV_CLI_COMMAND_H

#include <stdbool.h>
#include <stdio.h>

#include "shiver/shiver.h"

/* Exit statuses of the program; shv_exit_meanings says what they mean. A comparison that misses ends the program like a
   failure, but what is printed is whole. */
enum { SHV_EXIT_DONE = 0, SHV_EXIT_FAILED = 1, SHV_EXIT_INPUT = 2, SHV_EXIT_MISSED = 3, SHV_EXIT_INTERRUPTED = 130 };

typedef struct ShvExitMeaning {
    int status;
    const char *meaning;
} ShvExitMeaning;

enum { SHV_EXIT_MEANINGS = 4 };
extern const ShvExitMeaning shv_exit_meanings[SHV_EXIT_MEANINGS];

/* Options of a command's own, and with those that every command takes. */
enum { SHV_MOST_OPTIONS = 16, SHV_MOST_LISTED = 24, SHV_MOST_POSITIONAL = 32, SHV_MOST_OVERRIDES = 64 };

typedef struct ShvOption {
    const char *name;  /* "--force"; NULL ends the table */
    const char *value; /* what follows it ("FILE"), or NULL for a flag */
    const char *help;
} ShvOption;

/* A command line taken apart. */
typedef struct ShvArguments {
    const char *positional[SHV_MOST_POSITIONAL];
    int positional_count;
    const char *values[SHV_MOST_OPTIONS]; /* by index in the command's options; a flag's value is its name */
    const char *overrides[SHV_MOST_OVERRIDES];
    int override_count;
    /* Of the options that every command takes. */
    const char
        *report; /* --output of a command that only prints: what is printed goes there; NULL: to standard output */
    bool force, json, quiet;
} ShvArguments;

typedef struct ShvCommand {
    const char *name, *positional, *summary, *details;
    int least_positional, most_positional;
    int first_input;   /* positional arguments from this one on are files that are read */
    bool takes_scene;  /* --set key=value is allowed */
    bool takes_stream; /* - stands for a scene on standard input */
    ShvOption options[SHV_MOST_OPTIONS];
    int (*run)(const ShvArguments *arguments);
} ShvCommand;

extern const ShvCommand shv_command_run, shv_command_check, shv_command_plan, shv_command_mesh, shv_command_info,
    shv_command_export, shv_command_materials, shv_command_compare, shv_command_study, shv_command_stability,
    shv_command_verify, shv_command_view, shv_command_survive, shv_command_generate;

/* In the order of the overview. */
enum { SHV_COMMANDS = 14 };
extern const ShvCommand *const shv_commands[SHV_COMMANDS];

/* Room for the name of a file: the longest that POSIX promises to open. */
enum { SHV_CLI_PATH = 4096 };

/* The whole program: finds the command, takes its arguments apart, runs it; returns the exit status. */
int shv_program(int argc, char **argv);

/* ---- the command line ---- */

/* All options that a command takes, its own first in their order; returns how many. */
int shv_cli_options(const ShvCommand *command, const ShvOption *options[SHV_MOST_LISTED]);
/* Whether an option is one that most commands take, told once for all in the manual page. */
bool shv_cli_is_common(const ShvOption *option);
/* The letter of an option's short form, 0 without one. */
char shv_cli_letter(const ShvOption *option);
/* Fills up with spaces to `width` characters, which printf counts as bytes; a negative width fills up on the left. */
void shv_cli_print_padded(const char *text, int width);
void shv_cli_print_help(const ShvCommand *command);
/* Takes a command line apart, without the names of program and command; returns an exit status, or −1 to go on. */
int shv_cli_parse(const ShvCommand *command, ShvArguments *arguments, int argc, char **argv);
/* Runs a command with standard output going where --output and --quiet want it; returns the exit status. */
int shv_cli_run(const ShvCommand *command, const ShvArguments *arguments);

/* ---- shared by commands ---- */

/* The command as it was given, for a report: its arguments, what it sets, and of its own options those from `first` to `last`. */
void shv_cli_command_line(const ShvCommand *command, const ShvArguments *arguments, int first, int last, char *text,
                          size_t size);

/* Loads a scene with the overrides; all errors and warnings go to stderr. After an error *scene is NULL, and the exit status is
   returned that belongs to it. */
int shv_cli_load_scene(ShvScene **scene, const ShvArguments *arguments);
/* What follows once a scene has been read, or could not be: says its faults, puts them away, and returns the exit status. */
int shv_cli_end_loading(ShvStatus status, ShvDiagnostics *diagnostics, const ShvError *error);
/* Each fault of an input on a line of stderr; whether there are errors among them, which then need no message more. */
bool shv_cli_print_faults(const ShvDiagnostics *diagnostics);
/* Whether anything in the scene can crack. */
bool shv_cli_can_break(const ShvSimulation *simulation);
/* Makes the simulation of a scene, has it shown, and puts both away; returns the exit status. */
typedef ShvStatus (*ShvInspection)(ShvSimulation *simulation, const ShvArguments *arguments, ShvError *error);
int shv_cli_inspect(const ShvArguments *arguments, ShvInspection show);
/* A name of a file that is made up as by printf; SHV_BAD_INPUT when it is too long. */
ShvStatus shv_cli_path(char path[SHV_CLI_PATH], ShvError *error, const char *format, ...);
/* The name of `file` with another ending, beside it or in the working folder. */
ShvStatus shv_cli_default_path(char path[SHV_CLI_PATH], const char *file, bool beside, const char *ending,
                               ShvError *error);
/* Whether an argument stands for standard input. */
bool shv_cli_is_stream(const char *argument);
/* A name for what comes from the scene: as given, or else made of the scene file's name in the working folder. A scene on
   standard input has none: `scene` (NULL: nothing) may have one in its keys, else SHV_BAD_INPUT. */
ShvStatus shv_cli_scene_output(char path[SHV_CLI_PATH], const ShvArguments *arguments, const char *given,
                               const ShvSceneDefinition *scene, const char *ending, ShvError *error);
/* A folder of scenes that comes with the program: in the working folder, or else where the program was installed. */
ShvStatus shv_cli_scenes(char path[SHV_CLI_PATH], const char *folder, ShvError *error);
/* SHV_BAD_INPUT when the output is the input, which no --force may replace. */
ShvStatus shv_cli_keep_input(const char *output, const char *input, ShvError *error);
/* study.c: runs the study of options->plan with the scene named first, writes its folder and prints its table. Returns the exit
   status. */
int shv_cli_study(const ShvArguments *arguments, ShvStudyOptions *options, bool json);
/* verify.c: as `shiver verify --folder`; `markdown` may be NULL. Returns the exit status. */
int shv_cli_verify_folder(const ShvArguments *arguments, const char *folder, bool full, const char *markdown);
/* Numbers from zero on with commas between, at most `most`; `what` says what the option needs. *count and the values stay where
   it was not given (NULL). */
ShvStatus shv_cli_read_numbers(const char *text, const char *option, const char *what, double *values, int32_t most,
                               int32_t *count, ShvError *error);
/* The number of --every, 1 or more; *every stays where it was not given (NULL). */
ShvStatus shv_cli_every(const char *text, int32_t *every, ShvError *error);
/* Tells on standard error that what was read of the file is not its end: another process is writing it. */
void shv_cli_tell_live(const ShvRunFile *file, const char *path);
/* A text to a terminal: its control characters but the line break become '?'. */
void shv_cli_print_plain(FILE *stream, const char *text);
/* Of a run that was stopped: memory is out, or else the user wanted it. */
ShvStatus shv_cli_why_stopped(ShvError *error);
/* Warns on stderr of what overlaps at the start in a scene that keeps it, with what the run does about it. */
ShvStatus shv_cli_warn_overlaps(const ShvSimulation *simulation, ShvError *error);
/* One line on the strength and energy of a breakable material in effect, and whether its mesh resolves the cohesive zone. */
/* How many pieces there are under other limits for what still bonds (ShvFrameView). */
void shv_cli_print_pieces(const int32_t pieces[3]);
void shv_cli_print_cohesion(const ShvMaterialView *material);
/* The same as JSON members, without braces. */
void shv_cli_print_cohesion_json(const ShvMaterialView *material);
/* The materials of a simulation or a run file. */
typedef struct ShvMaterialList {
    const void *owner;
    int32_t count;
    ShvMaterialView (*get)(const void *owner, int32_t index);
} ShvMaterialList;
/* Both for all materials; as JSON, a member "materials" with a comma before it. */
void shv_cli_print_materials(ShvMaterialList materials);
void shv_cli_print_materials_json(ShvMaterialList materials);
/* Prints "shiver: message" and returns the exit status that belongs to the status. */
int shv_cli_failed(ShvStatus status, const ShvError *error);
/* One JSON string with quotes and escapes. */
void shv_cli_print_json_text(const char *text);
/* A number as JSON: null when it is not finite. */
void shv_cli_print_json_number(double value);

#endif
