/* Inside of an open run file, for the files of this folder. */
#ifndef SHV_RECORD_RUN_FILE_H
#define SHV_RECORD_RUN_FILE_H

#include "record/series.h"
#include "record/snapshot.h"
#include "shiver/run_file.h"

typedef struct ShvRunTexts {
    char code_version[64], status[32], message[1100], scene_name[1024], processor[256], rigid_engine[32];
} ShvRunTexts;

typedef struct ShvObstacleBodies ShvObstacleBodies;

struct ShvRunFile {
    ShvMemory *memory;
    char *path;
    int64_t bytes;         /* of the file */
    bool partial;          /* corners that were left out are NaN */
    ShvSnapshot *snapshot; /* NULL: nobody writes the file */
    hid_t file;
    ShvSeries series[SHV_SERIES_COUNT];
    ShvRunFileInfo info;
    ShvRunTexts texts;
    char *scene_text, *overrides, *object_names, *object_materials, *obstacle_names, *cost_names, *part_names,
        *probe_names;
    ShvObstacleBodies *bodies; /* of the obstacles; read when asked for */
    size_t obstacle_name_size, probe_name_size;
    ShvObjectView *objects;
    char *material_names;
    ShvMaterialView *materials;
    int32_t material_count;
    double *times;
    uint8_t *modes, *animation; /* one block */
    ShvCostView *costs;         /* read when asked for */
    ShvBytesView *parts;
};

ShvStatus shv_run_fail_damaged(const ShvRunFile *file, const char *what, ShvError *error);
ShvStatus shv_run_check_frame(const ShvRunFile *file, int64_t frame, ShvError *error);
ShvStatus shv_run_read_materials(ShvRunFile *file, ShvError *error);
/* Reads one entry of a series quietly; nothing when `data` is NULL. */
ShvStatus shv_run_get(ShvRunFile *file, ShvSeriesName name, int64_t index, int64_t columns, void *data,
                      ShvError *error);
/* Reads a whole array of int32_t or double whose extents must be these; columns 0: one dimension. */
ShvStatus shv_run_read_array(const ShvRunFile *file, const char *path, int64_t rows, int64_t columns, bool real,
                             void *data, ShvError *error);
/* Fails where an array of int32_t or double has not so many rows of three. */
ShvStatus shv_run_check_rows(const ShvRunFile *file, const char *path, bool real, int32_t rows, ShvError *error);
/* within.c: corners that are NaN become those of the undeformed tet in its fragment's pose. */
ShvStatus shv_within_fill(ShvRunFile *file, int64_t frame, double *corners, ShvError *error);
ShvStatus shv_run_obstacle_names(ShvRunFile *file, ShvError *error);
void shv_obstacle_bodies_release(ShvObstacleBodies *bodies);
/* *count terminated texts of *size bytes each; rank 0: one text. The caller releases *texts, also after a failure. */
ShvStatus shv_run_read_texts(const ShvRunFile *file, const char *path, int rank, char **texts, size_t *size,
                             int32_t *count, ShvError *error);

#endif
