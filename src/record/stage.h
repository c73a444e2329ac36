/* A file driver of HDF5 that makes every flush a commit: whatever ends the process, the file of the last flush can be had, and a
   full disk is noticed before anything of that file is touched.

   What goes to space that the last flush did not know is written at once, after that space was reserved. What overwrites known
   bytes waits in memory; at a flush it goes to the journal, and from time to time to the file (record/journal.h). A file that
   has no journal, since nobody else knows it yet, is changed at the flush. */
#ifndef SHV_RECORD_STAGE_H
#define SHV_RECORD_STAGE_H

#include <hdf5.h>
#include <stdbool.h>

#include "base/memory.h"

typedef struct ShvStage ShvStage;

/* A driver over an open descriptor (read and write, stays the caller's) of an empty file. */
ShvStatus shv_stage_create(ShvStage **stage, ShvMemory *memory, int descriptor, ShvError *error);
void shv_stage_release(ShvStage *stage);
/* Makes the HDF5 file, or opens it; a negative number on failure. All its metadata have checksums. */
hid_t shv_stage_make(ShvStage *stage, const char *name);
hid_t shv_stage_open(ShvStage *stage, const char *name);
/* Takes a file that was written before, whose writer may have died: to be opened next, and then given a journal. */
ShvStatus shv_stage_adopt(ShvStage *stage, const char *path, ShvError *error);
/* Brings all flushes so far to the disk. */
ShvStatus shv_stage_settle(ShvStage *stage, ShvError *error);
/* From now on every flush is safe against whatever may happen: `path` is the name of the file, `place` that of the badge; the
   changes are made in the file at most every `interval` seconds. */
ShvStatus shv_stage_journal(ShvStage *stage, const char *path, uint64_t place, double interval, ShvError *error);

/* The errno of the first write or reservation that failed, 0: none. After a failure every write is dropped silently, so that
   HDF5 can close its objects; HDF5 itself does not tell of all failures. */
int shv_stage_failure(const ShvStage *stage);
/* Drops everything since the last flush, from now on and until shv_stage_restore. */
void shv_stage_discard(ShvStage *stage);
/* Both to be called when HDF5 has closed the file. The first brings it to its last flush and takes writes again; the second
   ends the journal and gives back the space reserved beyond the last flush. */
ShvStatus shv_stage_restore(ShvStage *stage, ShvError *error);
ShvStatus shv_stage_end(ShvStage *stage, ShvError *error);

#endif
