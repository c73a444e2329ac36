/* The run file (HDF5): written frame by frame beside a simulation, read back whole or in parts. */
#ifndef SHIVER_RUN_FILE_H
#define SHIVER_RUN_FILE_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

#define SHV_RUN_FILE_FORMAT 1

typedef struct ShvRecord ShvRecord;

typedef struct ShvRecordDefinition {
    uint32_t cookie;
    const char *path;
    bool force;             /* replace an existing file; it is replaced only when the new one has its first frame */
    const char *scene_text; /* stored in the file */
    uint64_t scene_hash;
    const char *const *object_names;
    int32_t object_count;
    bool nodes;             /* corner positions and facet damage of every frame */
    struct ShvMemory *memory;
} ShvRecordDefinition;
ShvRecordDefinition shv_record_default(void);

/* Opens a new file beside `path` and writes head and reference mesh. An existing file at `path` stays as it is until the
   first frame has been written and the new file takes its name. */
ShvStatus shv_record_create(ShvRecord **record, const ShvRecordDefinition *definition, const ShvSimulation *simulation,
                            ShvError *error);
/* Appends the simulation's present frame: reserves its space first, then writes and flushes. On failure the file holds
   all earlier frames and is readable. */
ShvStatus shv_record_frame(ShvRecord *record, const ShvSimulation *simulation, ShvError *error);
/* "finished", "interrupted" or "failed" by `status`; closes and releases in every case. */
ShvStatus shv_record_close(ShvRecord *record, ShvStatus status, const char *message, ShvError *error);

typedef struct ShvRunFile ShvRunFile;
typedef struct ShvRunFileInfo {
    int32_t format;
    const char *code_version, *status, *message, *scene_text, *scene_name, *processor;
    uint64_t scene_hash;
    int32_t threads;
    int32_t node_count, element_count, object_count, fragment_count;
    int64_t frame_count, event_count;
    double first_time, last_time;
    double wall_seconds;
} ShvRunFileInfo;

/* Opens for reading; a file that is being written, truncated or not of this kind is refused with a message saying so. */
ShvStatus shv_run_file_open(ShvRunFile **file, const char *path, struct ShvMemory *memory, ShvError *error);
void shv_run_file_close(ShvRunFile *file);
const ShvRunFileInfo *shv_run_file_info(const ShvRunFile *file);
const char *shv_run_file_object_name(const ShvRunFile *file, int32_t object);
/* Genealogy and constants of all fragments (poses are those of the last frame). */
ShvStatus shv_run_file_fragments(ShvRunFile *file, ShvFragmentView *fragments, ShvError *error);
/* One frame: time, mode, and pose and velocities of every fragment (fragment_count entries; dead or unborn ones have
   NaN positions and alive = 0). Any pointer may be NULL. */
ShvStatus shv_run_file_frame(ShvRunFile *file, int64_t frame, double *time, int32_t *mode, uint8_t *alive, double *positions,
                             double *orientations, double *velocities, double *angular_velocities, ShvError *error);
ShvStatus shv_run_file_ledger(ShvRunFile *file, int64_t frame, ShvLedgerView *ledger, ShvError *error);
ShvStatus shv_run_file_event(ShvRunFile *file, int64_t index, ShvEventView *event, ShvError *error);
/* Reference mesh; element_fragment: which fragment owned the tet at the last frame. */
ShvStatus shv_run_file_mesh(ShvRunFile *file, double *positions, int32_t *elements, uint16_t *element_object,
                            int32_t *element_fragment, ShvError *error);
/* Corner positions (12 per element) and facet damage (4 per element) of a frame recorded with `nodes`. */
ShvStatus shv_run_file_corners(ShvRunFile *file, int64_t frame, double *corners, double *damage, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
