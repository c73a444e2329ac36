/* What of contact goes to a checkpoint. */
#ifndef SHV_CONTACT_CONTACT_ARCHIVE_H
#define SHV_CONTACT_CONTACT_ARCHIVE_H

#include "base/archive.h"
#include "contact/surface_contact.h"

bool shv_surface_contact_archive(ShvSurfaceContact *contact, ShvArchive *archive);

#endif
