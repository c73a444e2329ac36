/* What of position based dynamics goes to a checkpoint. */
#ifndef SHV_PBD_PBD_ARCHIVE_H
#define SHV_PBD_PBD_ARCHIVE_H

#include "base/archive.h"
#include "pbd/pbd_body.h"

bool shv_bars_archive(ShvBars *bars, ShvArchive *archive);
bool shv_relax_archive(ShvRelax *relax, ShvArchive *archive);
bool shv_ties_archive(ShvTies *ties, ShvArchive *archive);
bool shv_pbd_body_archive(ShvPbdBody *body, ShvArchive *archive);

#endif
