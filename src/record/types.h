/* Compound types of the run file: rows of /fragments/list, /events, /ledger and /progress are the public structs. */
#ifndef SHV_RECORD_TYPES_H
#define SHV_RECORD_TYPES_H

#include <hdf5.h>

#include "shiver/run_file.h"

typedef enum ShvRow {
    SHV_ROW_FRAGMENT,
    SHV_ROW_EVENT,
    SHV_ROW_LEDGER,
    SHV_ROW_PROGRESS,
    SHV_ROW_SUM,
    SHV_ROW_OBSTACLE
} ShvRow;

/* A row of /frames: how much of the rest belongs to the frames up to this one, and a checksum of the frame. */
typedef struct ShvFrameSum {
    int64_t fragments, events, probe_rows;
    int64_t checksum; /* docs/run_file.md tells of what */
} ShvFrameSum;

/* A row of /obstacles/list; half-open ranges in /obstacles/nodes and /obstacles/triangles. */
typedef struct ShvObstacleRow {
    ShvObstacleShape shape;
    ShvObstacleMotion motion;
    double normal[3], offset, radius, size[3], mass, friction, restitution;
    int32_t nodes[2], triangles[2];
} ShvObstacleRow;

/* The row as it lies in memory, and as it lies in the file (packed, little-endian). Both are closed by the caller;
   negative on failure. SHV_ROW_FRAGMENT leaves mode, pose and velocities out: those are in /trajectory. */
hid_t shv_row_memory_type(ShvRow row);
hid_t shv_row_file_type(ShvRow row);
/* `count` rows as they lie in the file, packed. */
void shv_row_pack(ShvRow row, const void *rows, size_t count, unsigned char *packed);

#endif
