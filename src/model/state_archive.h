/* What of a state goes to a checkpoint. */
#ifndef SHV_MODEL_STATE_ARCHIVE_H
#define SHV_MODEL_STATE_ARCHIVE_H

#include "base/archive.h"
#include "model/state.h"

bool shv_state_archive(ShvState *state, ShvArchive *archive);

#endif
