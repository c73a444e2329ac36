/* Rigid flight as the chapter has it: the nodes of a fragment fly on their own, damped towards rigid motion, with bars
   that hold them together and obstacle projections inside the relaxation. */
#ifndef SHV_PBD_PBD_BACKEND_H
#define SHV_PBD_PBD_BACKEND_H

#include "rigid/backend.h"

/* One step of a fragment: damping (Table 6.1); p = x + dt v + dt² g/2, or with exact_rotation the rigid part of the motion
   turned about the centre of mass as a free body of the nodes' present inertia, so that radii do not drift; relaxation
   (relax.h); v += dt g + (projected − predicted)/dt. All fragments in flight are relaxed together.

   A contact that would close within the step goes to the judge; `fresh` tells that the fragment did not touch that obstacle
   in its step before (or when it was added). When accepted the fragment stops at the START of the step: the collision is
   then resolved in fracture mode with its smaller steps. Contact work holds the change of kinetic energy and, for what
   projections lift, of potential energy: all works together balance the energy of the nodes to round-off. The inertia of
   a fragment's record is that of its reference shape, so that fitted angular velocities are right to the strain.

   `pbd` must outlive the backend. Impossible settings are refused. */
ShvStatus shv_pbd_create(ShvRigidBackend **backend, const ShvRigidWorld *world, const ShvPbdDefinition *pbd,
                         ShvError *error);

#endif
