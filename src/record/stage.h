/* A file driver of HDF5 that makes every flush a commit: a process that dies at any moment leaves the file of the last
   flush, and a full disk is noticed before anything of that file is touched.

   HDF5 writes its metadata in the order of addresses, so that a writer killed within a flush may leave an index whose
   root points to nodes not yet written. Here, what goes to space that the last flush did not know is written at once,
   after that space was reserved; what overwrites known bytes waits in memory until the flush, and is then written in an
   order in which every prefix is a valid file: end of allocation, index nodes from the root down, data, object headers. */
#ifndef SHV_RECORD_STAGE_H
#define SHV_RECORD_STAGE_H

#include <hdf5.h>
#include <stdbool.h>

#include "base/memory.h"

typedef struct ShvStage ShvStage;

/* A driver over an open descriptor (read and write, stays the caller's) of a file of `size` committed bytes; 0: new. */
ShvStatus shv_stage_create(ShvStage **stage, ShvMemory *memory, int descriptor, int64_t size, ShvError *error);
void shv_stage_release(ShvStage *stage);
/* A file access property list for H5Fcreate or H5Fopen, or a negative number; the caller closes it. */
hid_t shv_stage_access(ShvStage *stage);

/* Bytes of the file as of the last flush. */
int64_t shv_stage_committed(const ShvStage *stage);
/* The errno of the first write or reservation that failed, 0: none. After a failure every write is dropped silently,
   so that HDF5 can close its objects; the file on disk stays as of the last flush. */
int shv_stage_failure(const ShvStage *stage);
/* Drops everything since the last flush, from now on and until shv_stage_rollback. */
void shv_stage_discard(ShvStage *stage);
/* To be called when HDF5 has closed the file: cuts what was not committed and takes writes again. */
ShvStatus shv_stage_rollback(ShvStage *stage, ShvError *error);

#endif
