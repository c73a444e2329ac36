/* A file of HDF5 that another process is writing (record/stage.h), as it was at one time: file and journal together, whatever
   the writer does afterwards. The writer is neither asked nor held up, and nothing is written.

   Chunks whose rows are all there never change and are read when they are asked for. Everything else, which is little, is
   copied when the snapshot is frozen. Whether the writer has changed the file in between is seen by its journal, since no byte
   that it had is changed before a mark is there: the reader then begins anew. */
#ifndef SHV_RECORD_SNAPSHOT_H
#define SHV_RECORD_SNAPSHOT_H

#include "record/series.h"

typedef struct ShvSnapshot ShvSnapshot;

/* Begins one; *bytes is the size of the file. */
ShvStatus shv_snapshot_take(ShvSnapshot **snapshot, ShvMemory *memory, const char *path, int64_t *bytes,
                            ShvError *error);
/* NULL is accepted; HDF5 must have closed the file. */
void shv_snapshot_release(ShvSnapshot *snapshot);
/* Opens the file through the snapshot; a negative number on failure. */
hid_t shv_snapshot_open(ShvSnapshot *snapshot, const char *name);
/* Copies what may change from now on; `series` are all SHV_SERIES_COUNT of the file, open or closed. */
ShvStatus shv_snapshot_freeze(ShvSnapshot *snapshot, const ShvSeries *series, ShvError *error);
/* Whether the file has been changed since the snapshot was taken: then nothing that was read from it before counts. */
bool shv_snapshot_moved(const ShvSnapshot *snapshot);

#endif
