/* Checks of mesh definitions that several generators share. `what` names the kind of mesh in messages. */
#ifndef SHV_MESH_PARAMETERS_H
#define SHV_MESH_PARAMETERS_H

#include "base/memory.h"

/* value > 0 and finite. */
ShvStatus shv_require_length(double value, const char *what, const char *name, ShvError *error);
/* edge > 0, finite, and not so long that the thinnest part of the body (`thickness`, called `part`) would be filled with
   flat tets: at most twice as long. */
ShvStatus shv_require_edge(double edge, double thickness, const char *what, const char *part, ShvError *error);
/* Refuses an estimated number of elements that no mesh can hold. */
ShvStatus shv_require_count(double elements, double edge, const char *what, ShvError *error);

#endif
