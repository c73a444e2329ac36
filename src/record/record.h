/* Inside of a record, for the files of this folder. */
#ifndef SHV_RECORD_RECORD_H
#define SHV_RECORD_RECORD_H

#include "record/checkpoint.h"
#include "record/materials.h"
#include "record/series.h"
#include "record/stage.h"
#include "shiver/run_file.h"

/* Size of the root attribute "message": it is filled in at the end without new space. */
enum { SHV_RECORD_MESSAGE = 1024, SHV_RECORD_STATUS = 16 };

/* By fragment. */
typedef struct ShvLineage {
    int32_t *lineage;
    int32_t *first_element, *heir; /* scratch */
} ShvLineage;

struct ShvRecord {
    ShvMemory *memory;
    char *path, *temporary; /* temporary: NULL once the file has its name */
    bool force, nodes;
    int descriptor;
    ShvStage *stage;
    hid_t file, owners; /* owners: /fragments/elements */
    uint64_t badge;     /* address of the journal's badge in the file */
    double sync_interval;
    ShvSeries series[SHV_SERIES_COUNT];
    int32_t element_count, obstacle_count, cost_count, bytes_count, probe_count;
    int64_t frames, events, probe_rows;
    int32_t fragment_count;     /* rows of /fragments/list */
    ShvFragmentView *fragments; /* as they were last written */
    int32_t fragment_capacity;
    ShvLineage lines;
    uint32_t sums[SHV_SERIES_SUM]; /* of what has been put of the frame */
    double *values;                /* one frame of one series */
    size_t value_capacity;
    int32_t *element_fragment;
    ShvNodesWithin within;
    uint8_t *chosen;        /* per element, whether its corners are recorded; NULL: all are */
    double *corners;        /* 12 × element_count with `nodes`, else NULL */
    double start;           /* s, shv_now */
    int64_t last_checksum;  /* of the last frame */
    bool resumed;           /* and no frame has been written since */
    uint64_t resume_hash;   /* ShvRecordDefinition */
    ShvCheckpointMark mark; /* of the last checkpoint; hashes are found for the first */
    ShvError broken;        /* status SHV_OK: nothing has failed so far */
};

/* A record without a file, room of it for a mesh, and its end (record.c). */
ShvStatus shv_record_prepare(ShvRecord **record, const ShvRecordDefinition *definition, ShvError *error);
ShvStatus shv_record_allocate(ShvRecord *record, const ShvRecordDefinition *definition, const ShvMeshView *mesh,
                              ShvError *error);
void shv_record_release(ShvRecord *record);

/* within.c: which corners are recorded; and those that are not become NaN in the frame that is written. */
ShvStatus shv_within_prepare(ShvRecord *record, const ShvSimulation *simulation, const ShvMeshView *mesh,
                             ShvError *error);
void shv_within_blank(ShvRecord *record, double time);

/* Groups, root attributes, scene, mesh (head.c); false when HDF5 fails. */
bool shv_record_write_head(hid_t file, const ShvRecordDefinition *definition, const ShvSimulation *simulation);
bool shv_record_write_mesh(hid_t file, const ShvMeshView *mesh, hid_t *owners);
/* Room for the journal's badge, and where it is. */
bool shv_record_write_badge(hid_t file, uint64_t *address);
bool shv_record_find_badge(hid_t file, uint64_t *address);
/* Of a run that goes on with other ones. */
bool shv_record_rewrite_overrides(hid_t file, const ShvRecordDefinition *definition);
/* /materials: what every material asks of its mesh and gets. */
bool shv_record_write_materials(hid_t file, const ShvSimulation *simulation);
/* /obstacles: what they are. */
bool shv_record_write_obstacles(hid_t file, const ShvSimulation *simulation, int32_t count);
bool shv_record_write_names(hid_t file, const ShvFrameView *frame);

/* Appends a frame to all series (frame.c). */
ShvStatus shv_record_append(ShvRecord *record, const ShvSimulation *simulation, ShvError *error);
/* Lines of the fragments [known, count): the largest child goes on in its parent's line, of equals the one with the lowest
   reference tet; every other fragment begins its own, named by its id. `owner` is the fragment of each of the elements. */
void shv_lineage_extend(const ShvLineage *lines, const ShvFragmentView *fragments, int32_t known, int32_t count,
                        const int32_t *owner, int32_t element_count);
/* The checksum of a frame from those of its parts. */
int64_t shv_frame_checksum(const uint32_t sums[SHV_SERIES_SUM], uint32_t events, uint32_t probe_times,
                           uint32_t probe_samples);
/* The message of what HDF5 or the driver below it could not do. */
ShvStatus shv_record_fail(const ShvRecord *record, ShvError *error);

#endif
