/* Checkpoints: the whole state of a hybrid between two passes of its loop. */
#ifndef SHV_COUPLING_HYBRID_ARCHIVE_H
#define SHV_COUPLING_HYBRID_ARCHIVE_H

#include "base/archive.h"
#include "coupling/hybrid.h"

/* Whether the scene's rigid engine has checkpoints. */
bool shv_hybrid_has_checkpoints(const ShvHybrid *hybrid);
/* Into the archive, or from it into a hybrid that was just made of the same scene; on failure that can only be released. */
bool shv_hybrid_archive(ShvHybrid *hybrid, ShvArchive *archive);

#endif
