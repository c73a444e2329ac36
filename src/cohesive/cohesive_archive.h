/* What of cohesive facets goes to a checkpoint. */
#ifndef SHV_COHESIVE_COHESIVE_ARCHIVE_H
#define SHV_COHESIVE_COHESIVE_ARCHIVE_H

#include "base/archive.h"
#include "cohesive/cohesive.h"

/* `awake`: the flags that shv_cohesive_begin is called with. */
bool shv_cohesive_archive(ShvCohesive *cohesive, const uint8_t *awake, ShvArchive *archive);

#endif
