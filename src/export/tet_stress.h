/* Stress of a tet from where its corners are. */
#ifndef SHV_EXPORT_TET_STRESS_H
#define SHV_EXPORT_TET_STRESS_H

#include "shiver/export.h"

/* Largest principal Cauchy stress, Pa, of an isotropic tet at rest in `rest` with its corners at `now`: St. Venant-Kirchhoff,
   which for small strains is the solver's law. NaN where the tet is flat or inside out. */
double shv_tet_stress(const double rest[12], const double now[12], ShvElasticity elasticity);

#endif
