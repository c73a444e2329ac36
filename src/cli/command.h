/* Commands of the program: each a table of its options and a function. */
#ifndef SHV_CLI_COMMAND_H
#define SHV_CLI_COMMAND_H

#include <stdbool.h>
#include <stdio.h>

#include "shiver/shiver.h"

/* Exit statuses of the program. */
enum { SHV_EXIT_DONE = 0, SHV_EXIT_FAILED = 1, SHV_EXIT_INPUT = 2, SHV_EXIT_INTERRUPTED = 130 };

enum { SHV_MOST_OPTIONS = 16, SHV_MOST_POSITIONAL = 32, SHV_MOST_OVERRIDES = 64 };

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
} ShvArguments;

typedef struct ShvCommand {
    const char *name, *positional, *summary, *details;
    int least_positional, most_positional;
    bool takes_scene; /* --set key=value is allowed */
    ShvOption options[SHV_MOST_OPTIONS];
    int (*run)(const ShvArguments *arguments);
} ShvCommand;

extern const ShvCommand shv_command_run, shv_command_check, shv_command_plan, shv_command_mesh, shv_command_info,
    shv_command_export, shv_command_materials, shv_command_compare, shv_command_study, shv_command_stability,
    shv_command_verify, shv_command_view;

/* Room for the name of a file: the longest that POSIX promises to open. */
enum { SHV_CLI_PATH = 4096 };

/* The whole program: finds the command, takes its arguments apart, runs it; returns the exit status. */
int shv_program(int argc, char **argv);

/* ---- shared by commands ---- */

/* Loads a scene with the overrides; all errors and warnings go to stderr. After an error *scene is NULL, and the exit status is
   returned that belongs to it. */
int shv_cli_load_scene(ShvScene **scene, const ShvArguments *arguments);
/* Makes the simulation of a scene, has it shown, and puts both away; returns the exit status. */
typedef ShvStatus (*ShvInspection)(ShvSimulation *simulation, const ShvArguments *arguments, ShvError *error);
int shv_cli_inspect(const ShvArguments *arguments, ShvInspection show);
/* A name of a file that is made up as by printf; SHV_BAD_INPUT when it is too long. */
ShvStatus shv_cli_path(char path[SHV_CLI_PATH], ShvError *error, const char *format, ...);
/* The name of `file` with another ending, beside it or in the working folder. */
ShvStatus shv_cli_default_path(char path[SHV_CLI_PATH], const char *file, bool beside, const char *ending,
                               ShvError *error);
/* SHV_BAD_INPUT when the output is the input, which no --force may replace. */
ShvStatus shv_cli_keep_input(const char *output, const char *input, ShvError *error);
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
