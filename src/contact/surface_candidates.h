/* Which nodes may soon meet which facets. */
#ifndef SHV_CONTACT_SURFACE_CANDIDATES_H
#define SHV_CONTACT_SURFACE_CANDIDATES_H

#include "contact/surface_contact.h"

/* Makes lists and candidates anew when they may no longer hold, and adds those of cracks that have parted. What it decides
   depends on the state at time n and the velocities before it alone, so that it does not matter how often it is called for
   one moment. */
ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         double gravity, ShvError *error);
/* Largest speeds against the frame of the nodes of candidates and of obstacles, m/s, into contact->speed. */
void shv_surface_candidates_look(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies);

#endif
