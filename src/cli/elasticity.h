/* What a run file tells of its scene: moduli of the objects, and whether there were convex pieces. */
#ifndef SHV_CLI_ELASTICITY_H
#define SHV_CLI_ELASTICITY_H

#include "base/memory.h"
#include "shiver/export.h"

/* One an object, to be released with shv_release; NULL, which is no failure, where an earlier version wrote none. */
ShvStatus shv_cli_elasticity(const ShvRunFile *file, ShvElasticity **elasticity, ShvError *error);
/* Whether the scene's rigid engine moves bodies as convex pieces; false, too, where an earlier version wrote the file. */
bool shv_cli_made_convex_pieces(const ShvRunFile *file);

#endif
