/* Series: the datasets of a run file that get one entry a frame (or one a row). One table serves writing and reading. */
#ifndef SHV_RECORD_SERIES_H
#define SHV_RECORD_SERIES_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

/* What the second dimension counts. */
typedef enum ShvWidth {
    SHV_WIDTH_NONE,
    SHV_WIDTH_FRAGMENT,
    SHV_WIDTH_OBSTACLE,
    SHV_WIDTH_ELEMENT,
    SHV_WIDTH_COST,
    SHV_WIDTH_BYTES,
    SHV_WIDTH_PROBE,
    SHV_WIDTH_COUNT
} ShvWidth;

typedef enum ShvSeriesName {
    SHV_SERIES_TIME,
    SHV_SERIES_MODE,      /* 1: some fragment is in fracture mode */
    SHV_SERIES_ANIMATION, /* 1: on the animation grid */
    SHV_SERIES_POSITION,
    SHV_SERIES_ORIENTATION,
    SHV_SERIES_VELOCITY,
    SHV_SERIES_ANGULAR_VELOCITY,
    SHV_SERIES_ALIVE,
    SHV_SERIES_OBSTACLE_POSITION,
    SHV_SERIES_OBSTACLE_ORIENTATION,
    SHV_SERIES_OBSTACLE_VELOCITY,
    SHV_SERIES_OBSTACLE_ANGULAR_VELOCITY,
    SHV_SERIES_LEDGER,
    SHV_SERIES_PROGRESS,
    SHV_SERIES_WALL,
    SHV_SERIES_COST_SECONDS,
    SHV_SERIES_COST_CALLS,
    SHV_SERIES_BYTES,
    SHV_SERIES_BYTES_PEAK,
    SHV_SERIES_CORNERS, /* this and the next three only with `nodes` */
    SHV_SERIES_DAMAGE,
    SHV_SERIES_BOND,
    SHV_SERIES_NODE_FRAGMENT,
    SHV_SERIES_SUM,                           /* sizes of the rest, and checksum of the entries above */
    SHV_SERIES_FRAMES,                        /* the number of those above: one entry a frame */
    SHV_SERIES_FRAGMENTS = SHV_SERIES_FRAMES, /* one row a fragment; also the next */
    SHV_SERIES_LINEAGE,
    SHV_SERIES_EVENTS,     /* one row an event */
    SHV_SERIES_PROBE_TIME, /* one row a sample; this and the next only where there are probes */
    SHV_SERIES_PROBE_SAMPLES,
    SHV_SERIES_COUNT
} ShvSeriesName;

typedef struct ShvSeries {
    hid_t dataset, memory_type, file_type; /* negative: closed */
    ShvSeriesName name;
    hsize_t extent[3];
    int rank;
    ShvWidth width;
    size_t entry_size;  /* bytes in memory of one column of one frame */
    size_t stored_size; /* the same in the file */
    bool doubles;
    unsigned char *stored; /* what is being written, as it lies in the file */
    size_t room;
} ShvSeries;

/* The counts that the second dimensions have; SHV_WIDTH_FRAGMENT: those expected at most, for the size of chunks. */
typedef struct ShvWidths {
    int64_t count[SHV_WIDTH_COUNT];
} ShvWidths;

bool shv_series_of_nodes(ShvSeriesName name);
bool shv_series_of_probes(ShvSeriesName name);
/* Run times and memory: they differ between equal runs, and frames have the same checksum whatever they are. */
bool shv_series_of_cost(ShvSeriesName name);
const char *shv_series_path(ShvSeriesName name);
/* Makes the empty dataset; its group must exist. False when HDF5 fails. */
bool shv_series_create(ShvSeries *series, hid_t file, ShvSeriesName name, const ShvWidths *widths);
/* Opens it and checks that shape and types are those of the table. */
bool shv_series_open(ShvSeries *series, hid_t file, ShvSeriesName name);
void shv_series_close(ShvSeries *series);

/* Writes entries [begin, begin + count) with `columns` columns each, extending both dimensions as needed; *sum (may be NULL)
   goes on over the bytes as they lie in the file (CRC-32, zlib's). */
bool shv_series_write(ShvSeries *series, int64_t begin, int64_t count, int64_t columns, const void *data,
                      uint32_t *sum);
/* Leaves the first `count` entries, of fragments so many columns. */
bool shv_series_cut(ShvSeries *series, int64_t count, int64_t fragments);
/* Reads them to `data` (columns × components × count). What the file does not have becomes NaN or 0. */
bool shv_series_read(const ShvSeries *series, int64_t begin, int64_t count, int64_t columns, void *data);
/* Goes on with *sum over the same bytes, read back; false where they cannot be read. */
bool shv_series_sum(const ShvSeries *series, int64_t begin, int64_t count, int64_t columns, uint32_t *sum);
/* Whether a file of `file_bytes` bytes can hold `count` entries: deflate reaches 1032:1 at most, and what is not
   deflated takes its size. Guards allocations against the counts of a damaged file. */
bool shv_series_plausible(const ShvSeries *series, int64_t file_bytes);

#endif
