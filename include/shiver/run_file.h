/* The run file (HDF5): written frame by frame beside a simulation, read back whole or in parts. */
#ifndef SHIVER_RUN_FILE_H
#define SHIVER_RUN_FILE_H

#include "shiver/simulation.h"

#ifdef __cplusplus
extern "C" {
#endif

/* docs/run_file.md describes every dataset. */
#define SHV_RUN_FILE_FORMAT 4

typedef struct ShvRecord ShvRecord;

typedef struct ShvRecordDefinition {
    uint32_t cookie;
    const char *path;
    bool force;             /* replace an existing file; it is replaced only when the new one has its first frame */
    const char *scene_name; /* may be NULL, as every text here but the path */
    const char *scene_text; /* stored in the file */
    const char *const *overrides; /* "a.b.c=value": what was changed of the text; stored in the file */
    int32_t override_count;
    uint64_t scene_hash;
    uint64_t
        resume_hash; /* of what a run that goes on from a checkpoint must have in common with the one that took it */
    int32_t threads; /* stored in the file */
    bool nodes;      /* corner positions (within the scene's output.nodes_within) and facet damage of every frame */
    double sync_interval; /* s of run time from one time that everything is brought to the disk to the next; 5 */
    struct ShvMemory *memory;
} ShvRecordDefinition;
ShvRecordDefinition shv_record_default(void);

/* Opens a new file beside `path` ("path.PID-N.part") and writes head and reference mesh. An existing file at `path` stays as
   it is until the first frame has been written and the new file takes its name; without `force` it is SHV_BAD_INPUT. The
   simulation may be at any time before its first frame. On failure *record is NULL and nothing is left behind. */
ShvStatus shv_record_create(ShvRecord **record, const ShvRecordDefinition *definition, const ShvSimulation *simulation,
                            ShvError *error);
/* Appends the simulation's present frame: reserves its space first, then writes and flushes. On failure (SHV_FILE_ERROR: the
   disk is full, or a limit of file size) the file holds all earlier frames and is readable; later frames are refused with
   the same message. A process that is killed at any time leaves all frames of which this has returned; a machine that stops
   leaves those that had been brought to the disk. The first reader puts such a file right from its journal, "FILE.journal". */
ShvStatus shv_record_frame(ShvRecord *record, const ShvSimulation *simulation, ShvError *error);
/* Writes "finished" (SHV_OK), "interrupted" (SHV_INTERRUPTED) or "failed" with the message (may be NULL); closes and releases
   in every case. A record without a frame leaves no file. NULL is accepted. */
ShvStatus shv_record_close(ShvRecord *record, ShvStatus status, const char *message, ShvError *error);

/* Releases a record as if its writer had died: the file stays as of its last frame. NULL is accepted. */
void shv_record_abandon(ShvRecord *record);
/* Writes a checkpoint of the simulation beside the file, "FILE.checkpoint-1" and "-2" in turn, which names the frame last written,
   after that was brought to the disk. `note`: what the caller wants to have back. Whether it succeeds or not
   nothing else has changed. The files are removed where a new run takes the place of this one, and all but the last when a run
   is closed with SHV_OK. */
ShvStatus shv_record_checkpoint(ShvRecord *record, ShvSimulation *simulation, const void *note, size_t note_size,
                                ShvError *error);
/* Goes on with the file at definition->path from the latest checkpoint whose frame the file has: loads it into a simulation that
   was just made, and cuts off what came after that frame when the next one is written; until then the file stays as it is.
   Without file or checkpoints *record is NULL, and the simulation as it was. SHV_BAD_INPUT for those of another program, scene or
   mesh, and for damaged ones. After a failure the simulation can only be destroyed. */
ShvStatus shv_record_resume(ShvRecord **record, const ShvRecordDefinition *definition, ShvSimulation *simulation,
                            void *note, size_t note_size, ShvError *error);

typedef struct ShvRunFile ShvRunFile;
typedef struct ShvRunFileInfo {
    int32_t format;
    const char *code_version, *status, *message, *scene_text, *scene_name, *processor, *rigid_engine;
    const char *overrides; /* one a line */
    bool nodes;            /* corners and damage were recorded */
    bool live;             /* another process was writing the file: it has the frames of that time */
    uint64_t scene_hash;
    int32_t threads;
    int32_t node_count, element_count, object_count, obstacle_count, fragment_count, probe_count;
    int64_t frame_count, event_count, probe_row_count;
    double first_time, last_time;
    double wall_seconds; /* from the making of the file to its last frame */
} ShvRunFileInfo;

/* Counters of the solver at one frame. */
typedef struct ShvProgressView {
    int64_t steps;          /* of fracture mode so far */
    double step, courant;   /* s: last step of fracture mode; its ratio to the stable step */
    double worst_overshoot; /* largest criterion / strength at an insertion so far */
    int32_t alive, inserted, failed;
    int32_t pieces[3]; /* as in ShvFrameView */
} ShvProgressView;

/* Opens for reading; a file that is truncated, damaged or not of this kind is refused with a message saying so. A file that
   another process is writing (it holds a lock) is read as it is at this time, whatever is added later, and without holding
   up the writer. A file whose writer was killed has the status "running" and no lock, and is put right first. */
ShvStatus shv_run_file_open(ShvRunFile **file, const char *path, struct ShvMemory *memory, ShvError *error);
void shv_run_file_close(ShvRunFile *file);
const ShvRunFileInfo *shv_run_file_info(const ShvRunFile *file);
/* Name, material and ranges in the mesh; valid as long as the file is open. */
const char *shv_run_file_object_name(const ShvRunFile *file, int32_t object);
ShvObjectView shv_run_file_object(const ShvRunFile *file, int32_t object);
/* What every material asked of its mesh and got; none in files of earlier versions. Names are valid as long as the file is open. */
int32_t shv_run_file_material_count(const ShvRunFile *file);
ShvMaterialView shv_run_file_material(const ShvRunFile *file, int32_t index);
/* Times of all frames, s, and whether they are on the animation grid; frame_count each. */
const double *shv_run_file_times(const ShvRunFile *file);
const uint8_t *shv_run_file_animation(const ShvRunFile *file);
/* The frame nearest to a time, of two the earlier one; −1 where the run has none, or does not reach to that time. The digits with which
   times are printed count as reaching (%g: six). */
int64_t shv_run_file_nearest(const ShvRunFile *file, double time);
/* The line of every fragment, named by the id of its first piece: the largest child goes on in its parent's line, of equals
   the one with the lowest reference tet. */
ShvStatus shv_run_file_lineages(ShvRunFile *file, int32_t *lineages, ShvError *error);
/* Genealogy and constants of all fragments (fragment_count); mode, pose and velocities are those of the last frame, NaN where
   the fragment is dead. */
ShvStatus shv_run_file_fragments(ShvRunFile *file, ShvFragmentView *fragments, ShvError *error);
/* One frame: time, mode, and pose and velocities of every fragment (fragment_count entries; dead or unborn ones have
   NaN positions and alive = 0). mode: SHV_FRAGMENT_FRACTURE when some fragment was in fracture mode. Any pointer may be
   NULL. */
ShvStatus shv_run_file_frame(ShvRunFile *file, int64_t frame, double *time, int32_t *mode, uint8_t *alive,
                             double *positions, double *orientations, double *velocities, double *angular_velocities,
                             ShvError *error);
ShvStatus shv_run_file_ledger(ShvRunFile *file, int64_t frame, ShvLedgerView *ledger, ShvError *error);
ShvStatus shv_run_file_progress(ShvRunFile *file, int64_t frame, ShvProgressView *progress, ShvError *error);
ShvStatus shv_run_file_event(ShvRunFile *file, int64_t index, ShvEventView *event, ShvError *error);
/* "wake", "split", …; "impact", "quiet", … */
const char *shv_run_event_name(ShvRunEvent kind);
const char *shv_switch_reason_name(ShvSwitchReason reason);
/* CRC-32 over the checksums of all frames: equal runs have the same, whatever they cost. */
ShvStatus shv_run_file_checksum(ShvRunFile *file, uint32_t *checksum, ShvError *error);
/* Reads everything once more and compares it with its checksums: SHV_BAD_INPUT names the first frame or table that is damaged. */
ShvStatus shv_run_file_verify(ShvRunFile *file, ShvError *error);
/* Poses and velocities of the obstacles (obstacle_count); the names are valid as long as the file is open. */
ShvStatus shv_run_file_obstacles(ShvRunFile *file, int64_t frame, ShvObstacleView *obstacles, ShvError *error);
/* What an obstacle is; valid as long as the file is open. */
ShvStatus shv_run_file_obstacle(ShvRunFile *file, int32_t index, ShvObstacleBody *body, ShvError *error);
/* Name of a probe, valid as long as the file is open; "" for none. */
const char *shv_run_file_probe_name(const ShvRunFile *file, int32_t probe);
/* Rows [begin, begin + count) of all probes: times (count) and samples (count × probe_count). Any pointer may be NULL. */
ShvStatus shv_run_file_probes(ShvRunFile *file, int64_t begin, int64_t count, double *times, ShvProbeSample *samples,
                              ShvError *error);
/* Cost and bytes by part as of the last frame; the arrays are valid as long as the file is open. */
ShvStatus shv_run_file_cost(ShvRunFile *file, const ShvCostView **costs, int32_t *cost_count,
                            const ShvBytesView **bytes, int32_t *bytes_count, ShvError *error);
/* Run time up to a frame: s since the file was made, and by part (cost_count of shv_run_file_cost). Any pointer may be NULL. */
ShvStatus shv_run_file_cost_at(ShvRunFile *file, int64_t frame, double *wall, double *seconds, ShvError *error);
/* Reference mesh; element_fragment: which fragment owned the tet at the last frame. Any pointer may be NULL. */
ShvStatus shv_run_file_mesh(ShvRunFile *file, double *positions, int32_t *elements, uint16_t *element_object,
                            int32_t *element_fragment, ShvError *error);
/* Of a frame with `nodes`: whether each tet is held across each of its facets (4 per element, as of shv_simulation_bonds). */
ShvStatus shv_run_file_bonds(ShvRunFile *file, int64_t frame, uint8_t *bonds, ShvError *error);
/* Corner positions (12 per element), facet damage (4 per element) and owner of each element at a frame recorded with `nodes`;
   SHV_UNSUPPORTED without. Corners that output.nodes_within left out are those of the undeformed tet in its fragment's pose. Any
   pointer may be NULL. */
ShvStatus shv_run_file_corners(ShvRunFile *file, int64_t frame, double *corners, double *damage,
                               int32_t *element_fragment, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
