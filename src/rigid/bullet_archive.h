/* Checkpoints of the Bullet backend. Bullet's world itself remembers nothing: its bodies are made again from their convex
   pieces, and told where those are that nobody will tell it of in the next step. */
#ifndef SHV_RIGID_BULLET_ARCHIVE_H
#define SHV_RIGID_BULLET_ARCHIVE_H

#include "rigid/bullet_step.h"

/* backend.h */
bool shv_bullet_archive(ShvRigidBackend *backend, ShvArchive *archive);

#endif
