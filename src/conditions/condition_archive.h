/* What of conditions goes to a checkpoint. */
#ifndef SHV_CONDITIONS_CONDITION_ARCHIVE_H
#define SHV_CONDITIONS_CONDITION_ARCHIVE_H

#include "base/archive.h"
#include "conditions/imposed.h"

bool shv_imposed_archive(ShvImposed *imposed, ShvArchive *archive);

#endif
