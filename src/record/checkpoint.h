/* Checkpoints beside a run file: "RUN.h5.checkpoint-1" and "-2", written in turn, so that one is whole whatever happens to the
   other. Each names the frame of the run file after which it was taken, by its number and its checksum. */
#ifndef SHV_RECORD_CHECKPOINT_H
#define SHV_RECORD_CHECKPOINT_H

#include <stdbool.h>

#include "base/memory.h"
#include "shiver/simulation.h"

enum { SHV_CHECKPOINTS = 2 };

/* What has to be the same where a checkpoint is taken and where a run goes on from it; and where in the run that is. */
typedef struct ShvCheckpointMark {
    uint64_t program, scene, geometry;
    int64_t frames, checksum; /* frames of the run file; checksum of the last of them */
    uint64_t sequence;        /* the larger, the later */
    double time;              /* s, of the simulation */
} ShvCheckpointMark;

/* Of the file of the program that runs, and its version. */
uint64_t shv_checkpoint_program(void);
char *shv_checkpoint_path(ShvMemory *memory, const char *run_file, int index);
/* Writes the one whose turn it is by mark->sequence. `note`: whatever the caller wants to have back. */
ShvStatus shv_checkpoint_write(const char *run_file, ShvMemory *memory, ShvSimulation *simulation,
                               const ShvCheckpointMark *mark, const void *note, size_t note_size, ShvError *error);

typedef struct ShvCheckpoint {
    int descriptor; /* at the state; −1: there is none */
    ShvCheckpointMark mark;
    uint64_t size; /* of the state */
    unsigned char *note;
    size_t note_size;
} ShvCheckpoint;
void shv_checkpoint_close(ShvCheckpoint *checkpoint);

/* Whether a mark belongs to the run file; NULL: any does. */
typedef bool (*ShvCheckpointFits)(void *data, const ShvCheckpointMark *mark);
/* Opens the latest that is whole and fits, of a run with this program, scene and geometry. Without any file descriptor is −1. That
   there are files and none will do is SHV_BAD_INPUT, with a message that tells why. */
ShvStatus shv_checkpoint_find(ShvCheckpoint *found, const char *run_file, ShvMemory *memory,
                              const ShvCheckpointMark *own, ShvCheckpointFits fits, void *data, ShvError *error);
/* Removes all but `kept` (−1: none of them is kept). */
void shv_checkpoint_remove(const char *run_file, ShvMemory *memory, int kept);

#endif
