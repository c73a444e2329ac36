/* Inside of an open run file, for the files of this folder. */
#ifndef SHV_RECORD_RUN_FILE_H
#define SHV_RECORD_RUN_FILE_H

#include "record/series.h"
#include "shiver/run_file.h"

typedef struct ShvRunTexts {
    char code_version[64], status[32], message[1100], scene_name[1024], processor[256];
} ShvRunTexts;

struct ShvRunFile {
    ShvMemory *memory;
    char *path;
    int64_t bytes; /* of the file */
    hid_t file;
    ShvSeries series[SHV_SERIES_COUNT];
    ShvRunFileInfo info;
    ShvRunTexts texts;
    char *scene_text, *overrides, *object_names, *object_materials, *obstacle_names, *cost_names, *part_names;
    size_t obstacle_name_size;
    ShvObjectView *objects;
    double *times;
    uint8_t *modes, *animation; /* one block */
    ShvCostView *costs;   /* read when asked for */
    ShvBytesView *parts;
};

#endif
