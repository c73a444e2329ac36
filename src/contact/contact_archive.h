/* What of contact and conditions goes to a checkpoint. */
#ifndef SHV_CONTACT_CONTACT_ARCHIVE_H
#define SHV_CONTACT_CONTACT_ARCHIVE_H

#include "base/archive.h"
#include "conditions/imposed.h"
#include "contact/surface_contact.h"

bool shv_node_contact_archive(ShvNodeContact *contact, ShvArchive *archive);
bool shv_surface_contact_archive(ShvSurfaceContact *contact, ShvArchive *archive);
bool shv_imposed_archive(ShvImposed *imposed, ShvArchive *archive);

#endif
