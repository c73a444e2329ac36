/* Runs that go on: the scene of a run file, and whether a file is of the same run. */
#ifndef SHV_CLI_RESUME_H
#define SHV_CLI_RESUME_H

#include "cli/command.h"

/* Whether an argument is an HDF5 file, and so a run file in place of a scene. */
bool shv_resume_is_run_file(const char *path);
/* As shv_cli_load_scene; of a run file its scene with what --set had changed then. Meshes start from the run file's folder. */
int shv_resume_load_scene(ShvScene **scene, const ShvArguments *arguments);
/* What a run that goes on must have in common with what was: all but duration and number of threads. */
uint64_t shv_resume_hash(const ShvScene *scene);

/* What is there in place of a run file. */
typedef enum ShvLeftover {
    SHV_LEFTOVER_NONE,    /* no run file that can be read */
    SHV_LEFTOVER_OTHER,   /* of another run */
    SHV_LEFTOVER_PARTIAL, /* of this one, which has not come to the end */
    SHV_LEFTOVER_WHOLE
} ShvLeftover;
/* `time`: of its last frame, s. */
ShvLeftover shv_resume_inspect(const char *path, const ShvScene *scene, double *time);

#endif
