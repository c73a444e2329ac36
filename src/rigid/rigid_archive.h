/* What of fragments and of flight goes to a checkpoint. */
#ifndef SHV_RIGID_RIGID_ARCHIVE_H
#define SHV_RIGID_RIGID_ARCHIVE_H

#include "base/archive.h"
#include "rigid/flight_body.h"

bool shv_fragments_archive(ShvFragments *fragments, ShvArchive *archive);
bool shv_flight_body_archive(ShvFlightBody *body, ShvArchive *archive);

#endif
